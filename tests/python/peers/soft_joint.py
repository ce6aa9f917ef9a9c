"""A joint of an arm behind a soft gear: MuJoCo's rigid bodies, the joint's link integrated on a spring and a damper.

The motors are led along strokes, after whose starts and stops the links swing. What the gear transmits is what the soft
joint's motor feels, and the other joints feel the links as they really move.
"""

import math

import mujoco
import numpy

# Samples a second, and steps of the integration in each.
RATE = 500.0
STEPS = 4


def strokes(random, model, joints, samples):
    """Time, positions, velocities and accelerations of all joints: to and fro with pauses, each joint in its own time."""
    t = numpy.arange(samples) / RATE
    q, v, a = (numpy.zeros((samples, model.nv)) for _ in range(3))
    for joint in joints:
        low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-math.pi, math.pi)
        half = min(0.8, 0.3 * (high - low))
        at, place = int(random.uniform(0.1, 0.6) * RATE), 0.0
        while at < samples:
            way = random.uniform(-half, half) - place
            ramp = max(2, int(random.uniform(0.08, 0.25) * RATE))
            speed = min(random.uniform(0.2, 1.2), abs(way) * RATE / ramp)
            if speed < 0.05:
                continue
            cruise = max(0, round(abs(way) / speed * RATE) - ramp)
            rate = math.copysign(speed * RATE / ramp, way)
            a[at : at + ramp, joint] = rate
            a[at + ramp + cruise : at + 2 * ramp + cruise, joint] = -rate
            place += math.copysign(speed * (ramp + cruise) / RATE, way)
            at += 2 * ramp + cruise + int(random.uniform(0.05, 0.4) * RATE)
        v[1:, joint] = numpy.cumsum(a[:-1, joint]) / RATE
        q[1:, joint] = numpy.cumsum(v[:-1, joint] / RATE + 0.5 * a[:-1, joint] / RATE**2)
        q[:, joint] += 0.5 * (low + high)
    # In the middle between two steps of the acceleration, which at a step is neither that before nor that after.
    half = 0.5 / RATE
    return t, q + half * v + 0.5 * half**2 * a, v + half * a, a


class Gear:
    """A spring and a damper between a motor and the links that it turns."""

    def __init__(self, random, strength):
        # Softer where it is plainer to see.
        self.omega = 2 * math.pi * random.uniform(5.0, 16.0) / math.sqrt(strength)
        self.damping_ratio = random.uniform(0.02, 0.1)
        self.stiffness = self.damping = None
        self.inertias = []

    def truth(self):
        """As the lab has it, at the mean inertia over all sessions."""
        inertia = numpy.mean(self.inertias)
        omega = math.sqrt(self.stiffness / inertia)
        return {
            "frequency": omega / (2 * math.pi),
            "damping_ratio": self.damping / (2 * inertia * omega),
            "load_share": 1.0,
        }

    def torques(self, model, motion, joint):
        """What the links take of each joint where this is the gear of one; `model` has no armatures."""
        q, v, a = motion
        data, column = mujoco.MjData(model), numpy.zeros(model.nv)
        unit = numpy.eye(model.nv)[joint]
        step = 1.0 / RATE / STEPS

        def held(at, since, place=None, speed=None):
            """What all joints take along their motors, this one from its link's place and speed, and not accelerated."""
            data.qpos[:], data.qvel[:] = q[at] + v[at] * since + 0.5 * a[at] * since**2, v[at] + a[at] * since
            data.qacc[:] = a[at]
            motor = data.qpos[joint], data.qvel[joint]
            data.qpos[joint], data.qvel[joint] = motor if place is None else (place, speed)
            data.qacc[joint] = 0.0
            mujoco.mj_inverse(model, data)
            mujoco.mj_mulM(model, data, column, unit)
            return motor, data.qfrc_inverse

        def inertia(at):
            held(at, 0.0)
            return column[joint]

        self.inertias.append(numpy.mean([inertia(at) for at in range(0, len(q), 50)]))
        if self.stiffness is None:
            self.stiffness = self.inertias[0] * self.omega**2
            self.damping = 2 * self.damping_ratio * self.inertias[0] * self.omega
        speed = v[0, joint]
        place = q[0, joint] - held(0, 0.0)[1][joint] / self.stiffness
        found = numpy.zeros_like(q)
        for at in range(len(q)):
            for number in range(STEPS):
                (position, velocity), taken = held(at, number * step, place, speed)
                felt = self.stiffness * (position - place) + self.damping * (velocity - speed)
                # The damper by the mean speed of the step.
                acceleration = (felt - taken[joint]) / (column[joint] + 0.5 * step * self.damping)
                if number == 0:
                    found[at] = taken + column * acceleration
                speed += step * acceleration
                place += step * speed
        return found
