"""Participants of `cases/moving.toml` in Python: `mover` with a moving grid, and `plate` with a fixed
one; their laws are in tests/src/moving.rs. The first argument is the role."""

import struct
import sys

import numpy as np
from cosim import FieldKind, Grid, Key, Layout, ModelSpec, Quadrilaterals, Refusal, Solver
from cosim import StepError, StepReport, Structured, main

ROLE = sys.argv.pop(1)
SIDE, CORNER, COUNTS, PLATE = 0.05, (0.3, 0.4), (24, 16), (4.0, 2.0)


def flux(at):
    return 1000.0 * (1.0 + at[:, 0] + 0.5 * at[:, 1])


def temperature(at):
    return 2.0 + np.sin(1.3 * at[:, 0]) * np.cos(0.9 * at[:, 1])


def patch(motion, s):
    x, y = CORNER[0] + 0.5 * SIDE, CORNER[1] + 0.5 * SIDE
    ni, nj = COUNTS
    match motion:
        case "translate":
            return Structured.contact_plane(x + 0.03 * s, y + 0.01 * s, SIDE, SIDE, ni, nj)
        case "grow":
            return Structured.contact_plane(x, y, SIDE, SIDE, ni + s, nj)
        case "stretch":
            i, j = np.meshgrid(np.arange(ni + 1), np.arange(nj + 1))
            rest_x, rest_y = CORNER[0] + SIDE * i.ravel(), CORNER[1] + SIDE * j.ravel()
            moved_x = CORNER[0] + (rest_x - CORNER[0]) * (1.0 + 0.05 * s)
            moved_y = rest_y + 0.02 * s * np.sin(3.0 * rest_x)
            vertices = np.column_stack([moved_x, moved_y, np.zeros(moved_x.size)])
            first = (np.arange(nj)[:, None] * (ni + 1) + np.arange(ni)).ravel()
            elements = np.column_stack([first, first + 1, first + ni + 2, first + ni + 1])
            return Quadrilaterals(vertices, elements.astype(np.uint32))
    return Structured.contact_plane(x, y, SIDE, SIDE, ni, nj)


class Moving(Solver):
    """Heat of a moving patch, or temperature of a plate."""

    name, role, standalone = f"python-{ROLE}", ROLE, True
    follows_moving_grids = True
    fields = (
        FieldKind("moving_flux", "W/m2", mapping="conservative", meaning="flux into the plate"),
        FieldKind("moving_place", "m", 2, meaning="x and y of the elements' centres"),
        FieldKind("plate_temperature", "K", meaning="temperature of the plate"),
    )
    moves = ROLE == "mover"
    sends, receives = ("moving_flux", "plate_temperature")[:: 1 if moves else -1]
    models = (
        ModelSpec(
            "law",
            "a field given as a function of place",
            "a closed form",
            steady=False,
            transient=True,
            consumes=(receives,),
            provides=(sends, "moving_place") if moves else (sends,),
        ),
    )
    own = (
        Key.choice("mover.motion", ["none", "translate", "grow", "stretch"], "how it moves",
                   default="none"),
        Key.integer("mover.every", "windows from one step to the next", at_least=1, default=1),
    ) if moves else (
        Key.integer("plate.resolution", "elements of the plate along x", at_least=2, default=53),
        Key.flag("plate.direct", "the flux comes on the mover's grid", default=False),
    )
    keys = (Key.number("moving.gain", "how much each heeds the other", at_least=0.0, default=0.0), *own)

    def configure(self, configuration):
        case = configuration.case
        if case.number("moving.gain") != 0.0:
            raise Refusal("moving.gain", "is not in this version", "leave it out")
        self.motion = case.get("mover.motion", "none") if self.moves else "none"
        self.every = case.get("mover.every", 1)
        if self.moves:
            self.grid = Grid("patch", patch(self.motion, 0))
        else:
            resolution = case.integer("plate.resolution")
            h = PLATE[0] / resolution
            # Halves are rounded up.
            rows = max(1, int(PLATE[1] / h + 0.5))
            dy = PLATE[1] / rows
            self.grid = Grid(
                "plate", Structured.contact_plane(0.5 * h, 0.5 * dy, h, dy, resolution, rows)
            )
        self.solved_on = self.grid
        self.accepted = self.trial = (0, 0, 0.0)
        direct = case.get("plate.direct", False)
        placed = {self.sends: self.grid.name}
        if self.moves:
            placed["moving_place"] = self.grid.name
        return Layout(
            grids=[self.grid],
            fields=placed,
            inputs={} if direct else {self.receives: self.grid.name},
            moving=["patch"] if self.motion != "none" else [],
        )

    def first_outputs(self, outputs):
        law = flux if self.moves else temperature
        outputs[self.sends] = law(self.grid.centres())

    def solve(self, step, inputs, outputs):
        received, place = inputs[self.receives], inputs.grid(self.receives)
        report = StepReport(work=outputs[self.sends].size)
        if self.moves:
            if place.revision != self.grid.revision:
                raise StepError(f"revision {place.revision}, not {self.grid.revision}")
            outputs[self.sends] = flux(self.grid.centres())
        else:
            report.received_power = place.integrate(received)
            outputs[self.sends] = temperature(self.grid.centres())
        expected = (temperature if self.moves else flux)(place.centres())
        error = float(np.max(np.abs(received - expected) / expected))
        windows, _, largest = self.accepted
        self.trial = (windows + 1, place.revision, max(largest, error))
        return report

    def accept(self):
        self.accepted, self.solved_on = self.trial, self.grid
        self.go_on()

    def go_on(self):
        if self.moves and self.motion != "none":
            steps = self.accepted[0] // self.every
            while self.grid.revision < 1 + steps:
                self.grid = self.grid.moved(patch(self.motion, self.grid.revision))

    def moved_grids(self):
        return [self.grid]

    def observe(self, outputs):
        if "moving_place" in outputs:
            outputs["moving_place"] = self.solved_on.centres()[:, :2].T

    def save(self, file):
        file.write(struct.pack("<QQd", *self.accepted))

    def restore(self, file):
        self.accepted = struct.unpack("<QQd", file.read(24))
        self.go_on()

    def summary(self):
        windows, revision, error = self.accepted
        return {
            ROLE: {"windows": windows, "grid_revision": revision, "largest_error": error}
        }


main(Moving)
