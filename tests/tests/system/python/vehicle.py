"""Participant that sets the load of the contact, a live value, as a function of time."""

from cosim import FieldKind, Grid, Layout, ModelSpec, Solver, Structured, main

LOAD = "load.normal_force"


class Vehicle(Solver):
    """Rising load."""

    name, role, standalone = "python-vehicle", "vehicle", True
    fields = (FieldKind(LOAD, "N", meaning="load on the contact"),)
    models = (
        ModelSpec("law", "a load by a law of time", "a closed form", provides=(LOAD,), transient=True),
    )

    def configure(self, configuration):
        point = Structured((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1, 1)
        return Layout([Grid("point", point)], {LOAD: "point"})

    def first_outputs(self, outputs):
        outputs[LOAD] = 100e3

    def solve(self, step, inputs, outputs):
        outputs[LOAD] = 100e3 + 10e3 * step.window

    def save(self, file):
        pass

    def restore(self, file):
        pass


main(Vehicle)
