"""Runs the commands of standard input, one a line, on a HyperQueue cluster within this process.

    coordinator sweep CASE --vary KEY=VALUES --out FOLDER --engine list | python hyperqueue_commands.py

The package `hyperqueue` has server and workers, but not the command `hq`. With a cluster that runs
already, `Client(server_dir)` in the place of `LocalCluster` submits to it; with `hq` itself,
`coordinator sweep --engine hyperqueue` does all of it.
"""

import shlex
import sys
import tempfile

from hyperqueue import Job, LocalCluster
from hyperqueue.cluster import WorkerConfig


def main() -> int:
    """Run them; 1 if one has failed."""
    commands = [shlex.split(line) for line in sys.stdin if line.strip()]
    if not commands:
        return 0
    job = Job(max_fails=None)
    for command in commands:
        job.program(command, stdout=None, stderr=None)
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalCluster(folder, WorkerConfig()) as cluster,
    ):
        client = cluster.client()
        return 0 if client.wait_for_jobs([client.submit(job)], raise_on_error=False) else 1


if __name__ == "__main__":
    sys.exit(main())
