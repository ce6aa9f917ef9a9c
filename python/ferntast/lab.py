"""Models against recordings: `ferntast lab …` and `ferntast challenge new`."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from ferntast import _native
from ferntast.experiment import Experiment, PathLike
from ferntast.record import Record
from ferntast.results import Added, Automatic, Comparison, Diagnosis, Discovery

Progress = Callable[[float], object] | None


def compare(source: Any, *, points: int = 2000, **signals: Any) -> Comparison | list[Comparison]:
    """Fits the model, tells its error on data it was not fitted to, and where it fails.

    `source` and `signals` are those of `Experiment.of`. The recording of a session gives a
    list, one of each joint. `points` of each session are kept for `plot`, at most.
    """
    experiment = Experiment.of(source, **signals)
    answers = json.loads(_native.compare(experiment.path, points))
    return _one_or_all([Comparison.from_answer(own, experiment) for own in answers])


def diagnose(
    source: Any, *, progress: Progress = None, **signals: Any
) -> Diagnosis | list[Diagnosis]:
    """Tells which effect is missing: `missing`, `complete` or `unexplained`.

    `source` and `signals` are those of `Experiment.of`; `progress` is called with the share
    done. The recording of a session gives a list, one of each joint.
    """
    experiment = Experiment.of(source, **signals)
    answers = json.loads(_native.diagnose(experiment.path, progress))
    return _one_or_all([Diagnosis.from_answer(own, experiment) for own in answers])


def discover(
    source: Any, *, seed: int = 1, progress: Progress = None, **signals: Any
) -> Discovery | list[Discovery]:
    """Proposes formulas for what no effect of the catalogue explains.

    `source` and `signals` are those of `Experiment.of`; `seed` decides what chance is taken to
    be, `progress` is called with the share done. The formula that you believe goes to
    `add(source, f"{formula.name}={formula.expression}")`. The recording of a session gives a
    list, one of each joint; the experiment of a whole arm one result, whose formulas have a
    `joint`.
    """
    experiment = Experiment.of(source, **signals)
    answers = json.loads(_native.discover(experiment.path, seed, progress))
    return _one_or_all([Discovery.from_answer(own, experiment) for own in answers])


def add(
    source: Any,
    effect: str,
    *,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    output: PathLike | None = None,
    **signals: Any,
) -> Added:
    """Adds an effect, fits again, and writes the new experiment file.

    `effect` is an id of the catalogue (`effects()`) or `NAME=EXPRESSION`; `bounds` are those
    of parameters of an expression that are searched. `output` is the new experiment file,
    else beside the old one.
    """
    experiment = Experiment.of(source, **signals)
    searched = [f"{name}={low!r},{high!r}" for name, (low, high) in (bounds or {}).items()]
    answer = json.loads(_native.add(experiment.path, effect, searched, output))
    return Added.from_answer(answer, experiment)


def auto(
    source: Any, *, folder: PathLike | None = None, progress: Progress = None, **signals: Any
) -> Automatic:
    """Diagnoses and adds until the model is complete or what is left has no name.

    New experiment files go into `folder`, else beside the old one. `progress` begins anew
    with each diagnosis.
    """
    experiment = Experiment.of(source, **signals)
    answer = json.loads(_native.auto(experiment.path, folder, progress))
    return Automatic.from_answer(answer, experiment)


def export(
    source: Any,
    to: str,
    output: PathLike | None = None,
    *,
    approximate: bool = False,
    **signals: Any,
) -> Record:
    """Writes what was identified for another program: `urdf`, `sdf`, `mujoco`, `ur`, `ferntast`.

    `output` is the new file, else beside the experiment. `approximate` fits what can be said
    there anew, without the rest. Gives `files`, `joints` (errors), `unsaid` (effects that the
    form has no words for) and `notes`.
    """
    experiment = Experiment.of(source, **signals)
    return Record(json.loads(_native.export(experiment.path, to, output, approximate)))


def effects() -> list[Record]:
    """The effects of the catalogue: `id`, `of` (a joint or a contact), `equation`."""
    return [Record(own) for own in json.loads(_native.effects())]


def challenge(
    folder: PathLike,
    *,
    seed: int = 1,
    strength: float = 1.0,
    hide: Iterable[str] = (),
    sessions: int | None = None,
    contact: bool = False,
) -> Experiment:
    """Makes a recording with a hidden effect in `folder`, which must not exist; gives its
    experiment, whose model lacks it. `hide` says what, or `["none"]`; else `seed` does."""
    path = _native.challenge(folder, contact, seed, strength, list(hide), sessions)
    return Experiment(Path(path))


def _one_or_all(results: list[Any]) -> Any:
    """Of one joint the result, of a recording of several a list."""
    return results[0] if len(results) == 1 else results
