"""Plots of results, by matplotlib where it is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ferntast._native import RefusedError

if TYPE_CHECKING:
    import matplotlib.figure

    from ferntast.record import Record


def _subplots(rows: int, columns: int, **how: Any) -> tuple[matplotlib.figure.Figure, Any]:
    try:
        import matplotlib.figure
    except ImportError as error:
        raise RefusedError("plots need matplotlib: pip install 'ferntast[plot]'") from error
    figure = matplotlib.figure.Figure(figsize=(9, 2.4 * rows), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **how)


def comparison(result: Record) -> matplotlib.figure.Figure:
    """Measured and modelled torque and residual of every session; residual maps below."""
    series = [own.to_dict() for own in result.series]
    maps = [own.to_dict() for own in result.residual_maps]
    figure, axes = _subplots(2 + (len(maps) + 1) // 2, 2)
    for axis in axes[:2].flat:
        axis.remove()
    grid = axes[0][0].get_gridspec()
    torque = figure.add_subplot(grid[0, :])
    residual = figure.add_subplot(grid[1, :], sharex=torque)
    start = 0.0
    for number, own in enumerate(series):
        time = [start + at for at in own["time"]]
        rest = [m - p for m, p in zip(own["measured"], own["modelled"], strict=True)]
        label = number == 0
        torque.plot(time, own["measured"], "C0", lw=0.8, label="measured" if label else None)
        torque.plot(time, own["modelled"], "C1", lw=0.8, label="modelled" if label else None)
        residual.plot(time, rest, "C3", lw=0.8)
        start = time[-1] if time else start
    torque.set_title(result.title)
    torque.set_ylabel(result.unit)
    torque.legend(loc="upper right")
    residual.set_ylabel(f"residual [{result.unit}]")
    residual.set_xlabel("time [s]")
    for axis, own in zip(axes[2:].flat, maps, strict=False):
        bins = own["bins"]
        at, mean, spread = ([one[key] for one in bins] for key in ("at", "mean", "spread"))
        axis.errorbar(at, mean, spread, fmt="o-", ms=3, lw=0.8)
        axis.set_xlabel(f"{own['signal']} [{own['unit']}]")
        axis.set_ylabel(f"residual [{result.unit}]")
    for axis in axes[2:].flat[len(maps) :]:
        axis.remove()
    return figure


def diagnosis(result: Record) -> matplotlib.figure.Figure:
    """The error held out, as it is and with each candidate."""
    figure, axes = _subplots(1, 1)
    rows = [("as it is", result.rms.held_out)]
    rows += [(f"+ {own.effect}", own.held_out_after) for own in result.candidates]
    names, errors = zip(*reversed(rows), strict=True)
    axes[0][0].barh(names, errors)
    axes[0][0].set_xlabel(f"error held out [{result.unit}]")
    axes[0][0].set_title(f"{result.title}: {result.verdict}")
    return figure


def discovery(result: Record) -> matplotlib.figure.Figure:
    """Each formula beside what was measured: curves over one signal, maps over two."""
    formulas = result.to_dict()["formulas"]
    figure, axes = _subplots(max(1, len(formulas)), 2)
    figure.suptitle(f"{result.title}: {result.verdict}")
    if not formulas:
        for axis in axes.flat:
            axis.remove()
        figure.text(0.5, 0.4, "no formula is proposed", ha="center")
    for (left, right), own in zip(axes, formulas, strict=False):
        chart = own["map"]
        names = [f"{n} [{u}]" for n, u in zip(chart["signals"], chart["units"], strict=True)]
        both = [[float("nan") if x is None else x for x in chart[k]] for k in ("measured", "formula")]
        if len(names) == 1:
            left.plot(chart["axes"][0], both[0], "o", ms=3, label="measured")
            left.plot(chart["axes"][0], both[1], "-", label="formula")
            left.set_ylabel(f"residual [{result.unit}]")
            left.set_xlabel(names[0])
            left.legend()
            right.axis("off")
        else:
            size = max((abs(x) for values in both for x in values if x == x), default=1.0)
            across, along = chart["axes"][0], chart["axes"][1]
            for axis, values, what in zip((left, right), both, ("measured", "formula"), strict=True):
                rows = [values[i * len(along) : (i + 1) * len(along)] for i in range(len(across))]
                drawn = axis.pcolormesh(along, across, rows, vmin=-size, vmax=size, cmap="RdBu_r")
                axis.set_xlabel(names[1])
                axis.set_ylabel(names[0])
                axis.set_title(f"{what} [{result.unit}]", fontsize="small")
                figure.colorbar(drawn, ax=axis)
        left.set_title(own["expression"], fontsize="small", loc="left")
    return figure


def automatic(result: Record) -> matplotlib.figure.Figure:
    """The error held out, falling step by step."""
    figure, axes = _subplots(1, 1)
    steps = result.steps
    errors = [own.held_out_before for own in steps[:1]] + [own.held_out_after for own in steps]
    names = (["as it was"] if steps else []) + [f"+ {own.effect}" for own in steps]
    axes[0][0].plot(names, errors, "o-")
    axes[0][0].set_ylabel(f"error held out [{result.last.unit}]")
    axes[0][0].set_title(f"{result.title}: {result.verdict}")
    return figure


def sweep(result: Record) -> matplotlib.figure.Figure:
    """The share of trials that is stable, by law over the round trip."""
    figure, axes = _subplots(1, 1)
    counts: dict[str, dict[float, list[bool]]] = {}
    for row in result.to_dict()["rows"]:
        counts.setdefault(row["law"], {}).setdefault(row["rtt_ms"], []).append(row["stable"])
    for law, by_delay in counts.items():
        delays = sorted(by_delay)
        shares = [sum(by_delay[own]) / len(by_delay[own]) for own in delays]
        axes[0][0].plot(delays, shares, "o-", label=law)
    axes[0][0].set_xlabel("round trip [ms]")
    axes[0][0].set_ylabel("share stable")
    axes[0][0].legend()
    return figure
