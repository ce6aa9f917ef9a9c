"""Adds up the results of `cargo test` and pytest, for tests/run.

Prints what was not run, with the reason, and as its last line
`N passed, N failed` (`, N skipped` after it where something was not run).
Exits with 1 unless all that ran passed. Not run are tests that need recordings
which do not come with the project, and what the command line left out. Any other
test that was ignored or skipped counts as failed; so does a test program that
broke off without a result, and a run without a single test.
"""

import argparse
import re
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

NEEDS = "needs outside recordings: "

# Where the recordings come from, by folder; docs/recordings.md says more.
ORIGINS = {
    "emps": "Janot, Gautier, Brunot 2019, as in github.com/forgi86/sysid-neural-continuous",
    "xl330": "github.com/Rhoban/bam",
    "hand": "made from github.com/brendenlake/omniglot",
    "hidden": "simulated for this project by another program; not published",
}

RUST_PROGRAM = re.compile(r"^\s+Running .*[/(](\w+)-[0-9a-f]+\)$")
RUST_IGNORED = re.compile(r"^test (\S+) \.\.\. ignored(?:, (.*))?$")
RUST_FAILED = re.compile(r"^test (\S+) \.\.\. FAILED$")
RUST_PASSED = re.compile(r"^test (\S+) \.\.\. ok$")
RUST_RESULT = re.compile(r"^test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored;")
RUST_TIME = re.compile(r"^test result: .* finished in ([0-9.]+)s$")


def lines_by_program(log: str) -> Iterator[tuple[str, str]]:
    """The lines of the output of `cargo test`, each with the test program that it is of."""
    program = ""
    for line in log.splitlines():
        if found := RUST_PROGRAM.match(line):
            program = found[1]
        else:
            yield program, line


def slowest(log: str, least: float = 10.0) -> str:
    """The test programs that took longer than `least` [s], in a line."""
    times: dict[str, float] = {}
    for program, line in lines_by_program(log):
        if found := RUST_TIME.match(line):
            times[program] = times.get(program, 0.0) + float(found[1])
    long = sorted((-time, name) for name, time in times.items() if time > least)
    return ", ".join(f"{name} {-time:.0f} s" for time, name in long)


class Count(NamedTuple):
    """Tests that passed and failed, and the names of those that were not run."""

    passed: int = 0
    failed: int = 0
    not_run: tuple[str, ...] = ()

    def plus(self, other: "Count") -> "Count":
        """The sum; what was not run twice is named once."""
        not_run = dict.fromkeys(self.not_run + other.not_run)
        return Count(self.passed + other.passed, self.failed + other.failed, tuple(not_run))

    def with_passed_again(self, tests: int) -> "Count":
        """The same, with so many of the failed ones passed."""
        return self._replace(passed=self.passed + tests, failed=self.failed - tests)


def count_rust(log: str) -> Count:
    """What the output of `cargo test` tells."""
    passed = failed = ignored = 0
    not_run: list[str] = []
    for program, line in lines_by_program(log):
        if found := RUST_IGNORED.match(line):
            if (found[2] or "").startswith(NEEDS):
                ignored -= 1
                not_run.append(f"{program}::{found[1]} ({found[2]})")
        elif found := RUST_RESULT.match(line):
            passed += int(found[1])
            failed += int(found[2])
            ignored += int(found[3])
    return Count(passed, failed + ignored, tuple(dict.fromkeys(not_run)))


def ended_so(log: str, ended: re.Pattern[str]) -> list[tuple[str, str]]:
    """The tests, each with its program, that ended so in the output of `cargo test`."""
    each = ((program, ended.match(line)) for program, line in lines_by_program(log))
    return [(program, test[1]) for program, test in each if test]


def held_up(log: str, again: str) -> list[tuple[str, str]]:
    """The tests that failed in `log` and passed in `again`."""
    passed = ended_so(again, RUST_PASSED)
    return [test for test in ended_so(log, RUST_FAILED) if test in passed]


def count_python(path: Path) -> Count:
    """What a JUnit report of pytest tells."""
    if not path.exists():
        return Count()
    passed = failed = 0
    not_run: list[str] = []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        tags = {child.tag for child in case}
        skipped = case.find("skipped")
        reason = "" if skipped is None else skipped.get("message", "")
        if tags & {"failure", "error"} or (skipped is not None and not reason.startswith(NEEDS)):
            failed += 1
        elif skipped is not None:
            not_run.append(f"{case.get('classname')}::{case.get('name')} ({reason})")
        else:
            passed += 1
    return Count(passed, failed, tuple(not_run))


def total(rust: Count, rust_status: int, python: Count, python_status: int) -> Count:
    """The sum; a runner that failed without a failed test to show counts as one failure."""
    both = rust.plus(python)
    broken = (rust_status != 0 and rust.failed == 0) + (python_status != 0 and python.failed == 0)
    if both.passed + both.failed + broken == 0:
        broken = 1
    return both._replace(failed=both.failed + broken)


def explanation(not_run: Iterable[str]) -> list[str]:
    """Lines that name what was not run, and where its recordings are to be had."""
    not_run = list(not_run)
    lines = [f"not run: {name}" for name in not_run]
    needed = [folder for folder in ORIGINS if any(NEEDS in n and folder in n.split(NEEDS)[1] for n in not_run)]
    if needed:
        lines.append("They come from (put the folders side by side and set FERNTAST_DATA to the folder")
        lines.append("that has them; docs/recordings.md has their files and columns):")
        lines += [f"  {folder}/: {ORIGINS[folder]}" for folder in needed]
    return lines


def main() -> int:
    """Reads the reports and prints the total."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rust-log", type=Path, required=True)
    parser.add_argument("--rust-status", type=int, default=0)
    parser.add_argument("--list-failed", nargs="+", metavar="PROGRAM")
    parser.add_argument("--again-log", type=Path, help="what was run again, alone")
    parser.add_argument("--python-xml", type=Path, nargs="*", default=[])
    parser.add_argument("--python-status", type=int, default=0)
    parser.add_argument("--not-run", action="append", default=[], help="left out on purpose")
    arguments = parser.parse_args()
    log = arguments.rust_log.read_text(errors="replace")
    if arguments.list_failed:
        for program, test in ended_so(log, RUST_FAILED):
            if program in arguments.list_failed:
                print(program, test)
        return 0
    rust = count_rust(log)
    python = Count(not_run=tuple(arguments.not_run))
    for path in arguments.python_xml:
        python = python.plus(count_python(path))
    result = total(rust, arguments.rust_status, python, arguments.python_status)
    again = arguments.again_log
    passed_again = held_up(log, again.read_text(errors="replace") if again else "")
    result = result.with_passed_again(len(passed_again))
    print(f"took longest: {slowest(log) or 'nothing more than 10 s'}")
    print("\n".join(explanation(result.not_run)))
    for program, test in passed_again:
        print(f"failed, and passed when run again alone: {program}::{test}")
    skipped = f", {len(result.not_run)} skipped" if result.not_run else ""
    print(f"{result.passed} passed, {result.failed} failed{skipped}")
    return int(result.failed > 0)


if __name__ == "__main__":
    sys.exit(main())
