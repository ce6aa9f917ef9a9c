"""The operator's tasks, and what is made of a case: the columns of a sweep."""

from dataclasses import dataclass

import numpy as np

from .bodies import ENVIRONMENTS, TICK

START = -0.04
PRESSED = 0.02
SLIDE = 0.02
LIFTED = -0.01
TAPPED = 0.004
STROKE = 0.15
TAPS = 3
REST = 2e-3
"""What moves to and fro by more is not at rest [m]."""
ARRIVED = 2e-3
"""So near to where it began the tip is back [m]."""
TOUCH = 1e-6


def least_jerk(since: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Way and rate of a motion from 0 to 1 in a unit of time (Flash and Hogan 1985)."""
    s = np.clip(since, 0.0, 1.0)
    return 10 * s**3 - 15 * s**4 + 6 * s**5, 30 * s**2 - 60 * s**3 + 30 * s**4


@dataclass
class Case:
    """One trial."""

    law: str
    environment: str
    task: str
    rtt_ms: float

    def __post_init__(self) -> None:
        trip = 1e-3 * self.rtt_ms
        self.one_way = round(0.5 * self.rtt_ms)
        self.reach = 0.5 + trip
        self.wall = self.reach + 2.0 + trip
        self.slide = self.wall + 4.0
        self.watch_pressed = self.slide + (TAPS if self.task == "tap" else 2.0) + 2.0 + 5 * trip
        self.retreat = self.watch_pressed + 1.0 + 2 * trip
        self.watch_free = self.retreat + 4.0 + 3 * trip
        self.end = self.watch_free + 1.0 + 2 * trip

    def wanted(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the operator wants the hand [m] and its rate [m/s], both (times, 2)."""
        there, there_rate = least_jerk(time - self.reach)
        back, back_rate = least_jerk(time - self.retreat)
        way = (LIFTED if self.task == "tap" else PRESSED) - START
        x, x_rate = START + way * (there - back), way * (there_rate - back_rate)
        y, y_rate = np.zeros_like(time), np.zeros_like(time)
        since = time - self.slide
        if self.task == "tap":
            within = (since >= 0.0) & (since < TAPS)
            down, down_rate = least_jerk(since % 1.0 / STROKE)
            up, up_rate = least_jerk((since % 1.0 - STROKE) / STROKE)
            depth = TAPPED - LIFTED
            x = x + np.where(within, depth * (down - up), 0.0)
            x_rate = x_rate + np.where(within, depth * (down_rate - up_rate) / STROKE, 0.0)
        if self.task == "press_and_slide":
            out, out_rate = least_jerk(since)
            home, home_rate = least_jerk(since - 1.0)
            y, y_rate = SLIDE * (out - home), SLIDE * (out_rate - home_rate)
        return np.stack([x, y], axis=1), np.stack([x_rate, y_rate], axis=1)


@dataclass
class Record:
    """What happened in a case, tick by tick: (times, 2), place and energy (times,)."""

    hand: np.ndarray
    speed: np.ndarray
    tip: np.ndarray
    felt: np.ndarray
    touched: np.ndarray
    place: np.ndarray
    energy: np.ndarray


def delayed(values: np.ndarray, ticks: int) -> np.ndarray:
    """As they were so many ticks ago; zero before."""
    if ticks == 0:
        return values
    return np.concatenate([np.zeros_like(values[:ticks]), values[:-ticks]])


def swing(values: np.ndarray) -> float:
    """To and fro: the lesser of the largest rise and the largest fall."""
    rise = (values - np.minimum.accumulate(values)).max()
    fall = (np.maximum.accumulate(values) - values).max()
    return float(min(rise, fall))


def judged(case: Case, record: Record) -> dict:
    """A row as `ferntast sweep --json` has it."""
    time = TICK * np.arange(len(record.hand))
    pressing = (time >= case.watch_pressed) & (time < case.retreat)
    free = time >= case.watch_free
    watched = [record.hand[:, 0], record.tip[:, 0], record.hand[:, 1]]
    moved = max(swing(own[mask]) for own in watched for mask in (pressing, free))

    # Felt stiffness: least squares of force over depth. The hand cannot know of a surface that
    # moves before the way back is over.
    stiffness, _, _, moves = ENVIRONMENTS[case.environment]
    window = (time >= case.wall) & (time < case.slide) if moves else pressing
    depth = record.hand[:, 0] - delayed(record.place, case.one_way)
    window = window & (depth > TOUCH)
    felt = None
    if window.any():
        felt = -float(record.felt[window, 0] @ depth[window] / (depth[window] @ depth[window]))

    # Drag: on the free way to the surface.
    touching = (record.touched != 0.0).any(axis=1)
    known = (delayed(record.touched, case.one_way) != 0.0).any(axis=1)
    way = (time < case.wall) & ~touching & ~known
    power = -(record.felt[way] * record.speed[way]).sum()
    square = (record.speed[way] ** 2).sum()

    away = np.hypot(*(record.tip - record.tip[0]).T) > ARRIVED
    last = time[away].max(initial=-1.0)
    done = case.task == "let_go" or case.retreat < last < case.watch_free
    peak = np.hypot(*record.touched.T).max()
    done = bool(done and (peak > 0.0 or case.environment == "free"))
    steps = np.diff(record.felt, axis=0, prepend=np.zeros((1, 2)))
    return {
        "law": case.law,
        "environment": case.environment,
        "task": case.task,
        "rtt_ms": case.rtt_ms,
        "stable": bool(moved < REST and done),
        "done": done,
        "swing_m": moved,
        "felt_stiffness_N_per_m": felt,
        "true_stiffness_N_per_m": stiffness,
        "peak_force_N": float(peak),
        "peak_felt_N": float(np.hypot(*record.felt.T).max()),
        "force_step_N_per_ms": float(np.hypot(*steps.T).max()),
        "drift_mm": 1e3 * float(np.hypot(*(record.hand[-1] - record.tip[-1]))),
        "drag_N_s_per_m": float(power / square) if square > 0.0 else 0.0,
        "true_energy_J": float(min(0.0, record.energy.min())),
    }
