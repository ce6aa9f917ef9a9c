"""Starts a session of ferntast.

    ros2 launch ferntast_msgs session.launch.py hand:=crtk namespace:=left record:=recordings/first
    ros2 launch ferntast_msgs session.launch.py --show-args

The command `ferntast` has to be on the path, or named by program:=…. Ctrl-C ends the session
cleanly: the arm holds, the recording is closed.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, ExecuteProcess, OpaqueFunction
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration

# Options of `ferntast session`, with what `--help` says of them in short.
OPTIONS = {
    "scenario": "a scenario that comes along, or a file",
    "arm": "another arm than the scenario's: a name, a file or a URDF",
    "driver": "what is behind the arm's topics: simulated, or a driver",
    "hand": "whose hand: scripted, crtk (a CRTK client on ROS 2), or a CSV file",
    "link": "channel between operator and arm: a name or a file",
    "law": "delay law to start with",
    "middleware": "how ROS 2 is reached: dds or zenoh",
    "domain": "ROS domain, else ROS_DOMAIN_ID",
    "namespace": "namespace of all topics, nodes and services",
    "record": "folder of the recording, which must not exist yet",
    "duration": "seconds after which the session ends",
    "session": "its name on this host; two at once need two",
}


def start(context: LaunchContext) -> list:
    """The session, with the options that were given."""
    value = {name: LaunchConfiguration(name).perform(context) for name in ["program", "arguments", *OPTIONS]}
    command = [value["program"], "session"]
    for name in OPTIONS:
        if value[name]:
            command += [f"--{name}", value[name]]
    command += value["arguments"].split()
    # Time to hold the arm and to close the recording.
    session = ExecuteProcess(
        cmd=command,
        output="screen",
        sigterm_timeout="10",
        on_exit=EmitEvent(event=Shutdown(reason="the session has ended")),
    )
    return [session]


def generate_launch_description() -> LaunchDescription:
    """What `ros2 launch` runs."""
    arguments = [
        DeclareLaunchArgument("program", default_value="ferntast", description="the command"),
        DeclareLaunchArgument("arguments", default_value="", description="further options, as on the command line"),
    ]
    arguments += [
        DeclareLaunchArgument(name, default_value="", description=what) for name, what in OPTIONS.items()
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=start)])
