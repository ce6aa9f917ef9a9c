"""Somebody at a terminal who holds the space bar, for a program that wants one.

Runs the command behind `--` with a pseudo-terminal as its standard input. The key is held for
`--hold` seconds (as a keyboard does: one character, a pause of 0.4 s, then one every 33 ms), released for
`--release` seconds, held again until the program ends. Prints JSON: `exit_code`, `stdout`, `stderr`
of the program, `terminal_restored`: whether its line mode and echo are as before.
"""

import argparse
import os
import pty
import subprocess
import tempfile
import termios
import time

from arguments import print_report

PAUSE, REPEAT = 0.4, 0.033


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hold", type=float, default=3.0, help="seconds")
    parser.add_argument("--release", type=float, default=1.0, help="seconds")
    parser.add_argument("--wait", type=float, default=1.0, help="seconds before the key is pressed")
    parser.add_argument("command", nargs="+")
    arguments = parser.parse_args()
    hand, terminal = pty.openpty()
    before = termios.tcgetattr(terminal)
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        program = subprocess.Popen(arguments.command, stdin=terminal, stdout=out, stderr=errors)
        begun = time.monotonic() + arguments.wait
        pressed: float | None = None
        while program.poll() is None:
            passed = time.monotonic() - begun
            released = arguments.hold <= passed < arguments.hold + arguments.release
            if passed < 0.0 or released:
                pressed = None
                time.sleep(0.005)
                continue
            os.write(hand, b" ")
            time.sleep(PAUSE if pressed is None else REPEAT)
            pressed = passed
        out.seek(0)
        errors.seek(0)
        after = termios.tcgetattr(terminal)
        print_report(
            {
                "exit_code": program.returncode,
                "stdout": out.read().decode(),
                "stderr": errors.read().decode(),
                "terminal_restored": after[3] == before[3],
            }
        )


if __name__ == "__main__":
    main()
