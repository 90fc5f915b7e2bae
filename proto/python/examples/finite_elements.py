"""A thermal participant in Python that uses finite elements from scikit-fem.

    pip install 'proto/python[elements]'
    coordinator run CASE --set thermal.model=bricks \
        --set 'thermal.command=["python3", "proto/python/examples/finite_elements.py"]'

Steady heat conduction in both bodies, each with its own speed and mesh; the numerics are in
`moving_body.py`. Pairs are ordered upper, lower. Units are SI.
"""

from __future__ import annotations

from typing import BinaryIO

import numpy as np
from conduction import Material
from moving_body import MovingBody, NotSolvedError
from strip_columns import SURFACES, StripColumns, expected_speed, own_grid, vertex

from cosim import (
    Array,
    Configuration,
    Effect,
    Grid,
    Inputs,
    Key,
    Layout,
    ModelSpec,
    Outputs,
    Refusal,
    Solver,
    StateError,
    Step,
    StepError,
    StepReport,
    Structured,
    main,
)

#: Smallest V L/(2κ), with L half the length of the flux's grid; below it heat leaves the mesh.
LEAST_PECLET = 10.0


class FiniteElements(Solver):
    """Advection and diffusion of heat in three dimensions, for two bodies."""

    name = "finite-elements"
    version = "0.1.0"
    role = "thermal"
    models = (
        ModelSpec(
            "bricks",
            "heat conduction in three dimensions in bodies that move, trilinear bricks",
            "Brooks & Hughes, Comput. Methods Appl. Mech. Eng. 32 (1982) 199-259",
            steady=True,
            transient=False,
            consumes=("friction_power", "surface_speed"),
            provides=SURFACES,
            keys=(
                Key.integer(
                    "thermal.resolution",
                    "elements along the larger extent of the heat flux's grid",
                    default=40,
                    at_least=2.0,
                    at_most=400.0,
                ),
                Key.integer(
                    "thermal.layers", "layers in depth", default=16, at_least=4.0, at_most=100.0
                ),
            ),
        ),
    )
    effects = (
        Effect(
            "friction_heat",
            "one half of q_f into each body",
            "symmetry",
            models=("bricks",),
            consumes=("friction_power", "surface_speed"),
            provides=SURFACES,
            keys=(
                Key.choice(
                    "effects.friction_heat.partition", ("equal",), "one half each", default="equal"
                ),
            ),
        ),
    )
    keys = StripColumns.keys
    figures = StripColumns.figures[:4]

    def configure(self, configuration: Configuration) -> Layout:
        """Check the case and choose the elements of the surface."""
        case = configuration.case
        self.names = case.bodies()
        self.materials = [
            Material(
                *(
                    case.number(f"materials.{case.text(f'bodies.{body}.material')}.{name}")
                    for name in Material.__dataclass_fields__
                )
            )
            for body in self.names
        ]
        self.layers = int(case.number("thermal.layers"))
        self.grid: Structured | None = None
        given = configuration.input("friction_power")
        if given is None or given.grid is None:
            return Layout(remarks=["grid and cost follow the grid of friction_power"])
        arriving = given.grid.shape
        if not isinstance(arriving, Structured) or not arriving.is_contact_plane():
            raise Refusal(
                f"{given.producer}.model",
                "its grid is not made of rows along x in a contact plane",
                "name a model with such a grid",
            )
        grid = self.grid = own_grid(arriving, int(case.number("thermal.resolution")))
        for body, material in zip(self.names, self.materials):
            speed = expected_speed(case, body)
            peclet = speed * grid.ni * grid.dx / (4.0 * material.diffusivity)
            if peclet < LEAST_PECLET:
                raise Refusal(
                    "motion.speed",
                    f"{body} passes too slowly: its Péclet number is {peclet:.3g}, and the mesh is "
                    f"for {LEAST_PECLET:g} and more",
                    "write a larger speed, or take the model `moving-source` of thermal-solver",
                )
        nodes = 2 * grid.points * self.layers
        return Layout(
            grids=[Grid("contact", grid)],
            fields=dict.fromkeys(SURFACES, "contact"),
            inputs={"friction_power": "contact"} if grid != arriving else {},
            solve_seconds=100e-6 * nodes,
            memory_bytes=8000 * nodes,
        )

    def build(self) -> None:
        """Allocate the initial state at zero rise; meshes are created once the speeds are known."""
        if self.grid is None:
            raise Refusal(
                "effects.friction_heat",
                "the grid of `friction_power` is not known",
                "configure the participant that computes it first",
            )
        self.rise: list[Array] = [np.zeros((self.grid.nj, self.grid.ni)) for _ in SURFACES]
        self.trial = self.rise
        self.bodies: dict[tuple[Material, float], MovingBody] = {}

    def solve(self, step: Step, inputs: Inputs, outputs: Outputs) -> StepReport:
        """Compute both temperature rises for the received flux and speeds."""
        assert self.grid is not None, "build has demanded it"
        flux = inputs.finite("friction_power").reshape(self.grid.nj, self.grid.ni)
        speeds = map(float, inputs.finite("surface_speed").ravel())
        wanted = list(zip(self.materials, speeds))
        self._make(wanted)
        try:
            self.trial = [self.bodies[body].rise(0.5 * flux) for body in wanted]
        except NotSolvedError as error:
            raise StepError(str(error)) from error
        for name, rise in zip(SURFACES, self.trial):
            outputs[name] = rise.ravel()
        heat = self.grid.element_area * float(np.sum(flux))
        return StepReport(received_power=heat, work=flux.size)

    def _make(self, wanted: list[tuple[Material, float]]) -> None:
        """Keep the required bodies and create the missing ones, which takes longest."""
        assert self.grid is not None, "build has demanded it"
        kept = {body: made for body, made in self.bodies.items() if body in wanted}
        for done, (name, (material, speed)) in enumerate(zip(self.names, wanted)):
            if speed <= 0.0:
                raise StepError(f"`surface_speed` is {speed} m/s for {name}: it has to be above 0")
            if (material, speed) not in kept:
                self.progress(done, len(wanted), "factorising")
                made = MovingBody(material, speed, self.grid, self.layers)
                kept[material, speed] = made
        self.bodies = kept

    def accept(self) -> None:
        """Make the last solve the accepted state."""
        self.rise = self.trial

    def observe(self, outputs: Outputs) -> None:
        """Write the fields of the accepted state."""
        for name, rise in zip(SURFACES, self.rise):
            outputs[name] = rise.ravel()

    def summary(self) -> dict[str, object]:
        """Return the hottest place of each body."""
        return {"temperature": {name: self._hottest(body) for body, name in enumerate(self.names)}}

    def _hottest(self, body: int) -> dict[str, float]:
        assert self.grid is not None, "build has demanded it"
        rise = self.rise[body]
        row, column = divmod(int(rise.argmax()), rise.shape[1])
        if rise[row, column] <= 0.0:
            return {"max_rise_k": 0.0}
        place, largest = vertex(rise[row], column)
        x = float(self.grid.x[column]) + place * self.grid.dx
        return {"max_rise_k": largest, "x_m": x, "y_m": float(self.grid.y[row])}

    def save(self, file: BinaryIO) -> None:
        """Write the accepted rises."""
        np.save(file, np.array(self.rise))

    def restore(self, file: BinaryIO) -> None:
        """Restore saved rises on this grid."""
        try:
            rise = np.load(file, allow_pickle=False)
        except Exception as error:
            raise StateError("it is not complete") from error
        if rise.shape != (2, *self.rise[0].shape):
            raise StateError(f"it is on {rise.shape[1:]}, not on {self.rise[0].shape}")
        self.rise = self.trial = list(rise)


if __name__ == "__main__":
    main(FiniteElements)
