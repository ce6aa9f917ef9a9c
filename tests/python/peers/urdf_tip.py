"""The tip by the URDF of a recording, as MuJoCo reads it, beside what the recording says.

Takes a rosbag2 directory; needs `/robot_description`, `/tf` and `/follower/measured_cp`. Prints
JSON: {bodies, joints, compared, largest_difference_m}, at the stamps that both topics have.
"""

import argparse
import math
from pathlib import Path

import mujoco
from arguments import print_report
from rosbags.highlevel import AnyReader

TOPICS = ["/robot_description", "/tf", "/follower/measured_cp"]


def stamp(header: object) -> tuple[int, int]:
    """Comparable."""
    return header.stamp.sec, header.stamp.nanosec


def read(directory: Path) -> tuple[str, dict, dict]:
    """URDF; angles of the joints and the tip by their stamps."""
    urdf, angles, tips = "", {}, {}
    with AnyReader([directory]) as reader:
        wanted = [each for each in reader.connections if each.topic in TOPICS]
        for connection, _, data in reader.messages(wanted):
            message = reader.deserialize(data, connection.msgtype)
            if connection.topic == "/robot_description":
                urdf = message.data
            elif connection.topic == "/tf":
                turns = [each.transform.rotation for each in message.transforms]
                angles[stamp(message.transforms[0].header)] = [
                    2 * math.atan2(turn.z, turn.w) for turn in turns[:2]
                ]
            else:
                place = message.pose.position
                tips[stamp(message.header)] = (place.x, place.y)
    return urdf, angles, tips


def main() -> None:
    """Reads, compares, prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=Path)
    urdf, angles, tips = read(parser.parse_args().directory)
    # MuJoCo would merge the fixed tip into link 2.
    extension = '<mujoco><compiler fusestatic="false"/></mujoco></robot>'
    arm = mujoco.MjModel.from_xml_string(urdf.replace("</robot>", extension))
    data = mujoco.MjData(arm)
    differences = []
    for when in angles.keys() & tips.keys():
        data.qpos[:] = angles[when]
        mujoco.mj_kinematics(arm, data)
        place = data.body("follower_tip").xpos
        differences.append(math.dist(place[:2], tips[when]))
    print_report(
        {
            "bodies": [arm.body(index).name for index in range(arm.nbody)],
            "joints": [arm.joint(index).name for index in range(arm.njnt)],
            "compared": len(differences),
            "largest_difference_m": max(differences, default=math.nan),
        }
    )


if __name__ == "__main__":
    main()
