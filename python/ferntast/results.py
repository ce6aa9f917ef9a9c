"""Results: the fields of the command line's JSON, with tables and plots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ferntast import plots
from ferntast.record import Record, wrapped

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

    from ferntast.experiment import Experiment


class _Answer(Record):
    """A result of the lab about one experiment."""

    title: str
    """The experiment's title."""
    notes: list[str]
    """What was noticed while reading."""

    def __init__(self, fields: dict[str, Any], title: str, notes: list[str]) -> None:
        super().__init__(fields)
        self.title = title
        self.notes = notes


class Comparison(_Answer):
    """A model against recordings."""

    unit: str
    samples: int
    """In the recordings that are fitted."""
    used: Record
    """What of the recordings is used: `samples`, `share`, `by_reason` (samples by what becomes of
    them), `rows` (fitted), `speed_range`, `cutoff_hz`, …"""
    rms: Record
    """Errors in `unit`: `train` on rows fitted, `held_out` on rows left out."""
    relative_error: float
    relative_error_held_out: float
    held_out_by: str
    parameters: Record
    """By name: `value`, `std_error` (`None` where searched), `unit`, `effect`."""
    not_excited: list[str]
    condition: float
    noise: Record
    residual_maps: list[Record]
    worst: list[Record]
    extrapolated: list[Record]
    simulation: Record | None
    series: list[Record]
    """Of each session: `time`, `position`, `velocity`, `acceleration`, `measured`, `modelled`,
    `used`; thinned."""

    @classmethod
    def from_answer(cls, answer: dict[str, Any], _experiment: Experiment) -> Comparison:
        """From what the compiled part says."""
        found = cls(answer["result"], answer["title"], answer["notes"])
        found.series = wrapped(answer["series"])
        return found

    def to_pandas(self) -> pandas.DataFrame:
        """The parameters, one a row."""
        return _parameters(self._fields["parameters"])

    def plot(self) -> matplotlib.figure.Figure:
        """Measured and modelled torque over time, the residual, and where it is large."""
        return plots.comparison(self)


class Diagnosis(_Answer):
    """Which effect a model lacks."""

    unit: str
    samples: int
    used: Record
    """As of a comparison."""
    verdict: str
    """`missing`, `complete` or `unexplained`."""
    rms: Record
    noise_floor: float | None
    noise: Record
    candidates: list[Record]
    """Effects that pass all tests, best first: `effect`, `held_out_before`, `held_out_after`,
    `p_value`, `share`, `parameters`, `indistinguishable_from`, `next_experiment`, …"""
    suspected: list[Record]
    residual_depends_on: list[Record]
    tried: int
    not_tested: list[str]
    """Effects that these recordings cannot show, whatever the verdict."""
    why_not_tested: list[str]
    """The same in words, a line for each reason."""

    @classmethod
    def from_answer(cls, answer: dict[str, Any], _experiment: Experiment) -> Diagnosis:
        """From what the compiled part says."""
        return cls(answer["result"], answer["title"], answer["notes"])

    def to_pandas(self) -> pandas.DataFrame:
        """The candidates, one a row."""
        keys = ["held_out_before", "held_out_after", "p_value", "share", "share_std_error"]
        rows = {own["effect"]: own for own in self._fields["candidates"]}
        return _frame(rows, keys, "effect")

    def plot(self) -> matplotlib.figure.Figure:
        """The error held out, as it is and with each candidate."""
        return plots.diagnosis(self)


class Discovery(_Answer):
    """Formulas for what no effect of the catalogue explains."""

    unit: str
    verdict: str
    """`missing`, `complete` or `unexplained`; formulas are searched where it is the last."""
    rms: Record
    formulas: list[Record]
    """Best first: `name`, `expression`, `form`, `parameters`, `signals`, `held_out_before`,
    `held_out_after`, `p_value`, `complexity`, `cannot_be_told_from`, `next_experiment`, …; of a
    whole arm also `joint`."""
    residual_depends_on: list[Record]
    tried: int

    @classmethod
    def from_answer(cls, answer: dict[str, Any], _experiment: Experiment) -> Discovery:
        """From what the compiled part says."""
        return cls(answer["result"], answer["title"], answer["notes"])

    def to_pandas(self) -> pandas.DataFrame:
        """The formulas, one a row."""
        import pandas

        keys = ["expression", "held_out_before", "held_out_after", "p_value", "complexity"]
        formulas = self._fields["formulas"]
        if any("joint" in own for own in formulas):
            keys.insert(0, "joint")
        return pandas.DataFrame([[own[key] for key in keys] for own in formulas], columns=keys)

    def plot(self) -> matplotlib.figure.Figure:
        """Each formula beside what was measured, over its signals."""
        return plots.discovery(self)


class Added(_Answer):
    """An effect added to a model."""

    unit: str
    effect: str
    held_out_before: float
    held_out_after: float
    parameters: Record
    not_excited: list[str]
    experiment: Experiment
    """The new experiment."""

    @classmethod
    def from_answer(cls, answer: dict[str, Any], experiment: Experiment) -> Added:
        """From what the compiled part says."""
        found = cls(answer["result"], answer["title"], answer["notes"])
        found.experiment = experiment.child(answer["result"]["experiment"])
        return found

    def to_pandas(self) -> pandas.DataFrame:
        """The parameters, one a row."""
        return _parameters(self._fields["parameters"])


class Automatic(_Answer):
    """What came of adding what is missing, again and again."""

    steps: list[Record]
    verdict: str
    last: Record
    """The diagnosis of the last model."""
    experiment: Experiment
    """The last experiment."""

    @classmethod
    def from_answer(cls, answer: dict[str, Any], experiment: Experiment) -> Automatic:
        """From what the compiled part says."""
        found = cls(answer["result"], answer["title"], answer["notes"])
        found.experiment = experiment.child(answer["result"]["experiment"])
        return found

    def to_pandas(self) -> pandas.DataFrame:
        """The steps, one a row."""
        rows = {own["effect"]: own for own in self._fields["steps"]}
        return _frame(rows, ["held_out_before", "held_out_after"], "effect")

    def plot(self) -> matplotlib.figure.Figure:
        """The error held out, falling step by step."""
        return plots.automatic(self)


class Lockstep(Record):
    """A scenario in virtual time."""

    scenario: str
    seed: int
    duration_s: float
    wall_s: float
    real_time_factor: float
    link: Record
    contact: Record
    leader: Record
    twins: list[Record]
    friction: list[Record]
    states: Record
    recording: str | None
    recording_fault: str | None


class Sweep(Record):
    """Trials of delay laws."""

    rows: list[Record]

    def __init__(self, fields: dict[str, Any], text: str) -> None:
        super().__init__(fields)
        self._text = text

    def __str__(self) -> str:
        return self._text

    def to_pandas(self) -> pandas.DataFrame:
        """The trials, one a row."""
        import pandas

        return pandas.DataFrame(self._fields["rows"])

    def plot(self) -> matplotlib.figure.Figure:
        """The share of trials that is stable, by law over the round trip."""
        return plots.sweep(self)


def _parameters(parameters: dict[str, Any]) -> pandas.DataFrame:
    return _frame(parameters, ["value", "std_error", "unit", "effect"], "parameter")


def _frame(rows: dict[str, Any], keys: list[str], name: str) -> pandas.DataFrame:
    import pandas

    index = pandas.Index(list(rows), name=name)
    return pandas.DataFrame([[own[key] for key in keys] for own in rows.values()], index, keys)
