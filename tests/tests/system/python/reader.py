"""Participant that consumes a field of a volume, which no case allows."""

from cosim import Layout, ModelSpec, Solver, StepReport, main


class Reader(Solver):
    """Reads and says nothing."""

    name = role = "reader"
    standalone = True
    models = (ModelSpec("mean", "a mean", "none", True, True, ("volume_temperature",), ()),)

    def configure(self, configuration):
        return Layout()

    def solve(self, step, inputs, outputs):
        return StepReport()


main(Reader)
