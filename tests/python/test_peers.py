"""The peers do what they say: each against another process that is not ferntast."""

import json
import math
from pathlib import Path

import pytest
import zenoh
from check_hashes import check, hash_by_rosbags, hash_in_wheel
from hand import Hand
from peer_process import Peer, run_peer
from zenoh_node import Attachment, message_class

POSE = "geometry_msgs/msg/PoseStamped"
POSE_HASH = "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"


def write_hand(path: Path) -> Path:
    """One second along x at 0.1 m/s with a gap in the middle, in 11 samples less 3."""
    rows = [f"{k / 10},{k / 100},{-k / 100}" for k in range(11) if k not in (4, 5, 6)]
    path.write_text("t_s,x_m,y_m\n" + "\n".join(rows) + "\n")
    return path


def router(port: int) -> zenoh.Session:
    """A Zenoh router of our own."""
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", f'["tcp/127.0.0.1:{port}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def test_rclpy_operator_and_counter_meet(tmp_path, domain):
    hand = write_hand(tmp_path / "hand.csv")
    with (
        Peer("count_messages.py", "/leader/measured_cp", POSE, "--seconds", 20,
             "--at-least", 300, domain=domain) as counter,
        Peer("ros_operator.py", "--hand", hand, "--rate", 200, "--duration", 3,
             domain=domain) as operator,
    ):  # fmt: skip
        sent = operator.report()
        counted = counter.report()
    assert sent["heard"] and sent["sent_bad"] == 0 and not sent["interrupted"]
    assert 300 <= sent["sent"] <= 620
    assert counted["received"] >= 300
    assert counted["zero_stamps"] == 0 and counted["stamps_back"] == 0
    assert 50 < counted["stamp_rate_hz"] < 250
    assert counted["last"]["header"]["frame_id"] == "leader_base"
    # The hand ends at (0.1, -0.1), and stands still there.
    assert counted["last"]["pose"]["position"]["x"] == pytest.approx(0.1)
    assert counted["last"]["pose"]["position"]["y"] == pytest.approx(-0.1)
    assert counted["last"]["pose"]["orientation"]["w"] == 1.0


def test_rclpy_lists_topics_of_another_process(tmp_path, domain):
    hand = write_hand(tmp_path / "hand.csv")
    with Peer("ros_operator.py", "--hand", hand, "--duration", 30, "--wait", 0,
              domain=domain) as operator:  # fmt: skip
        operator.await_ready()
        listed = run_peer(
            "list_topics.py", "--seconds", 10, "--until", "/leader/measured_cp", domain=domain
        )
    topic = listed["topics"]["/leader/measured_cp"]
    assert topic["types"] == [POSE]
    assert [p["node"] for p in topic["publishers"]] == ["/ferntast_test_operator"]
    assert topic["publishers"][0]["reliability"] == "best_effort"
    assert listed["topics"]["/leader/servo_cf"]["types"] == ["geometry_msgs/msg/WrenchStamped"]


def test_an_interrupted_operator_still_reports(tmp_path, domain):
    hand = write_hand(tmp_path / "hand.csv")
    with Peer("ros_operator.py", "--hand", hand, "--duration", 60, "--wait", 0,
              domain=domain) as operator:  # fmt: skip
        operator.await_ready()
        operator.interrupt()
        report = operator.report()
    assert report["interrupted"] and report["seconds"] < 30
    assert not report["heard"]


@pytest.mark.parametrize("spoil", ["nan", "infinite", "far", "zero_stamp"])
def test_the_operator_spoils_what_it_is_asked_to(tmp_path, domain, spoil):
    hand = write_hand(tmp_path / "hand.csv")
    with (
        Peer("count_messages.py", "/leader/measured_cp", POSE, "--seconds", 20,
             "--at-least", 40, domain=domain) as counter,
        Peer("ros_operator.py", "--hand", hand, "--rate", 100, "--duration", 1,
             "--spoil", spoil, "--spoil-after", 0.1, domain=domain) as operator,
    ):  # fmt: skip
        sent = operator.report()
        last = counter.report()["last"]
    position, stamp = last["pose"]["position"], last["header"]["stamp"]
    assert 40 <= sent["sent_bad"] < sent["sent"]
    match spoil:
        case "nan":
            assert position["x"] == "nan"
        case "infinite":
            assert position["y"] == "-inf"
        case "far":
            assert position["x"] == 1000.0
        case "zero_stamp":
            assert stamp == {"sec": 0, "nanosec": 0}


def test_zenoh_operator_and_counter_meet(tmp_path, domain, port):
    hand = write_hand(tmp_path / "hand.csv")
    address = f"tcp/127.0.0.1:{port}"
    with (
        router(port),
        Peer("zenoh_peer.py", "--router", address, "count", "/leader/measured_cp", POSE,
             "--seconds", 20, "--at-least", 300, domain=domain) as counter,
        Peer("zenoh_peer.py", "--router", address, "operator", "--hand", hand,
             "--rate", 200, "--duration", 3, domain=domain) as operator,
    ):  # fmt: skip
        operator.await_ready()
        listed = run_peer("zenoh_peer.py", "--router", address, "list", domain=domain)
        sent = operator.report()
        counted = counter.report()
    key = f"{domain}/leader/measured_cp/geometry_msgs::msg::dds_::PoseStamped_/{POSE_HASH}"
    assert sent["heard"] and sent["key"] == key
    assert counted["keys"] == [key] and counted["broken"] == []
    assert counted["received"] >= 300 and counted["zero_stamps"] == 0
    assert counted["last"]["header"]["frame_id"] == "leader_base"
    publishers = listed["topics"]["/leader/measured_cp"]["publishers"]
    assert [p["type_hash"] for p in publishers] == [POSE_HASH]
    assert publishers[0]["type"] == POSE
    assert listed["topics"]["/leader/servo_cf"]["types"] == ["geometry_msgs/msg/WrenchStamped"]


def test_a_wrong_hash_gets_nothing_over_zenoh(tmp_path, domain, port):
    """The peer is worth having only if it does not take what has another hash."""
    address = f"tcp/127.0.0.1:{port}"
    with router(port) as session:
        key = f"{domain}/x/geometry_msgs::msg::dds_::PoseStamped_/{POSE_HASH.replace('1', '2')}"
        payload = message_class(POSE)().serialize()
        with Peer("zenoh_peer.py", "--router", address, "count", "/x", POSE,
                  "--seconds", 1, domain=domain) as counter:  # fmt: skip
            counter.await_ready()
            for _ in range(20):
                session.put(key, payload)
            assert counter.report()["received"] == 0


def test_zenoh_attachment_is_that_of_rmw_zenoh():
    # rmw_zenoh: int64 sequence number, int64 time, then the GID with its length, all little endian.
    data = Attachment(1, 2, bytes(range(16))).serialize()[4:]
    assert data == bytes([1, *[0] * 7, 2, *[0] * 7, 16, *range(16)])


STANDARD = ["sensor_msgs/msg/JointState", "geometry_msgs/msg/WrenchStamped", POSE]


def wheel_schema(name: str) -> str:
    """The definition of a standard type, put together from the wheels' .msg files."""
    import sys

    texts: dict[str, str] = {}

    def add(full: str) -> None:
        package, _, short = full.split("/")
        text = (Path(sys.prefix) / "share" / package / "msg" / f"{short}.msg").read_text()
        texts[full] = text
        for line in text.splitlines():
            word = line.split("#")[0].split()[:1]
            if not word or not word[0][0].isalpha():
                continue
            kind = word[0].split("[")[0]
            if not kind.split("/")[-1][0].isupper():
                continue
            owner, _, part = kind.rpartition("/")
            part = f"{owner.removesuffix('/msg') or package}/msg/{part}"
            if part not in texts:
                add(part)

    add(name)
    first, *rest = texts.items()
    return first[1] + "".join(
        f"\n{'=' * 80}\nMSG: {full.replace('/msg/', '/')}\n{text}" for full, text in rest
    )


@pytest.mark.parametrize("name", STANDARD)
def test_rosbags_and_wheels_agree_on_hashes(name):
    assert hash_by_rosbags(name, wheel_schema(name)) == hash_in_wheel(name)


def test_hash_check_finds_a_wrong_hash(tmp_path, domain):
    right = [{"name": POSE, "hash": POSE_HASH, "schema": wheel_schema(POSE)}]
    wrong = [right[0] | {"hash": POSE_HASH.replace("10f", "11f")}]
    changed = [right[0] | {"schema": right[0]["schema"].replace("float64 w", "float32 w")}]
    assert check(right)["wrong"] == []
    assert len(check(wrong)["wrong"]) == 2
    assert len(check(changed)["wrong"]) == 1
    assert check([])["wrong"] == ["no types to check"]
    path = tmp_path / "types.json"
    path.write_text(json.dumps(wrong))
    with Peer("check_hashes.py", path, domain=domain) as peer:
        assert len(peer.report(status=1)["wrong"]) == 2


def test_open_bag_reads_what_rosbags_wrote(tmp_path, domain):
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    temperature = store.types["sensor_msgs/msg/Temperature"]
    header, time = store.types["std_msgs/msg/Header"], store.types["builtin_interfaces/msg/Time"]
    directory = tmp_path / "bag"
    with Writer(directory, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/t", temperature.__msgtype__, typestore=store)
        for count in range(5):
            message = temperature(header(time(1, count), "joint_1"), 20.0 + count, 0.0)
            data = store.serialize_cdr(message, temperature.__msgtype__)
            writer.write(connection, 1_000_000_000 + count, data)
    report = run_peer("open_bag.py", directory, domain=domain)
    for library in ("rosbags", "mcap"):
        topic = report[library]["topics"]["/t"]
        assert topic["type"] == "sensor_msgs/msg/Temperature"
        assert topic["count"] == 5
        assert topic["first"]["temperature"] == 20.0
        assert topic["last"]["temperature"] == 24.0
        assert topic["last"]["header"]["frame_id"] == "joint_1"
    assert report["rosbags"]["topics"]["/t"]["last_ns"] == 1_000_000_004


def test_open_bag_fails_on_what_is_no_recording(tmp_path, domain):
    with Peer("open_bag.py", tmp_path, domain=domain) as peer:
        _, errors = peer.process.communicate(timeout=60)
        assert peer.process.returncode == 1
        assert str(tmp_path) in errors


def test_hand_is_interpolated_and_checked(tmp_path):
    hand = Hand(write_hand(tmp_path / "hand.csv"))
    assert hand.duration == pytest.approx(1.0)
    assert hand.at(-1.0) == (0.0, 0.0)
    assert hand.at(0.5) == pytest.approx((0.05, -0.05))
    assert hand.at(9.0) == (0.1, -0.1)
    for bad in ("t_s,x_m,y_m\n0,nan,0\n", "t_s,x_m\n0,1\n", "t_s,x_m,y_m\n",
                "t_s,x_m,y_m\n1,0,0\n0,0,0\n"):  # fmt: skip
        path = tmp_path / "bad.csv"
        path.write_text(bad)
        with pytest.raises(ValueError, match="bad.csv"):
            Hand(path)


@pytest.mark.parametrize("name", ["hand_1", "hand_2", "hand_3"])
def test_recorded_hands_stay_in_their_workspace(data, name):
    """README of the data: strokes within 5 cm, up to 175 s; bursts above 1.5 m/s in hand_3."""
    hand = Hand(data / "hand" / f"{name}.csv")
    steps = zip(hand.times, hand.times[1:], hand.points, hand.points[1:], strict=False)
    speed = max(math.dist(p, q) / (t1 - t0) for t0, t1, p, q in steps if t1 > t0)
    assert 20.0 < hand.duration < 176.0
    assert all(abs(x) <= 0.05 and abs(y) <= 0.05 for x, y in hand.points)
    assert speed > (1.5 if name == "hand_3" else 0.1)
