"""Recordings for other programs, read by those that share nothing with us: messages by
mcap-ros2-support, tables by pandas and pyarrow.

A dataset of LeRobot is held here against the layout that lerobot 0.6 documents and reads
(`lerobot/datasets/{utils,feature_utils,io_utils}.py`); stock lerobot itself opens it in `stock_lerobot/`, in an
environment of its own (`./tests/run --lerobot`), since it takes PyTorch.
"""

import csv
import json
import os
import subprocess
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pyarrow.parquet
import pytest
from mcap_ros2.reader import read_ros2_messages

TOPIC = "/follower/measured_js"
RATE = 50


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two short sessions in virtual time."""
    default = Path(__file__).parents[2] / "target" / "release" / "ferntast"
    program = os.environ.get("FERNTAST_BIN", default)
    folder = tmp_path_factory.mktemp("recordings")
    made = []
    for seed, duration in [(3, 4), (4, 3)]:
        made.append(folder / f"seed_{seed}")
        lockstep = [program, "lockstep", "--seed", seed, "--duration", duration, "--record", made[-1]]
        subprocess.run([str(own) for own in lockstep], check=True, capture_output=True)
    return made


def told(ferntast: Path, *arguments: object) -> Any:
    """What the command line says in JSON."""
    command = [str(own) for own in (ferntast, *arguments, "--json")]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)


def messages(recording: Path, topic: str) -> list[Any]:
    """The messages of a topic, by another reader."""
    [file] = recording.glob("*.mcap")
    return list(read_ros2_messages(str(file), topics=[topic]))


def test_tables_have_the_numbers_of_the_messages(ferntast, recordings, tmp_path):
    recording = recordings[0]
    info = told(ferntast, "bag", "info", recording)
    counts = {own["name"]: own["messages"] for own in info["topics"]}
    for form in ["csv", "parquet"]:
        for table in told(ferntast, "bag", "export", form, recording, "-o", tmp_path / form):
            assert table["rows"] == counts[table["topic"]]
    name = TOPIC.strip("/").replace("/", ".")
    of_csv = pandas.read_csv(tmp_path / "csv" / f"{name}.csv")
    of_parquet = pandas.read_parquet(tmp_path / "parquet" / f"{name}.parquet")
    pandas.testing.assert_frame_equal(of_csv, of_parquet, check_dtype=False, check_exact=True)
    heard = messages(recording, TOPIC)
    assert list(of_csv["position[1]_rad"]) == [own.ros_msg.position[1] for own in heard]
    assert list(of_csv["effort[0]_Nm"]) == [own.ros_msg.effort[0] for own in heard]
    since = [own.log_time_ns - info["start"] for own in heard]
    assert np.allclose(of_csv["t_s"], np.array(since) * 1e-9, atol=1e-9)
    stamps = [own.ros_msg.header.stamp for own in heard]
    stamps = np.array([own.sec * 10**9 + own.nanosec - info["start"] for own in stamps])
    assert np.allclose(of_csv["stamp_s"], stamps * 1e-9, atol=1e-9)
    wrench = pandas.read_csv(tmp_path / "csv" / "follower.contact_cf.csv")
    assert "wrench.force.z_N" in wrench.columns
    start = datetime.fromtimestamp(info["start"] / 1e9, UTC)
    assert info["start_date"] == f"{start:%Y-%m-%d %H:%M:%S}.000 UTC"


def test_topics_are_joined_as_they_were_heard_last(ferntast, recordings, tmp_path):
    recording = recordings[0]
    output = tmp_path / "joined"
    topics = f"{TOPIC},/follower/joint_1/temperature"
    export = ["bag", "export", "csv", recording, "-o", output, "--topics", topics]
    [table] = told(ferntast, *export, "--rate", RATE)
    with (output / "joined.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert table["rows"] == len(rows) == pytest.approx(4 * RATE, abs=1)
    start = told(ferntast, "bag", "info", recording)["start"]
    heard = messages(recording, TOPIC)
    times = np.array([own.log_time_ns - start for own in heard])
    for number in [0, 1, 77, len(rows) - 1]:
        assert float(rows[number]["t_s"]) == pytest.approx(number / RATE)
        last = np.searchsorted(times, round(number * 1e9 / RATE), side="right") - 1
        value = heard[last].ros_msg.position[0]
        assert float(rows[number][f"{TOPIC}.position[0]_rad"]) == value


def test_what_cannot_be_exported_is_refused(ferntast, recordings, tmp_path):
    for arguments, said in [
        (["csv", recordings[0], "-o", tmp_path], "exists already"),
        (["csv", recordings[0], "-o", tmp_path / "a", "--topics", "/follower/measured"], TOPIC),
        (["csv", recordings[0], "-o", tmp_path / "a", "--rate", "0"], "--rate 0"),
        (["lerobot", recordings[0], "-o", tmp_path / "a", "--rate", "2.5"], "whole number"),
        (["lerobot", recordings[0], "-o", tmp_path / "a", "--action", "/no.x"], "the most alike"),
    ]:
        command = [str(own) for own in [ferntast, "bag", "export", *arguments]]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 2 and said in done.stderr, done.stderr
        assert not (tmp_path / "a").exists()


def test_a_dataset_has_the_layout_that_lerobot_reads(ferntast, recordings, tmp_path):
    output = tmp_path / "dataset"
    export = ["bag", "export", "lerobot", *recordings, "-o", output, "--task", "press and slide"]
    said = told(ferntast, *export)
    info = json.loads((output / "meta" / "info.json").read_text())
    assert (info["codebase_version"], info["fps"], info["video_path"]) == ("v3.0", RATE, None)
    assert (info["total_episodes"], info["total_tasks"]) == (2, 1)
    assert info["total_frames"] == said["frames"] == pytest.approx(7 * RATE, abs=6)
    features = info["features"]
    assert features["observation.state"]["names"][0] == f"{TOPIC}.position[0]_rad"
    assert features["observation.state"]["names"][-1].endswith("force.z_N")
    assert [name.rsplit(".")[-1] for name in features["action"]["names"]] == ["x_m", "y_m"]

    path = output / info["data_path"].format(chunk_index=0, file_index=0)
    table = pyarrow.parquet.read_table(path)
    assert sorted(table.column_names) == sorted(features)
    kinds = {"float32": "float", "int64": "int64"}
    for name, feature in features.items():
        kind = table.schema.field(name).type
        if feature["shape"] == [1]:
            assert str(kind) == kinds[feature["dtype"]], name
        else:
            assert str(kind.value_type) == kinds[feature["dtype"]], name
            lengths = {len(row) for row in table[name].to_pylist()}
            assert {tuple(feature["shape"])} == {(own,) for own in lengths}
            assert len(feature["names"]) == feature["shape"][0]
    # Each episode can be read alone.
    assert pyarrow.parquet.ParquetFile(path).num_row_groups == 2

    tasks = pandas.read_parquet(output / "meta" / "tasks.parquet")
    assert tasks.iloc[0].name == "press and slide" and tasks.loc["press and slide", "task_index"] == 0
    episodes = pandas.read_parquet(output / "meta" / "episodes" / "chunk-000" / "file-000.parquet")
    frames = table.to_pandas()
    assert list(frames["index"]) == list(range(len(frames)))
    for number, episode in episodes.iterrows():
        own = frames[frames["episode_index"] == number]
        assert episode["episode_index"] == number and list(episode["tasks"]) == ["press and slide"]
        assert own["index"].iloc[0] == episode["dataset_from_index"]
        assert own["index"].iloc[-1] + 1 == episode["dataset_to_index"]
        assert len(own) == episode["length"]
        assert episode["data/chunk_index"] == episode["data/file_index"] == 0
        assert np.allclose(own["timestamp"], own["frame_index"] / RATE, atol=1e-6)
        actions = np.stack(own["action"])
        assert np.allclose(episode["stats/action/mean"], actions.mean(axis=0), atol=1e-6)

    stats = json.loads((output / "meta" / "stats.json").read_text())
    states = np.stack(frames["observation.state"]).astype(float)
    own = stats["observation.state"]
    assert own["count"] == [len(frames)]
    assert np.allclose(own["mean"], states.mean(axis=0))
    assert np.allclose(own["std"], states.std(axis=0))
    assert np.allclose(own["q90"], np.quantile(states, 0.9, axis=0))
    assert set(stats) == set(features)

    # Frames are what the arm measured last; the first has all that a frame consists of.
    heard = messages(recordings[1], TOPIC)
    second = np.stack(frames[frames["episode_index"] == 1]["observation.state"])[:, 0]
    measured = np.array([own.ros_msg.position[0] for own in heard], dtype=np.float32)
    assert np.isin(second, measured).all()
