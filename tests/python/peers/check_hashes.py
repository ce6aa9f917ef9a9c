"""Compares RIHS01 hashes with those of `rosbags` and of the ROS 2 wheels.

Reads JSON [{name, hash, schema}], or {interfaces: [...]} as `ferntast interfaces
--json` prints it, from a file ("-": stdin): `name` such as
`sensor_msgs/msg/JointState`; `schema` the text of the definition with those it
needs, as it stands in an MCAP file (`ros2msg`). Prints JSON: `checked`, by name
{hash, rosbags, wheel (None where no wheel has the type)}; `wrong`, a list of
texts. Exit code 1 if anything is wrong.
"""

import argparse
import json
import sys
from pathlib import Path

from arguments import print_report
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

SEPARATOR = "=" * 80


def definitions(name: str, schema: str) -> dict[str, object]:
    """Every type in a schema with its parts, parsed by rosbags."""
    first, *parts = schema.split(f"{SEPARATOR}\n")
    types = dict(get_types_from_msg(first, name))
    for part in parts:
        head, _, body = part.partition("\n")
        package, _, short = head.removeprefix("MSG: ").strip().rpartition("/")
        full = f"{package}/{short}" if package.endswith("/msg") else f"{package}/msg/{short}"
        types |= get_types_from_msg(body, full)
    return types


def hash_by_rosbags(name: str, schema: str) -> str:
    """From nothing but the schema: rosbags' own definitions are left out."""
    store = get_typestore(Stores.EMPTY)
    store.register(definitions(name, schema))
    return store.hash_rihs01(name)


def hash_in_wheel(name: str) -> str | None:
    """As ROS 2's own generator wrote it when the wheel was built."""
    package, kind, short = name.split("/")
    path = Path(sys.prefix) / "share" / package / kind / f"{short}.json"
    if not path.exists():
        return None
    for entry in json.loads(path.read_text())["type_hashes"]:
        if entry["type_name"] == name:
            return entry["hash_string"]
    return None


def check(entries: list[dict[str, str]]) -> dict[str, object]:
    """Compares every entry; see above."""
    checked: dict[str, dict[str, str | None]] = {}
    wrong: list[str] = []
    for entry in entries:
        name, ours = entry["name"], entry["hash"]
        others = {
            "rosbags": hash_by_rosbags(name, entry["schema"]),
            "wheel": hash_in_wheel(name),
        }
        checked[name] = {"hash": ours} | others
        for who, theirs in others.items():
            if theirs is not None and theirs != ours:
                wrong.append(f"{name}: ours is {ours}, {who} says {theirs}")
    if not checked:
        wrong.append("no types to check")
    return {"checked": checked, "wrong": wrong}


def main() -> int:
    """Reads, compares, prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", help='JSON, or "-" for stdin')
    arguments = parser.parse_args()
    text = sys.stdin.read() if arguments.file == "-" else Path(arguments.file).read_text()
    entries = json.loads(text)
    report = check(entries["interfaces"] if isinstance(entries, dict) else entries)
    print_report(report)
    return int(bool(report["wrong"]))


if __name__ == "__main__":
    sys.exit(main())
