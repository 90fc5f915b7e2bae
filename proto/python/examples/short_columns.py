import struct

import numpy as np

from cosim import Effect, Figure, Key, Layout, ModelSpec, Solver, StepReport, main

BODIES = ("lower_temperature", "upper_temperature")
STEEL = {"density": "kg/m3", "specific_heat": "J/(kg K)", "conductivity": "W/(m K)"}
RISE = Figure("temperature.*.max_rise_k", "K", "temperature rise", line="*", headline=True, rank=1)
HALF = Key.choice("effects.friction_heat.partition", ("equal",), "one half each", default="equal")


class ShortColumns(Solver):
    """T(x) = 1/(β√(πV)) ∫ q/2 dx'/√(x' - x) upstream, in strips, q constant over elements."""

    name = "short-columns"
    role = "thermal"
    models = (
        ModelSpec("short", "Abel's integral", "Jaeger", True, False, ("friction_power",), BODIES),
    )
    effects = (Effect("friction_heat", "q/2 into each body", "symmetry", ("short",), keys=(HALF,)),)
    keys = (
        Key.position(),
        Key.name_in("bodies.*.material", "materials", "material of the body", required=True),
        Key.quantity("motion.speed", "m/s", "rolling speed", required=True, above=0.0),
        *(Key.quantity(f"materials.*.{p}", u, p, required=True) for p, u in STEEL.items()),
    )
    figures = (RISE,)

    def configure(self, configuration):
        case, number = configuration.case, configuration.case.number
        speed = number("motion.speed")
        self.bodies = dict(zip(BODIES, reversed(case.bodies())))
        steels = {name: case.text(f"bodies.{body}.material") for name, body in self.bodies.items()}
        self.scale = {
            name: np.prod([np.pi * speed, *(number(f"materials.{steel}.{p}") for p in STEEL)]) ** -0.5
            for name, steel in steels.items()
        }
        self.grid = configuration.input("friction_power").grid
        if self.grid is None:  # while planning
            return Layout()
        return Layout([self.grid], dict.fromkeys(BODIES, self.grid.name))

    def build(self):
        plane = self.grid.shape
        upstream = (np.arange(plane.ni)[:, None] - np.arange(plane.ni)) * plane.dx
        far, near = (np.sqrt(np.maximum(upstream + d * plane.dx, 0.0)) for d in (0.5, -0.5))
        self.abel, self.peak = far - near, 0.0

    def solve(self, step, inputs, outputs):
        flux = inputs.finite("friction_power")  # a read-only view; NaN is refused by name
        self.sums = flux.reshape(self.grid.shape.nj, -1) @ self.abel
        for name in outputs:
            outputs[name] = self.scale[name] * self.sums.ravel()
        return StepReport(heat_received=self.grid.integrate(flux))

    def accept(self):
        self.peak = float(self.sums.max())

    def summary(self):
        rises = {body: {"max_rise_k": self.scale[name] * self.peak} for name, body in self.bodies.items()}
        return {"temperature": rises}

    def save(self, file):
        file.write(struct.pack("d", self.peak))

    def restore(self, file):
        (self.peak,) = struct.unpack("d", file.read())


if __name__ == "__main__":
    main(ShortColumns)
