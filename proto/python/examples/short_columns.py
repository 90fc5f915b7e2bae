import numpy as np

from cosim import Effect, Key, Layout, Model, Solver, StepReport, main

BODIES = ("lower_temperature", "upper_temperature")
STEEL = {"density": "kg/m3", "specific_heat": "J/(kg K)", "conductivity": "W/(m K)"}
HALF = Key.choice("effects.friction_heat.partition", ("equal",), "one half each", default="equal")


class ShortColumns(Solver):
    """T(x) = 1/(β√(πV)) ∫ q/2 dx'/√(x' - x) upstream, in strips, q constant over elements."""

    role = "thermal"
    models = (
        Model("short", "Abel's integral", "Jaeger", True, False, ("friction_power",), BODIES),
    )
    effects = (Effect("friction_heat", "q/2 into each body", "symmetry", ("short",), keys=(HALF,)),)
    keys = (
        Key.position(),
        Key.name_in("bodies.*.material", "materials", "material of the body", required=True),
        Key.quantity("motion.speed", "m/s", "rolling speed", required=True, above=0.0),
        *(Key.quantity(f"materials.*.{p}", u, p, required=True) for p, u in STEEL.items()),
    )

    def configure(self, configuration):
        case, number = configuration.case, configuration.case.number
        speed = number("motion.speed")
        upper, lower = (case.text(f"bodies.{body}.material") for body in case.bodies())
        self.scale = {
            name: np.prod([np.pi * speed, *(number(f"materials.{steel}.{p}") for p in STEEL)]) ** -0.5
            for name, steel in zip(BODIES, (lower, upper))
        }
        self.grid = configuration.input("friction_power").grid
        if self.grid is None:  # while planning
            return Layout()
        return Layout([self.grid], dict.fromkeys(BODIES, self.grid.name))

    def build(self):
        plane = self.grid.shape
        upstream = (np.arange(plane.ni)[:, None] - np.arange(plane.ni)) * plane.dx
        far, near = (np.sqrt(np.maximum(upstream + d * plane.dx, 0.0)) for d in (0.5, -0.5))
        self.abel = far - near

    def solve(self, step, inputs, outputs):
        flux = inputs.finite("friction_power")  # a read-only view; NaN is refused by name
        strips = flux.reshape(self.grid.shape.nj, -1)
        for name in outputs:
            rise = np.matmul(strips, self.abel, out=outputs[name].reshape(strips.shape))  # no copy
            rise *= self.scale[name]
        return StepReport(heat_received=self.grid.integrate(flux))


if __name__ == "__main__":
    main(ShortColumns)
