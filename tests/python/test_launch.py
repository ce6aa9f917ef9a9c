"""The launch file names options that `ferntast session` has. (ROS 2's `launch` is no wheel: it
is not run here.)"""

import ast
import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROGRAM = os.environ.get("FERNTAST_BIN", str(ROOT / "target" / "release" / "ferntast"))


def test_every_argument_is_an_option_of_session() -> None:
    tree = ast.parse((ROOT / "msgs" / "launch" / "session.launch.py").read_text())
    tables = [own.value for own in tree.body if isinstance(own, ast.Assign) and own.targets[0].id == "OPTIONS"]
    options = ast.literal_eval(tables[0])
    told = subprocess.run([PROGRAM, "session", "--help"], capture_output=True, text=True, check=True).stdout
    assert len(options) > 8
    assert [name for name in options if f"--{name} <" not in told] == []
