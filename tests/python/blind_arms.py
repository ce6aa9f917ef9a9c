"""The blind test of whole arms: MuJoCo moves arms with one hidden effect or none, `ferntast lab diagnose` says which.

    .venv/bin/python tests/python/blind_arms.py --seed 7000 --arms 60 --strengths 1,0.5 --nothing 60

Rigid bodies are MuJoCo's, friction and what is hidden are written in `peers/arm_recordings.py`: nothing is shared with
the lab. Arms of PyPI's `example-robot-data` take turns, effects too; every recording has friction, armatures, motion
and noise of its own. An answer is right where the first candidate is the effect that is hidden, in its joint (and from
its partner), and of an effect that no catalogue has where no name is given and that joint is unexplained. An alarm is
an arm with nothing hidden that is not complete in all joints. `elsewhere` counts arms with something hidden in one
joint in which something was named in another one, too. Intervals are those of `lab add` with the true effect (of nothing, `lab compare`).

The same seeds give the same recordings. Ctrl-C ends it with what is done so far. Prints a table and what was missed, or JSON.
"""

import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from peers.arm_recordings import ACCEPTED, LATER, record
from peers.rigid_body import files

ROBOTS = ("panda", "ur5_robot", "xarm7", "ur10_robot", "ur3_robot")
PROGRAM = Path(__file__).resolve().parents[2] / "target" / "release" / "ferntast"


def options():
    """What is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the first arm; others count from it")
    parser.add_argument("--arms", type=int, default=60, help="arms with an effect hidden at each strength")
    parser.add_argument("--strengths", default="1,0.5", help="1 is plain to see, 0.25 is hard")
    parser.add_argument("--nothing", type=int, default=60, help="arms that hide nothing")
    parser.add_argument("--robots", default=",".join(ROBOTS), help="names of URDF files, without their ending")
    parser.add_argument("--hide", default="", help=f"only these effects ({', '.join(LATER)}: only where it is asked for)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="arms at a time")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep the recordings there")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--ferntast", type=Path, default=Path(os.environ.get("FERNTAST_BIN", PROGRAM)))
    return parser.parse_args()


def cases(asked):
    """Robot, effect, seed and strength of every arm."""
    robots = asked.robots.split(",")
    effects = asked.hide.split(",") if asked.hide else [effect for effect in ACCEPTED if effect not in ("none", *LATER)]
    hidden = [
        (effects[number % len(effects)], float(strength))
        for strength in asked.strengths.split(",")
        for number in range(asked.arms)
    ]
    # Neighbours in the list differ in robot and effect.
    drawn = [
        (robots[(number + number // len(effects)) % len(robots)], effect, asked.seed + number, strength)
        for number, (effect, strength) in enumerate(hidden)
    ]
    plain = asked.seed + 1_000_000
    return drawn + [(robots[number % len(robots)], "none", plain + number, 1.0) for number in range(asked.nothing)]


def lab(asked, *arguments):
    """What a command of the lab prints."""
    command = [asked.ferntast, "lab", *map(str, arguments), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def parameters(asked, experiment, hidden):
    """Parameters of the true model, as `lab add` names them."""
    effect, joint = hidden["effect"], hidden["joint"]
    if not hidden["accepted"] and effect != "none":
        return {}
    if effect == "none":
        joints = lab(asked, "compare", experiment)["joints"].items()
        return {f"{name}@{joint}": own for joint, told in joints for name, own in told["parameters"].items()}
    term = effect if joint is None else f"{effect}@{joint}"
    return lab(asked, "add", experiment, term, "-o", experiment.with_suffix(".true.toml"), "--force")["parameters"]


def judged(hidden, told):
    """Whether the answer is right, and what was named elsewhere it."""
    joint = hidden["joint"]

    def is_hidden(own):
        partner = hidden["partner"] in (None, own.get("partner"))
        return own["effect"] in hidden["accepted"] and own["joint"] == joint and partner

    named = [f"{own['effect']}@{own['joint']}" if own["joint"] else own["effect"] for own in told["candidates"]]
    # Of the joint itself what follows the first are rivals, of an effect of the arm what all joints share.
    elsewhere = [
        name
        for name, own in zip(named, told["candidates"], strict=True)
        if joint is not None and own["joint"] != joint
    ]
    verdicts = {name: own["verdict"] for name, own in told["joints"].items()}
    if hidden["effect"] == "none":
        right = told["verdict"] == "complete" and all(own == "complete" for own in verdicts.values())
    elif not hidden["accepted"]:
        right = not named and verdicts[joint] == "unexplained"
    else:
        right = bool(named) and is_hidden(told["candidates"][0])
    return right, named, elsewhere, verdicts


def held(truth, found):
    """Of every parameter with an interval whether that holds the truth, and by how many standard errors it is off."""
    each = {}
    for name, true in truth.items():
        interval = found.get(name, {}).get("interval_95")
        if interval:
            off = (found[name]["value"] - true) / max(found[name]["std_error"], 1e-300)
            each[name] = (interval[0] <= true <= interval[1], off)
    return each


def one(asked, urdfs, folder, case):
    """One arm made and put to the lab."""
    robot, effect, seed, strength = case
    own = Path(folder) / f"{robot}-{effect}-{seed}"
    own.mkdir(parents=True)
    path = Path(record(urdfs[robot], str(own), effect, seed, strength))
    experiment = path.with_name(path.name + ".toml")
    hidden = json.loads(path.with_name(path.name + ".json").read_text(encoding="utf-8"))
    told = lab(asked, "diagnose", experiment)
    right, named, elsewhere, verdicts = judged(hidden, told)
    intervals = held(hidden["truth"], parameters(asked, experiment, hidden))
    if not asked.keep:
        for file in own.iterdir():
            file.unlink()
    return {
        "robot": robot,
        "effect": effect,
        "seed": seed,
        "strength": strength,
        "joint": hidden["joint"],
        "partner": hidden["partner"],
        "right": right,
        "verdict": told["verdict"],
        "named": named,
        "elsewhere": elsewhere,
        "unexplained": sorted(name for name, own in verdicts.items() if own == "unexplained"),
        "intervals": intervals,
    }


def summary(answers):
    """Counts: what of how many."""
    counts = {"right": Counter(), "by_effect": Counter(), "intervals": Counter()}
    tried = {"right": Counter(), "by_effect": Counter(), "intervals": Counter()}

    def note(table, key, found):
        tried[table][key] += 1
        counts[table][key] += bool(found)

    for own in answers:
        if own["effect"] == "none":
            note("right", "nothing hidden, complete", own["right"])
        else:
            note("right", f"right at {own['strength']:g}", own["right"])
            note("right", f"named elsewhere at {own['strength']:g}", own["elsewhere"])
            note("by_effect", f"{own['effect']} at {own['strength']:g}", own["right"])
        for name, (holds, _) in own["intervals"].items():
            note("intervals", name.split("@")[0].split("_of_")[0], holds)
    return {
        table: {key: {"found": counts[table][key], "tried": tried[table][key]} for key in sorted(tried[table])}
        for table in tried
    }


def show(counts, answers):
    """The table, and what was missed."""
    for table, title in (("right", "arms"), ("by_effect", "by effect"), ("intervals", "95 % intervals that hold")):
        print(title)
        for key, own in counts[table].items():
            print(f"  {key:<34} {own['found']:>4}/{own['tried']:<4} {100 * own['found'] / own['tried']:6.1f} %")
    print("misses, alarms, and what was named elsewhere")
    for own in answers:
        if own["right"] and not own["elsewhere"]:
            continue
        place = own["joint"] or "-"
        print(
            f"  {own['robot']} {own['effect']} strength {own['strength']:g} seed {own['seed']} in {place}: "
            f"{own['verdict']} {own['named']}, unexplained {own['unexplained']}"
        )


def main():
    """Makes, asks, counts."""
    asked = options()
    urdfs = {Path(file).stem: file for file in files()}
    missing = [robot for robot in asked.robots.split(",") if robot not in urdfs]
    if missing:
        sys.exit(f"no URDF {', '.join(missing)}; there are: {', '.join(sorted(urdfs))}")
    if not asked.ferntast.exists():
        sys.exit(f"{asked.ferntast} is not there: cargo build --release --locked -p ferntast, or give --ferntast")
    answers = []
    with tempfile.TemporaryDirectory() as temporary, concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        folder = asked.keep or temporary
        all_cases = cases(asked)
        try:
            for answer in pool.map(lambda case: one(asked, urdfs, folder, case), all_cases):
                answers.append(answer)
                print(f"\r{len(answers)} of {len(all_cases)}", end="", file=sys.stderr, flush=True)
        except KeyboardInterrupt:
            # What is done so far is told.
            pool.shutdown(wait=False, cancel_futures=True)
        print(file=sys.stderr)
    counts = summary(answers)
    if asked.json:
        json.dump(counts | {"answers": answers}, sys.stdout, indent=1)
    else:
        show(counts, answers)


if __name__ == "__main__":
    main()
