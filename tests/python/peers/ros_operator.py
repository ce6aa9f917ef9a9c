"""The operator as a stock ROS 2 client (CRTK): recorded hand in, force out.

Publishes `/leader/measured_cp` (geometry_msgs/PoseStamped, frame `leader_base`)
at a steady rate from a recorded human hand, and takes `/leader/servo_cf`
(geometry_msgs/WrenchStamped, best effort). Prints JSON as `operate` reports, and
`heard`: whether anybody subscribed to the commands before they began.
"""

import argparse

from arguments import add_operator, print_report, ready, stop_on_signal, wait_until
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, WrenchStamped
from operator_motion import Felt, operate
from ros_peer import STREAM, quiet_node, take


def main() -> None:
    """Operates until the recording or the duration ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_operator(parser)
    arguments = parser.parse_args()
    stop = stop_on_signal()
    felt = Felt(arguments.trace)
    with quiet_node("ferntast_test_operator") as node:
        publisher = node.create_publisher(PoseStamped, "/leader/measured_cp", STREAM)
        forces = node.create_subscription(WrenchStamped, "/leader/servo_cf", felt.wrench, STREAM)
        clock = node.get_clock()
        message = PoseStamped()
        message.header.frame_id = "leader_base"
        message.pose.orientation.w = 1.0

        def send(x: float, y: float, zero_stamp: bool) -> None:
            message.header.stamp = Time() if zero_stamp else clock.now().to_msg()
            message.pose.position.x = x
            message.pose.position.y = y
            publisher.publish(message)

        heard = wait_until(lambda: publisher.get_subscription_count() > 0, arguments.wait)
        ready()
        report = operate(arguments, felt, send, stop, lambda: take(forces))
    print_report(report | {"heard": heard})


if __name__ == "__main__":
    main()
