"""Short columns over several processes (MPI): rank 0 takes part in the run, the other ranks follow.

    coordinator run cases/wheel-rail.toml --set thermal.model=short --set \
        'thermal.command=["mpiexec", "-n", "4", "python3", "-m", "mpi4py", "proto/python/examples/ranks.py"]'

A role belongs to one process. Rank 0 handles the command line and the coordinator. Before any joint
work, and before it exits, rank 0 broadcasts what to do. `-m mpi4py` ends all ranks when one of them
fails.
"""

import numpy as np
from mpi4py import MPI
from short_columns import ShortColumns

from cosim import main

ALL = MPI.COMM_WORLD


class SpreadColumns(ShortColumns):
    """Distributes the strips, which are independent of each other, over the ranks."""

    def build(self):
        """Build the operator once, and send it to all ranks."""
        super().build()
        ALL.bcast(("build", self.abel))

    def solve(self, step, inputs, outputs):
        """Count the ranks that compute."""
        report = super().solve(step, inputs, outputs)
        report.work = ALL.Get_size()
        return report

    def upstream(self, rows):
        """Distribute the rows of the flux, and collect their sums."""
        ALL.bcast(("solve", None))
        return np.concatenate(share(self.abel, np.array_split(rows, ALL.Get_size())))


def share(abel, shares=None):
    """Compute one rank's share of a solve; rank 0 passes the shares and gets all results."""
    return ALL.gather(ALL.scatter(shares) @ abel)


def follow():
    """Follow the commands of rank 0 until it exits."""
    abel = None
    while True:
        command, value = ALL.bcast(None)
        match command:
            case "build":
                abel = value
            case "solve":
                share(abel)
            case "leave":
                return


if __name__ == "__main__":
    if ALL.Get_rank() > 0:
        follow()
    else:
        try:
            main(SpreadColumns)
        finally:
            ALL.bcast(("leave", None))
