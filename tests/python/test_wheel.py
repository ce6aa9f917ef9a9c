"""The Python package: built as a wheel, installed, and held against the command line."""

import importlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import ModuleType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
import pandas
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """`ferntast`, as `pip install ./python` installs it."""
    wheels = tmp_path_factory.mktemp("wheels")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    # maturin stands beside the interpreter.
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = os.environ | {"PATH": path, "CARGO_NET_OFFLINE": "true"}
    build = [*pip, "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", wheels]
    built = subprocess.run(
        [*build, ROOT / "python"], env=environment, capture_output=True, text=True
    )
    assert built.returncode == 0, built.stdout + built.stderr
    [wheel] = wheels.glob("*.whl")
    assert "-cp311-abi3-" in wheel.name
    assert 5e6 < wheel.stat().st_size < 40e6
    install = [*pip, "install", "--quiet", "--no-deps", "--force-reinstall", wheel]
    subprocess.run(install, check=True)
    importlib.invalidate_caches()
    return importlib.import_module("ferntast")


@pytest.fixture(scope="module")
def riddle(package: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A small recording with a hidden effect, and its experiment."""
    return package.challenge(tmp_path_factory.mktemp("riddle") / "76", seed=76, sessions=3)


def told(ferntast: Path, *arguments: object) -> Any:
    """What the command line says in JSON."""
    command = [str(own) for own in (ferntast, *arguments, "--json")]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)


def result(ferntast: Path, *arguments: object) -> Any:
    """The one result of an experiment file, which stands under `joints`, too."""
    said = told(ferntast, *arguments)
    only = said.pop("joints").values()
    assert list(only) == [said]
    return said


def test_results_are_those_of_the_command_line(package, riddle, ferntast, tmp_path):
    comparison = package.compare(riddle)
    assert comparison.to_dict() == result(ferntast, "lab", "compare", riddle.path)
    shares: list[float] = []
    diagnosis = package.diagnose(riddle, progress=shares.append)
    assert diagnosis.to_dict() == result(ferntast, "lab", "diagnose", riddle.path)
    assert diagnosis.verdict == "missing"
    assert shares == sorted(shares) and all(0 < share <= 1 for share in shares)

    effect = diagnosis.candidates[0].effect
    ours, theirs = tmp_path / "ours.toml", tmp_path / "theirs.toml"
    added = package.add(riddle, effect, output=ours)
    said = told(ferntast, "lab", "add", riddle.path, effect, "-o", theirs)
    assert added.to_dict() == said | {"experiment": str(ours), "unit": comparison.unit}
    assert ours.read_text() == theirs.read_text()
    assert package.compare(added.experiment).rms.held_out == added.held_out_after

    automatic = package.auto(riddle, folder=tmp_path / "ours")
    said = told(ferntast, "lab", "auto", riddle.path, "-o", tmp_path / "theirs")
    assert automatic.verdict == said["verdict"] == "complete"
    assert automatic.last.to_dict() == said["last"]
    assert [own.effect for own in automatic.steps] == [own["effect"] for own in said["steps"]]


def test_discover_finds_the_formula_of_the_command_line(package, ferntast, tmp_path):
    # Torques of a law that no catalogue has: it goes with position and with turning back.
    columns = joint()
    q, qd = columns["q"], np.gradient(columns["q"], columns["t"])
    columns["tau"] += 0.8 * np.tanh(qd / 0.1) * q**2
    experiment = package.Experiment.of(columns, position="q:rad", motor_torque="tau:Nm")
    shares: list[float] = []
    found = package.discover(experiment, seed=3, progress=shares.append)
    said = result(ferntast, "lab", "discover", experiment.path, "--seed", 3)
    assert found.to_dict() == said
    assert shares == sorted(shares) and all(0 < share <= 1 for share in shares)
    assert len(found.to_pandas()) == len(found.formulas)
    found.plot().savefig(tmp_path / "discovery.png")
    assert (tmp_path / "discovery.png").stat().st_size > 5000
    if found.formulas:
        best = found.formulas[0]
        added = package.add(experiment, f"{best.name}={best.expression}")
        assert added.held_out_after == best.held_out_after


def test_outside_recordings_give_the_numbers_of_the_command_line(
    package, ferntast, data, monkeypatch
):
    if not (data / "emps").is_dir():
        pytest.skip("needs outside recordings: emps")
    monkeypatch.setenv("FERNTAST_DATA", str(data))
    path = ROOT / "config" / "experiments" / "emps.toml"
    comparison = package.compare(path)
    assert comparison.to_dict() == result(ferntast, "lab", "compare", path)
    # Published: 95.1089 kg; the least-squares fits of others lie within 0.2 %.
    assert comparison.parameters.inertia.value == pytest.approx(95.1, rel=0.005)
    table = np.genfromtxt(data / "emps" / "emps.csv", delimiter=",", names=True)
    of_array = package.compare(table, position="q_m", motor_torque="force_N")
    assert of_array.parameters.inertia.value == pytest.approx(95.1, rel=0.005)


def joint() -> dict[str, np.ndarray]:
    """A joint with 2 kg m², 3 Nm and 5 Nm s/rad, moved by known sines."""
    t = np.arange(0, 40, 0.002)
    parts = [(0.8, 0.9), (0.3, 2.3)]
    q = sum(a * np.sin(w * t) for a, w in parts)
    qd = sum(a * w * np.cos(w * t) for a, w in parts)
    qdd = sum(-a * w * w * np.sin(w * t) for a, w in parts)
    noise = 0.02 * np.random.default_rng(1).standard_normal(t.size)
    return {"t": t, "q": q, "tau": 2 * qdd + 3 * np.sign(qd) + 5 * qd + noise}


class OfColumns:
    """A frame as pyarrow's: `column_names`, and columns that are arrays by a protocol."""

    class Column:
        def __init__(self, values: np.ndarray) -> None:
            self.values = values

        def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
            return np.asarray(self.values, dtype)

    def __init__(self, columns: dict[str, np.ndarray]) -> None:
        self.columns_by_name = columns
        self.column_names = list(columns)

    def __getitem__(self, name: str) -> "OfColumns.Column":
        return self.Column(self.columns_by_name[name])


@pytest.mark.parametrize("kind", ["dictionary", "structured", "pandas", "protocol"])
def test_arrays_and_frames_give_the_truth(package, kind):
    columns = joint()
    frame = {
        "dictionary": columns,
        "structured": np.rec.fromarrays(list(columns.values()), names=list(columns)),
        "pandas": pandas.DataFrame(columns),
        "protocol": OfColumns(columns),
    }[kind]
    comparison = package.compare(frame, position="q:rad", motor_torque="tau:Nm")
    parameters = comparison.parameters
    assert parameters.inertia.value == pytest.approx(2, rel=0.02)
    values = {own["effect"]: own["value"] for own in parameters.to_dict().values()}
    assert values["coulomb"] == pytest.approx(3, rel=0.02)
    assert values["viscous"] == pytest.approx(5, rel=0.02)
    # The noise is 0.02 Nm before the filter.
    assert 0.002 < comparison.rms.held_out < 0.02


def test_units_holes_and_dates_are_read(package):
    columns = joint()
    frame = pandas.DataFrame(
        {
            "time": pandas.Timestamp("2026-01-26 10:00") + pandas.to_timedelta(columns["t"], "s"),
            "q_deg": np.degrees(columns["q"]),
            "tau_mNm": 1e3 * columns["tau"],
            "remark": "x",
        }
    )
    frame.loc[1000:1002, "q_deg"] = np.nan
    experiment = package.Experiment.of(frame, position="q_deg", motor_torque="tau_mNm")
    assert experiment.made["rate_hz"] == pytest.approx(500, rel=0.01)
    inertia = package.compare(experiment).parameters.inertia
    assert inertia.value == pytest.approx(2, rel=0.02)
    assert inertia.unit == "kg m²"


def test_an_experiment_of_arrays_goes_with_it_or_is_saved(package, tmp_path):
    experiment = package.Experiment.of(joint(), position="q:rad", motor_torque="tau:Nm")
    added = package.add(experiment, "stribeck")
    kept = experiment.save(tmp_path / "kept")
    folder = experiment.path.parent
    assert package.compare(kept).to_dict() == package.compare(experiment).to_dict()
    assert (tmp_path / "kept" / added.experiment.path.name).is_file()
    with pytest.raises(package.RefusedError, match=r"has experiment\S* already"):
        experiment.save(tmp_path / "kept")
    experiment.save(tmp_path / "kept", force=True)
    del experiment
    assert folder.is_dir(), "the experiment that came of it needs the recording"
    del added
    assert not folder.exists()


def test_errors_are_exceptions_with_the_lab_s_text(package, riddle, ferntast):
    with pytest.raises(package.RefusedError) as raised:
        package.compare("nowhere.toml")
    command = [ferntast, "lab", "compare", "nowhere.toml"]
    said = subprocess.run(command, capture_output=True, text=True)
    assert said.stderr.strip() == f"error: {raised.value}"
    with pytest.raises(package.RefusedError, match="the catalogue has coulomb"):
        package.add(riddle, "no_such_effect")
    with pytest.raises(package.RefusedError, match="which column is the time"):
        package.compare({"a": np.arange(9.0), "b": np.arange(9.0)}, position="b")
    with pytest.raises(package.RefusedError, match="has no named columns"):
        package.compare(np.zeros((9, 2)))
    with pytest.raises(package.RefusedError, match="no delay law"):
        package.lockstep(law="none")
    with pytest.raises(package.RefusedError, match="the sweep has"):
        package.sweep(laws=["none"])
    assert issubclass(package.RefusedError, package.FerntastError)


def test_lockstep_and_sweep(package, ferntast, tmp_path):
    outcome = package.lockstep(duration=3, seed=3, record=tmp_path / "ours" / "run")
    said = told(ferntast, "lockstep", "--duration", 3, "--seed", 3, "--record", tmp_path / "theirs" / "run")
    same = ["scenario", "seed", "duration_s", "link", "contact", "leader", "states", "friction"]
    assert {key: outcome.to_dict()[key] for key in same} == {key: said[key] for key in same}
    ours, theirs = (tmp_path / name / "run" / "run_0.mcap" for name in ("ours", "theirs"))
    assert ours.read_bytes() == theirs.read_bytes()

    text = (ROOT / "config" / "scenarios" / "delay_sweep.toml").read_text()
    small = tmp_path / "small.toml"
    lists = {"rtt_ms": "[20]", "jitter_ms": "[0]", "loss": "[0]", "seeds": "[1]"}
    lines = [
        f"{key} = {lists[key]}" if (key := line.split("=")[0].strip()) in lists else line
        for line in text.splitlines()
    ]
    small.write_text("\n".join(lines))
    swept = package.sweep(str(small), laws=["position_force"])
    assert swept.to_dict()["rows"] == told(ferntast, "sweep", small, "--law", "position_force")
    assert len(swept.to_pandas()) == len(swept.rows) > 0
    assert "position_force" in str(swept)


def test_ctrl_c_ends_long_work_and_closes_the_recording(package, ferntast, tmp_path):
    for work in ["sweep()", f"lockstep(duration=1e6, record={str(tmp_path / 'cut')!r})"]:
        code = f"import ferntast; print('begun', flush=True); ferntast.{work}"
        # A shell that started the tests in the background would have SIGINT ignored.
        code = f"import signal; signal.signal(signal.SIGINT, signal.default_int_handler); {code}"
        process = subprocess.Popen(
            [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        assert process.stdout.readline() == "begun\n"
        time.sleep(1)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=30)
        assert said.rstrip().endswith("KeyboardInterrupt")
    info = told(ferntast, "bag", "info", tmp_path / "cut")
    assert info["closed"] and info["messages"] > 1000


def test_other_threads_run_meanwhile(package):
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    package.lockstep(duration=60)
    took = time.monotonic() - begun
    done.set()
    thread.join()
    # With the interpreter's lock held there would be none; how many depends on the load.
    assert took > 0.1 and counted > 10


def test_what_was_identified_goes_on_to_mujoco(package, riddle, tmp_path):
    mujoco = importlib.import_module("mujoco")
    told = package.export(riddle, "mujoco", tmp_path / "joint.xml")
    model = mujoco.MjModel.from_xml_path(told.files[0])
    parameters = package.compare(riddle).parameters
    assert model.dof_frictionloss[0] == pytest.approx(parameters["b0"].value, rel=1e-6)
    assert model.dof_damping[0] == pytest.approx(parameters["b1"].value, rel=1e-6)
    with pytest.raises(package.RefusedError, match="exists already"):
        package.export(riddle, "mujoco", tmp_path / "joint.xml")
    with pytest.raises(package.RefusedError, match="one of urdf"):
        package.export(riddle, "webots")


def test_what_is_annotated_is_there(package, riddle):
    results = importlib.import_module("ferntast.results")
    diagnosis = package.diagnose(riddle)
    added = package.add(riddle, "stribeck", output=riddle.path.parent / "annotated.toml")
    automatic = package.auto(riddle, folder=riddle.path.parent / "auto")
    outcome = package.lockstep(duration=1)
    names = {"Experiment": package.Experiment}
    for result in [package.compare(riddle), diagnosis, added, automatic, outcome]:
        for name, hint in get_type_hints(type(result), localns=names).items():
            kinds = [get_origin(own) or own for own in get_args(hint) if isinstance(hint, UnionType)]
            kinds = tuple(kinds) or get_origin(hint) or hint
            assert isinstance(getattr(result, name), kinds), f"{type(result).__name__}.{name}"
        assert repr(result).startswith(type(result).__name__)
    assert isinstance(diagnosis.rms, results.Record)
    with pytest.raises(AttributeError, match="has no 'nothing': "):
        diagnosis.nothing  # noqa: B018
    assert Path(package.__file__).with_name("py.typed").is_file()


def test_the_stub_names_what_is_compiled(package):
    native = importlib.import_module("ferntast._native")
    stub = Path(package.__file__).with_name("_native.pyi").read_text()
    declared = {
        line.split()[1].split("(")[0]
        for line in stub.splitlines()
        if line.startswith(("def ", "class "))
    }
    there = {name for name in dir(native) if not name.startswith("__")}
    assert declared == there


def test_the_notebook_runs(package, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((ROOT / "python" / "examples" / "riddle.ipynb").read_text())
    names: dict[str, Any] = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [], "kept without outputs"
            exec("".join(cell["source"]), names)
    assert names["automatic"].verdict == "complete"
    assert names["added"] == "stribeck"
    assert names["better"].rms.held_out < names["comparison"].rms.held_out
    for name in ["comparison", "diagnosis", "automatic"]:
        figure = names[name].plot()
        figure.savefig(tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 5000
