import struct

import numpy as np

from cosim import Effect, Figure, Key, Layout, ModelSpec, Solver, StepReport, main

INPUTS = ("friction_power", "surface_speed")
BODIES = ("lower_temperature", "upper_temperature")
STEEL = {"density": "kg/m3", "specific_heat": "J/(kg K)", "conductivity": "W/(m K)"}
RISE = Figure(
    "temperature.*.max_rise_k", "K", "temperature rise", "*", style="signed", headline=True, rank=1
)
HALF = Key.choice("effects.friction_heat.partition", ("equal",), "one half each", default="equal")


class ShortColumns(Solver):
    """T(x) = 1/(β√(πV)) ∫ q/2 dx'/√(x' - x) upstream, in strips, q constant over elements.

    V is the speed of a body's own surface: a body that slides passes faster or slower than it rolls.
    """

    name = "short-columns"
    role = "thermal"
    models = (
        ModelSpec("short", "Abel's integral", "Jaeger", True, False, INPUTS, BODIES),
    )
    effects = (Effect("friction_heat", "q/2 into each body", "symmetry", ("short",), keys=(HALF,)),)
    keys = (
        Key.position(),
        Key.name_in("bodies.*.material", "materials", "material of the body", required=True),
        *(Key.quantity(f"materials.*.{p}", u, p, required=True) for p, u in STEEL.items()),
    )
    figures = (RISE,)

    def configure(self, configuration):
        case, number = configuration.case, configuration.case.number
        self.bodies = dict(zip(BODIES, reversed(case.bodies())))
        steels = {name: case.text(f"bodies.{body}.material") for name, body in self.bodies.items()}
        self.scale = {
            name: np.prod([np.pi, *(number(f"materials.{steel}.{p}") for p in STEEL)]) ** -0.5
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
        self.abel, self.peaks = far - near, dict.fromkeys(BODIES, 0.0)

    def solve(self, step, inputs, outputs):
        flux = inputs.finite("friction_power")  # a read-only view; NaN is refused by name
        speeds = dict(zip(reversed(BODIES), inputs.finite("surface_speed").ravel()))  # upper, lower
        if min(speeds.values()) <= 0.0:
            raise ValueError("material has to move through the contact: `surface_speed` > 0")
        sums = self.upstream(flux.reshape(self.grid.shape.nj, -1)).ravel()
        rises = {name: self.scale[name] / speeds[name] ** 0.5 * sums for name in BODIES}
        for name in outputs:
            outputs[name] = rises[name]
        self.trial = {name: float(rise.max()) for name, rise in rises.items()}
        return StepReport(received_power=self.grid.integrate(flux))

    def upstream(self, rows):
        return rows @ self.abel

    def accept(self):
        self.peaks = self.trial

    def summary(self):
        rises = {body: {"max_rise_k": self.peaks[name]} for name, body in self.bodies.items()}
        return {"temperature": rises}

    def save(self, file):
        file.write(struct.pack("2d", *self.peaks.values()))

    def restore(self, file):
        self.peaks = dict(zip(BODIES, struct.unpack("2d", file.read())))


if __name__ == "__main__":
    main(ShortColumns)
