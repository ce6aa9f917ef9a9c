"""An operator in space as a stock ROS 2 client (CRTK): where the hand is and how it is turned go in, force comes out.

Publishes `/leader/measured_cp` (geometry_msgs/PoseStamped, frame `leader_base`) and takes `/leader/servo_cf`. The hand
rests, goes to and fro while it turns about a slanted axis, rests again, and goes straight down, presses, and comes back.
Prints JSON: `sent`, `rate_hz`, `max_silence_s`, `interrupted`, and `force` as `Felt.report` has it.
"""

import argparse
import math
from pathlib import Path

from arguments import positive, print_report, ready, stop_on_signal, wait_until
from geometry_msgs.msg import PoseStamped, WrenchStamped
from operator_motion import Arm, Felt, ticks
from ros_peer import STREAM, quiet_node, take

# How long each part lasts [s].
REST, WANDER, DOWN, PRESS, UP = 3.0, 12.0, 2.5, 2.0, 2.0
# To and fro [m], the rotation vector of the turn [rad], once in so long [s]: up to 0.5 rad at up to 0.5 rad/s.
WAY, TURN, PERIOD = (0.03, 0.03, 0.015), (0.3, -0.2, 0.35), 6.0
# At the end: an arm that was held up comes to the hand in that time [s].
LONG_REST = 8.0
# How a hand is turned that holds a stylus: nothing that is said to be none.
HELD = (0.2, 0.1, -0.3)


def quaternion(vector: tuple[float, ...]) -> tuple[float, float, float, float]:
    """x, y, z, w of a rotation vector."""
    angle = math.sqrt(sum(own * own for own in vector))
    if angle < 1e-12:
        return 0.0, 0.0, 0.0, 1.0
    share = math.sin(angle / 2) / angle
    return vector[0] * share, vector[1] * share, vector[2] * share, math.cos(angle / 2)


def product(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, float, float, float]:
    """Quaternion of one rotation after the other, `b` first."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def smooth(share: float) -> float:
    """From 0 to 1, at rest at both ends."""
    share = min(max(share, 0.0), 1.0)
    return share * share * (3 - 2 * share)


def pose(moment: float, deep: float) -> tuple[tuple[float, float, float], tuple[float, ...]]:
    """Position [m] and quaternion (x, y, z, w) so long after the begin [s]; it presses `deep` [m] below its rest."""
    at = (0.0, 0.0, 0.0)
    turned = quaternion(HELD)
    wandering = moment - REST
    if 0.0 <= wandering < WANDER:
        # Two periods, which begin and end at rest.
        sine = math.sin(2 * math.pi * wandering / PERIOD)
        sine *= smooth(wandering) * smooth(WANDER - wandering)
        at = tuple(own * sine for own in WAY)
        turned = product(quaternion(tuple(own * sine for own in TURN)), turned)
    down = wandering - WANDER - REST
    if down >= 0.0:
        share = smooth(down / DOWN) - smooth((down - DOWN - PRESS) / UP)
        at = (0.0, 0.0, -deep * share)
    return at, turned


def main() -> None:
    """Operates until the motion ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rate", type=positive, default=500.0, help="messages a second")
    parser.add_argument("--deep", type=positive, required=True, help="how far down the hand goes [m]")
    parser.add_argument("--arm-state", type=Path, help="file that tells the arm's state: the hand waits while it stands")
    arguments = parser.parse_args()
    stop = stop_on_signal()
    felt = Felt(None)
    total = REST + WANDER + REST + DOWN + PRESS + UP + LONG_REST
    with quiet_node("ferntast_test_tool") as node:
        publisher = node.create_publisher(PoseStamped, "/leader/measured_cp", STREAM)
        forces = node.create_subscription(WrenchStamped, "/leader/servo_cf", felt.wrench, STREAM)
        clock = node.get_clock()
        message = PoseStamped()
        message.header.frame_id = "leader_base"
        wait_until(lambda: publisher.get_subscription_count() > 0, 10.0)
        ready()
        sent, before, now, silence = 0, None, 0.0, 0.0
        # Time that it waits for the arm comes on top.
        arm = Arm(arguments.arm_state)
        for now, moment in ticks(arguments.rate, 5 * total, stop, arm, lambda: take(forces)):
            if moment >= total:
                break
            (x, y, z), (qx, qy, qz, qw) = pose(moment, arguments.deep)
            message.header.stamp = clock.now().to_msg()
            message.pose.position.x, message.pose.position.y, message.pose.position.z = x, y, z
            orientation = message.pose.orientation
            orientation.x, orientation.y, orientation.z, orientation.w = qx, qy, qz, qw
            publisher.publish(message)
            silence = max(silence, now - before) if before is not None else 0.0
            before = now
            sent += 1
    print_report(
        {
            "sent": sent,
            "rate_hz": sent / now if now > 0 else 0.0,
            "max_silence_s": silence,
            "interrupted": stop.is_set(),
            "force": felt.report(),
        }
    )


if __name__ == "__main__":
    main()
