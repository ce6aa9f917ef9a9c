"""Calls services of type std_srvs/srv/Trigger, one after the other, as `ros2 service call` does.

Prints JSON: a list of `service`, `success`, `message`.
"""

import argparse
import time

from arguments import print_report, ready
from ros_peer import ros_node
from std_srvs.srv import Trigger

PATIENCE = 15.0


def main() -> None:
    """Calls them and ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("services", nargs="+", metavar="SERVICE", help="such as /follower/pause")
    arguments = parser.parse_args()
    answers = []
    with ros_node("ferntast_test_trigger") as node:
        ready()
        for service in arguments.services:
            client = node.create_client(Trigger, service)
            if not client.wait_for_service(timeout_sec=PATIENCE):
                raise SystemExit(f"no service {service}")
            future = client.call_async(Trigger.Request())
            end = time.monotonic() + PATIENCE
            while not future.done():
                if time.monotonic() > end:
                    raise SystemExit(f"{service} does not answer")
                time.sleep(0.01)
            answer = future.result()
            answers.append(
                {"service": service, "success": answer.success, "message": answer.message}
            )
    print_report(answers)


if __name__ == "__main__":
    main()
