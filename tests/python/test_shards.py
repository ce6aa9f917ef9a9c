"""Studies in parts, started by a scheduler that is none of ours: HyperQueue."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROGRAM = os.environ.get("FERNTAST_BIN", str(ROOT / "target" / "release" / "ferntast"))
SWEEP = """
description = "Two laws at two delays."
rtt_ms = [0, 300]
jitter_ms = [0, 5]
loss = [0]
environments = ["soft_spring", "hard_wall"]
seeds = [1]
hand = { mass = 0.5, damping = 20.0, stiffness = 300.0 }
laws = [{ kind = "position_force", force_scale = 1.0 }, { kind = "wave", force_scale = 1.0 }]
"""


def run(arguments: list[object], folder: Path) -> bytes:
    done = subprocess.run([str(own) for own in arguments], cwd=folder, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def test_parts_by_hyperqueue_are_one_run(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(SWEEP)
    whole = run([PROGRAM, "sweep", "two.toml", "--json"], tmp_path)
    example = ROOT / "python" / "examples" / "hyperqueue_shards.py"
    parts = run([sys.executable, example, "--program", PROGRAM, 3, "sweep", "two.toml"], tmp_path)
    assert parts == whole
    assert len(list((tmp_path / "parts").glob("*.toml"))) == 3


def test_a_part_that_fails_is_told(tmp_path: Path) -> None:
    example = ROOT / "python" / "examples" / "hyperqueue_shards.py"
    arguments = [sys.executable, example, "--program", PROGRAM, 2, "sweep", "not_there"]
    done = subprocess.run([str(own) for own in arguments], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1 and "have failed" in done.stderr, done.stderr
