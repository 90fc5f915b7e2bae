r"""A thermal participant in Python: strips of one-dimensional columns in two bodies.

    coordinator run CASE \
        --set 'thermal.command=["python3", "proto/python/examples/strip_columns.py"]'

Replaces `thermal-solver` with model `columns`: same fields and case keys, steady and transient. The
equations are in `conduction.py`. Pairs are ordered upper, lower. Units are SI.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import BinaryIO

import numpy as np
from conduction import (
    Material,
    SteadyConvolution,
    Window,
    accumulate,
    merge,
    past_weights,
)

from cosim import (
    Array,
    Case,
    Configuration,
    Effect,
    Figure,
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

BODIES = ("upper", "lower")
SURFACES = ("upper_temperature", "lower_temperature")
SECTIONS = ("upper_section_temperature", "lower_section_temperature")
#: Number of levels of a section in depth, including the surface.
LEVELS = 33


class StripColumns(Solver):
    """Heat conduction in strips of one-dimensional columns, for two bodies."""

    name = "strip-columns"
    version = "0.1.0"
    role = "thermal"
    models = (
        ModelSpec(
            "columns",
            "heat conduction normal to the surface, flux constant over elements",
            "Carslaw & Jaeger, Conduction of Heat in Solids, 2.9",
            steady=True,
            transient=True,
            consumes=("friction_power", "surface_speed"),
            provides=(*SURFACES[::-1], *SECTIONS[::-1]),
            keys=(
                Key.integer(
                    "thermal.resolution",
                    "elements along the larger extent of the heat flux's grid; absent: its grid",
                    at_least=2.0,
                    at_most=1e5,
                ),
            ),
        ),
    )
    effects = (
        Effect(
            "friction_heat",
            "q_upper = eps q_f, q_lower = (1 - eps) q_f; eps = 1/2 or by effusivity times root of "
            "speed",
            "Ertz & Knothe, Wear 253 (2002) 498-508",
            models=("columns",),
            consumes=("friction_power", "surface_speed"),
            provides=(*SURFACES[::-1], *SECTIONS[::-1]),
            keys=(
                Key.choice(
                    "effects.friction_heat.partition",
                    ("equal", "effusivity"),
                    "how the heat is split between the bodies",
                    default="equal",
                ),
            ),
        ),
    )
    keys = (
        Key.position(),
        Key.name_in("bodies.*.material", "materials", "material of the body", required=True),
        *(
            Key.quantity(f"materials.*.{name}", unit, words, required=True, above=0.0)
            for name, unit, words in (
                ("density", "kg/m3", "mass per volume"),
                ("specific_heat", "J/(kg K)", "heat per mass and temperature"),
                ("conductivity", "W/(m K)", "heat flux per temperature gradient"),
            )
        ),
        Key.quantity(
            "bodies.*.initial_temperature",
            "K",
            "initial temperature, over which temperatures are rises",
            above=0.0,
            default=293.15,
        ),
        Key.quantity(
            "bodies.*.surface_speed",
            "m/s",
            "speed at which the body's surface passes through the contact; absent: motion.speed",
            at_least=0.0,
            varies=True,
        ),
        Key.quantity("motion.speed", "m/s", "rolling speed", at_least=0.0, varies=True),
    )
    figures = (
        Figure(
            "temperature.*.max_rise_k",
            "K",
            "temperature rise",
            line="*",
            style="signed",
            headline=True,
            rank=1,
            driven_by="contact.friction_power_w",
        ),
        Figure(
            "temperature.*.x_over_a",
            "1",
            "place x/a",
            line="*",
            short="at x/a",
            digits=4,
            measure="absolute",
            rank=2,
            derived={"ratio": {"of": ["temperature.*.x_m"], "over": "contact.semi_axis_a_m"}},
        ),
        Figure("temperature.*.x_m", "m", "place x", style="place", measure="absolute"),
        Figure("temperature.*.y_m", "m", "place y", "*", "y", style="place", measure="absolute"),
        Figure(
            "temperature.*.penetration_depth_m",
            "m",
            "depth to 1/e",
            line="*",
            short="1/e at depth",
            digits=3,
            rank=3,
            driven_by="contact.friction_power_w",
        ),
    )

    def configure(self, configuration: Configuration) -> Layout:
        """Check the case and place surfaces and sections."""
        if configuration.model != "columns":
            raise Refusal(
                "thermal.model", f"there is no `{configuration.model}`", 'write "columns"'
            )
        if not configuration.has_effect("friction_heat"):
            raise Refusal(
                "effects.friction_heat",
                "no other effect gives this participant any heat",
                "add the table `[effects.friction_heat]`",
            )
        case = configuration.case
        self.steady = configuration.is_steady
        self.names = case.bodies()
        self.speeds = [expected_speed(case, name) for name in self.names]
        self.materials = [
            Material(
                *(
                    case.number(f"materials.{case.text(f'bodies.{body}.material')}.{name}")
                    for name in Material.__dataclass_fields__
                )
            )
            for body in self.names
        ]
        self.partition = case.get("effects.friction_heat.partition", "equal")
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
        self.grid = own_grid(arriving, case.get("thermal.resolution"))
        return self._lay_out(configuration, self.grid, self.grid != arriving)

    def _lay_out(self, configuration: Configuration, grid: Structured, remapped: bool) -> Layout:
        layout = Layout(
            grids=[Grid("contact", grid)],
            fields=dict.fromkeys(SURFACES, "contact"),
            inputs={"friction_power": "contact"} if remapped else {},
            solve_seconds=60e-9 * grid.points * (1.0 if self.steady else grid.ni),
            memory_bytes=8 * grid.points * (12 if self.steady else grid.ni + 140),
        )
        for body, section in enumerate(SECTIONS):
            if configuration.wants(section):
                name = f"{BODIES[body]}_section"
                layout.grids.append(Grid(name, self._section(grid, body)))
                layout.fields[section] = name
        return layout

    def _section(self, grid: Structured, body: int) -> Structured:
        up = self._level_spacing(grid, body) * (1.0 if body == 0 else -1.0)
        x0, _, z0 = grid.origin
        origin = (x0, float(grid.y[middle_row(grid)]), z0)
        return Structured(origin, grid.step_i, (0.0, 0.0, up), grid.ni, LEVELS)

    def _level_spacing(self, grid: Structured, body: int) -> float:
        """Return the distance of levels; the last is at 4√(2κL/V), L half the grid, where the rise
        vanishes."""
        time = 0.5 * grid.ni * grid.dx / self.speeds[body]
        return 4.0 * math.sqrt(2.0 * self.materials[body].diffusivity * time) / (LEVELS - 1)

    def build(self) -> None:
        """Allocate the initial state at zero rise."""
        if self.grid is None:
            raise Refusal(
                "effects.friction_heat",
                "the grid of `friction_power` is not known",
                "configure the participant that computes it first",
            )
        self.shape = (self.grid.nj, self.grid.ni)
        self.convolution = SteadyConvolution(self.grid.ni)
        self.accepted: list[Window] = []
        self.trial: Window | None = None
        self.trial_rise: list[Array] = []
        self.rise = [np.zeros(self.shape) for _ in BODIES]
        self.past_key: tuple[float, tuple[float, float]] | None = None

    def solve(self, step: Step, inputs: Inputs, outputs: Outputs) -> StepReport:
        """Solve one window from the accepted state."""
        assert self.grid is not None, "build has demanded it"
        self.trial = None
        flux = inputs.finite("friction_power").reshape(self.shape)
        window = self._window(step, inputs.finite("surface_speed"), flux)
        self.trial_rise = self._steady(window) if self.steady else self._transient(window)
        self.trial = replace(window, flux=np.array(flux))
        for name, rise in zip(SURFACES, self.trial_rise):
            outputs[name] = rise.ravel()
        self._write_sections(outputs, self._windows(self.trial))
        heat = self.grid.element_area * float(np.sum(flux))
        return StepReport(received_power=heat, work=flux.size)

    def _window(self, step: Step, speeds: Array, flux: Array) -> Window:
        upper, lower = map(float, speeds.ravel())
        if min(upper, lower) <= 0.0:
            raise StepError(
                f"`surface_speed` is {upper} m/s for {self.names[0]}, {lower} m/s for {self.names[1]}: "
                "material has to move through the contact, at a speed greater than 0"
            )
        duration = math.inf if self.steady else step.duration
        if duration <= 0.0:
            raise StepError(f"a transient window lasts {duration} s")
        share = 0.5
        if self.partition == "effusivity":
            uptake = [
                material.effusivity * math.sqrt(speed)
                for material, speed in zip(self.materials, (upper, lower))
            ]
            share = uptake[0] / sum(uptake)
        return Window(duration, (upper, lower), (share, 1.0 - share), flux)

    def _steady(self, window: Window) -> list[Array]:
        """Compute the rises of both bodies from one convolution."""
        assert self.grid is not None, "build has demanded it"
        unit = self.convolution(window.flux)
        if (window.flux >= 0.0).all():
            # Negative values are rounding errors: the exact result is not negative.
            np.maximum(unit, 0.0, out=unit)
        return [
            unit * (share * material.amplitude * math.sqrt(self.grid.dx / speed))
            for share, material, speed in zip(window.shares, self.materials, window.speeds)
        ]

    def _transient(self, window: Window) -> list[Array]:
        """Add this window's part to that of earlier windows, which is kept while only the flux
        changes."""
        key = (window.duration, window.speeds)
        weights = [self._weights([window, *self.accepted], body) for body in range(2)]
        if self.past_key != key:
            self.past = [np.zeros(self.shape) for _ in BODIES]
            for past, parts in zip(self.past, weights):
                for older, (first, values) in zip(self.accepted, parts[1:]):
                    accumulate(past, older.flux, first, values)
            self.past_key = key
        rises = [past.copy() for past in self.past]
        for rise, parts in zip(rises, weights):
            accumulate(rise, window.flux, *parts[0])
        return rises

    def _weights(self, windows: list[Window], body: int) -> list[tuple[int, Array]]:
        """Return the weights times the body's amplitude [m² K/W]."""
        assert self.grid is not None, "build has demanded it"
        amplitude = self.materials[body].amplitude
        parts = past_weights(windows, body, self.grid.dx, self.grid.ni)
        return [(first, amplitude * values) for first, values in parts]

    def _windows(self, newest: Window | None) -> list[Window]:
        older = [] if self.steady else self.accepted
        return [newest, *older] if newest is not None else older

    def accept(self) -> None:
        """Make the last solve the accepted state, and merge old windows."""
        if self.trial is None:
            return
        assert self.grid is not None, "build has demanded it"
        windows = [self.trial] if self.steady else [self.trial, *self.accepted]
        self.accepted = merge(windows, self.grid.dx, self.grid.ni)
        self.rise, self.trial, self.past_key = self.trial_rise, None, None

    def observe(self, outputs: Outputs) -> None:
        """Write the fields of the accepted state."""
        for name, rise in zip(SURFACES, self.rise):
            outputs[name] = rise.ravel()
        self._write_sections(outputs, self.accepted)

    def _write_sections(self, outputs: Outputs, windows: list[Window]) -> None:
        for body, section in enumerate(SECTIONS):
            if section in outputs:
                outputs[section] = self._section_rise(windows, body)

    def _section_rise(self, windows: list[Window], body: int) -> Array:
        assert self.grid is not None, "build has demanded it"
        row, material = middle_row(self.grid), self.materials[body]
        rise = np.zeros((LEVELS, self.grid.ni))
        distances = self._level_spacing(self.grid, body) * np.arange(LEVELS)
        for level, distance in enumerate(distances):
            depth = float(distance) / (2.0 * math.sqrt(material.diffusivity))
            parts = past_weights(windows, body, self.grid.dx, self.grid.ni, depth)
            for window, (first, weights) in zip(windows, parts):
                flux = window.flux[row]
                accumulate(rise[level], flux, first, material.amplitude * weights)
        return rise.ravel()

    def summary(self) -> dict[str, object]:
        """Return hottest place and penetration depth of each body."""
        return {"temperature": {name: self._hottest(body) for body, name in enumerate(self.names)}}

    def _hottest(self, body: int) -> dict[str, float]:
        assert self.grid is not None, "build has demanded it"
        rise = self.rise[body]
        row, column = divmod(int(rise.argmax()), rise.shape[1])
        if rise[row, column] <= 0.0:
            return {"max_rise_k": 0.0}
        offset, peak = vertex(rise[row], column)
        found = {
            "max_rise_k": peak,
            "x_m": float(self.grid.x[column] + offset * self.grid.dx),
            "y_m": float(self.grid.y[row]),
        }
        depth = self._penetration(body, row, column, 0.5 + offset)
        return found if depth is None else {**found, "penetration_depth_m": depth}

    def _penetration(self, body: int, row: int, column: int, place: float) -> float | None:
        """Return the depth [m] below the hottest place where the rise is 1/e of the surface's, by
        bisection."""
        assert self.grid is not None, "build has demanded it"
        grid, material = self.grid, self.materials[body]

        def rise(distance: float) -> float:
            depth = distance / (2.0 * math.sqrt(material.diffusivity))
            parts = past_weights(self.accepted, body, grid.dx, grid.ni - column, depth, place)
            total = 0.0
            for window, (first, weights) in zip(self.accepted, parts):
                flux = window.flux[row, column + first :][: len(weights)]
                total += float(weights[: len(flux)] @ flux)
            return total

        target, low, high = rise(0.0) / math.e, 0.0, self._level_spacing(grid, body)
        for _ in range(60):
            if rise(high) <= target:
                break
            low, high = high, 2.0 * high
        else:
            return None
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if rise(middle) > target else (low, middle)
        return 0.5 * (low + high)

    def save(self, file: BinaryIO) -> None:
        """Write the accepted windows and rises."""
        windows = self.accepted
        np.savez(
            file,
            name=np.array(self.name),
            duration=np.array([window.duration for window in windows]),
            speeds=np.array([window.speeds for window in windows]),
            shares=np.array([window.shares for window in windows]),
            flux=np.array([window.flux for window in windows]).reshape(-1, *self.shape),
            rise=np.array(self.rise),
        )

    def restore(self, file: BinaryIO) -> None:
        """Restore a saved state of this program on this grid."""
        try:
            with np.load(file, allow_pickle=False) as saved:
                name, rise = str(saved["name"]), saved["rise"]
                parts = [saved[key] for key in ("duration", "speeds", "shares", "flux")]
        except Exception as error:
            raise StateError("it is not complete") from error
        if name != self.name or rise.shape != (2, *self.shape):
            raise StateError(
                f"it belongs to {name} on {rise.shape[1:]}, not {self.name} on {self.shape}"
            )
        self.accepted = [
            Window(float(duration), tuple(speeds.tolist()), tuple(shares.tolist()), flux)
            for duration, speeds, shares, flux in zip(*parts)
        ]
        self.rise, self.trial, self.past_key = list(rise), None, None


def expected_speed(case: Case, body: str) -> float:
    """Return the body's own surface speed, or the rolling speed; it sets the depth of the
    section."""
    own = f"bodies.{body}.surface_speed"
    speed = case.number(own if own in case else "motion.speed")
    if speed <= 0.0:
        raise Refusal("motion.speed", f"{body} does not move", "write a speed above 0 m/s")
    return speed


def own_grid(arriving: Structured, resolution: int | None) -> Structured:
    """Return the requested grid with square elements, on the patch of the arriving grid."""
    if resolution is None:
        return arriving
    extents = arriving.ni * arriving.dx, arriving.nj * arriving.dy
    # Rounding must not add an element to a whole number.
    ni, nj = (math.ceil(resolution * e / max(extents) * (1.0 - 1e-12)) for e in extents)
    if (ni, nj) == (arriving.ni, arriving.nj):
        return arriving
    dx, dy = extents[0] / ni, extents[1] / nj
    x0, y0, z0 = arriving.origin
    origin = (x0 + 0.5 * (dx - arriving.dx), y0 + 0.5 * (dy - arriving.dy), z0)
    return Structured(origin, (dx, 0.0, 0.0), (0.0, dy, 0.0), ni, nj)


def middle_row(grid: Structured) -> int:
    """Return the row closest to y = 0, where the sections are."""
    return int(np.abs(grid.y).argmin())


def vertex(rise: Array, column: int) -> tuple[float, float]:
    """Return position, in elements from `column`, and value of the vertex of the parabola through
    three centres."""
    if not 0 < column < len(rise) - 1:
        return 0.0, float(rise[column])
    before, here, after = map(float, rise[column - 1 : column + 2])
    slope, bend = 0.5 * (after - before), after - 2.0 * here + before
    if bend >= 0.0:
        return 0.0, here
    return -slope / bend, here - 0.5 * slope * slope / bend


if __name__ == "__main__":
    main(StripColumns)
