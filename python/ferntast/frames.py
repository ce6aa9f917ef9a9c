"""Arrays and frames, of whatever library, as columns of numbers."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ferntast._native import RefusedError


def columns(frame: Any) -> dict[str, np.ndarray]:
    """The columns of numbers of a dictionary of arrays, a structured array, or a frame of
    pandas, polars, pyarrow or whatever else has `columns` or `column_names` and gives a
    column by its name. Times (datetime64) become seconds after the first."""
    if isinstance(frame, np.ndarray) and frame.dtype.names:
        names = list(frame.dtype.names)
    elif isinstance(frame, Mapping):
        names = list(frame)
    elif hasattr(frame, "column_names"):
        names = list(frame.column_names)
    elif hasattr(frame, "columns"):
        names = list(frame.columns)
    else:
        raise RefusedError(
            f"{type(frame).__name__} has no named columns: give a dictionary of arrays, "
            "as in {'t': t, 'q': q, 'tau': tau}, or a frame"
        )
    found = {str(name): numbers(frame[name]) for name in names}
    found = {name: values for name, values in found.items() if values is not None}
    lengths = {name: len(values) for name, values in found.items()}
    if len(set(lengths.values())) > 1:
        raise RefusedError(f"columns of different length: {lengths}")
    if not found:
        raise RefusedError("no column of numbers: a column has one number a row")
    return found


def numbers(column: Any) -> np.ndarray | None:
    """A column as float64; missing values as NaN. `None` for what is no column of numbers."""
    values = np.asarray(column)
    if values.ndim != 1:
        return None
    if values.dtype.kind == "M":
        since = values - values[:1]
        return np.asarray(since / np.timedelta64(1, "s"), dtype=np.float64)
    if values.dtype.kind == "m":
        return np.asarray(values / np.timedelta64(1, "s"), dtype=np.float64)
    try:
        # What is missing (None, NaN, NA) in columns of objects.
        return np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        return None


@contextmanager
def written(frames: list[Any], target: Path, force: bool) -> Iterator[list[Path]]:
    """Writes each frame as a file that the lab reads, beside the experiment file `target` and
    named after it; gives the files. They stay if what is done with them succeeds; else all is
    as it was before."""
    tables = [columns(frame) for frame in frames]
    folder = target.absolute().parent
    names = [f"{target.stem}.npz"]
    if len(tables) != 1:
        names = [f"{target.stem}_{number}.npz" for number in range(1, len(tables) + 1)]
    files = [folder / name for name in names]
    if target.absolute() in files:
        raise RefusedError(f"{target} is the file of the arrays: an experiment file ends in .toml")
    for file in () if force else (target, *files):
        if file.exists():
            raise RefusedError(
                f"{file} exists already: choose another output, or force=True to write over it"
            )
    folder.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory(prefix=".ferntast-", dir=folder) as aside,
        ExitStack() as undone,
    ):
        for file, table in zip(files, tables, strict=True):
            if file.exists():
                kept = file.rename(Path(aside) / file.name)
                undone.callback(kept.replace, file)
            else:
                undone.callback(file.unlink, missing_ok=True)
            with file.open("wb") as opened:
                np.savez(opened, **table)
        yield files
        undone.pop_all()
