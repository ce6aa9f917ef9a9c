"""What runs in virtual time: `ferntast lockstep` and `ferntast sweep`."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping

from ferntast import _native
from ferntast.experiment import PathLike
from ferntast.results import Lockstep, Sweep

Progress = Callable[[float], object] | None


def lockstep(
    scenario: str = "rokviss",
    *,
    link: str | None = None,
    law: str | None = None,
    rtt_ms: float | None = None,
    hand: str | None = None,
    seed: int | None = None,
    duration: float | None = None,
    switch: Mapping[float, str] | None = None,
    twin: Iterable[PathLike] = (),
    take_over: float | None = None,
    give_back: float | None = None,
    record: PathLike | None = None,
    progress: Progress = None,
) -> Lockstep:
    """Runs a scenario, shipped or a file, in one process and virtual time.

    `duration` [s] is that of the scenario unless given; `switch` changes the delay law so many
    seconds after the start, as in `{5.0: "wave"}`; `record` is a folder that must not exist.
    The same seed gives the same recording. Ctrl-C closes the recording.
    """
    text = _native.lockstep(
        scenario,
        link,
        law,
        rtt_ms,
        hand,
        seed,
        duration,
        list((switch or {}).items()),
        list(twin),
        take_over,
        give_back,
        record,
        progress,
    )
    return Lockstep(json.loads(text))


def sweep(
    config: str = "delay_sweep", *, laws: Iterable[str] = (), progress: Progress = None
) -> Sweep:
    """Holds the delay laws against each other over delay, jitter, loss and environment, on
    every processor. `config` is a shipped sweep or a file; `laws` are only these of it."""
    swept = json.loads(_native.sweep(config, list(laws), progress))
    return Sweep({"rows": swept["rows"]}, text=swept["text"])
