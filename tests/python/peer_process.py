"""Starts a peer as a process of its own, and reads its report."""

import json
import os
import selectors
import signal
import subprocess
import sys
import time
from pathlib import Path

from ros_environment import ros_environment

PEERS = Path(__file__).resolve().parent / "peers"


class Peer:
    """A script of `peers/`, in a process group of its own that `close` ends."""

    def __init__(self, script: str, *arguments: object, domain: int) -> None:
        self.name = script
        command = [sys.executable, str(PEERS / script), *map(str, arguments)]
        self.process = subprocess.Popen(
            command,
            env=ros_environment(domain),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        self._errors = ""

    def __enter__(self) -> "Peer":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def await_ready(self, seconds: float = 30.0) -> None:
        """Returns when the peer says that it is connected."""
        end = time.monotonic() + seconds
        with selectors.DefaultSelector() as selector:
            selector.register(self.process.stderr, selectors.EVENT_READ)
            while time.monotonic() < end:
                if not selector.select(timeout=0.1):
                    continue
                line = self.process.stderr.readline()
                self._errors += line
                if line.strip() == "ready":
                    return
                if not line:
                    break
        raise AssertionError(f"{self.name} is not ready:\n{self._errors}")

    def interrupt(self) -> None:
        """As Ctrl-C does."""
        self.process.send_signal(signal.SIGINT)

    def report(self, seconds: float = 60.0, status: int = 0) -> dict:
        """The JSON that the peer prints at its end."""
        output, errors = self.process.communicate(timeout=seconds)
        assert self.process.returncode == status, (
            f"{self.name} ended with {self.process.returncode}:\n{output}\n{self._errors}{errors}"
        )
        return json.loads(output)

    def close(self) -> None:
        """Ends the process and all it started."""
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()


def run_peer(script: str, *arguments: object, domain: int, seconds: float = 60.0) -> dict:
    """Runs a peer to its end; its report."""
    with Peer(script, *arguments, domain=domain) as peer:
        return peer.report(seconds)
