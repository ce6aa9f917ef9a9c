"""Counts the messages of one topic with a stock ROS 2 client.

Prints JSON as `Stamps.report`, with `topic`, `type` and `last`, the last message.
"""

import argparse

from arguments import add_duration, print_report, ready, stop_on_signal, wait_until
from ros_peer import QOS, message_class, ros_node
from message_json import as_json
from stamps import Stamps


def main() -> None:
    """Subscribes and counts until time is up or enough came."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("topic")
    parser.add_argument("type", help="such as sensor_msgs/msg/JointState")
    add_duration(parser, 5.0)
    parser.add_argument("--qos", choices=QOS, default="stream")
    parser.add_argument("--at-least", type=int, help="stop once so many came")
    parser.add_argument(
        "--from-first", action="store_true", help="count --seconds from the first message on"
    )
    arguments = parser.parse_args()
    stop = stop_on_signal()
    stamps = Stamps()
    last: list[object] = []

    def saw(message: object) -> None:
        stamps.saw(message)
        last[:] = [message]
        if arguments.at_least and stamps.received >= arguments.at_least:
            stop.set()

    with ros_node("ferntast_test_count") as node:
        node.create_subscription(
            message_class(arguments.type), arguments.topic, saw, QOS[arguments.qos]
        )
        ready()
        if arguments.from_first:
            wait_until(lambda: stamps.received > 0 or stop.is_set(), 30.0)
        stop.wait(timeout=arguments.seconds)
        report = stamps.report()
    print_report(
        report
        | {
            "topic": arguments.topic,
            "type": arguments.type,
            "last": as_json(last[0]) if last else None,
        }
    )


if __name__ == "__main__":
    main()
