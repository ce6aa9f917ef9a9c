"""Recorded human hand motion, sampled at any moment."""

import bisect
import csv
import math
from pathlib import Path


class Hand:
    """Positions of a hand over time, from a file with columns t_s, x_m, y_m.

    Between recorded samples the position is interpolated linearly; before the
    first and after the last it stands still. Raises ValueError, with file and
    line, on anything that is not a finite number or runs back in time.
    """

    def __init__(self, path: Path) -> None:
        self.times: list[float] = []
        self.points: list[tuple[float, float]] = []
        with path.open(newline="") as file:
            for line, row in enumerate(csv.DictReader(file), start=2):
                try:
                    values = [float(row[name]) for name in ("t_s", "x_m", "y_m")]
                except (KeyError, TypeError, ValueError) as error:
                    raise ValueError(f"{path}:{line}: needs numbers t_s, x_m, y_m") from error
                if not all(map(math.isfinite, values)):
                    raise ValueError(f"{path}:{line}: not finite")
                if self.times and values[0] < self.times[-1]:
                    raise ValueError(f"{path}:{line}: time runs back")
                self.times.append(values[0])
                self.points.append((values[1], values[2]))
        if not self.times:
            raise ValueError(f"{path}: no samples")

    @property
    def duration(self) -> float:
        """Length of the recording [s]."""
        return self.times[-1] - self.times[0]

    def at(self, seconds: float) -> tuple[float, float]:
        """Position (x, y) [m], `seconds` after the first sample."""
        time = self.times[0] + seconds
        after = bisect.bisect_right(self.times, time)
        if after == 0:
            return self.points[0]
        if after == len(self.times):
            return self.points[-1]
        start, end = self.times[after - 1], self.times[after]
        share = (time - start) / (end - start)
        (x0, y0), (x1, y1) = self.points[after - 1], self.points[after]
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0)
