"""Runs the commands on standard input, one per line, on a HyperQueue cluster within this process.

    coordinator sweep CASE --vary KEY=VALUES --out FOLDER --engine list | python hyperqueue_commands.py

The package `hyperqueue` contains server and workers, but not the command `hq`. To submit to a
running cluster, use `Client(server_dir)` instead of `LocalCluster`. If `hq` is available,
`coordinator sweep --engine hyperqueue` does everything by itself.
"""

import shlex
import sys
import tempfile

from hyperqueue import Job, LocalCluster
from hyperqueue.cluster import WorkerConfig


def main() -> int:
    """Run the commands; return 1 if any has failed."""
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
