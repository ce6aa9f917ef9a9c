"""Arms out of URDF files in MuJoCo: loading, walls, free motion for comparison with ours.

As a program it reads JSON from stdin: `arms`, list of {file, joints: names from the base on,
tip: name of a link, gravity [m/s²], armature [kg m²] joint by joint, start [rad] or [m], torques:
list of joint torques, each held for `hold` [s]}. All other joints are held at zero, no joint has
friction, damping or ends. It prints JSON: `arms`, for each one `motion`, after each hold
{q, qd, tip [m], energy [J]}.
"""

import json
import os
import sys
import tempfile
import xml.etree.ElementTree

import mujoco
import numpy as np

STEP = 1e-4


def load(urdf: str, joints: list[str]) -> mujoco.MjModel:
    """The arm of that text, or file, without shapes; of its joints `joints` only, the others
    at zero."""
    if not urdf.lstrip().startswith("<"):
        with open(urdf, encoding="utf-8") as file:
            urdf = file.read()
    robot = xml.etree.ElementTree.fromstring(urdf.lstrip())
    for link in robot.iter("link"):
        for shape in link.findall("visual") + link.findall("collision"):
            link.remove(shape)
    for old in robot.findall("mujoco"):
        robot.remove(old)
    options = xml.etree.ElementTree.SubElement(robot, "mujoco")
    # Every link stays a body of its own, so that the tip can be asked for.
    xml.etree.ElementTree.SubElement(options, "compiler", fusestatic="false")
    spec = mujoco.MjSpec.from_string(xml.etree.ElementTree.tostring(robot, "unicode"))
    for equality in list(spec.equalities):
        spec.delete(equality)
    for joint in list(spec.joints):
        if joint.name not in joints:
            spec.delete(joint)
    model = spec.compile()
    # What a URDF says of friction and damping is not part of the comparison, nor are ends.
    model.dof_damping[:] = 0.0
    model.dof_frictionloss[:] = 0.0
    model.jnt_limited[:] = 0
    return model


def places(model: mujoco.MjModel, joints: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Where positions and velocities of the joints stand."""
    ids = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in joints]
    assert min(ids) >= 0, joints
    return model.jnt_qposadr[ids], model.jnt_dofadr[ids]


def body(model: mujoco.MjModel, name: str) -> int:
    found = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    assert found >= 0, name
    return found


def motion(arm: dict) -> list[dict]:
    model = load(arm["file"], arm["joints"])
    model.opt.timestep = STEP
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.gravity = arm["gravity"]
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    positions, rates = places(model, arm["joints"])
    model.dof_armature[rates] = arm["armature"]
    tip = body(model, arm["tip"])
    data.qpos[positions] = arm["start"]
    steps = round(arm["hold"] / STEP)
    told = []
    for torque in arm["torques"]:
        data.qfrc_applied[rates] = torque
        for _ in range(steps):
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        told.append(
            {
                "q": data.qpos[positions].tolist(),
                "qd": data.qvel[rates].tolist(),
                "tip": data.xpos[tip].tolist(),
                "energy": float(sum(data.energy)),
            }
        )
    return told


def main() -> None:
    given = json.load(sys.stdin)
    arms = [{"motion": motion(arm)} for arm in given["arms"]]
    json.dump({"arms": arms}, sys.stdout)


if __name__ == "__main__":
    # MuJoCo writes what it refuses to a file where it runs.
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main()
        os.chdir("/")
