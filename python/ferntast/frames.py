"""Arrays and frames, of whatever library, as columns of numbers."""

from __future__ import annotations

from collections.abc import Mapping
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


def write(frames: list[Any], folder: Path) -> list[Path]:
    """Writes each frame as a file that the lab reads; gives the files."""
    files = []
    for number, frame in enumerate(frames, start=1):
        own = columns(frame)
        name = "recording.npz" if len(frames) == 1 else f"recording_{number}.npz"
        with (folder / name).open("wb") as file:
            np.savez(file, **own)
        files.append(folder / name)
    return files
