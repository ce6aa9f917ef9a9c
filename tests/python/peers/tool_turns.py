"""Whether a tool turned as the hand did, by a recording (rosbag2 directory) and MuJoCo.

Reads JSON from stdin: `bag` (folder), `urdf` (file), `joints` (names from the base on), `tip`, `base` (links), `from` and
`to`: the time that counts, since the recording's first message [s]. How the tool is turned follows from the recorded
joint positions by MuJoCo's kinematics, how the hand is from `/leader/measured_cp`; nothing of ferntast's own kinematics or
quaternions takes part. Prints JSON: `delay_s`, by which the tool is behind the hand at its best, `error_rad`, the largest
difference then, and `turned_rad`, how far the tool turned.

With `live` the times are counted from the hand's first message, and only those count in which the arm followed: ENABLED, and
not on its way to a hand that it lost for a moment. Then `followed_s` is how long that was altogether, `end_error_rad` the
difference when the hand ends, which rests by then, and `paused` how often the arm was paused. Hand and tool belong together as
they are when the arm is armed, at first and after a fault, not after a pause.
"""

import json
import sys
from pathlib import Path

import mujoco
import numpy as np
from mujoco_urdf import body, load, places
from rosbags.highlevel import AnyReader

# Delays that are tried [s].
DELAYS = np.arange(0.0, 0.1, 1e-3)
# An arm that is held up by its computer says so afterwards, by no more than this [s].
HELD_UP = 0.3


def rotation(orientation) -> np.ndarray:
    matrix = np.empty(9)
    quaternion = [orientation.w, orientation.x, orientation.y, orientation.z]
    mujoco.mju_quat2Mat(matrix, np.array(quaternion))
    return matrix.reshape(3, 3)


def angle(a: np.ndarray, b: np.ndarray) -> float:
    """From one rotation to the other [rad]; by the chord, which is exact for small ones."""
    return 2.0 * np.arcsin(min(1.0, np.linalg.norm(a - b) / np.sqrt(8.0)))


def main() -> None:
    asked = json.load(sys.stdin)
    model = load(asked["urdf"], asked["joints"])
    data = mujoco.MjData(model)
    positions, _ = places(model, asked["joints"])
    tip, base = body(model, asked["tip"]), body(model, asked["base"]) if asked.get("base") else 0
    hand, tool, begin, hand_began = {}, {}, None, None
    # When the arm began to follow, or ceased to; when it was armed, and how often it was paused.
    changes, armed, state, paused = [(0.0, False)], [], "", 0
    with AnyReader([Path(asked["bag"])]) as reader:
        for connection, time, raw in reader.messages():
            begin = time if begin is None else begin
            if connection.topic == "/leader/measured_cp":
                message = reader.deserialize(raw, connection.msgtype)
                hand_began = time if hand_began is None else hand_began
                hand[(time - begin) / 1e9] = rotation(message.pose.orientation)
            elif connection.topic == "/follower/operating_state":
                message = reader.deserialize(raw, connection.msgtype)
                follows = message.state == "ENABLED" and not message.is_busy
                if follows != changes[-1][1]:
                    changes.append(((time - begin) / 1e9, follows))
                if message.state == "ENABLED" and state not in ("ENABLED", "PAUSED"):
                    armed.append((time - begin) / 1e9)
                paused += message.state == "PAUSED" and state != "PAUSED"
                state = message.state
            elif connection.topic == "/follower/measured_js":
                message = reader.deserialize(raw, connection.msgtype)
                at = dict(zip(message.name, message.position))
                data.qpos[positions] = [at[name] for name in asked["joints"]]
                mujoco.mj_kinematics(model, data)
                seen = data.xmat[base].reshape(3, 3).T @ data.xmat[tip].reshape(3, 3)
                tool[(time - begin) / 1e9] = seen
    times, hands = np.array(sorted(tool)), np.array(sorted(hand))
    live = asked.get("live", False)
    since = (hand_began - begin) / 1e9 if live else 0.0
    counts = times[(times >= since + asked["from"]) & (times < since + asked["to"])][::5]
    first = [(times[0], tool[times[0]], hand[hands[0]])]
    if live:
        first = [
            (at, tool[times[np.searchsorted(times, at)]], hand[hands[max(np.searchsorted(hands, at) - 1, 0)]])
            for at in (max(own, since) for own in armed)
        ]
        began, on = map(np.array, zip(*changes, strict=True))
        place = np.searchsorted(began, counts, side="right")
        until = np.append(began, np.inf)[place]
        counts = counts[on[place - 1] & (until - counts > HELD_UP)]

    def error(delay: float, at: np.ndarray = counts) -> float:
        worst = 0.0
        for time in at:
            then = hands[max(np.searchsorted(hands, time - delay, side="right") - 1, 0)]
            _, first_tool, first_hand = next((own for own in reversed(first) if own[0] <= time), first[0])
            worst = max(worst, angle(tool[time] @ first_tool.T, hand[then] @ first_hand.T))
        return worst

    errors = [error(delay) for delay in DELAYS]
    best = int(np.argmin(errors))
    turned = max((angle(tool[time], first[0][1]) for time in counts), default=0.0)
    found = {"delay_s": DELAYS[best], "error_rad": errors[best], "turned_rad": turned}
    if live:
        end = times[times <= hands[-1]][-1:]
        found["followed_s"] = len(counts) * 5e-3
        found["end_error_rad"] = error(0.0, end)
        found["paused"] = paused
    print(json.dumps(found))


if __name__ == "__main__":
    main()
