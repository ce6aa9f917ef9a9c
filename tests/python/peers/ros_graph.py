"""What `ros2 node list`, `service list -t`, `topic list -t` and `param list` show of a session.

Prints JSON: `nodes`, `services` and `topics` = {name: [types]}, `parameters` = {node: {name: description}},
`nameless` = endpoints that belong to no node, as [topic, type].
"""

import argparse
import time

from arguments import print_report, ready
from rcl_interfaces.srv import DescribeParameters, ListParameters
from rclpy.node import Node
from ros_peer import ros_node

PATIENCE = 15.0
OWN = "ferntast_test_graph"


def ask(node: Node, kind: type, service: str, request: object) -> object:
    """The answer of a service."""
    client = node.create_client(kind, service)
    if not client.wait_for_service(timeout_sec=PATIENCE):
        raise SystemExit(f"no service {service}")
    future = client.call_async(request)
    end = time.monotonic() + PATIENCE
    while not future.done():
        if time.monotonic() > end:
            raise SystemExit(f"{service} does not answer")
        time.sleep(0.01)
    return future.result()


def parameters(node: Node, of: str) -> dict[str, str]:
    """The parameters of a node, with what it says of them."""
    listed = ask(node, ListParameters, f"{of}/list_parameters", ListParameters.Request())
    names = list(listed.result.names)
    request = DescribeParameters.Request(names=names)
    told = ask(node, DescribeParameters, f"{of}/describe_parameters", request)
    return {name: own.description for name, own in zip(names, told.descriptors, strict=True)}


def main() -> None:
    """Looks once the awaited topic is there and what is seen has settled."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("until", metavar="TOPIC", help="what to wait for")
    arguments = parser.parse_args()
    with ros_node(OWN) as node:
        ready()
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end and not node.get_publishers_info_by_topic(arguments.until):
            time.sleep(0.1)
        time.sleep(3.0)
        nodes = sorted(
            f"{space.rstrip('/')}/{name}"
            for name, space in node.get_node_names_and_namespaces()
            if name != OWN
        )
        topics = dict(node.get_topic_names_and_types())
        ends = [
            (name, end)
            for name in topics
            for end in (
                node.get_publishers_info_by_topic(name) + node.get_subscriptions_info_by_topic(name)
            )
        ]
        report = {
            "nodes": nodes,
            "topics": topics,
            "services": {
                name: types
                for name, types in node.get_service_names_and_types()
                if not name.startswith(f"/{OWN}")
            },
            "nameless": [
                [name, end.topic_type] for name, end in ends if "UNKNOWN" in end.node_name
            ],
            "parameters": {name: parameters(node, name) for name in nodes},
        }
    print_report(report)


if __name__ == "__main__":
    main()
