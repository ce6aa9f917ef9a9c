"""A robot on ROS 2 whose arm is MuJoCo's, in real time: for `ferntast session --driver ros2`.

A stock rclpy node that speaks as ros2_control does: `sensor_msgs/JointState` out (its joints in an
order of their own, with a gripper's among them), `std_msgs/Float64MultiArray` in, as a forward
command controller of effort, velocity or position takes it. The arm comes out of a file of
config/arms (`--arm panda.toml`: URDF, home, surfaces). As a robot does, it has brakes: they are on
until the first command comes, and again 50 ms after the last.

`--spoil` makes it a bad one, from `--spoil-after` on: silent, slow (20 Hz), jump, nan, names, degrees,
sign (of the torques that it tells). Prints JSON at the end: `peak_force_N` on the tip (true),
`contact_s`, `commands` (how many came), `states`, `states_hz`, `braked` (how often), `stopped` (it was too fast), `moved_rad` (the farthest
that a joint was from home), `tip_m` in the end.
"""

import argparse
import os
import time
import tomllib
import xml.etree.ElementTree
from pathlib import Path

import mujoco
import numpy as np
from arguments import print_report, ready, stop_on_signal
from mujoco_plant import Plant, options_of
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from ros_peer import quiet_node, take
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

SPOILS = ("silent", "slow", "jump", "nan", "names", "degrees", "sign")
# Without a command for so long the brakes fall in [s].
COMMAND_LIFE = 0.05
# A joint that is faster makes it stop for good, as robots do [rad/s].
STOP_SPEED = 4.0
# The robot's own controllers work in steps of [s].
STEP = 1e-3
# As joint_state_broadcaster and forward command controllers have it.
QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)


def arm_of(path: Path) -> tuple[dict, list[str]]:
    """What the file says, with motors as heavy as ferntast assumes where it does not, and its joints."""
    with path.open("rb") as file:
        written = tomllib.load(file)
    section = written["arm"]
    urdf = (path.parent / section["urdf"]).read_text(encoding="utf-8")
    model = mujoco.MjModel.from_xml_string(urdf)
    names = [model.joint(number).name for number in range(model.njnt)]
    strength = model.jnt_actfrcrange[:, 1]
    own = {joint["name"]: joint for joint in written.get("joint", [])}
    armature = [
        own.get(name, {}).get("motor_inertia", 0.0022 * strength[number])
        for number, name in enumerate(names)
    ]
    arm = {
        "urdf": urdf,
        "tip": section.get("tip") or last_link(urdf),
        "home": section["home"],
        "joint": [{"motor_inertia": inertia} for inertia in armature],
        "surface": written.get("surface", []),
    }
    return arm, names


def real_time() -> None:
    """A robot has a computer of its own: as far as that is allowed no other program holds it up, but
    for the loops of ferntast that stand before all."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(36))
    except PermissionError:
        pass


def last_link(urdf: str) -> str:
    """The link that carries no other."""
    robot = xml.etree.ElementTree.fromstring(urdf)
    parents = {parent.get("link") for parent in robot.iter("parent")}
    (last,) = [link.get("name") for link in robot.findall("link") if link.get("name") not in parents]
    return last


class Robot:
    """The plant behind a robot's own controller and brakes."""

    def __init__(self, arm: dict, joints: list[str], interface: str) -> None:
        self.plant = Plant(arm, joints, options_of([]))
        self.interface, self.joints = interface, joints
        self.command: tuple[float, np.ndarray] | None = None
        self.torque, self.braked, self.brakes = np.zeros(len(joints)), 0, True
        self.stopped = False
        self.home = np.array(arm["home"])
        self.peak, self.contact, self.moved, self.commands = 0.0, 0.0, 0.0, 0
        inertia = np.zeros((self.plant.model.nv, self.plant.model.nv))
        mujoco.mj_fullM(self.plant.model, self.plant.data, inertia)
        self.inertia = np.diag(inertia)[self.plant.rates]

    def take(self, message: Float64MultiArray) -> None:
        values = np.array(message.data)
        if len(values) == len(self.joints) and np.isfinite(values).all():
            self.commands += 1
            self.command = (time.monotonic(), values)

    def wanted(self, values: np.ndarray) -> np.ndarray:
        """Torques of the robot's controller: as stiff as an industrial one."""
        data, plant = self.plant.data, self.plant
        rate = data.qvel[plant.rates]
        weight = data.qfrc_bias[plant.rates]
        if self.interface == "velocity":
            return weight + 200.0 * self.inertia * (values - rate)
        if self.interface == "position":
            apart = values - data.qpos[plant.positions]
            return weight + self.inertia * (1e4 * apart - 200.0 * rate)
        return values

    def step(self, elapsed: float) -> None:
        plant, command = self.plant, self.command
        silent = command is None or time.monotonic() - command[0] > COMMAND_LIFE
        self.stopped |= bool(np.abs(plant.data.qvel).max() > STOP_SPEED)
        if silent or self.stopped:
            self.braked += not self.brakes
            self.brakes = True
            plant.data.qvel[:] = 0.0
            mujoco.mj_forward(plant.model, plant.data)
            # The brakes carry the arm, which its sensors feel.
            self.torque = plant.data.qfrc_bias[plant.rates].copy()
            plant.data.qacc[:] = 0.0
            return
        self.brakes = False
        while elapsed > 0.0:
            slice_ = min(elapsed, STEP)
            elapsed -= slice_
            self.torque = self.wanted(command[1])
            plant.step(slice_, self.torque)
            force = float(np.linalg.norm(plant.force))
            self.peak = max(self.peak, force)
            self.contact += slice_ * (force > 0.0)
        away = np.abs(plant.data.qpos[plant.positions] - self.home)
        self.moved = max(self.moved, float(away.max()))

    def state(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        count = len(self.joints)
        reading = self.plant.reading(self.torque)
        parts = [np.array(reading[part * count : (part + 1) * count]) for part in range(3)]
        return parts[0], parts[1], parts[2]


def message(robot: Robot, spoiled: str | None) -> JointState:
    """As the robot tells it: the last joint first, fingers between."""
    position, velocity, effort = robot.state()
    if spoiled == "jump":
        position[1] += 0.3
    elif spoiled == "nan":
        velocity[2] = np.nan
    elif spoiled == "degrees":
        position, velocity = np.degrees(position), np.degrees(velocity)
    elif spoiled == "sign":
        effort = -effort
    told = JointState()
    for number in reversed(range(len(robot.joints))):
        name = robot.joints[number]
        told.name.extend([f"other_{name}" if spoiled == "names" else name, f"finger_{number}"])
        told.position.extend([float(position[number]), 0.02])
        told.velocity.extend([float(velocity[number]), float("nan")])
        told.effort.extend([float(effort[number]), float("nan")])
    return told


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--arm", type=Path, required=True, help="file of config/arms")
    parser.add_argument("--rate", type=float, default=500.0, help="joint states a second")
    parser.add_argument("--interface", choices=("velocity", "position", "effort"), default="velocity")
    parser.add_argument("--joint-states", default="/joint_states")
    parser.add_argument("--command", help="topic; /forward_velocity_controller/commands and its like without it")
    parser.add_argument("--spoil", choices=SPOILS)
    parser.add_argument("--spoil-after", type=float, default=0.0, help="seconds")
    arguments = parser.parse_args()
    command = arguments.command or f"/forward_{arguments.interface}_controller/commands"
    stop = stop_on_signal()
    real_time()
    robot = Robot(*arm_of(arguments.arm), arguments.interface)
    with quiet_node("mujoco_arm") as node:
        publisher = node.create_publisher(JointState, arguments.joint_states, QOS)
        commands = node.create_subscription(Float64MultiArray, command, robot.take, QOS)
        clock = node.get_clock()
        ready()
        begun = due = last = time.monotonic()
        states = 0
        while not stop.is_set():
            due += 1.0 / arguments.rate
            time.sleep(max(0.0, due - time.monotonic()))
            now = time.monotonic()
            take(commands)
            # A machine that stalls is no time that goes by.
            robot.step(min(now - last, 0.02))
            due = max(due, now - 0.02)
            last = now
            spoiled = arguments.spoil if now - begun >= arguments.spoil_after else None
            slow = spoiled == "slow" and states % round(arguments.rate / 20.0)
            states += 1
            if spoiled == "silent" or slow:
                continue
            told = message(robot, spoiled)
            told.header.stamp = clock.now().to_msg()
            publisher.publish(told)
        passed = time.monotonic() - begun
    print_report(
        {
            "peak_force_N": robot.peak,
            "contact_s": robot.contact,
            "commands": robot.commands,
            "states": states,
            "states_hz": states / passed,
            "braked": robot.braked,
            "stopped": robot.stopped,
            "moved_rad": robot.moved,
            "tip_m": robot.plant.place().tolist(),
        }
    )


if __name__ == "__main__":
    main()
