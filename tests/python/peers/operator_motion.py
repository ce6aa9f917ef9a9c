"""What an operator sends and feels, whatever the middleware."""

import math
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TextIO

from hand import Hand
from stamps import Stamps

# An arm that hears nothing for so long holds [s].
HELD_UP = 0.015
# A hand that shall feel something passes over its motion so often, there and back in turn.
PASSES = 6

# Commands that are wrong on purpose. `jump` is finite, but half a metre away
# from the command before; `far` stays a kilometre away.
SPOILS = ("nan", "infinite", "far", "jump", "zero_stamp")


def ticks(
    rate: float,
    seconds: float,
    stop: threading.Event,
    arm: "Arm",
    hear: Callable[[], None] = lambda: None,
) -> Iterator[tuple[float, float]]:
    """Yields the time since the start and that of the motion [s], `rate` times a second for
    `seconds`, or until `stop`; calls `hear` each time before.

    A tick that comes late is yielded late, and those it overran are left out. The motion
    stands still while the arm does.
    """
    start = time.monotonic()
    patience = max(HELD_UP, 2 / rate)
    moment = before = 0.0
    count = 0
    while (now := time.monotonic() - start) < seconds and not stop.is_set():
        due = count / rate
        if now < due:
            time.sleep(due - now)
            now = time.monotonic() - start
        # A person does not jump after the clock where this process was held up.
        if now - before <= patience and arm.obeys():
            moment += now - before
        before = now
        hear()
        yield now, moment
        count = max(count + 1, int(now * rate) + 1)


class Arm:
    """What is known of the arm: a person sees that it stands, and waits for it."""

    def __init__(self, state: Path | None) -> None:
        self._state = state
        self._looked = -math.inf
        self._obeys = True

    def obeys(self) -> bool:
        """Whether it does, as told in the file of its state, if there is one."""
        now = time.monotonic()
        if self._state is not None and now - self._looked > 0.1:
            self._looked = now
            self._obeys = not self._state.exists() or self._state.read_text() == "ENABLED"
        return self._obeys


def there_and_back(now: float, seconds: float) -> float:
    """The moment [s] of a motion that runs forwards and backwards in turn, `now` after its begin."""
    passed = now % (2 * seconds)
    return min(passed, 2 * seconds - passed)


class Felt:
    """The forces that came back. Filled by the operator's loop, or from the middleware's own thread."""

    def __init__(self, trace: Path | None) -> None:
        self.stamps = Stamps()
        self.peak = 0.0
        self.not_finite = 0
        self.nonzero = 0
        self.first_nonzero_s: float | None = None
        self.start = time.monotonic()
        self.position = (0.0, 0.0)
        self._lock = threading.Lock()
        self._trace: TextIO | None = None
        if trace is not None:
            self._trace = trace.open("w")
            self._trace.write("t_s,hand_x_m,hand_y_m,force_x_N,force_y_N,force_z_N\n")

    def wrench(self, message: object) -> None:
        """Takes one WrenchStamped."""
        with self._lock:
            self.stamps.saw(message)
            force = message.wrench.force
            size = math.hypot(force.x, force.y, force.z)
            now = time.monotonic() - self.start
            if not math.isfinite(size):
                self.not_finite += 1
            elif size > 0.0:
                self.nonzero += 1
                self.peak = max(self.peak, size)
                if self.first_nonzero_s is None:
                    self.first_nonzero_s = now
            if self._trace is not None:
                x, y = self.position
                row = (now, x, y, force.x, force.y, force.z)
                self._trace.write(",".join(f"{value:.6f}" for value in row) + "\n")

    def report(self) -> dict[str, object]:
        """For JSON: the stream as in `Stamps.report`, and the forces [N]."""
        with self._lock:
            if self._trace is not None:
                self._trace.close()
                self._trace = None
            return self.stamps.report() | {
                "peak_force_N": self.peak,
                "nonzero": self.nonzero,
                "not_finite": self.not_finite,
                "first_nonzero_s": self.first_nonzero_s,
            }


def spoiled(spoil: str, x: float, y: float, count: int) -> tuple[float, float, bool]:
    """(x, y, whether the stamp is zero) of a bad command in place of a good one at (x, y)."""
    match spoil:
        case "nan":
            return math.nan, y, False
        case "infinite":
            return x, -math.inf, False
        case "far":
            return 1000.0, 1000.0, False
        case "jump":
            return x + (0.5 if count % 2 else 0.0), y, False
        case "zero_stamp":
            return x, y, True
    raise ValueError(f"unknown kind of bad command: {spoil}")


def operate(
    arguments: object,
    felt: Felt,
    send: Callable[[float, float, bool], None],
    stop: threading.Event,
    hear: Callable[[], None] = lambda: None,
) -> dict[str, object]:
    """Moves the hand as recorded; `send(x, y, zero_stamp)` publishes one command, `hear` takes
    the forces that came, unless they come by themselves.

    It waits while the arm stands. With `until_felt`, it goes back and there again until so
    many forces came, and one of `until_peak`.

    Returns the report for JSON. `stop` ends the motion early, which is told in
    `interrupted`.
    """
    hand = Hand(arguments.hand)
    seconds = arguments.duration or hand.duration / arguments.speed
    sent = sent_bad = 0
    max_step = 0.0
    max_silence = 0.0
    before: tuple[float, float, float] | None = None
    felt.start = time.monotonic()
    passes = PASSES if arguments.until_felt else 1
    arm = Arm(arguments.arm_state)
    for now, moment in ticks(arguments.rate, PASSES * seconds, stop, arm, hear):
        enough = felt.nonzero >= arguments.until_felt and felt.peak >= arguments.until_peak
        done = moment >= seconds and enough
        if done or moment >= passes * seconds:
            break
        x, y = hand.at(there_and_back(moment, seconds) * arguments.speed)
        felt.position = (x, y)
        if before is not None:
            max_step = max(max_step, math.hypot(x - before[1], y - before[2]))
            max_silence = max(max_silence, now - before[0])
        before = (now, x, y)
        if arguments.spoil and moment >= arguments.spoil_after:
            send(*spoiled(arguments.spoil, x, y, sent))
            sent_bad += 1
        else:
            send(x, y, False)
        sent += 1
    elapsed = time.monotonic() - felt.start
    return {
        "hand": str(arguments.hand),
        "sent": sent,
        "sent_bad": sent_bad,
        "rate_hz": sent / elapsed if elapsed > 0 else 0.0,
        "seconds": elapsed,
        "max_step_m": max_step,
        "max_silence_s": max_silence,
        "interrupted": stop.is_set(),
        "force": felt.report(),
    }
