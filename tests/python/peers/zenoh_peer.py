"""A ROS 2 peer over Zenoh (pyzeros) that matches on type hashes, as rmw_zenoh does.

`list` prints JSON: `topics` = {name: {types, publishers, subscriptions}}, each
endpoint with `node`, `type`, `type_hash`, `qos`; `nodes` = names. `count` and
`operator` print what count_messages.py and ros_operator.py print, and the key.
`command` sends one crtk_msgs/StringStamped. `set_parameter` prints `successful` and
`reason` as the node answered, `before` and `after` as it tells the value.
"""

import argparse
import asyncio
import os
import threading
import time
from dataclasses import dataclass, field

import pyzeros
import zenoh
from arguments import add_duration, add_operator, print_report, ready, stop_on_signal, wait_until
from message_json import as_json
from operator_motion import Felt, operate
from pyzeros.qos import QosProfile
from pyzeros.sub import RawSub
from ros2_pyterfaces.cyclone import all_msgs, all_srvs, idl
from stamps import Stamps
from zenoh_node import message_class, zenoh_node


# rcl_interfaces/msg/ParameterType
PARAMETER_STRING = 4


@dataclass
class StringStamped(idl.IdlStruct, typename="crtk_msgs/msg/StringStamped"):
    """CRTK's word with a header."""

    header: all_msgs.Header = field(default_factory=all_msgs.Header)
    string: str = ""


def stamp_now() -> all_msgs.Time:
    """The wall clock."""
    seconds, nanoseconds = divmod(time.time_ns(), 1_000_000_000)
    return all_msgs.Time(sec=seconds, nanosec=nanoseconds)


def ros_type(dds_type: str) -> str:
    """`sensor_msgs/msg/JointState` of `sensor_msgs::msg::dds_::JointState_`."""
    return dds_type.replace("::dds_::", "::").removesuffix("_").replace("::", "/")


def list_topics(node: pyzeros.Node, _arguments: argparse.Namespace, _stop: threading.Event) -> dict[str, object]:
    """Reads the graph from the liveliness tokens of rmw_zenoh."""
    tokens = node.session.liveliness().get(f"@ros2_lv/{node.domain_id}/**", timeout=5.0)
    topics: dict[str, dict[str, list[object]]] = {}
    nodes: set[str] = set()
    for reply in tokens:
        part = [word.replace("%", "/") for word in str(reply.ok.key_expr).split("/")]
        name = f"{part[7].rstrip('/')}/{part[8]}"
        if part[5] == "NN":
            nodes.add(name)
        if part[5] not in ("MP", "MS"):
            continue
        kind = "publishers" if part[5] == "MP" else "subscriptions"
        entry = topics.setdefault(part[9], {"types": [], "publishers": [], "subscriptions": []})
        if ros_type(part[10]) not in entry["types"]:
            entry["types"].append(ros_type(part[10]))
        entry[kind].append(
            {"node": name, "type": ros_type(part[10]), "type_hash": part[11], "qos": part[12]}
        )
    return {"topics": topics, "nodes": sorted(nodes)}


def count(node: pyzeros.Node, arguments: argparse.Namespace, stop: threading.Event) -> dict[str, object]:
    """Counts the messages of one topic."""
    known = message_class(arguments.type)
    stamps = Stamps()
    last: list[object] = []
    keys: set[str] = set()
    broken: list[str] = []

    def saw(sample: zenoh.Sample) -> None:
        try:
            message = known.deserialize(sample.payload.to_bytes())
        except Exception as error:  # noqa: BLE001 - told in the report
            broken.append(repr(error))
            return
        keys.add(str(sample.key_expr))
        stamps.saw(message)
        last[:] = [message]
        if arguments.at_least and stamps.received >= arguments.at_least:
            stop.set()

    subscriber = RawSub(
        known, arguments.topic, saw, QosProfile.sensor_data(), session=node, scope=None
    )
    ready()
    if arguments.from_first:
        wait_until(lambda: stamps.received > 0 or stop.is_set(), 30.0)
    stop.wait(timeout=arguments.seconds)
    subscriber.close()
    return stamps.report() | {
        "topic": arguments.topic,
        "type": arguments.type,
        "type_hash": known.hash_rihs01(),
        "keys": sorted(keys),
        "broken": broken[:5],
        "last": as_json(last[0]) if last else None,
    }


def operator(node: pyzeros.Node, arguments: argparse.Namespace, stop: threading.Event) -> dict[str, object]:
    """Recorded hand in, force out."""
    felt = Felt(arguments.trace)
    stream = QosProfile.sensor_data()
    publisher = pyzeros.Pub(
        all_msgs.PoseStamped, "/leader/measured_cp", stream, session=node, scope=None
    )
    subscriber = RawSub(
        all_msgs.WrenchStamped,
        "/leader/servo_cf",
        lambda sample: felt.wrench(
            all_msgs.WrenchStamped.deserialize(sample.payload.to_bytes())
        ),
        stream,
        session=node,
        scope=None,
    )
    message = all_msgs.PoseStamped()
    message.header.frame_id = "leader_base"
    message.pose.orientation.w = 1.0

    def send(x: float, y: float, zero_stamp: bool) -> None:
        message.header.stamp = all_msgs.Time() if zero_stamp else stamp_now()
        message.pose.position.x = x
        message.pose.position.y = y
        publisher.publish(message)

    heard = wait_until(lambda: bool(publisher.zenoh_pub.matching_status.matching), arguments.wait)
    ready()
    report = operate(arguments, felt, send, stop)
    publisher.close()
    subscriber.close()
    return report | {"heard": heard, "key": publisher.publisher_keyexpr}


def command(node: pyzeros.Node, arguments: argparse.Namespace, _stop: threading.Event) -> dict[str, object]:
    """Sends one state command."""
    publisher = pyzeros.Pub(
        StringStamped, arguments.topic, QosProfile(depth=10), session=node, scope=None
    )
    heard = wait_until(lambda: bool(publisher.zenoh_pub.matching_status.matching), arguments.wait)
    message = StringStamped(header=all_msgs.Header(stamp=stamp_now()), string=arguments.word)
    publisher.publish(message)
    ready()
    time.sleep(0.2)
    publisher.close()
    return {"heard": heard, "key": publisher.publisher_keyexpr, "word": arguments.word}


def set_parameter(node: pyzeros.Node, arguments: argparse.Namespace, _stop: threading.Event) -> dict[str, object]:
    """Sets a parameter as `ros2 param set` does, and reads it back."""

    async def ask(kind: type, service: str, request: object) -> object:
        name = f"{arguments.node}/{service}"
        client = pyzeros.Client(kind, name, session=node, scope=None)
        try:
            await asyncio.wait_for(client.wait_for_service(), arguments.wait)
            return await asyncio.wait_for(client.call_async(request), arguments.wait)
        finally:
            client.close()

    async def value() -> str:
        request = all_srvs.GetParameters.Request(names=[arguments.name])
        told = await ask(all_srvs.GetParameters, "get_parameters", request)
        return told.values[0].string_value

    async def talk() -> dict[str, object]:
        before = await value()
        wish = all_msgs.ParameterValue(type=PARAMETER_STRING, string_value=arguments.value)
        parameter = all_msgs.Parameter(name=arguments.name, value=wish)
        request = all_srvs.SetParameters.Request(parameters=[parameter])
        told = await ask(all_srvs.SetParameters, "set_parameters", request)
        await asyncio.sleep(arguments.settle)
        return {
            "before": before,
            "successful": bool(told.results[0].successful),
            "reason": told.results[0].reason,
            "after": await value(),
        }

    ready()
    return asyncio.run(talk())


def main() -> None:
    """Runs one of the jobs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--router", default="tcp/127.0.0.1:7447")
    parser.add_argument("--config", help="a file with the whole configuration of Zenoh, in place of --router")
    parser.add_argument("--domain", type=int, default=int(os.environ.get("ROS_DOMAIN_ID", "0")))
    jobs = parser.add_subparsers(required=True)

    job = jobs.add_parser("list", help="topics, types and hashes")
    job.set_defaults(run=list_topics)

    job = jobs.add_parser("count", help="messages of one topic")
    job.add_argument("topic")
    job.add_argument("type", help="such as sensor_msgs/msg/JointState")
    add_duration(job, 5.0)
    job.add_argument("--at-least", type=int, help="stop once so many came")
    job.add_argument("--from-first", action="store_true", help="count from the first message on")
    job.set_defaults(run=count)

    job = jobs.add_parser("operator", help="recorded hand in, force out")
    add_operator(job)
    job.set_defaults(run=operator)

    job = jobs.add_parser("command", help="one CRTK state command")
    job.add_argument("topic", help="such as /follower/state_command")
    job.add_argument("word", help="enable, disable, pause or resume")
    job.add_argument("--wait", type=float, default=10.0)
    job.set_defaults(run=command)

    job = jobs.add_parser("set_parameter", help="a string parameter of a node")
    job.add_argument("node", help="full name, such as /link")
    job.add_argument("name", help="the parameter")
    job.add_argument("value", help="its new value")
    job.add_argument("--wait", type=float, default=15.0)
    job.add_argument("--settle", type=float, default=2.0, help="seconds before reading it back")
    job.set_defaults(run=set_parameter)

    arguments = parser.parse_args()
    stop = stop_on_signal()
    with zenoh_node("ferntast_test_peer", arguments.router, arguments.domain, arguments.config) as node:
        report = arguments.run(node, arguments, stop)
    print_report(report)


if __name__ == "__main__":
    main()
