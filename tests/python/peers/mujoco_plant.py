"""An arm in MuJoCo as a plant for ferntast: `--driver 'process:python tests/python/peers/mujoco_plant.py'`.

What goes over stdin and stdout is described in docs/process_driver.md. The greeting has the arm's file:
{urdf (text), base, tip, gravity [m/s²], home [rad] or [m], joint: list of {motor_inertia}, surface: list of
{point, normal, stiffness, damping, friction}}. Options take the place of what it says. Gears are rigid;
with --friction they have MuJoCo's own dry friction and damping, on the motors' side of the torque sensors.

Surfaces are springs that MuJoCo knows nothing of, so that the force on the tip is known exactly.
"""

import argparse
import json
import struct
import sys

import mujoco
import numpy as np
from mujoco_urdf import body, load, places

# Integration step of MuJoCo [s].
STEP = 2.5e-4
# The velocity from which on Coulomb friction of a wall is full [m/s].
SLIDES = 1e-3


class Wall:
    """A plane that pushes along its normal, with friction that is regularised at rest."""

    def __init__(self, point, normal, stiffness, damping=100.0, friction=0.3, **_names) -> None:
        self.point = np.array(point)
        self.normal = np.array(normal) / np.linalg.norm(normal)
        self.stiffness, self.damping, self.friction = stiffness, damping, friction

    @staticmethod
    def parse(text: str) -> "Wall":
        numbers = [float(number) for number in text.split(",")]
        return Wall(numbers[0:3], numbers[3:6], *numbers[6:])

    def force(self, tip: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        depth = -self.normal @ (tip - self.point)
        if depth <= 0.0:
            return np.zeros(3)
        rate = self.normal @ velocity
        pressed = max(0.0, self.stiffness * depth - self.damping * rate)
        sliding = velocity - rate * self.normal
        speed = np.linalg.norm(sliding)
        return pressed * (self.normal - self.friction * sliding / max(speed, SLIDES))


class Push:
    """A wrench on the tip for a time: force and torque about it, base frame."""

    def __init__(self, text: str) -> None:
        numbers = [float(number) for number in text.split(",")]
        self.begin, self.end = numbers[:2]
        self.force, self.torque = np.array(numbers[2:5]), np.array(numbers[5:8])

    def at(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        on = float(self.begin <= time < self.end)
        return on * self.force, on * self.torque


class Plant:
    def __init__(self, arm: dict, joints: list[str], options: argparse.Namespace) -> None:
        self.model = load(options.urdf or arm["urdf"], joints)
        self.positions, self.rates = places(self.model, joints)
        own = arm.get("joint") or [{}] * len(joints)
        self.armature = np.array([joint.get("motor_inertia", 0.1) for joint in own])
        self.model.opt.timestep = STEP
        self.model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        self.model.dof_armature[self.rates] = self.armature
        coulomb, viscous = options.friction
        self.model.dof_frictionloss[self.rates] = coulomb * self.armature
        self.model.dof_damping[self.rates] = viscous * self.armature
        self.data = mujoco.MjData(self.model)
        start = options.start or arm.get("home") or [0.0] * len(joints)
        self.data.qpos[self.positions] = start
        self.tip = body(self.model, options.tip or arm["tip"])
        walls = [Wall.parse(text) for text in options.wall]
        self.walls = walls or [Wall(**surface) for surface in arm.get("surface", [])]
        self.pushes = [Push(text) for text in options.push]
        self.force, self.work = np.zeros(3), 0.0
        self.jacobian, self.turning = np.zeros((3, self.model.nv)), np.zeros((3, self.model.nv))
        self.left, self.time = 0.0, 0.0
        mujoco.mj_forward(self.model, self.data)
        # MuJoCo's world is the file's first link; the arm's base may be another one.
        base = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, arm.get("base") or "world")
        self.base = self.data.xmat[max(base, 0)].reshape(3, 3).copy()
        self.origin = self.data.xpos[max(base, 0)].copy()
        self.model.opt.gravity = self.base @ np.array(arm.get("gravity", [0.0, 0.0, -9.80665]))

    def place(self) -> np.ndarray:
        """Of the tip, in the base frame."""
        return self.base.T @ (self.data.xpos[self.tip] - self.origin)

    def step(self, elapsed: float, torque: np.ndarray) -> None:
        """Steps of MuJoCo are of one length; what is left over is made up for later."""
        data = self.data
        self.left += elapsed
        self.time += elapsed
        while self.left > 0.5 * STEP:
            self.left -= STEP
            mujoco.mj_step1(self.model, data)
            mujoco.mj_jacBody(self.model, data, self.jacobian, self.turning, self.tip)
            motion = self.base.T @ self.jacobian
            tip, velocity = self.place(), motion @ data.qvel
            self.force = sum((wall.force(tip, velocity) for wall in self.walls), np.zeros(3))
            data.qfrc_applied[:] = 0.0
            for push in self.pushes:
                force, turn = push.at(data.time)
                self.force = self.force + force
                data.qfrc_applied[:] += (self.base.T @ self.turning).T @ turn
            data.qfrc_applied[:] += motion.T @ self.force
            data.qfrc_applied[self.rates] += torque
            mujoco.mj_step2(self.model, data)
            # Positions go on with the new velocities.
            self.work += float(self.force @ (motion @ data.qvel)) * STEP

    def reading(self, torque: np.ndarray) -> list[float]:
        """A rigid gear: behind it is what the motor gives less what its own inertia and friction take."""
        data = self.data
        friction = data.qfrc_constraint[self.rates] + data.qfrc_passive[self.rates]
        behind = torque + friction - self.armature * data.qacc[self.rates]
        mujoco.mj_kinematics(self.model, data)
        return [
            *data.qpos[self.positions],
            *data.qvel[self.rates],
            *behind,
            *torque,
            *self.force,
            *self.place(),
            self.work,
        ]


def options_of(arguments: list[str] | None = None) -> argparse.Namespace:
    """The options; those of the command line where none are given."""
    parser = argparse.ArgumentParser(description="An arm in MuJoCo as a plant for ferntast.")
    parser.add_argument("--urdf", help="file of the arm; that of the greeting without it")
    parser.add_argument("--tip", help="link whose origin is the tip; that of the greeting without it")
    parser.add_argument("--start", type=float, nargs="*", help="joint positions; home without it")
    parser.add_argument(
        "--wall",
        action="append",
        default=[],
        help="x,y,z,nx,ny,nz,stiffness[,damping[,friction]]; in place of the surfaces of the greeting",
    )
    parser.add_argument(
        "--push",
        action="append",
        default=[],
        help="from,to,fx,fy,fz,mx,my,mz: for that time [s] a force [N] and a torque [Nm] on the tip",
    )
    parser.add_argument(
        "--friction",
        type=float,
        nargs=2,
        default=(0.0, 0.0),
        metavar=("COULOMB", "VISCOUS"),
        help="of each gear, by its motor's inertia: Nm and Nm s/rad for each kg m²",
    )
    parser.add_argument("--down", type=float, default=0.036, help="of mujoco_leader.py: how far the hand goes down [m]")
    parser.add_argument("--truth", help="file for what is true, a line a step: t_s, force_N and tip_m in x, y, z")
    return parser.parse_args(arguments)


def main(plant_of: type[Plant] = Plant) -> None:
    options = options_of()
    source, sink = sys.stdin.buffer, sys.stdout.buffer
    greeting = json.loads(source.readline())
    joints = greeting["joints"]
    plant = plant_of(greeting.get("arm") or {}, joints, options)
    answer = {
        "protocol": "ferntast-plant",
        "version": 1,
        "joints": joints,
        "period_s": greeting["period_s"],
        "measures": ["joint_torque", "motor_torque"],
        "truth": ["contact_force", "tip", "contact_work"],
    }
    sink.write(json.dumps(answer).encode() + b"\n")
    sink.flush()
    command = struct.Struct(f"<{1 + len(joints)}d")
    truth = open(options.truth, "w", encoding="utf-8") if options.truth else None
    while record := source.read(command.size):
        elapsed, *torque = command.unpack(record)
        torque = np.array(torque)
        plant.step(elapsed, torque)
        reading = plant.reading(torque)
        sink.write(struct.pack(f"<{len(reading)}d", *reading))
        sink.flush()
        if truth:
            print(plant.time, *plant.force, *plant.place(), sep=",", file=truth)


if __name__ == "__main__":
    main()
