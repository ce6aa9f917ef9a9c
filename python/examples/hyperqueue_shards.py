"""Runs a study of ferntast in parts on HyperQueue, and puts the parts together.

    pip install hyperqueue
    python hyperqueue_shards.py 8 sweep delay_sweep

Without --server it starts a server and a worker of its own on this machine, for a try. On a
cluster there is one already (`hq server start`, workers by `hq alloc add slurm …`): name its
folder with --server, and give a folder that all workers see with --folder.
"""

import argparse
import contextlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

from hyperqueue import Job, LocalCluster
from hyperqueue.client import Client, FailedJobsException
from hyperqueue.cluster import WorkerConfig


@contextlib.contextmanager
def stdout_on_stderr():
    """A worker says on stdout what it is; stdout is for the result."""
    kept = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


@contextlib.contextmanager
def client_of(server: Path | None):
    """A client of the server there, or of one of our own with a worker of all processors."""
    if server is not None:
        yield Client(server)
        return
    with LocalCluster() as cluster:
        cluster.start_worker(WorkerConfig())
        yield cluster.client()


def run_in_parts(client: Client, program: str, study: list[str], count: int, folder: Path) -> list[Path]:
    """Has every part of the study answered by a task of its own; gives the parts' files."""
    job = Job(default_workdir=Path.cwd())
    parts = [folder / f"part_{number}_of_{count}.toml" for number in range(1, count + 1)]
    for number, part in enumerate(parts, start=1):
        job.program(
            [program, *study, "--shard", f"{number}/{count}", "--part", str(part)],
            stdout=part.with_suffix(".out"),
            stderr=part.with_suffix(".err"),
        )
    client.wait_for_jobs([client.submit(job)])
    return parts


def main() -> int:
    arguments = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    arguments.add_argument("--server", type=Path, help="folder of a server that is there already")
    arguments.add_argument("--folder", type=Path, default=Path("parts"), help="folder of the parts")
    arguments.add_argument("--program", default=shutil.which("ferntast"), help="the command ferntast")
    arguments.add_argument("--output", help="what `ferntast merge` takes as -o")
    arguments.add_argument("count", type=int, help="parts")
    arguments.add_argument("study", nargs=argparse.REMAINDER, help="sweep, faults, challenge blind, …")
    given = arguments.parse_args()
    if given.program is None:
        sys.exit("no command ferntast on the path: name it with --program")
    given.folder.mkdir(parents=True, exist_ok=True)
    with stdout_on_stderr(), client_of(given.server) as client:
        try:
            parts = run_in_parts(client, given.program, given.study, given.count, given.folder.resolve())
        except FailedJobsException as error:
            sys.exit(f"{error}")
    output = ["-o", given.output] if given.output else []
    return subprocess.run([given.program, "merge", *parts, *output, "--json"], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
