"""Interpolates the figures of a sweep, for arrays of points.

`coordinator sweep --fit` writes the file; docs/surrogate.md describes it. Needs only numpy.

    contact = surrogate.load("results/wheel-rail-sweep/fit.json")
    figures = contact.ask({"motion.speed": np.linspace(10, 80, 1000), "load.normal_force": 100e3})
    rise = figures["temperature.rail.max_rise_k"]
    error = contact.figures["temperature.rail.max_rise_k"].bound(rise)
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

SCHEMA = 1
LARGEST_DEGREE = 32
LONGEST = 8 << 20
CHUNK = 2048

Array = NDArray[np.float64]


class Fault(ValueError):
    """A file that is not a surrogate, or a figure that overflows."""


class Outside(ValueError):
    """A point outside the region of a surrogate.

    Attributes: `key` (for a quotient both keys, separated by a slash), `value`, `least`, `largest`.
    """

    def __init__(self, key: str, value: float, least: float, largest: float, unit: str) -> None:
        self.key, self.value, self.least, self.largest = key, value, least, largest
        told = f"{value}{unit} is outside {least} to {largest}{unit}"
        super().__init__(f"{key} = {told}, where the surrogate was made")


@dataclass(frozen=True)
class Key:
    """A varied key of the case."""

    key: str
    unit: str
    least: float
    largest: float


@dataclass(frozen=True)
class Coordinate:
    """A key, or the quotient of two keys, by their indices."""

    name: str
    of: int
    per: int | None
    least: float
    largest: float

    def scaled(self, value: Array, scale: str) -> Array:
        """Scale a value to −1 to 1 between the ends."""
        least, largest = self.least, self.largest
        if scale == "log":
            value, least, largest = np.log(value), math.log(least), math.log(largest)
        return value * (2.0 / (largest - least)) - (largest + least) / (largest - least)


@dataclass(frozen=True)
class Figure:
    """A figure, its errors at points not used in the fit, and its terms."""

    key: str
    words: str
    relative: bool
    largest_error: float
    rms_error: float
    log: bool
    sign: float
    scales: tuple[str, ...]
    degrees: NDArray[np.int64]
    coefficients: Array

    def bound(self, value: ArrayLike) -> Any:
        """Return the largest error of a value, in the unit of the figure."""
        size: Any = np.abs(value) if self.relative else np.ones(np.shape(value))
        return self.largest_error * size


@dataclass
class _Plan:
    """The numbers whose weighted sums are figures.

    They are rows of one array: 1, the Chebyshev polynomials of each coordinate in each scale that a
    figure needs, and their products, each of two earlier rows.
    """

    figures: tuple[Figure, ...]
    axes: dict[tuple[int, str], tuple[int, int]]
    products: list[tuple[int, int]]
    terms: list[NDArray[np.intp]]
    rows: int

    @classmethod
    def of(cls, figures: Sequence[Figure]) -> _Plan:
        degrees: dict[tuple[int, str], int] = {}
        for one in figures:
            for n, scale in enumerate(one.scales):
                largest = int(one.degrees[:, n].max())
                degrees[n, scale] = max(degrees.get((n, scale), 0), largest)
        axes, row = {}, 1
        for of, degree in sorted(degrees.items()):
            axes[of] = (row, degree)
            row += degree
        known: dict[tuple[int, int], int] = {}

        def product(degrees: Sequence[int], scales: Sequence[str]) -> int:
            at = 0
            for n, degree in enumerate(degrees):
                if degree:
                    factor = axes[n, scales[n]][0] + int(degree) - 1
                    at = factor if at == 0 else known.setdefault((at, factor), row + len(known))
            return at

        terms = [np.array([product(d, one.scales) for d in one.degrees]) for one in figures]
        return cls(tuple(figures), axes, list(known), terms, row + len(known))

    def evaluate(self, scaled: Callable[[int, str], Array], out: Array) -> None:
        numbers = np.empty((self.rows, out.shape[1]))
        numbers[0] = 1.0
        for (n, scale), (first, degree) in self.axes.items():
            if degree:
                s = numbers[first] = scaled(n, scale)
            for row in range(first + 1, first + degree):
                before = numbers[row - 2] if row > first + 1 else 1.0
                numbers[row] = 2.0 * s * numbers[row - 1] - before
        for row, (one, other) in enumerate(self.products, self.rows - len(self.products)):
            np.multiply(numbers[one], numbers[other], out=numbers[row])
        for figure, terms, values in zip(self.figures, self.terms, out, strict=True):
            np.matmul(figure.coefficients, numbers[terms], out=values)
            if figure.log:
                np.exp(values, out=values)
                np.multiply(values, figure.sign, out=values)


class Surrogate:
    """Figures as functions of the varied keys of a case."""

    def __init__(
        self, keys: Sequence[Key], coordinates: Sequence[Coordinate], figures: Sequence[Figure]
    ) -> None:
        self.keys = {one.key: one for one in keys}
        self.figures = {one.key: one for one in figures}
        self._coordinates = tuple(coordinates)
        self._plans: dict[tuple[str, ...], _Plan] = {}

    def ask(
        self,
        at: Mapping[str, ArrayLike] | None = None,
        /,
        *,
        figures: Sequence[str] | None = None,
        **more: ArrayLike,
    ) -> dict[str, Any]:
        """Return the figures at points [SI], by key.

        Every key has a value, or an array of values; arrays are broadcast against each other, and
        the results have their shape. Raises `Outside` for a point outside the region, `KeyError`
        for an unknown or missing name, and `Fault` for a figure that overflows.
        """
        values = self._values({**(at or {}), **more})
        shape = values[0].shape
        points = self._points([value.ravel() for value in values])
        wanted = tuple(self.figures if figures is None else figures)
        if wanted not in self._plans:
            self._plans[wanted] = _Plan.of([self.figures[key] for key in wanted])
        out = np.empty((len(wanted), points[0].size))
        for begin in range(0, points[0].size, CHUNK):
            chunk = slice(begin, begin + CHUNK)

            def scaled(n: int, scale: str, chunk: slice = chunk) -> Array:
                return self._coordinates[n].scaled(points[n][chunk], scale)

            with np.errstate(over="ignore", invalid="ignore"):
                self._plans[wanted].evaluate(scaled, out[:, chunk])
        for key, values in zip(wanted, out, strict=True):
            if not np.isfinite(values).all():
                raise Fault(f"{key} has no finite value here; make the surrogate again")
        return {key: one.reshape(shape)[()] for key, one in zip(wanted, out, strict=True)}

    def _values(self, given: Mapping[str, ArrayLike]) -> list[Array]:
        unknown = [f"{key} did not vary" for key in given if key not in self.keys]
        missing = [f"{key} is missing" for key in self.keys if key not in given]
        if unknown or missing:
            raise KeyError("; ".join([*unknown, *missing]))
        values = [np.asarray(given[key], dtype=np.float64) for key in self.keys]
        for key, value in zip(self.keys.values(), values, strict=True):
            unit = "" if key.unit in ("", "1") else f" {key.unit}"
            _admit(key.key, value, key.least, key.largest, unit)
        return list(np.broadcast_arrays(*values))

    def _points(self, values: Sequence[Array]) -> list[Array]:
        points = []
        for one in self._coordinates:
            value = values[one.of]
            if one.per is not None:
                value = value / values[one.per]
                _admit(one.name, value, one.least, one.largest, "")
            points.append(value)
        return points


def _admit(key: str, value: Array, least: float, largest: float, unit: str) -> None:
    inside = (value >= least) & (value <= largest)  # what is no number is outside
    if not inside.all():
        first = float(np.ravel(value)[np.ravel(~inside).argmax()])
        raise Outside(key, first, least, largest, unit)


def load(path: str | Path) -> Surrogate:
    """Read a surrogate; raises `Fault` if the file is not one."""
    with Path(path).open("rb") as file:
        text = file.read(LONGEST + 1)
    if len(text) > LONGEST:
        raise Fault(f"{path}: it is longer than {LONGEST} bytes")
    try:
        document = json.loads(text)
        if document["schema"] != SCHEMA:
            raise Fault(f"its layout has version {document['schema']}, supported is {SCHEMA}")
        return _read(document)
    except (KeyError, TypeError, ValueError, IndexError, RecursionError, OverflowError) as fault:
        raise Fault(f"{path}: it is not a surrogate: {fault}") from fault


def _read(document: Mapping[str, Any]) -> Surrogate:
    keys = [Key(one["key"], one["unit"], *_ends(one)) for one in document["keys"]]
    places = {one.key: n for n, one in enumerate(keys)}
    coordinates = []
    for one in document["coordinates"]:
        per = one.get("per")
        name = one["key"] if per is None else f"{one['key']}/{per}"
        divisor = None if per is None else places[per]
        if divisor is not None and keys[divisor].least <= 0.0 <= keys[divisor].largest:
            raise ValueError(f"{per} can be 0, and a coordinate is divided by it")
        coordinates.append(Coordinate(name, places[one["key"]], divisor, *_ends(one)))
    figures = [_figure(one, coordinates) for one in document["figures"]]
    if not keys or not coordinates or not figures:
        raise ValueError("it has no keys, no coordinates or no figures")
    return Surrogate(keys, coordinates, figures)


def _ends(one: Mapping[str, Any]) -> tuple[float, float]:
    least, largest = float(one["from"]), float(one["to"])
    if not (least < largest and math.isfinite(largest - least)):
        raise ValueError(f"{one['key']} goes from {least} to {largest}, which is no interval")
    return least, largest


def _figure(one: Mapping[str, Any], coordinates: Sequence[Coordinate]) -> Figure:
    held = one["held"]
    degrees = np.array(one["degrees"], dtype=np.int64)
    coefficients = np.array(one["coefficients"], dtype=np.float64)
    scales = tuple(one["scales"])
    count = len(coordinates)
    fits = degrees.shape == (len(coefficients), count) and len(scales) == count
    if not fits or not len(degrees) or degrees.min() < 0 or degrees.max() > LARGEST_DEGREE:
        raise ValueError(f"{one['key']}: its terms do not match the coordinates")
    measures = ("relative", "absolute")
    if not {one["scale"], *scales} <= {"linear", "log"} or held["measure"] not in measures:
        raise ValueError(f"{one['key']}: unknown word")
    if any(word == "log" and at.least <= 0.0 for word, at in zip(scales, coordinates, strict=True)):
        raise ValueError(f"{one['key']}: the logarithm of a coordinate that can be 0 or less")
    largest, rms = float(held["largest"]), float(held["rms"])
    if not np.isfinite([*coefficients, largest, rms]).all() or min(largest, rms) < 0.0:
        raise ValueError(f"{one['key']}: a number is not finite, or an error is negative")
    return Figure(
        key=str(one["key"]),
        words=str(one["words"]),
        relative=held["measure"] == "relative",
        largest_error=largest,
        rms_error=rms,
        log=one["scale"] == "log",
        sign=-1.0 if one.get("negative", False) else 1.0,
        scales=scales,
        degrees=degrees,
        coefficients=coefficients,
    )
