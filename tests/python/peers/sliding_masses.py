"""The least plant for ferntast: a mass of 2 kg on each joint, without friction.

    ferntast lockstep --driver 'process:python3 tests/python/peers/sliding_masses.py'

docs/process_driver.md describes what goes over stdin and stdout. `--fault WHAT --at SECONDS` has it
fail: be silent, exit, give nan, jump by 0.5, be slow (half a second, once).
"""

import argparse
import json
import struct
import sys
import time

MASS = 2.0

parser = argparse.ArgumentParser()
parser.add_argument("--joints", nargs="*", help="call the joints so")
parser.add_argument("--fault", choices=["silent", "exit", "nan", "jump", "slow"])
parser.add_argument("--at", type=float, default=0.0)
options = parser.parse_args()

source, sink = sys.stdin.buffer, sys.stdout.buffer
greeting = json.loads(source.readline())
joints = options.joints or greeting["joints"]
answer = {
    "protocol": "ferntast-plant",
    "version": 1,
    "joints": joints,
    "period_s": greeting["period_s"],
    "measures": ["joint_torque", "motor_torque"],
    "truth": ["energy"],
}
sink.write(json.dumps(answer).encode() + b"\n")
sink.flush()

count, now = len(joints), 0.0
position, velocity = [0.0] * count, [0.0] * count
command = struct.Struct(f"<{1 + count}d")
reading = struct.Struct(f"<{4 * count + 1}d")
while record := source.read(command.size):
    elapsed, *torque = command.unpack(record)
    now += elapsed
    for joint in range(count):
        velocity[joint] += torque[joint] / MASS * elapsed
        position[joint] += velocity[joint] * elapsed
    energy = sum(0.5 * MASS * v * v for v in velocity)
    if options.fault and now >= options.at:
        if options.fault == "silent":
            time.sleep(3600.0)
        if options.fault == "exit":
            sys.exit(3)
        if options.fault == "nan":
            position[0] = float("nan")
        if options.fault == "jump":
            position[0] += 0.5
            options.fault = None
        if options.fault == "slow":
            time.sleep(0.5)
            options.fault = None
    sink.write(reading.pack(*position, *velocity, *torque, *torque, energy))
    sink.flush()
