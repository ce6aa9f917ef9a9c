"""Experiments: recordings, where the signals are in them, and a model that is believed."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, TypeAlias

from ferntast import _native, frames
from ferntast._native import RefusedError

PathLike: TypeAlias = str | os.PathLike[str]


class Experiment:
    """An experiment file, and what is made of arrays.

    `Experiment("experiment.toml")` is one that exists; `Experiment.of` makes one of tables,
    arrays or frames.
    """

    def __init__(self, path: PathLike, *, _keep: object = None) -> None:
        self.path = Path(path)
        # The folder that goes when nothing needs it any more.
        self._keep = _keep
        self.made: dict[str, Any] | None = None
        """What was read when it was made of tables or arrays (`ferntast lab new --json`):
        signals, rate, share used, warnings."""

    def __repr__(self) -> str:
        return f"Experiment({str(self.path)!r})"

    def __fspath__(self) -> str:
        return str(self.path)

    @classmethod
    def of(
        cls,
        source: Any,
        *,
        position: str | None = None,
        motor_torque: str | None = None,
        joint_torque: str | None = None,
        temperature: str | None = None,
        time: str | None = None,
        rate_hz: float | None = None,
        joint: Literal["revolute", "prismatic"] | None = None,
        join: Literal["time", "row"] | None = None,
        output: PathLike | None = None,
        force: bool = False,
    ) -> Experiment:
        """An experiment on `source`: an experiment file or a session's recording as it is;
        tables and rosbag2 recordings, arrays or frames with what is said of their signals.
        A list of these, with the same columns, are runs of one joint.

        Signals are columns, `"q"`, or columns with their unit, `"q:deg"`; left out, names and
        numbers are guessed from, as by `ferntast lab new`. `rate_hz` is for data without time.
        The model is Coulomb and viscous friction, and an inertia that is fitted; `add` adds
        to it. `output` is the experiment file to write, and arrays lie beside it, in a file of
        its name (`first.toml`, `first.npz`); what is there already is refused, or written over
        where `force` says so. Without it the experiment lies in a folder that goes away with it
        (`save`).
        """
        signals = {
            "position": position,
            "motor_torque": motor_torque,
            "joint_torque": joint_torque,
            "temperature": temperature,
            "time": time,
        }
        said = [(key, text) for key, text in signals.items() if text is not None]
        how = (said, rate_hz, joint, join, output)
        is_default = all(own is None or own == [] for own in how)
        if isinstance(source, Experiment):
            if not is_default:
                raise RefusedError("an experiment says its signals and model itself")
            return source
        files = _paths(source)
        if files is not None and len(files) == 1 and is_default and not _is_table(files[0]):
            return cls(files[0])
        keep = None
        if output is None or files is None:
            keep = tempfile.TemporaryDirectory(prefix="ferntast-")
        target = Path(output) if output is not None else Path(keep.name) / "experiment.toml"

        def new(files: list[Path]) -> str:
            names = [str(file) for file in files]
            return _native.new(names, said, rate_hz, joint, join, target, force)

        if files is not None:
            made = new(files)
        else:
            arrays = source if isinstance(source, list) else [source]
            with frames.written(arrays, target, force) as files:
                made = new(files)
        experiment = cls(target, _keep=keep)
        experiment.made = json.loads(made)
        return experiment

    def save(self, folder: PathLike, force: bool = False) -> Experiment:
        """Copies an experiment that was made of arrays, with its recordings and those
        experiments that came of it, into `folder`; gives the one there. What is there already
        is refused, or written over where `force` says so."""
        if self._keep is None:
            raise RefusedError(f"{self.path} is a file already: copy it with its recordings")
        names = sorted(own.name for own in self.path.parent.iterdir())
        there = [name for name in names if (Path(folder) / name).exists()]
        if there and not force:
            raise RefusedError(
                f"{folder} has {there[0]} already: name another folder, or write over it with "
                "force=True"
            )
        shutil.copytree(self.path.parent, folder, dirs_exist_ok=True)
        return Experiment(Path(folder) / self.path.name)

    def child(self, path: PathLike) -> Experiment:
        """The experiment at `path`, which came of this one."""
        return Experiment(path, _keep=self._keep)


def _paths(source: Any) -> list[Path] | None:
    """Files, where these are some."""
    if isinstance(source, (str, os.PathLike)):
        return [Path(source)]
    if isinstance(source, Mapping) or not isinstance(source, (list, tuple)):
        return None
    if source and all(isinstance(own, (str, os.PathLike)) for own in source):
        return [Path(own) for own in source]
    return None


def _is_table(path: Path) -> bool:
    return path.suffix.lower() in {".csv", ".tsv", ".txt", ".dat", ".npz", ".npy", ".mat"}
