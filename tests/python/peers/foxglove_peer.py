"""Watches a session as Foxglove does: over its WebSocket, told of nothing.

Takes schemas from what the server advertises, subscribes to everything, and prints JSON:
{server: name, capabilities, topics: {name: {type, count, seconds, first, last}}}, seconds
from the first to the last by the server's clock.
"""

import argparse
import asyncio
import json
import struct
import time

from arguments import add_duration, print_report
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory
from message_json import as_json
from websockets.asyncio.client import connect

MESSAGE_DATA = 1


async def watch(url: str, seconds: float) -> dict[str, object]:
    """What comes within `seconds`."""
    topics: dict[str, dict[str, object]] = {}
    readers = []
    began: dict[int, int] = {}
    report: dict[str, object] = {"topics": topics}
    async with connect(url, subprotocols=["foxglove.sdk.v1"], max_size=None) as socket:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            try:
                frame = await asyncio.wait_for(socket.recv(), left)
            except TimeoutError:
                break
            if isinstance(frame, str):
                said = json.loads(frame)
                if said["op"] == "serverInfo":
                    report |= {"server": said["name"], "capabilities": said["capabilities"]}
                if said["op"] != "advertise":
                    continue
                wanted = []
                for channel in said["channels"]:
                    schema = Schema(
                        id=channel["id"],
                        name=channel["schemaName"],
                        encoding=channel["schemaEncoding"],
                        data=channel["schema"].encode(),
                    )
                    wanted.append({"id": len(readers), "channelId": channel["id"]})
                    decode = DecoderFactory().decoder_for(channel["encoding"], schema)
                    entry: dict[str, object] = {"type": schema.name, "count": 0, "seconds": 0.0}
                    topics[channel["topic"]] = entry
                    readers.append((decode, entry))
                await socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
            elif frame[0] == MESSAGE_DATA:
                subscription, nanoseconds = struct.unpack_from("<IQ", frame, 1)
                decode, entry = readers[subscription]
                began.setdefault(subscription, nanoseconds)
                entry["seconds"] = (nanoseconds - began[subscription]) * 1e-9
                message = as_json(decode(frame[13:]))
                entry.setdefault("first", message)
                entry["last"] = message
                entry["count"] += 1
    return report


def main() -> None:
    """Watches, prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("url", help="ws://127.0.0.1:PORT")
    add_duration(parser, 3.0)
    arguments = parser.parse_args()
    print_report(asyncio.run(watch(arguments.url, arguments.seconds)))


if __name__ == "__main__":
    main()
