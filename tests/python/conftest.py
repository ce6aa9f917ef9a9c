"""Fixtures of the Python tests. A skipped test is a failed test, but where it
needs recordings that do not come with the project: then it was not run."""

import importlib.util
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "peers")]

from ros_environment import Domain, free_tcp_port  # noqa: E402

# Tests with stock lerobot run in an environment of their own (tests/run --lerobot).
collect_ignore = [] if importlib.util.find_spec("lerobot") else ["stock_lerobot"]

SKIPPED = "skipped, which counts as failed: "
# As count_results.py knows it.
NEEDS = "needs outside recordings: "


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Turns skips and expected failures of tests into failures."""
    report = yield
    if report.skipped and NEEDS not in str(report.longrepr):
        report.outcome = "failed"
        report.longrepr = SKIPPED + str(report.longrepr)
        if hasattr(report, "wasxfail"):
            del report.wasxfail
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """Turns skips of whole modules into failures."""
    report = yield
    if report.skipped:
        report.outcome = "failed"
        report.longrepr = SKIPPED + str(report.longrepr)
    return report


@pytest.fixture
def domain() -> Iterator[int]:
    """A ROS domain of this test's own."""
    held = Domain()
    yield held.number
    held.release()


@pytest.fixture
def port() -> int:
    """A TCP port on the loopback interface that is free."""
    return free_tcp_port()


@pytest.fixture
def data() -> Path:
    """The recordings to test with: FERNTAST_DATA, else ../shared/data where that is there."""
    promised = os.environ.get("FERNTAST_DATA")
    path = Path(promised or HERE.parents[2] / "shared" / "data").resolve()
    if not path.is_dir():
        if not promised:
            pytest.skip(f"{NEEDS}hand")
        pytest.fail(f"no recordings in {path}: set FERNTAST_DATA to the folder that has them")
    return path


@pytest.fixture(scope="session")
def ferntast() -> Path:
    """The ferntast program."""
    default = HERE.parents[1] / "target" / "release" / "ferntast"
    path = Path(os.environ.get("FERNTAST_BIN", default))
    if not path.is_file():
        pytest.fail(f"no program {path}: 'cargo build --release', or set FERNTAST_BIN")
    return path
