"""The total that tests/run prints is true."""

from count_results import count_python, count_rust, total

RUST = """
running 2 tests
test result: ok. 12 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s
test result: FAILED. 3 passed; 2 failed; 1 ignored; 0 measured; 4 filtered out; finished in 0.00s
   Doc-tests ferntast_model
test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s
"""

PYTHON = """<testsuites><testsuite>
<testcase name="a"/><testcase name="b"><failure/></testcase>
<testcase name="c"><error/></testcase><testcase name="d"><skipped/></testcase>
<testcase name="e"><system-out/></testcase>
</testsuite></testsuites>"""


def test_every_rust_result_is_added_and_ignored_counts_as_failed():
    assert count_rust(RUST) == (16, 3)
    assert count_rust("") == (0, 0)


def test_every_python_case_is_counted_and_skipped_counts_as_failed(tmp_path):
    path = tmp_path / "report.xml"
    path.write_text(PYTHON)
    assert count_python(path) == (2, 3)
    assert count_python(tmp_path / "none.xml") == (0, 0)


def test_nothing_hides_a_failure():
    assert total((5, 0), 0, (3, 0), 0) == (8, 0)
    assert total((5, 1), 101, (3, 1), 1) == (8, 2)
    # A runner that broke off: a crash, a compile error.
    assert total((5, 0), 101, (3, 0), 0) == (8, 1)
    assert total((5, 0), 0, (0, 0), 3) == (5, 1)
    # No test at all is no success.
    assert total((0, 0), 0, (0, 0), 0) == (0, 1)


def test_skips_and_expected_failures_fail(tmp_path):
    """With this folder's conftest, in a pytest of its own."""
    import shutil
    import subprocess
    import sys
    from pathlib import Path

    here = Path(__file__).parent
    for name in ("conftest.py", "ros_environment.py"):
        shutil.copy(here / name, tmp_path)
    (tmp_path / "test_module.py").write_text("import pytest\npytest.importorskip('no_such')\n")
    (tmp_path / "test_cases.py").write_text(
        "import pytest\n"
        "def test_skip():\n    pytest.skip('x')\n"
        "@pytest.mark.skip\ndef test_mark(): pass\n"
        "@pytest.mark.xfail\ndef test_expected(): assert False\n"
        "def test_good(): pass\n"
    )
    xml = tmp_path / "report.xml"
    command = [sys.executable, "-m", "pytest", "-q", "--continue-on-collection-errors",
               "-p", "no:cacheprovider", "--junit-xml", str(xml), str(tmp_path)]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1, done.stdout
    assert count_python(xml) == (1, 4), done.stdout
