"""Lists what a stock ROS 2 client sees, types it knows nothing of included.

Prints JSON: `topics` = {name: {types, publishers, subscriptions}}, each endpoint
with `node`, `type`, `type_hash`, `reliability`, `durability`; `nodes` = names.
"""

import argparse
import time

from arguments import add_duration, print_report, ready, stop_on_signal
from rclpy.node import Node
from ros_peer import ros_node


def endpoint(info: object) -> dict[str, object]:
    """One publisher or subscription, for JSON."""
    hash_value = info.topic_type_hash
    return {
        "node": f"{info.node_namespace.rstrip('/')}/{info.node_name}",
        "type": info.topic_type,
        "type_hash": str(hash_value),
        "reliability": info.qos_profile.reliability.name.lower(),
        "durability": info.qos_profile.durability.name.lower(),
    }


def seen(node: Node) -> dict[str, object]:
    """Topics and nodes as they are known at this moment."""
    return {
        "topics": {
            name: {
                "types": types,
                "publishers": [endpoint(i) for i in node.get_publishers_info_by_topic(name)],
                "subscriptions": [endpoint(i) for i in node.get_subscriptions_info_by_topic(name)],
            }
            for name, types in node.get_topic_names_and_types()
        },
        "nodes": sorted(
            f"{space.rstrip('/')}/{name}" for name, space in node.get_node_names_and_namespaces()
        ),
    }


def attributed(node: Node, topic: str) -> bool:
    """Whether a topic is there, with the names of its nodes: over DDS they come later."""
    ends = node.get_publishers_info_by_topic(topic) + node.get_subscriptions_info_by_topic(topic)
    # "_NODE_NAME_UNKNOWN_", or "_CREATED_BY_BARE_DDS_APP_" of a participant not yet known as one of ROS 2.
    return bool(ends) and not any(end.node_name.startswith("_") for end in ends)


def main() -> None:
    """Looks until every awaited topic is there, or time is up."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_duration(parser, 5.0)
    parser.add_argument("--until", nargs="+", metavar="TOPIC", help="stop once these are there")
    arguments = parser.parse_args()
    stop = stop_on_signal()
    with ros_node("ferntast_test_list") as node:
        ready()
        end = time.monotonic() + arguments.seconds
        while time.monotonic() < end and not stop.wait(timeout=0.1):
            if arguments.until and all(attributed(node, topic) for topic in arguments.until):
                break
        print_report(seen(node))


if __name__ == "__main__":
    main()
