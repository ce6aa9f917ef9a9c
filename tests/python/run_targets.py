"""Runs the workspace's test programs two at a time, for tests/run.

`cargo test` runs one program after the other, so that a processor idles while one waits for
real time. Here one that waits runs beside one that computes, which yields to it (`nice`);
what measures milliseconds runs at last and alone. What a program says is printed in a piece
when it has ended, in the form of `cargo test`, and added to the log that count_results.py
reads. Exit code: 1 if a Rust test failed, 2 if one in Python did, 3 if both.
"""

import argparse
import json
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

# Tests in Python: with their own results, and their own bit of the exit code.
PYTHON = ("python", "python lerobot")
# Judged in milliseconds: nothing runs beside them.
ALONE = ("timing", "live_faults")
# Wait for real time or for peers most of the time, the longest first. All others compute.
WAITING = (
    "live", *PYTHON, "conformance", "dds_memory", "killed", "link_tls", "router_tls", "mcap_bus",
    "motors", "process", "motor_sdks", "feetech", "topics", "limits", "leader",
)  # fmt: skip
# Compute for long, the longest first.
LONG = ("offline", "judged", "true_ports", "planted bugs", "doc tests")
# Sessions at once: half of a processor each, and the page's browser more at times.
SESSIONS = max(3, 3 * (os.cpu_count() or 2) // 2)
# How far what computes steps back.
NICENESS = "10"
# Of what is over sooner nothing is told, nor of silence that is shorter [s].
SHORT = 3.0
SILENCE = 60.0


class Job(NamedTuple):
    """A program with tests."""

    name: str
    # As `cargo test` announces it; empty where the program does so itself.
    headline: str
    command: list[str]
    folder: Path

    def rank(self, names: tuple[str, ...]) -> int:
        """Its place among `names`; after them if it is not there."""
        return names.index(self.name) if self.name in names else len(names)


def programs(messages: str, arguments: list[str]) -> Iterator[Job]:
    """What `cargo test --no-run --message-format=json` built, with these arguments."""
    for line in messages.splitlines():
        built = json.loads(line)
        if not built.get("executable") or not built.get("profile", {}).get("test"):
            continue
        folder, target = Path(built["manifest_path"]).parent, built["target"]
        unit = "" if target["kind"] == ["test"] else "unittests "
        source = Path(target["src_path"]).relative_to(folder)
        yield Job(
            target["name"],
            f"     Running {unit}{source} ({built['executable']})\n",
            [built["executable"], *arguments],
            folder,
        )


def libraries() -> str:
    """Where a test of a procedural macro finds the compiler's libraries."""
    asked = subprocess.run(["rustc", "--print", "target-libdir"], capture_output=True, text=True)
    folders = [asked.stdout.strip(), os.environ.get("LD_LIBRARY_PATH", "")]
    return os.pathsep.join(own for own in folders if own)


def descendants(process: int) -> set[int]:
    """A process and all that it started, also what outlived its parent, by the test's mark."""
    parents: dict[int, list[int]] = {}
    marked: set[int] = set()
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            environment = (entry / "environ").read_bytes()
        except (OSError, ValueError):
            continue  # Gone, or not ours.
        parents.setdefault(parent, []).append(int(entry.name))
        if f"FERNTAST_TEST_SESSION=test-{process}-".encode() in environment:
            marked.add(int(entry.name))
    found, waiting = set(), [process, *marked]
    while waiting:
        own = waiting.pop()
        if own not in found:
            found.add(own)
            waiting.extend(parents.get(own, []))
    return found


class Runner:
    """Runs jobs, prints what they said, and remembers which failed."""

    def __init__(self, log: Path, environment: dict[str, str]) -> None:
        self.log = log
        self.environment = environment
        self.lock = threading.Lock()
        self.running: dict[int, str] = {}
        self.failed: list[str] = []
        self.begun = self.told = time.monotonic()
        self.ended = self.count = 0
        self.stopped = False

    def run(self, job: Job, nice: bool) -> None:
        """Runs a job to its end."""
        command = ["nice", "-n", NICENESS, *job.command] if nice else job.command
        environment = self.environment
        if job.name == "live":
            environment = {"RUST_TEST_THREADS": str(SESSIONS)} | environment
        with tempfile.TemporaryFile() as output:
            with self.lock:
                if self.stopped:
                    return
                # A group of its own, that Ctrl-C comes to `stop` first; but no session of its own,
                # in which the kernel may set niceness aside (sched_autogroup_enabled).
                process = subprocess.Popen(
                    command, cwd=job.folder, env=environment, preexec_fn=os.setpgrp,
                    stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                )  # fmt: skip
                self.running[process.pid] = job.name
            begun = time.monotonic()
            _, status, used = os.wait4(process.pid, 0)
            code = os.waitstatus_to_exitcode(status)
            process.returncode = code
            output.seek(0)
            text = job.headline + output.read().decode(errors="replace")
        with self.lock:
            del self.running[process.pid]
            self.ended += 1
            if code != 0:
                self.failed.append(job.name)
            if self.stopped:
                return
            if code < 0:
                text += f"error: {job.name} was ended by signal {-code}\n"
            print(text, end="", flush=True)
            if job.name not in PYTHON:
                with self.log.open("a") as log:
                    log.write(text)
            took = time.monotonic() - begun
            if took > SHORT:
                own = used.ru_utime + used.ru_stime
                self.tell(f"{job.name} took {took:.0f} s and {own:.0f} s of a processor; ")

    def tell(self, what: str = "") -> None:
        """Tells how far it is."""
        self.told = time.monotonic()
        beside = f", {', '.join(self.running.values())} running" if self.running else ""
        print(
            f"tests/run: {what}{self.ended} of {self.count} programs done after "
            f"{self.told - self.begun:.0f} s{beside}",
            file=sys.stderr,
            flush=True,
        )

    def side_by_side(self, waiting: list[Job], busy: list[Job]) -> None:
        """What waits beside what computes; whoever has done its part helps the other."""
        others = [(busy, True), (waiting, False)]

        def work(queues: list[tuple[list[Job], bool]]) -> None:
            while True:
                with self.lock:
                    queue, nice = next(((own, n) for own, n in queues if own), (None, False))
                    if queue is None:
                        return
                    job = queue.pop(0)
                self.run(job, nice)

        orders = [others[::-1], others]
        workers = [threading.Thread(target=work, args=(own,), daemon=True) for own in orders]
        for worker in workers:
            worker.start()
        for worker in workers:
            while worker.is_alive():
                worker.join(timeout=1.0)
                with self.lock:
                    if time.monotonic() - self.told > SILENCE:
                        self.tell()

    def stop(self) -> None:
        """Kills what runs, and all that it started."""
        with self.lock:
            self.stopped = True
            jobs = list(self.running)
        for job in jobs:
            for process in descendants(job):
                try:
                    os.kill(process, signal.SIGKILL)
                except ProcessLookupError:
                    pass


def sorted_by(names: tuple[str, ...], jobs: Iterable[Job]) -> list[Job]:
    """The jobs, those among `names` first, in that order."""
    return sorted(jobs, key=lambda job: job.rank(names))


def main() -> int:
    """Runs what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--messages", type=Path, required=True, help="of cargo test --no-run")
    parser.add_argument("--log", type=Path, required=True, help="is added to")
    parser.add_argument("--also", nargs=2, action="append", default=[], metavar=("NAME", "COMMAND"))
    parser.add_argument("arguments", nargs="*", help="of each program")
    arguments = parser.parse_args()
    jobs = list(programs(arguments.messages.read_text(), arguments.arguments))
    for name, command in arguments.also:
        jobs.append(Job(name, "", shlex.split(command), Path.cwd()))
    runner = Runner(arguments.log, os.environ | {"LD_LIBRARY_PATH": libraries()})
    runner.count = len(jobs)
    alone = [job for job in jobs if job.name in ALONE]
    waiting = [job for job in jobs if job.name in WAITING]
    busy = [job for job in jobs if job.name not in ALONE + WAITING]
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)
    try:
        runner.side_by_side(sorted_by(WAITING, waiting), sorted_by(LONG, busy))
        for job in sorted_by(ALONE, alone):
            runner.run(job, nice=False)
    except KeyboardInterrupt:
        runner.stop()
        # As whoever started this expects of it.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGINT)
    python = any(name in PYTHON for name in runner.failed)
    rust = any(name not in PYTHON for name in runner.failed)
    return rust + 2 * python


if __name__ == "__main__":
    sys.exit(main())
