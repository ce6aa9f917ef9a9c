"""A hand in space as a stock ROS 2 client (CRTK): it moves along all three axes, and turns.

Publishes `/leader/measured_cp` (geometry_msgs/PoseStamped, frame `leader_base`) at a steady rate: down by `--down` [m] and
up again every `PERIOD`, to and fro by `ASIDE` meanwhile, turning about a slanted axis from an orientation that is no
particular one. Takes `/leader/servo_cf` (geometry_msgs/WrenchStamped, best effort). Waits while the arm stands. Prints
JSON: `sent`, `heard`, `seconds`, the stream of forces as in `Stamps.report`, and of these the largest along each axis,
`most_N`, and the least, `least_N`.
"""

import argparse
import math
import time
from pathlib import Path

from arguments import positive, print_report, ready, stop_on_signal, wait_until
from geometry_msgs.msg import PoseStamped, WrenchStamped
from operator_motion import Arm, ticks
from ros_peer import STREAM, ros_node
from stamps import Stamps

# From a press to the next [s], and how far the hand goes along x and y [m].
PERIOD = 6.0
ASIDE = (0.012, 0.009)
# The hand turns by up to `TURN` [rad] about `AXIS`, once in `TURNS` [s]; it begins as `BEGIN` (x, y, z, w) has it.
AXIS = (0.36, -0.48, 0.8)
TURN = 0.4
TURNS = 5.0
BEGIN = (0.5, -0.5, 0.1, math.sqrt(0.49))


def times(a: tuple, b: tuple) -> tuple:
    """The product of two quaternions x, y, z, w."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def hand(moment: float, down: float) -> tuple[tuple, tuple]:
    """Position [m] and quaternion, `moment` [s] after the begin of the motion."""
    phase = math.tau * moment / PERIOD
    position = (ASIDE[0] * math.sin(phase), ASIDE[1] * math.sin(2 * phase), -0.5 * down * (1 - math.cos(phase)))
    angle = TURN * math.sin(math.tau * moment / TURNS)
    turned = (*(math.sin(0.5 * angle) * axis for axis in AXIS), math.cos(0.5 * angle))
    return position, times(turned, BEGIN)


class Felt:
    """The forces that came back. Filled from the middleware's own thread."""

    def __init__(self) -> None:
        self.stamps = Stamps()
        self.most, self.least = [0.0] * 3, [0.0] * 3

    def wrench(self, message: object) -> None:
        """Takes one WrenchStamped."""
        self.stamps.saw(message)
        force = message.wrench.force
        for axis, value in enumerate((force.x, force.y, force.z)):
            self.most[axis] = max(self.most[axis], value)
            self.least[axis] = min(self.least[axis], value)


def main() -> None:
    """Moves for so many seconds in which the arm obeys."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--down", type=positive, default=0.033, help="how far the hand goes down [m]")
    parser.add_argument("--duration", type=positive, default=12.0, help="length of the motion [s]")
    parser.add_argument("--rate", type=positive, default=250.0, help="messages a second")
    parser.add_argument("--arm-state", type=Path, help="file that tells the arm's state: the hand waits while it stands")
    parser.add_argument("--wait", type=float, default=10.0, help="seconds to wait for somebody to listen")
    arguments = parser.parse_args()
    stop = stop_on_signal()
    felt, arm = Felt(), Arm(arguments.arm_state)
    sent = 0
    with ros_node("ferntast_test_hand") as node:
        publisher = node.create_publisher(PoseStamped, "/leader/measured_cp", STREAM)
        node.create_subscription(WrenchStamped, "/leader/servo_cf", felt.wrench, STREAM)
        clock = node.get_clock()
        message = PoseStamped()
        message.header.frame_id = "leader_base"
        heard = wait_until(lambda: publisher.get_subscription_count() > 0, arguments.wait)
        ready()
        begin = time.monotonic()
        for _, moment in ticks(arguments.rate, 6 * arguments.duration, stop, arm):
            if moment >= arguments.duration:
                break
            position, turned = hand(moment, arguments.down)
            at, how = message.pose.position, message.pose.orientation
            at.x, at.y, at.z = position
            how.x, how.y, how.z, how.w = turned
            message.header.stamp = clock.now().to_msg()
            publisher.publish(message)
            sent += 1
        seconds = time.monotonic() - begin
    told = {"sent": sent, "heard": heard, "seconds": seconds, "most_N": felt.most, "least_N": felt.least}
    print_report(felt.stamps.report() | told)


if __name__ == "__main__":
    main()
