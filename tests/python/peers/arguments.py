"""What the peers have in common on the command line."""

import argparse
import json
import math
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from operator_motion import SPOILS


def add_duration(parser: argparse.ArgumentParser, default: float) -> None:
    """Adds `--seconds`."""
    parser.add_argument(
        "--seconds", type=positive, default=default, help=f"how long (default {default:g})"
    )


def add_operator(parser: argparse.ArgumentParser) -> None:
    """Adds the options of an operator: what the hand does, what goes wrong on purpose."""
    parser.add_argument("--hand", type=Path, required=True, help="CSV with t_s, x_m, y_m")
    parser.add_argument("--rate", type=positive, default=500.0, help="messages a second")
    parser.add_argument("--duration", type=positive, help="seconds (default: the whole file)")
    parser.add_argument("--speed", type=positive, default=1.0, help="recorded seconds a second")
    parser.add_argument(
        "--until-felt", type=int, default=0, help="go back and there again until so many forces came"
    )
    parser.add_argument(
        "--until-peak", type=float, default=0.0, help="and until one of them was as large [N]"
    )
    parser.add_argument(
        "--arm-state", type=Path, help="file that tells the arm's state: the hand waits while it stands"
    )
    parser.add_argument("--spoil", choices=SPOILS, help="send bad commands")
    parser.add_argument(
        "--spoil-after", type=float, default=0.0, help="seconds of good commands before"
    )
    parser.add_argument(
        "--wait", type=float, default=10.0, help="seconds to wait for somebody to listen"
    )
    parser.add_argument("--trace", type=Path, help="write what was felt, as CSV, to this file")


def positive(text: str) -> float:
    """A finite number above zero."""
    number = float(text)
    if not (math.isfinite(number) and number > 0):
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return number


def stop_on_signal() -> threading.Event:
    """An event that SIGINT (Ctrl-C) or SIGTERM sets: the peer ends, with its report printed."""
    stop = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: stop.set())
    signal.signal(signal.SIGINT, lambda *_: stop.set())
    return stop


def wait_until(condition: Callable[[], bool], seconds: float) -> bool:
    """Whether `condition` came true within so many seconds."""
    end = time.monotonic() + seconds
    while not (met := condition()) and time.monotonic() < end:
        time.sleep(0.02)
    return met


def ready() -> None:
    """Tells whoever started this process that it is connected."""
    print("ready", file=sys.stderr, flush=True)


def print_report(report: object) -> None:
    """One JSON value on stdout."""
    print(json.dumps(report, indent=1, sort_keys=True), flush=True)
