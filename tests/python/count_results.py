"""Adds up the results of `cargo test` and pytest, for tests/run.

Prints `N passed, N failed` as its last line and exits with 1 unless all passed.
A test that was ignored or skipped counts as failed; so does a test program that
broke off without a result, and a run without a single test.
"""

import argparse
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

RUST_RESULT = re.compile(
    r"^test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored;", re.MULTILINE
)


def count_rust(log: str) -> tuple[int, int]:
    """(passed, failed) in the output of `cargo test`."""
    results = [tuple(map(int, found)) for found in RUST_RESULT.findall(log)]
    passed = sum(result[0] for result in results)
    failed = sum(result[1] + result[2] for result in results)
    return passed, failed


def count_python(path: Path) -> tuple[int, int]:
    """(passed, failed) in a JUnit report of pytest."""
    if not path.exists():
        return 0, 0
    cases = list(ElementTree.parse(path).getroot().iter("testcase"))
    bad = {"failure", "error", "skipped"}
    failed = sum(any(child.tag in bad for child in case) for case in cases)
    return len(cases) - failed, failed


def total(
    rust: tuple[int, int], rust_status: int, python: tuple[int, int], python_status: int
) -> tuple[int, int]:
    """The sum; a runner that failed without a failed test to show counts as one failure."""
    passed = rust[0] + python[0]
    failed = rust[1] + python[1]
    failed += rust_status != 0 and rust[1] == 0
    failed += python_status != 0 and python[1] == 0
    if passed + failed == 0:
        failed = 1
    return passed, failed


def main() -> int:
    """Reads both reports and prints the total."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rust-log", type=Path, required=True)
    parser.add_argument("--rust-status", type=int, required=True)
    parser.add_argument("--python-xml", type=Path, required=True)
    parser.add_argument("--python-status", type=int, required=True)
    arguments = parser.parse_args()
    rust = count_rust(arguments.rust_log.read_text(errors="replace"))
    python = count_python(arguments.python_xml)
    passed, failed = total(rust, arguments.rust_status, python, arguments.python_status)
    print(f"{passed} passed, {failed} failed")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
