"""Test programs that run side by side are told one by one, and none is lost."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

RUNNER = Path(__file__).with_name("run_targets.py")


def program(folder: Path, name: str, script: str) -> str:
    """A test program that is a shell script, as cargo tells of it."""
    path = folder / f"{name}-0123456789abcdef"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    target = {"kind": ["test"], "name": name, "src_path": str(folder / "tests" / f"{name}.rs")}
    manifest = str(folder / "Cargo.toml")
    built = {"executable": str(path), "profile": {"test": True}, "manifest_path": manifest}
    return json.dumps(built | {"target": target})


def started(folder: Path, programs: dict[str, str], *more: str) -> subprocess.Popen:
    """The runner with these programs."""
    messages = [program(folder, name, script) for name, script in programs.items()]
    (folder / "programs.json").write_text("\n".join([*messages, json.dumps({"reason": "done"})]))
    command = [sys.executable, RUNNER, "--messages", folder / "programs.json"]
    return subprocess.Popen(
        [*command, "--log", folder / "log", *more],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip


def told(name: str) -> str:
    """A program that says when it begins and ends, with a while between."""
    return f"echo {name} begins; date +%s.%N >>times; sleep 1; echo {name} ends $1"


def test_what_is_said_is_told_in_pieces_and_milliseconds_are_measured_alone(tmp_path: Path) -> None:
    names = ["timing", "live", "arm", "offline"]
    runner = started(tmp_path, {name: told(name) for name in names}, "--", "chosen")
    out, progress = runner.communicate(timeout=30)
    assert runner.returncode == 0, progress
    log = (tmp_path / "log").read_text()
    assert log == out
    for name in names:
        headline = f"     Running tests/{name}.rs ({tmp_path}/{name}-0123456789abcdef)\n"
        assert f"{headline}{name} begins\n{name} ends chosen\n" in log
    assert log.rstrip().endswith("timing ends chosen")
    begun = sorted(float(line) for line in (tmp_path / "times").read_text().split())
    assert begun[1] - begun[0] < 1.0, "two at a time"
    assert begun[3] - begun[2] > 0.9, "the last one alone"


@pytest.mark.parametrize(
    ("rust", "python", "code"),
    [("true", "true", 0), ("false", "true", 1), ("true", "false", 2), ("kill -9 $$", "false", 3)],
)
def test_who_failed_is_in_the_exit_code(tmp_path: Path, rust: str, python: str, code: int) -> None:
    runner = started(tmp_path, {"arm": rust}, "--also", "python", f"sh -c 'echo said; {python}'")
    out, _ = runner.communicate(timeout=30)
    assert runner.returncode == code
    assert "said" in out and "said" not in (tmp_path / "log").read_text()
    assert ("ended by signal 9" in out) == ("kill" in rust)


def test_ctrl_c_ends_all_that_was_started(tmp_path: Path) -> None:
    # A grandchild in a group of its own, as the sessions' nodes are.
    script = "setsid sleep 300 & echo $! >>sleeper; wait"
    runner = started(tmp_path, {"live": script})
    sleeper = tmp_path / "sleeper"
    end = time.monotonic() + 20
    while not (sleeper.exists() and sleeper.read_text().strip()) and time.monotonic() < end:
        time.sleep(0.05)
    runner.send_signal(signal.SIGINT)
    runner.communicate(timeout=20)
    assert runner.returncode == -signal.SIGINT
    stat = Path(f"/proc/{sleeper.read_text().strip()}/stat")
    while stat.exists() and stat.read_text().split()[2] != "Z" and time.monotonic() < end:
        time.sleep(0.05)
    assert not stat.exists() or stat.read_text().split()[2] == "Z"
