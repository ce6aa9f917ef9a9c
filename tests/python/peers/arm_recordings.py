"""Recordings of a whole arm with one hidden effect: rigid bodies by MuJoCo's inverse dynamics, friction and the
hidden effect written here; nothing is shared with the lab. Same seed, same files.

usage: arm_recordings.py URDF FOLDER EFFECT SEED STRENGTH

Writes FOLDER/ARM-EFFECT-SEED-STRENGTH.csv (t, q_JOINT, tau_JOINT), its experiment file (.toml) and what is hidden (.json),
with the true values of parameters as `ferntast lab add` names them. Many at once: blind_arms.py.
"""

import json
import math
import os
import re
import shutil
import sys

import mujoco
import numpy

sys.path.insert(0, os.path.dirname(__file__))
import soft_joint  # noqa: E402

RATE = 200.0
SECONDS = 30.0
# Of a joint that warms up, which takes longer.
WARM_UP_SECONDS = 120.0
SESSIONS = 3
# What a name is accepted for; nothing where no name is right.
ACCEPTED = {
    "none": [],
    "stribeck": ["stribeck"],
    "load_coulomb": ["load_coulomb"],
    "quadratic_viscous": ["quadratic_viscous", "cubic_viscous", "nonlinear_viscous"],
    "asymmetric_coulomb": ["asymmetric_coulomb"],
    "inertia": ["inertia"],
    "payload": ["payload"],
    "base_tilt": ["base_tilt"],
    "joint_coupling": ["joint_coupling"],
    "ripple": ["ripple"],
    "unknown_product": [],
    "load_elasticity": ["load_elasticity"],
    "warm_up_viscous": ["warm_up_coulomb", "warm_up_viscous"],
    "joint_zero": ["joint_zero"],
    "joint_zeros": ["joint_zeros"],
}
OF_THE_ARM = ("payload", "base_tilt", "joint_zeros")
# These came after seeds had been published: they count behind the others, and are drawn where they are asked for.
LATER = ("load_elasticity", "warm_up_viscous", "joint_zero", "joint_zeros")


def readable(urdf):
    """The URDF's text for MuJoCo, without what can be seen or touched."""
    text = open(urdf, encoding="utf-8").read()
    text = re.sub(r"<(visual|collision)\b.*?</\1>", "", text, flags=re.S)
    text = re.sub(r"<(visual|collision)\b[^>]*/>", "", text)
    return re.sub(
        r"(<robot\b[^>]*>)",
        r'\1<mujoco><compiler discardvisual="true" fusestatic="false" balanceinertia="false"/></mujoco>',
        text,
        count=1,
    )


def model_of(urdf):
    """The model, free of contacts and ends."""
    model = mujoco.MjModel.from_xml_string(readable(urdf))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    return model


def hinges(model):
    """The arm's own joints: what slides behind them (fingers) stays where it is."""
    return [joint for joint in range(model.nv) if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE]


def trajectory(random, model, samples):
    """Positions, velocities and accelerations of all joints: five harmonics each, within limits."""
    t = numpy.arange(samples) / RATE
    q, v, a = (numpy.zeros((samples, model.nv)) for _ in range(3))
    for joint in hinges(model):
        low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-math.pi, math.pi)
        half = min(1.1, 0.4 * (high - low))
        middle = min(max(0.5 * (low + high) + 0.2 * half * random.uniform(-1, 1), low + half), high - half)
        parts = []
        for harmonic in range(1, 6):
            rate = 2 * math.pi * 0.1 * harmonic * random.uniform(0.8, 1.2)
            parts.append((random.uniform(0.3, 1.0) / harmonic, rate, random.uniform(0, 2 * math.pi)))
        scale = half / sum(size for size, _, _ in parts)
        q[:, joint] = middle
        for size, rate, phase in parts:
            size *= scale
            q[:, joint] += size * numpy.sin(rate * t + phase)
            v[:, joint] += size * rate * numpy.cos(rate * t + phase)
            a[:, joint] -= size * rate * rate * numpy.sin(rate * t + phase)
    return t, q, v, a


def bodies(model, q, v, a):
    """Torques that the motion takes, armatures included."""
    data = mujoco.MjData(model)
    torque = numpy.zeros_like(q)
    for at in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[at], v[at], a[at]
        mujoco.mj_inverse(model, data)
        torque[at] = data.qfrc_inverse
    return torque


def tilt(random, model, strength):
    """Turns gravity by one to three degrees; the turns of the base about x and y."""
    angle = math.radians(random.uniform(1.5, 3.0)) * strength
    axis = random.uniform(0, 2 * math.pi)
    across = math.sin(angle)
    model.opt.gravity[:] = [
        9.81 * across * math.cos(axis),
        9.81 * across * math.sin(axis),
        -9.81 * math.cos(angle),
    ]
    return {"base_tilt.tilt_1": -angle * math.sin(axis), "base_tilt.tilt_2": angle * math.cos(axis)}


def load(random, model, strength):
    """A ball on the last link that moves: its own inertia is that of 4 cm. Its mass and place."""
    mass = random.uniform(0.6, 1.5) * strength
    place = numpy.array([random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), random.uniform(0.05, 0.18)])
    body = int(model.jnt_bodyid[hinges(model)[-1]])
    turn = numpy.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    turn = turn.reshape(3, 3)
    about = turn @ numpy.diag(model.body_inertia[body]) @ turn.T
    before, center = model.body_mass[body], model.body_ipos[body].copy()
    total = before + mass
    middle = (before * center + mass * place) / total

    def moved(by, weight):
        return weight * (by @ by * numpy.eye(3) - numpy.outer(by, by))

    about = about + moved(center - middle, before) + moved(place - middle, mass)
    about += 0.4 * mass * 0.04**2 * numpy.eye(3)
    values, vectors = numpy.linalg.eigh(about)
    if numpy.linalg.det(vectors) < 0:
        vectors[:, 0] *= -1
    quaternion = numpy.zeros(4)
    mujoco.mju_mat2Quat(quaternion, vectors.flatten())
    model.body_mass[body] = total
    model.body_ipos[body] = middle
    model.body_iquat[body] = quaternion
    model.body_inertia[body] = values
    return {"payload.mass": mass} | {f"payload.{axis}": float(own) for axis, own in zip("xyz", place, strict=True)}


def warmth(power, time_constant):
    """How warm a joint is that friction heats with `power`, from cold; 1 at its mean power after a long time."""
    share, mean = 1.0 / RATE / time_constant, numpy.mean(power)
    warm = numpy.zeros(len(power))
    for at in range(1, len(power)):
        warm[at] = warm[at - 1] + share * (power[at - 1] / mean - warm[at - 1])
    return warm


def record(urdf, folder, effect, seed, strength):
    """One recording: the path of its files, without their endings."""
    numbers = [*sorted(set(ACCEPTED) - set(LATER)), *LATER]
    random = numpy.random.default_rng([seed, numbers.index(effect), round(100 * strength)])
    believed, model = model_of(urdf), model_of(urdf)
    for own in (believed, model):
        # Friction is drawn below; some files have their own, which MuJoCo takes over.
        own.dof_damping[:] = 0.0
        own.dof_frictionloss[:] = 0.0
    count = len(hinges(model))
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, joint) for joint in range(count)]
    strong = [joint < count - 3 for joint in range(count)]
    armature = numpy.array([random.uniform(0.45, 1.2) if own else random.uniform(0.15, 0.35) for own in strong])
    coulomb = numpy.array([random.uniform(1.5, 3.5) if own else random.uniform(0.35, 0.75) for own in strong])
    viscous = coulomb * random.uniform(0.7, 1.4, count)
    model.dof_armature[:count] = armature
    # The load that friction grows with is what the links take.
    believed.dof_armature[:] = 0.0
    truth = {}
    if effect == "payload":
        truth = load(random, model, strength)
    if effect == "base_tilt":
        truth = tilt(random, model, strength)
    heavy = range(1, count - 2) if effect in ("load_coulomb", "joint_zero") else range(count)
    joint = None if effect in OF_THE_ARM or effect == "none" else int(random.choice(heavy))
    other = None
    if joint is not None:
        other = int(random.choice([k for k in range(count) if k != joint]))
        own = strength * coulomb[joint]
    shape = random.uniform(0, 1, 4)
    for own_joint, name in enumerate(names):
        truth |= {f"b0@{name}": coulomb[own_joint], f"b1@{name}": viscous[own_joint]}
    rows = []
    gear = soft_joint.Gear(random, strength) if effect == "load_elasticity" else None
    zeros = numpy.zeros(count)
    if effect == "joint_zero":
        zeros[joint] = strength * math.radians(0.5 + 2.5 * shape[0]) * (1.0 if shape[1] < 0.5 else -1.0)
        truth[f"joint_zero@{names[joint]}.zero"] = zeros[joint]
    if effect == "joint_zeros":
        zeros[:] = strength * numpy.radians(random.uniform(-5.0, 5.0, count))
        # The first joint turns all about the vertical, which no torque tells.
        truth |= {f"joint_zeros.{name}": zero for name, zero in list(zip(names, zeros, strict=True))[1:]}
    for session in range(SESSIONS):
        if gear:
            t, *all_joints = soft_joint.strokes(random, model, hinges(model), int(SECONDS * soft_joint.RATE))
            torque = gear.torques(believed, all_joints, joint)[:, :count]
            torque += armature * all_joints[2][:, :count]
        else:
            seconds = WARM_UP_SECONDS if effect == "warm_up_viscous" else SECONDS
            t, *all_joints = trajectory(random, model, int(seconds * RATE))
            torque = bodies(model, *all_joints)[:, :count]
        q, v, a = all_joints
        q, v, a = q[:, :count], v[:, :count], a[:, :count]
        torque += coulomb * numpy.sign(v) + viscous * v
        if effect == "stribeck":
            speed = 0.04 + 0.06 * shape[0]
            truth |= {f"bs@{names[joint]}": 0.5 * own, f"vs@{names[joint]}": speed}
            torque[:, joint] += 0.5 * own * numpy.exp(-((v[:, joint] / speed) ** 2)) * numpy.sign(v[:, joint])
        elif effect == "load_coulomb":
            links = bodies(believed, *all_joints)[:, joint]
            share = strength * (0.06 + 0.06 * shape[0])
            truth[f"b0T@{names[joint]}"] = share
            torque[:, joint] += share * abs(links) * numpy.sign(v[:, joint])
        elif effect == "quadratic_viscous":
            truth[f"b2@{names[joint]}"] = 0.5 * own
            torque[:, joint] += 0.5 * own * v[:, joint] * abs(v[:, joint])
        elif effect == "asymmetric_coulomb":
            truth[f"ba@{names[joint]}"] = 0.3 * own
            torque[:, joint] += 0.3 * own
        elif effect == "inertia":
            truth[f"dJ@{names[joint]}"] = 0.3 * strength * armature[joint]
            torque[:, joint] += 0.3 * strength * armature[joint] * a[:, joint]
        elif effect == "joint_coupling":
            by_speed, by_sign = (0.25 * own, 0.0) if shape[0] < 0.5 else (0.0, 0.15 * own)
            truth |= {
                f"cv_of_{names[other]}@{names[joint]}": by_speed,
                f"cc_of_{names[other]}@{names[joint]}": by_sign,
            }
            if shape[0] < 0.5:
                torque[:, joint] += 0.25 * own * v[:, other]
            else:
                torque[:, joint] += 0.15 * own * numpy.sign(v[:, other])
        elif effect == "ripple":
            waves = 6 + 34 * shape[0]
            phase = 2 * math.pi * shape[1]
            truth |= {
                f"a_s@{names[joint]}": 0.2 * own * math.cos(phase),
                f"a_c@{names[joint]}": 0.2 * own * math.sin(phase),
                f"k@{names[joint]}": waves,
            }
            torque[:, joint] += 0.2 * own * numpy.sin(waves * q[:, joint] + phase)
        elif effect == "unknown_product":
            third = int(numpy.floor(shape[0] * count)) % count
            torque[:, joint] += 0.6 * own * q[:, other] * (q[:, third] if shape[1] < 0.5 else v[:, joint])
        elif effect == "warm_up_viscous":
            # Grease gets thinner by e^-1 of what it can for each warmth of 1; in half of the joints seals give way, too.
            friction = coulomb[joint] * abs(v[:, joint]) + viscous[joint] * v[:, joint] ** 2
            thinner = strength * (1.0 - numpy.exp(-warmth(friction, 20.0 + 60.0 * shape[0])))
            seals = 0.15 * coulomb[joint] if shape[1] < 0.5 else 0.0
            change = 0.6 * viscous[joint] * v[:, joint] + seals * numpy.sign(v[:, joint])
            torque[:, joint] -= thinner * change
        noise = 0.012 * numpy.sqrt(numpy.mean((torque - torque.mean(axis=0)) ** 2, axis=0) + 0.1 * coulomb**2)
        torque += noise * random.standard_normal(torque.shape)
        # A joint is where it says and its zero.
        q = numpy.round((q - zeros) / 1e-5) * 1e-5
        rows.append(numpy.column_stack([t + 600.0 * session, q, torque]))
    if gear:
        truth |= {f"{name}@{names[joint]}": value for name, value in gear.truth().items()}
    arm = os.path.basename(urdf).split("_")[0].removesuffix(".urdf")
    name = f"{arm}-{effect}-{seed}-{round(100 * strength)}"
    path = os.path.join(folder, name)
    columns = ["t"] + [f"q_{own}" for own in names] + [f"tau_{own}" for own in names]
    numpy.savetxt(path + ".csv", numpy.vstack(rows), "%.8g", delimiter=",", header=",".join(columns), comments="")
    here = os.path.join(folder, os.path.basename(urdf))
    if not os.path.exists(here):
        shutil.copyfile(urdf, here)
    with open(path + ".toml", "w", encoding="utf-8") as file:
        file.write(
            f'recording = "{name}.csv"\n\n[arm]\nurdf = "{os.path.basename(urdf)}"\n'
            f"joints = {json.dumps(names)}\n"
            f"armature = {json.dumps([round(float(own), 6) for own in armature])}\n\n"
            '[signals]\nposition = "q_{joint}"\nmotor_torque = "tau_{joint}"\ntime = "t"\n\n'
            '[model]\neffects = ["coulomb", "viscous"]\n'
        )
    hidden = {
        "effect": effect,
        "joint": None if joint is None else names[joint],
        "partner": names[other] if effect == "joint_coupling" else None,
        "accepted": ACCEPTED[effect],
        "strength": strength,
        "truth": {name: float(value) for name, value in truth.items()},
    }
    with open(path + ".json", "w", encoding="utf-8") as file:
        json.dump(hidden, file)
    return path


if __name__ == "__main__":
    asked_urdf, asked_folder, asked_effect, asked_seed, asked_strength = sys.argv[1:]
    record(asked_urdf, asked_folder, asked_effect, int(asked_seed), float(asked_strength))
