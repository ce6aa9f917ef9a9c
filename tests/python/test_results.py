"""The total that tests/run prints is true."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from count_results import (
    NEEDS,
    RUST_FAILED,
    Count,
    count_python,
    count_rust,
    explanation,
    held_up,
    slowest,
    ended_so,
    total,
)

HERE = Path(__file__).parent

RUST = f"""
     Running unittests src/lib.rs (target/release/deps/ferntast_model-0123456789abcdef)
test a ... ignored
test result: ok. 12 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s
     Running tests/real_data.rs (target/release/deps/real_data-0123456789abcdef)
test emps::is_there ... ignored, {NEEDS}emps
test emps::is_slow ... ignored, it takes too long
test result: FAILED. 3 passed; 2 failed; 2 ignored; 0 measured; 4 filtered out; finished in 0.00s
   Doc-tests ferntast_model
test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s
"""

TIMES = """
     Running tests/live/main.rs (target/release/deps/live-0123456789abcdef)
test result: ok. 5 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 61.20s
     Running tests/chain.rs (target/release/deps/chain-0123456789abcdef)
test result: ok. 5 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 9.00s
     Running tests/offline/main.rs (target/release/deps/offline-0123456789abcdef)
test result: ok. 5 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 100.00s
"""

PYTHON = f"""<testsuites><testsuite>
<testcase name="a"/><testcase name="b"><failure/></testcase>
<testcase name="c"><error/></testcase><testcase name="d"><skipped message="x"/></testcase>
<testcase name="e"><system-out/></testcase>
<testcase classname="t" name="f"><skipped message="{NEEDS}hand"/></testcase>
</testsuite></testsuites>"""


def test_every_rust_result_is_added_and_ignored_counts_as_failed():
    assert count_rust(RUST) == Count(16, 3, (f"real_data::emps::is_there ({NEEDS}emps)",))
    assert count_rust("") == Count()


def test_what_took_longest_comes_first():
    assert slowest(TIMES) == "offline 100 s, live 61 s"
    assert slowest("") == ""


def test_only_what_passed_when_run_again_is_forgiven():
    log = """
     Running tests/live/main.rs (target/release/deps/live-0123456789abcdef)
test crashes::a ... FAILED
test crashes::b ... ok
     Running tests/timing/main.rs (target/release/deps/timing-0123456789abcdef)
test crashes::a ... FAILED
"""
    again = log.replace("crashes::a ... FAILED", "crashes::a ... ok", 1)
    assert ended_so(log, RUST_FAILED) == [("live", "crashes::a"), ("timing", "crashes::a")]
    assert held_up(log, again) == [("live", "crashes::a")]
    assert held_up(log, log) == held_up(log, "") == []
    assert Count(1, 2).with_passed_again(1) == Count(2, 1)
    # A program that broke off is not forgiven by it.
    assert total(Count(1, 2), 101, Count(), 3).with_passed_again(2) == Count(3, 1)


def test_every_python_case_is_counted_and_skipped_counts_as_failed(tmp_path):
    path = tmp_path / "report.xml"
    path.write_text(PYTHON)
    assert count_python(path) == Count(2, 3, (f"t::f ({NEEDS}hand)",))
    assert count_python(tmp_path / "none.xml") == Count()


def test_nothing_hides_a_failure():
    assert total(Count(5), 0, Count(3), 0) == Count(8)
    assert total(Count(5, 1), 101, Count(3, 1), 1) == Count(8, 2)
    # A runner that broke off: a crash, a compile error.
    assert total(Count(5), 101, Count(3), 0) == Count(8, 1)
    assert total(Count(5), 0, Count(), 3) == Count(5, 1)
    # No test at all is no success, nor are tests that were not run.
    assert total(Count(), 0, Count(), 0) == Count(0, 1)
    assert total(Count(not_run=("a",)), 0, Count(), 0) == Count(0, 1, ("a",))


def test_what_was_not_run_is_named_once_with_its_origin():
    named = (f"real_data::emps::is_there ({NEEDS}emps, hand)",)
    assert Count(1, 0, named).plus(Count(1, 0, named)).not_run == named
    text = "\n".join(explanation(named))
    assert f"not run: {named[0]}" in text
    assert "Janot" in text and "omniglot" in text and "xl330" not in text
    assert explanation(()) == []


def run_pytest(folder: Path, tests: str, **environment: str) -> Count:
    """The count of a pytest of its own, with this folder's conftest; it has to fail."""
    for name in ("conftest.py", "ros_environment.py"):
        shutil.copy(HERE / name, folder)
    (folder / "test_cases.py").write_text(tests)
    xml = folder / "report.xml"
    command = [sys.executable, "-m", "pytest", "-q", "--continue-on-collection-errors",
               "-p", "no:cacheprovider", "--junit-xml", str(xml), str(folder)]  # fmt: skip
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=60, check=False,
        env=os.environ | environment,
    )  # fmt: skip
    assert done.returncode == 1, done.stdout
    return count_python(xml)


def test_skips_and_expected_failures_fail(tmp_path):
    (tmp_path / "test_module.py").write_text("import pytest\npytest.importorskip('no_such')\n")
    tests = (
        "import pytest\n"
        "def test_skip():\n    pytest.skip('x')\n"
        "@pytest.mark.skip\ndef test_mark(): pass\n"
        "@pytest.mark.xfail\ndef test_expected(): assert False\n"
        "def test_good(): pass\n"
    )
    assert run_pytest(tmp_path, tests) == Count(1, 4)


def test_recordings_are_needed_only_where_none_were_promised(tmp_path):
    tests = "def test_it(data): pass\ndef test_bad(): assert False\n"
    promised = run_pytest(tmp_path, tests, FERNTAST_DATA=str(tmp_path / "nowhere"))
    assert promised == Count(0, 2)
    # Here the folder of recordings would be two levels up.
    environment = dict.fromkeys(("FERNTAST_DATA",), "")
    counted = run_pytest(tmp_path, tests, **environment)
    assert (counted.failed, len(counted.not_run)) == (1, 1)
