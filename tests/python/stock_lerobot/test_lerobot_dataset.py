"""Datasets that `ferntast bag export lerobot` writes, opened by stock lerobot 0.6 of PyPI: as they are, with windows over time,
in batches, merged with others; and beside one that lerobot itself writes of the same numbers.

In an environment of its own (`./tests/run --lerobot`), since it takes PyTorch.
"""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pyarrow.parquet
import pytest
import torch
from lerobot.datasets.compute_stats import compute_episode_stats
from lerobot.datasets.dataset_tools import merge_datasets
from lerobot.datasets.lerobot_dataset import LeRobotDataset
from lerobot.datasets.sampler import EpisodeAwareSampler

RATE = 50
TASK = "press and slide"
SECONDS = {3: 4, 4: 3}
JOINTS = [f"/follower/measured_js.{what}" for what in ("position[{}]_rad", "velocity[{}]_rad_s", "effort[{}]_Nm")]
STATE = [name.format(joint) for name in JOINTS for joint in (0, 1)]
STATE += [f"/follower/contact_cf.wrench.force.{axis}_N" for axis in "xz"]
ACTION = [f"/follower/servo_cp.pose.position.{axis}_m" for axis in "xy"]
VECTORS = {"observation.state": STATE, "action": ACTION}
TOPICS = "/follower/measured_js,/follower/contact_cf,/follower/servo_cp"


@pytest.fixture(scope="module")
def said(ferntast: Path) -> Any:
    """What the command line says in JSON."""

    def run(*arguments: object) -> Any:
        command = [str(own) for own in (ferntast, *arguments, "--json")]
        return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)

    return run


@pytest.fixture(scope="module")
def recordings(said, tmp_path_factory) -> list[Path]:
    """Two short sessions in virtual time."""
    folder = tmp_path_factory.mktemp("recordings")
    for seed, seconds in SECONDS.items():
        said("lockstep", "--seed", seed, "--duration", seconds, "--record", folder / f"seed_{seed}")
    return [folder / f"seed_{seed}" for seed in SECONDS]


@pytest.fixture(scope="module")
def folder(said, recordings, tmp_path_factory) -> Path:
    """Both as a dataset."""
    output = tmp_path_factory.mktemp("exported") / "dataset"
    said("bag", "export", "lerobot", *recordings, "-o", output, "--task", TASK, "--rate", RATE)
    return output


@pytest.fixture(scope="module")
def dataset(folder) -> LeRobotDataset:
    """As stock lerobot reads it."""
    return LeRobotDataset("local/dataset", root=folder)


def columns(dataset: LeRobotDataset) -> dict[str, np.ndarray]:
    """All frames, feature by feature, as lerobot gives them one by one."""
    items = [dataset[index] for index in range(len(dataset))]
    return {name: torch.stack([item[name] for item in items]).numpy() for name in dataset.features}


def frames_of(said, recording: Path, output: Path, rate: int) -> dict[str, np.ndarray]:
    """The same of a recording by its table: rows from the first in which everything has been heard."""
    said("bag", "export", "csv", recording, "-o", output, "--topics", TOPICS, "--rate", rate)
    table = pandas.read_csv(output / "joined.csv", float_precision="round_trip")
    assert np.allclose(table["t_s"], np.arange(len(table)) / rate, atol=1e-9)
    whole = table[[*STATE, *ACTION]].notna().all(axis=1)
    table = table.iloc[int(np.argmax(whole)) :]
    return {feature: table[names].to_numpy(np.float32) for feature, names in VECTORS.items()}


def test_frames_rate_and_names(dataset):
    assert (dataset.num_episodes, dataset.fps, dataset.meta.total_tasks) == (len(SECONDS), RATE, 1)
    assert dataset.num_frames == len(dataset) == sum(dataset.meta.episodes["length"])
    for length, seconds in zip(dataset.meta.episodes["length"], SECONDS.values(), strict=True):
        # The first tenths of a second have no contact force yet.
        assert 0.9 * seconds * RATE < length <= seconds * RATE + 1
    for feature, names in VECTORS.items():
        own = dataset.meta.features[feature]
        assert (own["dtype"], own["shape"], own["names"]) == ("float32", (len(names),), names)
        assert dataset[0][feature].shape == (len(names),) and dataset[0][feature].dtype == torch.float32
    assert not dataset.meta.camera_keys
    assert {dataset[index]["task"] for index in (0, len(dataset) - 1)} == {TASK}
    assert list(dataset.meta.tasks.index) == [TASK]


def test_every_value_is_the_one_in_the_table(said, dataset, recordings, tmp_path):
    read = columns(dataset)
    assert list(read["index"]) == list(range(len(dataset)))
    for episode, recording in enumerate(recordings):
        expected = frames_of(said, recording, tmp_path / str(episode), RATE)
        own = read["episode_index"] == episode
        for feature, values in expected.items():
            np.testing.assert_array_equal(read[feature][own], values)
            assert np.ptp(values, axis=0).min() > 0.0, "numbers that never change prove little"
        count = own.sum()
        assert list(read["frame_index"][own]) == list(range(count))
        assert np.allclose(read["timestamp"][own], np.arange(count) / RATE, atol=1e-6)


@pytest.mark.parametrize("rate", [20, 333])
def test_other_rates(said, recordings, tmp_path, rate):
    said("bag", "export", "lerobot", recordings[0], "-o", tmp_path / "dataset", "--rate", rate)
    # Windows of whole frames are checked against rate and time stamps.
    window = {"action": [0.0, 1 / rate]}
    dataset = LeRobotDataset("local/dataset", root=tmp_path / "dataset", delta_timestamps=window)
    assert dataset.fps == rate and dataset.num_episodes == 1
    expected = frames_of(said, recordings[0], tmp_path / "table", rate)
    assert len(dataset) == len(expected["action"])
    for index in (0, 1, len(dataset) // 2, len(dataset) - 2):
        frame = dataset[index]
        assert frame["timestamp"].item() == pytest.approx(index / rate, abs=1e-6)
        assert frame["task"] == "teleoperate"
        np.testing.assert_array_equal(frame["observation.state"], expected["observation.state"][index])
        np.testing.assert_array_equal(frame["action"], expected["action"][index : index + 2])


def test_windows_end_where_an_episode_ends(folder, dataset):
    read = columns(dataset)
    state, action = [-2, -1, 0], list(range(16))
    windows = {"observation.state": state, "action": action}
    seconds = {name: [step / RATE for step in steps] for name, steps in windows.items()}
    windowed = LeRobotDataset("local/dataset", root=folder, delta_timestamps=seconds)
    for episode in windowed.meta.episodes:
        first, after = episode["dataset_from_index"], episode["dataset_to_index"]
        for index in (first, first + 1, (first + after) // 2, after - 3, after - 1):
            frame = windowed[index]
            for name, steps in windows.items():
                asked = index + np.array(steps)
                held = np.clip(asked, first, after - 1)
                np.testing.assert_array_equal(frame[name], read[name][held])
                np.testing.assert_array_equal(frame[f"{name}_is_pad"], asked != held)


def test_batches_of_a_loader(folder):
    seconds = {"action": [step / RATE for step in range(8)]}
    dataset = LeRobotDataset("local/dataset", root=folder, delta_timestamps=seconds)
    ends = [dataset.meta.episodes[name] for name in ("dataset_from_index", "dataset_to_index")]
    sampler = EpisodeAwareSampler(*ends, shuffle=True)
    seen = []
    for batch in torch.utils.data.DataLoader(dataset, batch_size=32, sampler=sampler):
        count = len(batch["index"])
        assert batch["observation.state"].shape == (count, len(STATE))
        assert batch["action"].shape == (count, 8, len(ACTION))
        assert torch.isfinite(batch["observation.state"]).all() and torch.isfinite(batch["action"]).all()
        assert batch["task"] == [TASK] * count
        seen += batch["index"].tolist()
    assert sorted(seen) == list(range(len(dataset))) and seen != sorted(seen)


def test_one_episode_alone(folder, dataset):
    second = LeRobotDataset("local/dataset", root=folder, episodes=[1])
    assert (second.num_episodes, second.num_frames) == (1, dataset.meta.episodes["length"][1])
    first = dataset.meta.episodes["dataset_from_index"][1]
    assert second[0]["index"].item() == first
    assert torch.equal(second[0]["observation.state"], dataset[first]["observation.state"])


def test_statistics_are_those_of_the_frames(dataset):
    read = columns(dataset)
    stats = dataset.meta.stats
    assert set(stats) == set(dataset.features)
    for name, values in read.items():
        values = values.reshape(len(values), -1).astype(float)
        own = stats[name]
        assert own["count"] == [len(values)]
        expected = {"min": values.min(0), "max": values.max(0), "mean": values.mean(0), "std": values.std(0)}
        expected |= {f"q{share:02}": np.quantile(values, share / 100, axis=0) for share in (1, 10, 50, 90, 99)}
        assert set(own) == {"count", *expected}
        for key, value in expected.items():
            assert own[key].shape == value.shape and np.isfinite(own[key]).all()
            np.testing.assert_allclose(own[key], value, rtol=1e-6, atol=1e-7, err_msg=f"{name} {key}")


def test_of_a_kind_with_what_lerobot_writes(folder, dataset, tmp_path):
    """Stock lerobot writes the same frames: what it writes differs in nothing but its own choices."""
    features = {name: dataset.meta.features[name] for name in VECTORS}
    written = LeRobotDataset.create("local/theirs", RATE, features, root=tmp_path / "theirs", use_videos=False)
    for episode in dataset.meta.episodes:
        for index in range(episode["dataset_from_index"], episode["dataset_to_index"]):
            frame = dataset[index]
            written.add_frame({"task": TASK, **{name: frame[name].numpy() for name in VECTORS}})
        written.save_episode()
    written.finalize()

    ours, theirs = (json.loads((own / "meta" / "info.json").read_text()) for own in (folder, tmp_path / "theirs"))
    assert ours == theirs
    for part in ("data", "meta/episodes"):
        own, other = (
            pyarrow.parquet.read_table(root / part / "chunk-000" / "file-000.parquet") for root in (folder, tmp_path / "theirs")
        )
        assert sorted(own.column_names) == sorted(other.column_names)
        for name in own.column_names:
            if not name.startswith("stats/"):
                assert own[name].to_pylist() == other[name].to_pylist(), name
    frames = columns(LeRobotDataset("local/theirs", root=tmp_path / "theirs"))
    for name, values in columns(dataset).items():
        np.testing.assert_array_equal(values, frames[name])
    # Its statistics of a whole dataset are put together from the episodes'; these are of one.
    first = slice(0, dataset.meta.episodes["length"][0])
    # In float32 it would lose the third digit of a standard deviation.
    numbers = {name: frames[name][first].astype(float) for name in VECTORS}
    expected = compute_episode_stats(numbers, features)
    [row] = pyarrow.parquet.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").slice(0, 1).to_pylist()
    for name, own in expected.items():
        values = numbers[name]
        span = np.ptp(values, axis=0)
        for key, value in own.items():
            mine = row[f"stats/{name}/{key}"]
            if key.startswith("q"):
                # It reads them off a histogram of 5000 bins: right to a bin of the frame before or after.
                near = int(key[1:]) / 100 + np.array([-1, 1]) / len(values)
                low, high = np.quantile(values, near.clip(0, 1), axis=0)
                for either in (mine, value):
                    assert np.all((low - span / 2500 <= either) & (either <= high + span / 2500)), (name, key)
            else:
                assert np.all(np.abs(mine - value) <= 1e-6 * span), (name, key)


def test_merged_with_another(said, dataset, recordings, tmp_path):
    said("bag", "export", "lerobot", recordings[1], "-o", tmp_path / "other", "--task", "again", "--rate", RATE)
    other = LeRobotDataset("local/other", root=tmp_path / "other")
    merged = merge_datasets([dataset, other], "local/merged", tmp_path / "merged")
    assert (merged.num_episodes, merged.num_frames) == (len(SECONDS) + 1, len(dataset) + len(other))
    assert sorted(merged.meta.tasks.index) == sorted([TASK, "again"])
    assert merged[len(merged) - 1]["task"] == "again"
    assert torch.equal(merged[len(merged) - 1]["action"], other[len(other) - 1]["action"])
    every = torch.stack([merged[index]["action"] for index in range(len(merged))]).double()
    np.testing.assert_allclose(merged.meta.stats["action"]["mean"], every.mean(0), atol=1e-6)
