"""The compiled part. Results are JSON, as the command line prints it."""

from collections.abc import Callable
from os import PathLike
from typing import TypeAlias

Path: TypeAlias = str | PathLike[str]
Progress: TypeAlias = Callable[[float], object] | None

class FerntastError(Exception): ...
class RefusedError(FerntastError): ...
class FailedError(FerntastError): ...

def compare(path: Path, points: int) -> str: ...
def diagnose(path: Path, progress: Progress) -> str: ...
def discover(path: Path, seed: int, progress: Progress) -> str: ...
def add(path: Path, effect: str, bounds: list[str], output: Path | None) -> str: ...
def auto(path: Path, folder: Path | None, progress: Progress) -> str: ...
def export(path: Path, to: str, output: Path | None, approximate: bool) -> str: ...
def new(
    files: list[Path],
    said: list[tuple[str, str]],
    rate_hz: float | None,
    joint: str | None,
    join: str | None,
    output: Path | None,
    force: bool,
) -> str: ...
def effects() -> str: ...
def challenge(
    folder: Path, contact: bool, seed: int, strength: float, hide: list[str], sessions: int | None
) -> str: ...
def lockstep(
    scenario: str,
    link: str | None,
    law: str | None,
    rtt_ms: float | None,
    hand: str | None,
    seed: int | None,
    duration: float | None,
    switch: list[tuple[float, str]],
    twin: list[Path],
    take_over: float | None,
    give_back: float | None,
    record: Path | None,
    progress: Progress,
) -> str: ...
def sweep(config: str, laws: list[str], progress: Progress) -> str: ...
