"""What the lab identified of an arm, in MuJoCo, against its recording.

Reads JSON from stdin: `recording` (a table of t, q_JOINT, tau_JOINT), `urdf` (as it is believed,
read by MuJoCo itself), `armature` by joint, `exported` (files that `ferntast lab export` wrote: MuJoCo's XML, or URDFs).
Prints JSON: `before`, the errors of the URDF with the armatures alone, and `exported`, for each file its errors,
`least_eigenvalues` of its bodies' pseudo-inertias, and how far its rigid bodies are `apart` from the URDF's.
"""

import json
import sys
from pathlib import Path

import mujoco
from reference import arm_in_mujoco as arm

sys.path.insert(0, str(Path(__file__).parent / "peers"))
from arm_recordings import model_of  # noqa: E402


def believed(urdf: str, joints: list[str], armature: list[float]) -> mujoco.MjModel:
    """The URDF as MuJoCo reads it."""
    model = model_of(urdf)
    for name, own in zip(joints, armature, strict=True):
        model.dof_armature[model.joint(name).dofadr[0]] = own
    return model


def main() -> None:
    """Reads, holds against, prints."""
    given = json.load(sys.stdin)
    names, table = arm.read_table(given["recording"])
    joints, motions = arm.joints_of(names), arm.motions(table)
    before = believed(given["urdf"], joints, given["armature"])
    told = {"before": arm.errors(before, joints, motions), "exported": []}
    for path in given["exported"]:
        if path.endswith(".urdf"):
            # It has no place for armatures.
            model = believed(path, joints, given["armature"])
            own = {}
        else:
            model = mujoco.MjModel.from_xml_path(path)
            own = {"least_eigenvalues": arm.pseudo_inertia_eigenvalues(path), "apart": arm.apart(before, model, joints)}
        own |= arm.errors(model, joints, motions)
        told["exported"].append(own)
    json.dump(told, sys.stdout)


if __name__ == "__main__":
    main()
