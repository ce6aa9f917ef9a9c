"""A pyzeros node on a given Zenoh router."""

import struct
from collections.abc import Iterator
from contextlib import contextmanager

import pyzeros
import pyzeros.pub
import pyzeros.service_client
import zenoh
from ros2_pyterfaces.cyclone import all_msgs


class Attachment:
    """The attachment of rmw_zenoh: sequence number, time of sending [ns], length and bytes of the GID.

    pyzeros has one of its own, whose serializer is compiled by Cython at the
    first message: that takes half a minute and needs Python's C headers. These
    are the same bytes.
    """

    def __init__(self, sequence_number: int, source_timestamp: int, source_gid: object) -> None:
        self.sequence_number = int(sequence_number)
        self.source_timestamp = int(source_timestamp)
        self.source_gid = bytes(source_gid)

    def serialize(self) -> bytes:
        """CDR with its header of four bytes (which the caller cuts off)."""
        return b"\x00\x01\x00\x00" + struct.pack(
            "<qqB16s", self.sequence_number, self.source_timestamp, 16, self.source_gid
        )


pyzeros.pub.Attachment = Attachment
pyzeros.service_client.Attachment = Attachment


def message_class(ros_type: str) -> type:
    """The Python class of a type such as `sensor_msgs/msg/JointState`."""
    found = getattr(all_msgs, ros_type.split("/")[-1])
    if found.get_type_name() != ros_type:
        raise ValueError(f"{ros_type} is not known here, only {found.get_type_name()}")
    return found


@contextmanager
def zenoh_node(name: str, router: str, domain: int, file: str | None = None) -> Iterator[pyzeros.Node]:
    """A node, as a client of the router at `router` (such as `tcp/127.0.0.1:7447`), or as a file with a configuration of Zenoh
    says (what ZENOH_SESSION_CONFIG_URI names to rmw_zenoh)."""
    config = zenoh.Config.from_file(file) if file else zenoh.Config()
    if not file:
        config.insert_json5("mode", '"client"')
        config.insert_json5("connect/endpoints", f'["{router}"]')
        config.insert_json5("scouting/multicast/enabled", "false")
    session = zenoh.open(config)
    try:
        node = pyzeros.Node(name, session=session, domain_id=domain)
        try:
            yield node
        finally:
            node.close()
    finally:
        session.close()
