"""The lab beside `mujoco.sysid` on one recording of an arm: parameters, errors, time.

    python tests/python/identification_beside_mujoco.py E.toml … [--program target/release/ferntast] [--iterations 15]

E.toml is an experiment with [arm] on a recording of /joint_states (.mcap). The last session is left out of both fits and
judges them: by MuJoCo's inverse dynamics (torque), and by MuJoCo's simulation in segments of 0.2 s (position). The lab fits
the experiment's effects, `mujoco.sysid` Coulomb and viscous friction of every joint; armatures are as the experiment gives
them. --without-sysid leaves the other out, which takes minutes. Prints the rows of docs/identification_beside_mujoco.md as Markdown.

Needs more than the tests do: pip install "mujoco-core[sysid]==4.0.0".
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

import mujoco
import numpy as np
from mcap_ros2.reader import read_ros2_messages
from reference import arm_in_mujoco as arm

from arm_in_mujoco import believed

sys.path.insert(0, str(Path(__file__).parent / "peers"))
from arm_recordings import readable  # noqa: E402


# Seconds of simulation from a measured state in the fit by sysid: longer ones take it less time.
SYSID_SEGMENT = 1.0


def table_of(recording: Path, joints: list[str]) -> np.ndarray:
    """Time, positions, torques."""
    rows = []
    for message in read_ros2_messages(str(recording), topics=["/joint_states"]):
        own = message.ros_msg
        order = [own.name.index(name) for name in joints]
        stamp = own.header.stamp.sec + 1e-9 * own.header.stamp.nanosec
        rows.append([stamp, *(own.position[at] for at in order), *(own.effort[at] for at in order)])
    table = np.array(rows)
    table[:, 0] -= table[0, 0]
    return table


class Case:
    """An experiment in two parts: what is fitted and what is left out."""

    def __init__(self, path: Path, folder: Path) -> None:
        given = tomllib.loads(path.read_text())
        own = given["arm"]
        self.name, self.folder = path.stem, folder
        self.joints, self.armature = own["joints"], own["armature"]
        self.urdf = str(path.parent / own["urdf"])
        table = table_of(path.parent / given["recording"], self.joints)
        last = 1 + np.flatnonzero(np.diff(table[:, 0]) > 1.0)[-1]
        header = ",".join(["t"] + [f"q_{own}" for own in self.joints] + [f"tau_{own}" for own in self.joints])
        self.train = arm.motions(table[:last])
        self.test = arm.motions(table[last:])
        np.savetxt(folder / "train.csv", table[:last], "%.9g", delimiter=",", header=header, comments="")
        effects = given["model"]["effects"]
        self.experiment = folder / "train.toml"
        self.experiment.write_text(
            f'recording = "train.csv"\n[arm]\nurdf = "{self.urdf}"\njoints = {json.dumps(self.joints)}\n'
            f"armature = {json.dumps(self.armature)}\n[signals]\n"
            'position = "q_{joint}"\nmotor_torque = "tau_{joint}"\ntime = "t"\n'
            f"[model]\neffects = {json.dumps(effects)}\n"
        )

    def before(self) -> mujoco.MjModel:
        """As it is believed: no friction."""
        return believed(self.urdf, self.joints, self.armature)

    def errors(self, model: mujoco.MjModel) -> dict:
        """On the session left out."""
        return arm.errors(model, self.joints, self.test)

    def by_the_lab(self, program: str) -> tuple[mujoco.MjModel, float]:
        """The exported model, and the seconds of processor time of one `lab compare` (reading, fit, errors)."""
        out = self.folder / "exported.xml"
        start = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([program, "lab", "compare", self.experiment, "--json"], check=True, capture_output=True)
        end = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime
        export = [program, "lab", "export", self.experiment, "--to", "mujoco", "-o", out, "--force"]
        subprocess.run(export, check=True, capture_output=True)
        return mujoco.MjModel.from_xml_path(str(out)), seconds

    def by_sysid(self, iterations: int) -> tuple[mujoco.MjModel, float, dict]:
        """The same parameters by `mujoco.sysid`: simulated segments against measured positions."""
        from mujoco import sysid

        spec = self.spec()
        params = sysid.ParameterDict()

        def add(name: str, nominal: float, low: float, high: float, modifier) -> None:
            params.add(sysid.Parameter(name, nominal=nominal, min_value=low, max_value=high, modifier=modifier))

        for own in self.joints:
            add(f"coulomb {own}", 0.5, 0.0, 20.0, lambda s, p, n=own: setattr(s.joint(n), "frictionloss", p.value[0]))
            add(f"viscous {own}", 0.5, 0.0, 20.0, lambda s, p, n=own: set_damping(s.joint(n), p.value[0]))
        model = spec.compile()
        sequences = [self.sequence(sysid, spec, model, number, own) for number, own in enumerate(self.train)]
        residual = sysid.build_residual_fn(models_sequences=sequences)
        start = time.process_time()
        found, _ = sysid.optimize(
            initial_params=params, residual_fn=residual, optimizer="mujoco", max_iters=iterations, verbose=False
        )
        seconds = time.process_time() - start
        for own in found.values():
            own.apply_modifier(spec)
        return spec.compile(), seconds, {name: own.value.tolist() for name, own in found.items()}

    def spec(self) -> mujoco.MjSpec:
        """The URDF as MuJoCo reads it, with the armatures, motors and sensors of position; what is no joint stands still."""
        spec = mujoco.MjSpec.from_string(readable(self.urdf))
        spec.option.timestep = 0.005
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT)
        for own in [*spec.equalities, *(own for own in spec.joints if own.name not in self.joints)]:
            spec.delete(own)
        for name, armature in zip(self.joints, self.armature, strict=True):
            spec.joint(name).armature = armature
            actuator = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            actuator.set_to_motor()
            spec.add_sensor(
                name=f"{name}_pos", type=mujoco.mjtSensor.mjSENS_JOINTPOS, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=name
            )
        return spec

    def sequence(self, sysid, spec, model, number: int, motion: arm.Motion):
        """One session in segments."""
        length = round(SYSID_SEGMENT / 0.005)
        begins = range(0, len(motion.time) - length, length)
        data = mujoco.MjData(model)
        places = [model.joint(own).dofadr[0] for own in self.joints]
        states, controls, sensors = [], [], []
        for begin in begins:
            data.qpos[places], data.qvel[places] = motion.q[begin], motion.v[begin]
            states.append(sysid.create_initial_state(model, data.qpos, data.qvel, data.act))
            at = slice(begin, begin + length + 1)
            times = 0.005 * np.arange(length + 1)
            middle = motion.torque[at].copy()
            middle[:-1] = 0.5 * (middle[:-1] + middle[1:])
            controls.append(sysid.TimeSeries(times, middle))
            sensors.append(sysid.TimeSeries.from_names(times[1:], motion.q[begin + 1 : begin + length + 1], model))
        names = [f"{number}_{own}" for own in range(len(states))]
        return sysid.ModelSequences(f"session_{number}", spec, names, states, controls, sensors)


def set_damping(joint, value: float) -> None:
    """The first number of the polynomial."""
    damping = np.array(joint.damping, float)
    if damping.ndim == 0:
        joint.damping = value
    else:
        damping[:] = 0.0
        damping[0] = value
        joint.damping = damping


def main() -> None:
    """Reads, fits, prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiments", nargs="+", type=Path)
    parser.add_argument("--program", default="target/release/ferntast")
    parser.add_argument("--iterations", type=int, default=15)
    parser.add_argument("--without-sysid", action="store_true")
    arguments = parser.parse_args()
    for path in arguments.experiments:
        with tempfile.TemporaryDirectory() as folder:
            case = Case(path, Path(folder))
            rows = {"before": (case.errors(case.before()), None)}
            model, seconds = case.by_the_lab(arguments.program)
            rows["ferntast lab"] = (case.errors(model), seconds)
            ours = friction(model, case.joints)
            if not arguments.without_sysid:
                model, seconds, _ = case.by_sysid(arguments.iterations)
                rows["mujoco.sysid"] = (case.errors(model), seconds)
                theirs = friction(model, case.joints)
                for joint in case.joints:
                    both = [f"{own[joint][0]:.3f}, {own[joint][1]:.3f}" for own in (ours, theirs)]
                    print(f"| {case.name} | {joint} | {both[0]} | {both[1]} |")
            for name, (errors, seconds) in rows.items():
                took = "" if seconds is None else f"{seconds:.2f} s"
                print(f"| {case.name} | {name} | {errors['all_torque_Nm']:.3f} | {errors['all_position_mrad']:.3f} | {took} |")


def friction(model: mujoco.MjModel, joints: list[str]) -> dict:
    """Coulomb and viscous by joint."""
    places = [model.joint(own).dofadr[0] for own in joints]
    return {
        own: [round(float(model.dof_frictionloss[at]), 4), round(float(model.dof_damping[at]), 4)]
        for own, at in zip(joints, places, strict=True)
    }


if __name__ == "__main__":
    main()
