"""Opens a recording (rosbag2 directory) with `rosbags` and `mcap-ros2-support`, unaided.

Neither is told of our message definitions: both take them from the recording.
Prints JSON: `rosbags` = {topics: {name: {type, hash, count, qos, first_ns, last_ns,
first, last}}, duration_s, message_count}, `mcap` = {topics: {name: {type, count,
first, last}}, profile, library, metadata: names of the metadata records}. Fails,
with the library's message, if either refuses the recording.
"""

import argparse
from pathlib import Path

from arguments import print_report
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from message_json import as_json
from rosbags.highlevel import AnyReader


def with_rosbags(directory: Path) -> dict[str, object]:
    """What rosbags reads."""
    with AnyReader([directory]) as reader:
        topics: dict[str, dict[str, object]] = {}
        for connection in reader.connections:
            qos = getattr(connection.ext, "offered_qos_profiles", [])
            topics[connection.topic] = {
                "type": connection.msgtype,
                "hash": connection.digest,
                "count": 0,
                "declared_count": connection.msgcount,
                "qos": [as_json(vars(profile)) if hasattr(profile, "__dict__") else str(profile)
                        for profile in qos],
            }
        for connection, time, data in reader.messages():
            entry = topics[connection.topic]
            message = reader.deserialize(data, connection.msgtype)
            if entry["count"] == 0:
                entry["first_ns"] = time
                entry["first"] = as_json(message)
            entry["count"] += 1
            entry["last_ns"] = time
            entry["last"] = message
        for entry in topics.values():
            entry["last"] = as_json(entry.get("last"))
        return {
            "topics": topics,
            "duration_s": reader.duration / 1e9,
            "message_count": reader.message_count,
        }


def with_mcap(directory: Path) -> dict[str, object]:
    """What mcap-ros2-support reads."""
    topics: dict[str, dict[str, object]] = {}
    metadata: list[str] = []
    header = None
    for path in sorted(directory.glob("*.mcap")):
        with path.open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            header = reader.get_header()
            metadata += [record.name for record in reader.iter_metadata()]
            for schema, channel, _, message in reader.iter_decoded_messages():
                entry = topics.setdefault(
                    channel.topic,
                    {
                        "type": schema.name,
                        "count": 0,
                        "first": as_json(message),
                        "channel": dict(channel.metadata),
                    },
                )
                entry["count"] += 1
                entry["last"] = message
    if header is None:
        raise FileNotFoundError(f"no .mcap in {directory}")
    for entry in topics.values():
        entry["last"] = as_json(entry["last"])
    return {
        "topics": topics,
        "profile": header.profile,
        "library": header.library,
        "metadata": metadata,
    }


def main() -> None:
    """Opens, reads all, prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=Path)
    arguments = parser.parse_args()
    print_report(
        {"rosbags": with_rosbags(arguments.directory), "mcap": with_mcap(arguments.directory)}
    )


if __name__ == "__main__":
    main()
