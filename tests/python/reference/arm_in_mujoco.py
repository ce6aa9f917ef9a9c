"""An arm's recording held against models in MuJoCo: by inverse dynamics, and by simulation.

Motions are smoothed by local polynomials (Savitzky, Golay 1964), nothing of which the lab has.
"""

import xml.etree.ElementTree as tree
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import rollout

WINDOW = 12  # samples to either side
ORDER = 4
SEGMENT = 0.2  # s of simulation from a measured state
SLOW = 0.02  # rad/s: slower samples do not count, friction is not defined there
STEP = 0.001  # s


@dataclass
class Motion:
    """One session: columns are joints."""

    time: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    torque: np.ndarray
    smooth_torque: np.ndarray


def read_table(path: str) -> tuple[list[str], np.ndarray]:
    """Columns t, q_JOINT, tau_JOINT."""
    with open(path, encoding="utf-8") as file:
        names = file.readline().strip().split(",")
    return names, np.loadtxt(path, delimiter=",", skiprows=1)


def joints_of(names: list[str]) -> list[str]:
    """Of the columns' names."""
    return [name.removeprefix("q_") for name in names if name.startswith("q_")]


def motions(table: np.ndarray) -> list[Motion]:
    """Sessions, smoothed, without their ends."""
    time = table[:, 0]
    count = (table.shape[1] - 1) // 2
    ends = [0, *(1 + np.flatnonzero(np.diff(time) > 1.0)), len(time)]
    all_of_them = []
    for begin, end in zip(ends[:-1], ends[1:], strict=True):
        own = table[begin:end]
        period = float(np.median(np.diff(own[:, 0])))
        states = [smoothed(own[:, 1 : 1 + count], period, order) for order in range(3)]
        within = slice(WINDOW, len(own) - WINDOW)
        torque = own[:, 1 + count :]
        all_of_them.append(Motion(own[within, 0], *states, torque[within], smoothed(torque, period, 0)))
    return all_of_them


def smoothed(columns: np.ndarray, period: float, order: int) -> np.ndarray:
    """The derivative of this order of each column."""
    places = np.arange(-WINDOW, WINDOW + 1) * period
    weights = np.linalg.pinv(np.vander(places, ORDER + 1, increasing=True))[order]
    weights = weights * (1, 1, 2)[order]
    return np.stack([np.convolve(own, weights[::-1], "valid") for own in columns.T], axis=1)


class Plant:
    """A model in MuJoCo, of which the named joints are moved and others stand still."""

    def __init__(self, model: mujoco.MjModel, joints: list[str]) -> None:
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
        model.opt.timestep = STEP
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        self.model = model
        self.places = np.array([model.joint(name).dofadr[0] for name in joints])
        held = np.setdiff1d(np.arange(model.nv), self.places)
        model.dof_armature[held] = 1e9
        # How soft friction is, depends on the inertias.
        mujoco.mj_setConst(model, mujoco.MjData(model))

    def torque_errors(self, motion: Motion) -> np.ndarray:
        """Measured less what the motion takes; not where a joint is slow."""
        data = mujoco.MjData(self.model)
        errors = np.full(motion.torque.shape, np.nan)
        for at in range(len(motion.time)):
            data.qpos[self.places], data.qvel[self.places] = motion.q[at], motion.v[at]
            data.qacc[:] = 0.0
            data.qacc[self.places] = motion.a[at]
            mujoco.mj_inverse(self.model, data)
            errors[at] = motion.smooth_torque[at] - data.qfrc_inverse[self.places]
        errors[np.abs(motion.v) < SLOW] = np.nan
        return errors

    def position_errors(self, motion: Motion) -> np.ndarray:
        """Measured less simulated, each segment begun at a measured state and driven by the measured torques."""
        period = float(np.median(np.diff(motion.time)))
        length, inner = round(SEGMENT / period), round(period / STEP)
        begins = np.arange(0, len(motion.time) - length, length)
        data = mujoco.MjData(self.model)
        size = mujoco.mj_stateSize(self.model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        states = np.zeros((len(begins), size))
        forces = np.zeros((len(begins), length * inner, self.model.nv))
        for number, begin in enumerate(begins):
            mujoco.mj_resetData(self.model, data)
            data.qpos[self.places], data.qvel[self.places] = motion.q[begin], motion.v[begin]
            mujoco.mj_getState(self.model, data, states[number], mujoco.mjtState.mjSTATE_FULLPHYSICS)
            # Torque between samples on a straight line.
            at = begin + (np.arange(length * inner) + 0.5) / inner
            for joint, place in enumerate(self.places):
                forces[number, :, place] = np.interp(at, np.arange(len(motion.time)), motion.torque[:, joint])
        kind = mujoco.mjtState.mjSTATE_QFRC_APPLIED
        found, _ = rollout.rollout(self.model, data, states, forces, control_spec=kind)
        simulated = found[:, inner - 1 :: inner, 1 + self.places]
        measured = np.stack([motion.q[begin + 1 : begin + 1 + length] for begin in begins])
        return (measured - simulated).reshape(-1, len(self.places))


def errors(model: mujoco.MjModel, joints: list[str], all_motions: list[Motion]) -> dict:
    """RMS of both errors by joint, and together [Nm], [mrad]."""
    plant = Plant(model, joints)
    torque = np.vstack([plant.torque_errors(own) for own in all_motions])
    position = 1e3 * np.vstack([plant.position_errors(own) for own in all_motions])
    return {
        "torque_Nm": dict(zip(joints, np.sqrt(np.nanmean(torque**2, axis=0)).tolist(), strict=True)),
        "position_mrad": dict(zip(joints, np.sqrt(np.mean(position**2, axis=0)).tolist(), strict=True)),
        "all_torque_Nm": float(np.sqrt(np.nanmean(torque**2))),
        "all_position_mrad": float(np.sqrt(np.mean(position**2))),
    }


def pseudo_inertia_eigenvalues(path: str) -> dict:
    """The least eigenvalue of each body's pseudo-inertia, as the file at `path` writes its masses."""
    least = {}
    for body in tree.parse(path).getroot().iter("body"):
        own = body.find("inertial")
        if own is None or "fullinertia" not in own.attrib:
            continue
        mass, center = float(own.attrib["mass"]), np.array(own.attrib["pos"].split(), float)
        xx, yy, zz, xy, xz, yz = (float(value) for value in own.attrib["fullinertia"].split())
        about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        second = 0.5 * np.trace(about) * np.eye(3) - about + mass * np.outer(center, center)
        matrix = np.block([[second, mass * center[:, None]], [mass * center[None], np.array([[mass]])]])
        least[body.attrib["name"]] = float(np.linalg.eigvalsh(matrix)[0])
    return least


def apart(one: mujoco.MjModel, other: mujoco.MjModel, joints: list[str]) -> float:
    """The largest difference of mass matrices and of bias torques of the joints, as a share."""
    random = np.random.default_rng(1)
    plants = [Plant(own, joints) for own in (one, other)]
    worst = 0.0
    for _ in range(20):
        q, v = random.uniform(-1, 1, (2, len(joints)))
        found = []
        for plant in plants:
            data = mujoco.MjData(plant.model)
            data.qpos[plant.places], data.qvel[plant.places] = q, v
            mujoco.mj_forward(plant.model, data)
            matrix = np.zeros((plant.model.nv, plant.model.nv))
            mujoco.mj_fullM(plant.model, data, matrix)
            matrix = matrix[np.ix_(plant.places, plant.places)]
            found.append((matrix, data.qfrc_bias[plant.places]))
        for a, b in zip(*found, strict=True):
            worst = max(worst, float(np.abs(a - b).max() / np.abs(a).max()))
    return worst
