"""ferntast from Python: the lab, lockstep and sweeps.

>>> import ferntast
>>> comparison = ferntast.compare("experiment.toml")
>>> diagnosis = ferntast.diagnose({"t": t, "q_deg": q, "current_A": i})
>>> diagnosis.verdict, diagnosis.candidates[0].effect

What goes in is an experiment file, the recording of a session, tables, or arrays: a
dictionary of NumPy arrays, a structured array, a frame of pandas, polars or pyarrow.
What comes out has the fields of the command line's JSON (`ferntast lab compare --json`),
tables (`to_pandas()`) and, with matplotlib, `plot()`.

Long work gives the interpreter's lock away and ends on Ctrl-C; `progress` is called with
the share done, 0 … 1. What is refused raises `RefusedError` with the lab's text.
"""

from ferntast._native import FailedError, FerntastError, RefusedError
from ferntast.experiment import Experiment
from ferntast.lab import add, auto, challenge, compare, diagnose, discover, effects, export
from ferntast.record import Record
from ferntast.results import (
    Added,
    Automatic,
    Comparison,
    Diagnosis,
    Discovery,
    Lockstep,
    Sweep,
)
from ferntast.virtual_time import lockstep, sweep

__all__ = [
    "Added",
    "Automatic",
    "Comparison",
    "Diagnosis",
    "Discovery",
    "Experiment",
    "FailedError",
    "FerntastError",
    "Lockstep",
    "Record",
    "RefusedError",
    "Sweep",
    "add",
    "auto",
    "challenge",
    "compare",
    "diagnose",
    "discover",
    "effects",
    "export",
    "lockstep",
    "sweep",
]
