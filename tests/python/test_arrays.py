"""Where arrays are written to: the Python part alone, without what is compiled."""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "python"
ARRAYS = {"t": np.arange(5.0), "q": np.arange(5.0)}
OTHERS = {"t": np.arange(7.0), "q": np.zeros(7)}


def compiled() -> ModuleType:
    """What stands for the compiled part: writes the experiment file, and refuses a temperature."""
    module = ModuleType("ferntast._native")

    class FerntastError(Exception):
        pass

    class RefusedError(FerntastError):
        pass

    def new(files, said, rate_hz, joint, join, output, force) -> str:
        if ("temperature", "none") in said:
            raise RefusedError("no column none")
        assert all(Path(file).is_file() for file in files)
        output.write_text("\n".join(files))
        return "{}"

    module.FerntastError, module.RefusedError, module.new = FerntastError, RefusedError, new
    module.FailedError = type("FailedError", (FerntastError,), {})
    return module


@pytest.fixture
def package(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """`ferntast` as it stands in this folder; the installed one is back afterwards."""

    def taken_out() -> dict[str, ModuleType]:
        names = [name for name in sys.modules if name.split(".")[0] == "ferntast"]
        return {name: sys.modules.pop(name) for name in names}

    installed = taken_out()
    monkeypatch.syspath_prepend(str(PACKAGE))
    sys.modules["ferntast._native"] = compiled()
    yield importlib.import_module("ferntast")
    taken_out()
    sys.modules.update(installed)


def rows(path: Path) -> int:
    """How many rows of data there are."""
    with np.load(path) as table:
        return len(table["t"])


def test_experiments_in_one_folder_have_data_of_their_own(package, tmp_path):
    folder = tmp_path / "x"
    package.Experiment.of(ARRAYS, output=folder / "first.toml")
    package.Experiment.of(OTHERS, output=folder / "second.toml")
    package.Experiment.of([ARRAYS, OTHERS], output=folder / "both.toml")
    assert {path.name: rows(path) for path in folder.glob("*.npz")} == {
        "first.npz": 5,
        "second.npz": 7,
        "both_1.npz": 5,
        "both_2.npz": 7,
    }
    assert len(list(folder.iterdir())) == 7


def test_what_is_there_is_written_over_only_where_that_is_said(package, tmp_path):
    output = tmp_path / "first.toml"
    package.Experiment.of(ARRAYS, output=output)
    with pytest.raises(package.RefusedError, match="first.toml exists already"):
        package.Experiment.of(OTHERS, output=output)
    output.unlink()
    with pytest.raises(package.RefusedError, match="first.npz exists already"):
        package.Experiment.of(OTHERS, output=output)
    assert rows(tmp_path / "first.npz") == 5 and not output.exists()
    package.Experiment.of(OTHERS, output=output, force=True)
    assert rows(tmp_path / "first.npz") == 7 and output.is_file()
    with pytest.raises(package.RefusedError, match="ends in .toml"):
        package.Experiment.of(OTHERS, output=tmp_path / "first.npz", force=True)
    assert rows(tmp_path / "first.npz") == 7


def test_what_is_refused_leaves_all_as_it_was(package, tmp_path):
    output = tmp_path / "first.toml"
    with pytest.raises(package.RefusedError, match="no column none"):
        package.Experiment.of(ARRAYS, output=output, temperature="none")
    assert list(tmp_path.iterdir()) == []
    package.Experiment.of(ARRAYS, output=output)
    for wrong in [OTHERS, [OTHERS, {"t": np.arange(3.0), "q": np.arange(4.0)}]]:
        with pytest.raises(package.RefusedError):
            package.Experiment.of(wrong, output=output, temperature="none", force=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["first.npz", "first.toml"]
    assert rows(tmp_path / "first.npz") == 5


def test_arrays_without_an_output_lie_in_a_folder_that_goes_with_them(package):
    experiment = package.Experiment.of(ARRAYS)
    folder = experiment.path.parent
    assert [rows(path) for path in folder.glob("*.npz")] == [5]
    del experiment
    assert not folder.exists()
