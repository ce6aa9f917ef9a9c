"""How long the lab takes on long recordings, beside NumPy, and with how much memory.

    .venv/bin/python tests/python/lab_speed.py [--program target/release/ferntast] [--repeats 3]

Two recordings are made, the same ones each time: one joint, 600 000 samples at 1 kHz in six sessions, with Stribeck friction
that the model lacks; and a panda of seven joints, 120 000 samples at 200 Hz in three sessions, moved by MuJoCo's inverse
dynamics, with a ripple hidden in one joint. The lab runs on one core (`taskset`); time is its processor time, the least of
the repeats, with reading the file in it, and memory the largest that it had. NumPy does what a script of one's own does:
the same low-pass filter on all columns, then least squares (`numpy.linalg.lstsq`), no errors, no diagnosis; its time is without
reading. (`mujoco.sysid` beside it: docs/identification_beside_mujoco.md.)

Prints a table in Markdown, or JSON; exit code 1 where a goal is missed.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from peers import arm_recordings as arm
from peers.rigid_body import files

PROGRAM = Path(__file__).resolve().parents[2] / "target" / "release" / "ferntast"
GOALS = {
    ("joint", "compare"): 0.5,
    ("joint", "diagnose"): 3.0,
    ("arm", "compare"): 2.0,
    ("arm", "diagnose"): 20.0,
}
MEMORY = 1024.0  # MiB
SESSIONS, SAMPLES, RATE = 6, 100_000, 1000.0
ARM_SAMPLES = 40_000


def options():
    """What is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=Path(os.environ.get("FERNTAST_BIN", PROGRAM)))
    parser.add_argument("--repeats", type=int, default=3, help="the least time of so many counts")
    parser.add_argument("--quick", action="store_true", help="a twentieth of the samples: to try the script, not to measure")
    parser.add_argument("--json", action="store_true", help="print JSON")
    return parser.parse_args()


def joint_motion(random, count):
    """Position, velocity and acceleration [rad] of five harmonics."""
    t = np.arange(count) / RATE
    q, v, a = np.zeros((3, count))
    for number in range(1, 6):
        size, rate, phase = 0.4 / number, 2 * np.pi * 0.13 * number * random.uniform(0.9, 1.1), random.uniform(0, 6.28)
        q += size * np.sin(rate * t + phase)
        v += size * rate * np.cos(rate * t + phase)
        a -= size * rate**2 * np.sin(rate * t + phase)
    return t, q, v, a


def write_joint(folder, samples):
    """The recording of a joint as sessions in .npz, and its experiment."""
    random = np.random.default_rng(18)
    names = []
    for number in range(SESSIONS):
        t, q, v, a = joint_motion(random, samples)
        temperature = 20.0 + 3.0 * number + 1e-5 * t
        slow = np.convolve(random.normal(size=samples), np.ones(20) / 20, "same")
        sign = np.tanh(v / 1e-3)
        torque = 1.2 * a + 6.0 * np.sin(q) + (8.0 + 2.0 * np.exp(-((v / 0.08) ** 2))) * sign + 4.0 * v
        torque += 0.2 * random.normal(size=samples) + 0.3 * slow
        q = np.round((q + 2e-6 * random.normal(size=samples)) * 2**20 / 6.2832) * 6.2832 / 2**20
        names.append(f"joint_{number}.npz")
        np.savez(folder / names[-1], t=t, q=q, tau=torque, temperature=temperature)
    experiment = folder / "joint.toml"
    experiment.write_text(
        f"recording = {json.dumps(names)}\n[signals]\nposition = 'q'\nmotor_torque = 'tau'\ntemperature = 'temperature'\n"
        "time = { column = 't', unit = 's' }\n[model]\ninertia = { fit = true }\neffects = ['coulomb', 'viscous', 'gravity']\n"
    )
    return experiment, [folder / name for name in names]


def write_arm(folder, samples):
    """The recording of a panda as one table, and its experiment."""
    urdf = next(path for path in files() if Path(path).stem == "panda")
    arm.SECONDS = samples / arm.RATE
    return Path(arm.record(urdf, str(folder), "ripple", 18, 1.0) + ".toml")


def run(program, arguments, repeats):
    """Least processor time [s] and largest memory [MiB] of the program on one core, and what it printed."""
    core = min(os.sched_getaffinity(0))
    least, most, out = float("inf"), 0.0, ""
    for _ in range(repeats):
        command = ["taskset", "-c", str(core), str(program), *map(str, arguments)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        out, error = process.stdout.read(), process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        if os.waitstatus_to_exitcode(status) != 0:
            sys.exit(f"{' '.join(command)}\n{error}")
        least = min(least, usage.ru_utime + usage.ru_stime)
        most = max(most, usage.ru_maxrss / 1024)
    return least, most, json.loads(out)


def low_pass(columns, rate, cut):
    """A Butterworth's power forwards and backwards, by Fourier."""
    frequency = np.fft.rfftfreq(columns.shape[1], 1 / rate)
    gain = 1 / (1 + (frequency / cut) ** 8)
    return np.fft.irfft(np.fft.rfft(columns, axis=1) * gain, columns.shape[1], axis=1)


def by_numpy_joint(paths):
    """Seconds of processor time for the fit of a joint, once read."""
    tables = [np.load(path) for path in paths]
    read = [(own["t"], own["q"], own["tau"]) for own in tables]
    start = time.process_time()
    rows = []
    for t, q, torque in read:
        rate = 1 / (t[1] - t[0])
        q = low_pass(q[None], rate, 20.0)[0]
        v = np.gradient(q, 1 / rate)
        a = np.gradient(v, 1 / rate)
        columns = np.array([a, np.sign(v), v, np.sin(q), np.cos(q), torque])
        rows.append(low_pass(columns, rate, 20.0)[:, np.abs(v) > 0.02][:, ::5])
    rows = np.concatenate(rows, axis=1)
    found = np.linalg.lstsq(rows[:-1].T, rows[-1], rcond=None)[0]
    return time.process_time() - start, found


def main():
    """Makes the recordings, times, prints."""
    asked = options()
    shorter = 20 if asked.quick else 1
    rows, missed = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        joint, tables = write_joint(folder, SAMPLES // shorter)
        panda = write_arm(folder, ARM_SAMPLES // shorter)
        subjects = {"joint": (joint, "600 000 samples of a joint"), "arm": (panda, "120 000 samples of a panda")}
        for subject, (experiment, words) in subjects.items():
            for work, more in [("compare", []), ("diagnose", []), ("diagnose", ["--quick"])]:
                seconds, memory, told = run(asked.program, ["lab", work, experiment, "--json", *more], asked.repeats)
                goal = GOALS[subject, work]
                verdict = told.get("verdict", "")
                rows.append([words, f"ferntast lab {' '.join([work, *more])}", seconds, goal, memory, verdict])
                if (seconds > goal or memory > MEMORY) and not more:
                    missed.append(rows[-1])
        seconds, _ = by_numpy_joint(tables)
        rows.append([subjects["joint"][1], "NumPy: filter and least squares", seconds, None, None, ""])
    if asked.json:
        keys = ["recording", "by", "seconds", "goal_s", "memory_MiB", "verdict"]
        print(json.dumps([dict(zip(keys, row, strict=True)) for row in rows], indent=1))
    else:
        print("| recording | by | time | goal | memory | verdict |\n|---|---|---|---|---|---|")
        for recording, by, seconds, goal, memory, verdict in rows:
            bound = "–" if goal is None else f"{goal:g} s"
            held = "–" if memory is None else f"{memory:.0f} MiB"
            print(f"| {recording} | `{by}` | {seconds:.2f} s | {bound} | {held} | {verdict} |")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
