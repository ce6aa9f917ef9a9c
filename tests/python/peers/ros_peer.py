"""A stock rclpy node, spun in a thread of its own, or read by the caller's loop."""

import importlib
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription

# As a CRTK servo stream is read: newest wins. The queue is deeper than the
# publisher's, so that a counting subscriber loses nothing while Python dawdles.
STREAM = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=200,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
)
STATE = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
# Reliable, but takes volatile publishers too.
EVENT = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=200,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)
QOS = {"stream": STREAM, "state": STATE, "event": EVENT}


def message_class(ros_type: str) -> type:
    """The Python class of a type such as `sensor_msgs/msg/JointState`."""
    package, kind, name = ros_type.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)


@contextmanager
def quiet_node(name: str) -> Iterator[Node]:
    """A node that nothing spins: its caller takes what comes, by `take`."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(name)
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


def take(subscription: Subscription) -> None:
    """Gives the callback of a subscription of a `quiet_node` what has come.

    For loops that have to be in time: an executor that is busy in a thread beside them holds
    Python's lock for 5 ms at a time.
    """
    with subscription.handle:
        while (taken := subscription.handle.take_message(subscription.msg_type, False)) is not None:
            message, _ = taken
            subscription.callback(message)


@contextmanager
def ros_node(name: str) -> Iterator[Node]:
    """A node whose callbacks run in a thread beside the caller's."""
    with quiet_node(name) as node:
        executor = SingleThreadedExecutor()
        executor.add_node(node)

        def spin() -> None:
            try:
                executor.spin()
            except ExternalShutdownException:
                pass

        thread = threading.Thread(target=spin, daemon=True)
        thread.start()
        try:
            yield node
        finally:
            executor.shutdown()
            thread.join(timeout=2.0)
