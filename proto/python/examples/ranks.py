"""Short columns over several processes (MPI): rank 0 takes part in the run, the others follow it.

    coordinator run cases/wheel-rail.toml --set thermal.model=short --set \
        'thermal.command=["mpiexec", "-n", "4", "python3", "-m", "mpi4py", "proto/python/examples/ranks.py"]'

One process plays a role. Rank 0 answers the command line and the coordinator; before it begins
something that all take part in, it tells the others by broadcast what that is, and so that it leaves.
`-m mpi4py` ends all ranks when one of them fails.
"""

import numpy as np
from mpi4py import MPI
from short_columns import ShortColumns

from cosim import StepReport, main

ALL = MPI.COMM_WORLD


class SpreadColumns(ShortColumns):
    """Strips do not depend on each other: every rank computes its share of them."""

    def build(self):
        """The operator is made once, and is the same for all."""
        super().build()
        ALL.bcast(("build", self.abel))

    def solve(self, step, inputs, outputs):
        """Spread the flux, and collect the temperature."""
        flux = inputs.finite("friction_power")
        shares = np.array_split(flux.reshape(self.grid.shape.nj, -1), ALL.Get_size())
        ALL.bcast(("solve", None))
        computed = share(self.abel, shares)
        self.sums = np.concatenate(computed)
        for name in outputs:
            outputs[name] = self.scale[name] * self.sums.ravel()
        return StepReport(work=len(computed), heat_received=self.grid.integrate(flux))


def share(abel, shares=None):
    """What every rank does in a solve; rank 0 has the shares, and gets what all have computed."""
    return ALL.gather(ALL.scatter(shares) @ abel)


def follow():
    """Do what rank 0 says until it leaves."""
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
