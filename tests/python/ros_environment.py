"""The environment in which the ROS 2 wheels run without a ROS installation.

What they need, found by trying:

* Shared libraries lie in `<venv>/lib` and in `site-packages/ros_*.libs`, so
  `LD_LIBRARY_PATH` must name these. The wheel `ros-wheels-bootstrapper` sees to
  it: at start, Python executes itself once more with that path, and marks the
  second round by `_ROS_WHEELS_BOOTSTRAP_COMPLETE`. Therefore a child must get
  neither that mark nor the path from its parent.
* `AMENT_PREFIX_PATH` and `RMW_IMPLEMENTATION` are not needed; they are set here
  all the same, so that a ROS installation that happens to be sourced does not
  mix its libraries with those of the wheels.
"""

import fcntl
import functools
import itertools
import os
import socket
import sys
import tempfile
from pathlib import Path
from typing import TextIO

# The environment of a sourced ROS installation, and the mark of the bootstrapper.
FOREIGN = (
    "_ROS_WHEELS_BOOTSTRAP_COMPLETE",
    "AMENT_PREFIX_PATH",
    "CMAKE_PREFIX_PATH",
    "COLCON_PREFIX_PATH",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "LD_LIBRARY_PATH",
    "PYTHONHOME",
    "PYTHONPATH",
    "RMW_IMPLEMENTATION",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_DISCOVERY_SERVER",
    "ROS_DISTRO",
    "ROS_DOMAIN_ID",
    "ROS_LOCALHOST_ONLY",
    "ROS_PYTHON_VERSION",
    "ROS_SECURITY_ENABLE",
    "ROS_STATIC_PEERS",
    "ROS_VERSION",
    "ZENOH_SESSION_CONFIG_URI",
)

# Above domain 100 the ports of DDS (7400 + 250 a domain) reach the range from
# which Linux hands out ephemeral ports (32768 and up).
DOMAINS = range(1, 101)


def clean_environment() -> dict[str, str]:
    """This process's environment without any trace of ROS: for our own processes."""
    return {name: value for name, value in os.environ.items() if name not in FOREIGN}


def ros_environment(domain: int) -> dict[str, str]:
    """The environment of a stock ROS 2 (Fast DDS) peer in ROS domain `domain`."""
    if domain not in DOMAINS:
        raise ValueError(f"ROS domain {domain} is outside {DOMAINS.start}..={DOMAINS.stop - 1}")
    environment = clean_environment()
    environment["AMENT_PREFIX_PATH"] = sys.prefix
    environment["RMW_IMPLEMENTATION"] = "rmw_fastrtps_cpp"
    environment["ROS_DOMAIN_ID"] = str(domain)
    environment["ROS_LOG_DIR"] = str(Path(tempfile.gettempdir()) / "ferntast-tests-ros-log")
    return environment


def try_lock(name: str) -> TextIO | None:
    """The file of that name, locked until it is closed or the process dies; None where another
    test holds it. The Rust tests lock the same files.
    """
    handle = (Path(tempfile.gettempdir()) / name).open("w")
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        handle.close()
        return None
    return handle


class Domain:
    """A ROS domain that no other test holds, given back by `release`."""

    def __init__(self) -> None:
        for offset in range(len(DOMAINS)):
            number = DOMAINS[(os.getpid() + offset) % len(DOMAINS)]
            handle = try_lock(f"ferntast-tests-domain-{number}.lock")
            if handle is None:
                continue
            self.number = number
            self._handle = handle
            return
        raise RuntimeError(f"all {len(DOMAINS)} ROS domains are taken by other tests")

    def release(self) -> None:
        """Gives the domain back."""
        self._handle.close()


class Ports:
    """A block of TCP ports that no other test holds, until this process ends.

    Below those that Linux hands out by itself: any connection that a process of this machine
    opens could take one of these before it is used.
    """

    def __init__(self) -> None:
        for block, first in enumerate(range(1400, 7400, 200)):
            handle = try_lock(f"ferntast-tests-ports-{block}.lock")
            if handle is None:
                continue
            self._ports = itertools.cycle(range(first, first + 200))
            self._handle = handle
            return
        raise RuntimeError("all blocks of TCP ports are taken by other tests")

    def next(self) -> int:
        """The next one that nobody listens at."""
        for port in itertools.islice(self._ports, 200):
            with socket.socket() as listener:
                try:
                    listener.bind(("127.0.0.1", port))
                except OSError:
                    continue
                return port
        raise RuntimeError("no free TCP port")


@functools.cache
def _ports() -> Ports:
    return Ports()


def free_tcp_port() -> int:
    """A TCP port on the loopback interface that is free, and that no other test gets."""
    return _ports().next()

