"""Arms out of URDF files as Pinocchio and MuJoCo have them, for comparison with ours.

Reads JSON from stdin. Without `arms` it prints `files`: the URDF files of `example-robot-data`.
Otherwise `arms`: list of {file, joints: names from the base on, tip: name of a link,
gravity [m/s²], states: list of {q, qd, qdd} in [rad] or [m]}. All other joints are held at zero.

Prints JSON: `arms`, for each one {pinocchio, mujoco}, each with `states`, for each one {torque,
mass_matrix, jacobian (6 rows: velocity, angular velocity, in axes of the base), rotation,
translation of the tip, regressor (Pinocchio only)}, or {refused: why}. With `repeat` and one arm
also `nanoseconds`: what one `inverse` and one `forward` dynamics take in Pinocchio's own loop, and
one `step` in MuJoCo's.
"""

import importlib.metadata
import json
import os
import sys
import tempfile
import time
import xml.etree.ElementTree

import mujoco
import mujoco.rollout
import numpy as np
import pinocchio

LINK_PARAMETERS = 10


def files() -> list[str]:
    listed = importlib.metadata.files("example-robot-data") or []
    return sorted(str(file.locate()) for file in listed if file.suffix == ".urdf")


def pinocchio_model(arm: dict) -> pinocchio.Model:
    whole = pinocchio.buildModelFromUrdf(arm["file"])
    held = [whole.getJointId(name) for name in whole.names[1:] if name not in arm["joints"]]
    # It refuses files that call a link as they call a joint, even where nothing is held.
    neutral = pinocchio.neutral(whole)
    model = pinocchio.buildReducedModel(whole, held, neutral) if held else whole
    assert list(model.names[1:]) == arm["joints"], list(model.names)
    model.gravity.linear = np.array(arm["gravity"])
    return model


def configuration(model: pinocchio.Model, positions: list[float]) -> np.ndarray:
    """Joints that turn without end are cosine and sine there."""
    q = np.zeros(model.nq)
    for joint, value in zip(model.joints[1:], positions, strict=True):
        own = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        q[joint.idx_q : joint.idx_q + joint.nq] = own
    return q


def with_pinocchio(arm: dict) -> dict:
    try:
        model = pinocchio_model(arm)
    except ValueError as error:
        return {"refused": str(error)}
    data = model.createData()
    tip = model.getFrameId(arm["tip"], pinocchio.FrameType.BODY)
    assert tip < model.nframes, arm["tip"]
    states = []
    for given in arm["states"]:
        q = configuration(model, given["q"])
        qd, qdd = np.array(given["qd"]), np.array(given["qdd"])
        torque = pinocchio.rnea(model, data, q, qd, qdd)
        mass = pinocchio.crba(model, data, q)
        regressor = pinocchio.computeJointTorqueRegressor(model, data, q, qd, qdd)
        frame = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        jacobian = pinocchio.computeFrameJacobian(model, data, q, tip, frame)
        pinocchio.framesForwardKinematics(model, data, q)
        place = data.oMf[tip]
        states.append(
            {
                "torque": torque.tolist(),
                "mass_matrix": (np.triu(mass) + np.triu(mass, 1).T).tolist(),
                "jacobian": jacobian.tolist(),
                "rotation": place.rotation.tolist(),
                "translation": place.translation.tolist(),
                "regressor": regressor.tolist(),
            }
        )
    return {"states": states}


def mujoco_model(arm: dict) -> mujoco.MjModel:
    robot = xml.etree.ElementTree.parse(arm["file"]).getroot()
    for link in robot.iter("link"):
        for shape in link.findall("visual") + link.findall("collision"):
            link.remove(shape)
    options = xml.etree.ElementTree.SubElement(robot, "mujoco")
    # Every link stays a body of its own, so that the tip can be asked for.
    xml.etree.ElementTree.SubElement(options, "compiler", fusestatic="false")
    spec = mujoco.MjSpec.from_string(xml.etree.ElementTree.tostring(robot, "unicode"))
    for equality in list(spec.equalities):
        spec.delete(equality)
    for joint in list(spec.joints):
        if joint.name not in arm["joints"]:
            spec.delete(joint)
    model = spec.compile()
    flags = mujoco.mjtDisableBit
    model.opt.disableflags = flags.mjDSBL_CONSTRAINT | flags.mjDSBL_SPRING | flags.mjDSBL_DAMPER
    model.opt.gravity = arm["gravity"]
    return model


def with_mujoco(arm: dict) -> dict:
    try:
        model = mujoco_model(arm)
    except ValueError as error:
        return {"refused": str(error)}
    data = mujoco.MjData(model)
    tip = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, arm["tip"])
    ids = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in arm["joints"]]
    places, rates = model.jnt_qposadr[ids], model.jnt_dofadr[ids]
    states = []
    for given in arm["states"]:
        data.qpos[places], data.qvel[rates] = given["q"], given["qd"]
        data.qacc[rates] = given["qdd"]
        mujoco.mj_inverse(model, data)
        velocity, turning = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jacBody(model, data, velocity, turning, tip)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        states.append(
            {
                "torque": data.qfrc_inverse[rates].tolist(),
                "mass_matrix": mass[np.ix_(rates, rates)].tolist(),
                "jacobian": np.vstack([velocity, turning])[:, rates].tolist(),
                "rotation": data.xmat[tip].reshape(3, 3).tolist(),
                "translation": data.xpos[tip].tolist(),
            }
        )
    return {"states": states}


def nanoseconds(arm: dict, repeat: int) -> dict:
    """One thread goes through a batch of states within each library, without Python; the best of five."""
    model = pinocchio_model(arm)
    pool = pinocchio.ModelPool(model, 1)
    chosen = [arm["states"][index % len(arm["states"])] for index in range(repeat)]
    q = np.column_stack([configuration(model, state["q"]) for state in chosen])
    qd, qdd = (np.array([state[key] for state in chosen]).T.copy() for key in ("qd", "qdd"))
    result = np.zeros_like(qd)
    steps, data, start = mujoco_steps(arm)
    work = {
        "inverse": lambda: pinocchio.rneaInParallel(1, pool, q, qd, qdd, result),
        # Torques in place of accelerations: what is computed is the same for any.
        "forward": lambda: pinocchio.abaInParallel(1, pool, q, qd, qdd, result),
        "step": lambda: mujoco.rollout.rollout(steps, data, start, nstep=repeat),
    }
    best = dict.fromkeys(work, np.inf)
    for _ in range(5):
        for name, run in work.items():
            begin = time.perf_counter()
            run()
            best[name] = min(best[name], time.perf_counter() - begin)
    return {name: seconds / repeat * 1e9 for name, seconds in best.items()}


def mujoco_steps(arm: dict) -> tuple:
    """A model that falls without friction or contact, its data, and the state that it begins in."""
    model = mujoco_model(arm)
    model.opt.timestep = 1e-4
    data = mujoco.MjData(model)
    state = np.zeros((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    mujoco.mj_getState(model, data, state[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
    return model, data, state


def main() -> None:
    given = json.load(sys.stdin)
    arms = given.get("arms")
    if arms is None:
        answer = {"files": files()}
    elif "repeat" in given:
        answer = {"nanoseconds": nanoseconds(arms[0], given["repeat"])}
    else:
        told = [{"pinocchio": with_pinocchio(arm), "mujoco": with_mujoco(arm)} for arm in arms]
        answer = {"arms": told}
    json.dump(answer, sys.stdout)


if __name__ == "__main__":
    # MuJoCo writes what it refuses to a file where it runs.
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main()
        os.chdir("/")
