"""The two-link arm as MuJoCo has it, for comparison with ours.

Reads JSON from stdin:

- `gravity` [m/s²], `links`: two of {length [m], mass [kg], center_of_mass [m], inertia [kg m²]};
- `states`: list of {q [rad], qd [rad/s], qdd [rad/s²], force [N] on the tip};
- `motors`: two of {inertia [kg m²], stiffness [Nm/rad], damping [Nm s/rad]}; `start` [rad]: link
  positions at rest; `torques`: motor torques [Nm], each held for `hold` [s].

Prints JSON: `states`, for each one {torque [Nm] that inverse dynamics asks for, tip [m], energy [J],
inertia [kg m²]}; `motion`, after each hold {link [rad], motor [rad], torque [Nm] between them}.
"""

import json
import sys

import mujoco
import numpy as np

STEP = 2e-5


def link_body(link: dict, joint: str, inner: str) -> str:
    """A link along its own x, turning about z; MuJoCo wants three moments of inertia."""
    inertia = link["inertia"]
    return (
        f'<joint name="{joint}" type="hinge" axis="0 0 1"/>'
        f'<inertial pos="{link["center_of_mass"]} 0 0" mass="{link["mass"]}"'
        f' diaginertia="{inertia} {inertia} {inertia}"/>{inner}'
    )


def model(arm: dict, flexible: bool) -> mujoco.MjModel:
    one, two = arm["links"]
    tip = f'<site name="tip" pos="{two["length"]} 0 0"/>'
    forearm = f'<body pos="{one["length"]} 0 0">{link_body(two, "q2", tip)}</body>'
    rotors = tendons = ""
    if flexible:
        for number, motor in enumerate(arm["motors"], start=1):
            # On an axis of its own: only its own turning counts, and it has no weight.
            half = motor["inertia"] / 2
            rotors += (
                f'<body><joint name="m{number}" type="hinge" axis="0 0 1"/>'
                f'<inertial pos="0 0 0" mass="1" diaginertia="{half} {half} {motor["inertia"]}"/></body>'
            )
            tendons += (
                f'<fixed name="t{number}" stiffness="{motor["stiffness"]}"'
                f' damping="{motor["damping"]}" springlength="0">'
                f'<joint joint="m{number}" coef="1"/><joint joint="q{number}" coef="-1"/></fixed>'
            )
    x, y = arm["gravity"]
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option gravity="{x} {y} 0" timestep="{STEP}"'
        f' integrator="RK4"><flag contact="disable" energy="enable"/></option>'
        f"<worldbody><body>{link_body(one, 'q1', forearm)}</body>{rotors}</worldbody>"
        f"<tendon>{tendons}</tendon></mujoco>"
    )


def state(arm: mujoco.MjModel, data: mujoco.MjData, given: dict) -> dict:
    data.qpos[:], data.qvel[:], data.qacc[:] = given["q"], given["qd"], given["qdd"]
    site = mujoco.mj_name2id(arm, mujoco.mjtObj.mjOBJ_SITE, "tip")
    mujoco.mj_inverse(arm, data)
    mujoco.mj_energyPos(arm, data)
    mujoco.mj_energyVel(arm, data)
    jacobian = np.zeros((3, 2))
    mujoco.mj_jacSite(arm, data, jacobian, None, site)
    inertia = np.zeros((2, 2))
    mujoco.mj_fullM(arm, data, inertia)
    force = np.array([*given["force"], 0.0])
    return {
        "torque": (data.qfrc_inverse - jacobian.T @ force).tolist(),
        "tip": data.site_xpos[site][:2].tolist(),
        "energy": float(sum(data.energy)),
        "inertia": inertia.tolist(),
    }


def motion(given: dict) -> list[dict]:
    arm = model(given, flexible=True)
    data = mujoco.MjData(arm)
    links, motors = [0, 1], [2, 3]
    stiffness = np.array([motor["stiffness"] for motor in given["motors"]])
    damping = np.array([motor["damping"] for motor in given["motors"]])
    data.qpos[links] = given["start"]
    data.qpos[motors] = given["start"]
    mujoco.mj_forward(arm, data)
    # At rest the gears bear the weight.
    data.qpos[motors] += data.qfrc_bias[links] / stiffness
    steps = round(given["hold"] / STEP)
    told = []
    for torque in given["torques"]:
        data.qfrc_applied[motors] = torque
        for _ in range(steps):
            mujoco.mj_step(arm, data)
        wound = data.qpos[motors] - data.qpos[links]
        turning = data.qvel[motors] - data.qvel[links]
        told.append(
            {
                "link": data.qpos[links].tolist(),
                "motor": data.qpos[motors].tolist(),
                "torque": (stiffness * wound + damping * turning).tolist(),
            }
        )
    return told


def main() -> None:
    given = json.load(sys.stdin)
    arm = model(given, flexible=False)
    data = mujoco.MjData(arm)
    states = [state(arm, data, each) for each in given["states"]]
    json.dump({"states": states, "motion": motion(given)}, sys.stdout)


if __name__ == "__main__":
    main()
