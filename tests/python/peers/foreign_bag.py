"""Writes recordings as others make them, with topics that ferntast has not.

`rosbags DIR` writes a rosbag2 directory by `rosbags`, `mcap FILE` an .mcap file by
`mcap-ros2-support`. Every message of a topic is the same. Prints JSON:
{topic: {type, count, message}}.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from arguments import print_report
from mcap_ros2.writer import Writer as McapWriter
from message_json import as_json
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

SECONDS = 3.0
START_NS = 1_700_000_000_000_000_000
JOINTS = [f"wheel_{i}" for i in range(12)]
FOREVER = QosTime(2147483647, 4294967295)


def qos(durability: QosDurability) -> list[Qos]:
    """Reliable, ten deep."""
    return [Qos(QosHistory.KEEP_LAST, 10, QosReliability.RELIABLE, durability, FOREVER, FOREVER,
                QosLiveliness.AUTOMATIC, FOREVER, False)]


def messages(types: object) -> dict[str, tuple[str, float, object]]:
    """By topic its type, rate and message."""
    time = types["builtin_interfaces/msg/Time"](sec=START_NS // 10**9, nanosec=0)
    header = types["std_msgs/msg/Header"](stamp=time, frame_id="base_link")
    vector, quaternion = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Quaternion"]
    turned = quaternion(x=0.0, y=0.0, z=0.6, w=0.8)
    imu = types["sensor_msgs/msg/Imu"](
        header=header,
        orientation=turned,
        orientation_covariance=np.arange(9.0),
        angular_velocity=vector(x=0.1, y=-0.2, z=0.3),
        angular_velocity_covariance=np.zeros(9),
        linear_acceleration=vector(x=0.0, y=0.0, z=9.81),
        linear_acceleration_covariance=np.zeros(9),
    )
    joints = types["sensor_msgs/msg/JointState"](
        header=header,
        name=JOINTS,
        position=np.linspace(0.0, 1.1, len(JOINTS)),
        velocity=np.array([]),
        effort=np.array([]),
    )
    transform = types["geometry_msgs/msg/TransformStamped"](
        header=header,
        child_frame_id="wheel",
        transform=types["geometry_msgs/msg/Transform"](
            translation=vector(x=1.0, y=2.0, z=3.0), rotation=turned
        ),
    )
    tf = types["tf2_msgs/msg/TFMessage"](transforms=[transform] * 40)
    picture = types["sensor_msgs/msg/Image"](
        header=header, height=48, width=64, encoding="rgb8", is_bigendian=0, step=192,
        data=(np.arange(48 * 192) % 251).astype(np.uint8),
    )
    # A name of ours, with another type.
    word = types["std_msgs/msg/String"](data="not a joint state")
    return {
        "/imu/data": ("sensor_msgs/msg/Imu", 100.0, imu),
        "/robot/joint_states": ("sensor_msgs/msg/JointState", 50.0, joints),
        "/tf": ("tf2_msgs/msg/TFMessage", 20.0, tf),
        "/tf_static": ("tf2_msgs/msg/TFMessage", 0.0, tf),
        "/camera/image": ("sensor_msgs/msg/Image", 10.0, picture),
        "/follower/measured_js": ("std_msgs/msg/String", 5.0, word),
    }


def with_rosbags(path: Path) -> dict[str, object]:
    """A rosbag2 directory of today."""
    store = get_typestore(Stores.ROS2_KILTED)
    told: dict[str, object] = {}
    queue: list[tuple[int, object, bytes]] = []
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, (kind, rate, message) in messages(store.types).items():
            durability = QosDurability.TRANSIENT_LOCAL if rate == 0.0 else QosDurability.VOLATILE
            connection = writer.add_connection(
                topic, kind, typestore=store, offered_qos_profiles=qos(durability)
            )
            count = max(1, int(SECONDS * rate))
            data = bytes(store.serialize_cdr(message, kind))
            queue += [(START_NS + int(i / max(rate, 1.0) * 1e9), connection, data) for i in range(count)]
            told[topic] = {"type": kind, "count": count, "message": as_json(message)}
        for time, connection, data in sorted(queue, key=lambda own: own[0]):
            writer.write(connection, time, data)
    return told


TWIST = """Vector3 linear
Vector3 angular
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""


def with_mcap(path: Path) -> dict[str, object]:
    """A file of mcap-ros2-support, and a topic in it that is no topic of ROS 2."""
    twist = {"linear": {"x": 0.5, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": -0.25}}
    count = int(SECONDS * 20)
    with path.open("wb") as file, McapWriter(file) as writer:
        schema = writer.register_msgdef("geometry_msgs/msg/Twist", TWIST)
        # Beside ROS 2, through the writer that it is made of.
        notes = writer._writer.register_channel("/notes", "json", 0)
        for i in range(count):
            time = START_NS + i * 50_000_000
            writer.write_message("/cmd_vel", schema, twist, log_time=time, publish_time=time)
            text = json.dumps({"note": i}).encode()
            writer._writer.add_message(notes, log_time=time, data=text, publish_time=time)
    return {"/cmd_vel": {"type": "geometry_msgs/msg/Twist", "count": count, "message": twist}}


def main() -> None:
    """Writes one of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("by", choices=["rosbags", "mcap"])
    parser.add_argument("path", type=Path)
    arguments = parser.parse_args()
    write = {"rosbags": with_rosbags, "mcap": with_mcap}[arguments.by]
    print_report(write(arguments.path))


if __name__ == "__main__":
    main()
