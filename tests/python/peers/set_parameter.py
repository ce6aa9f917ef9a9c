"""Sets a parameter of a node as `ros2 param set` does, and reads it back.

Prints JSON: `successful` and `reason` as the node answered, `before` and `after`
as it tells the value, `described` the names that it lists.
"""

import argparse
import time

from arguments import print_report, ready
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from ros_peer import ros_node

PATIENCE = 15.0


def main() -> None:
    """Sets it and ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--node", required=True, help="full name of the node, such as /link")
    parser.add_argument("--name", required=True, help="the parameter")
    parser.add_argument("--value", required=True, help="its new value, a string")
    parser.add_argument("--settle", type=float, default=2.0, help="seconds before reading it back")
    arguments = parser.parse_args()
    with ros_node("ferntast_test_parameters") as node:

        def ask(kind: type, service: str, request: object) -> object:
            client = node.create_client(kind, f"{arguments.node}/{service}")
            if not client.wait_for_service(timeout_sec=PATIENCE):
                raise SystemExit(f"no service {arguments.node}/{service}")
            future = client.call_async(request)
            end = time.monotonic() + PATIENCE
            while not future.done():
                if time.monotonic() > end:
                    raise SystemExit(f"{arguments.node}/{service} does not answer")
                time.sleep(0.01)
            return future.result()

        def value() -> str:
            request = GetParameters.Request(names=[arguments.name])
            return ask(GetParameters, "get_parameters", request).values[0].string_value

        ready()
        before = value()
        wish = ParameterValue(
            type=ParameterType.PARAMETER_STRING, string_value=arguments.value
        )
        request = SetParameters.Request(parameters=[Parameter(name=arguments.name, value=wish)])
        result = ask(SetParameters, "set_parameters", request).results[0]
        listed = ask(ListParameters, "list_parameters", ListParameters.Request()).result.names
        time.sleep(arguments.settle)
        after = value()
    print_report(
        {
            "successful": result.successful,
            "reason": result.reason,
            "before": before,
            "after": after,
            "listed": list(listed),
        }
    )


if __name__ == "__main__":
    main()
