"""Inputs read in place, and outputs written directly into shared memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from ctypes import byref, c_size_t
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import library
from .fields import FieldKind
from .grids import Array, Grid, Quadrilaterals, Structured, Vertices
from .solver import MissingInput, NonFiniteInput, first_non_finite
from .views import Views


class PortError(Exception):
    """An input or output that cannot be accessed, or not at this time."""


def shape_of(kind: FieldKind, points: int) -> tuple[int, ...]:
    """Return (points,) for one component, (components, points) for more."""
    return (points,) if kind.components == 1 else (kind.components, points)


class Inputs(Mapping[str, Array]):
    """Inputs of one solve, read in place.

    `inputs["friction_power"]` is a read-only view of shared memory, of shape (points,) for a field
    with one component and (components, points) for more. Views are valid until the end of the
    solve.
    """

    def __init__(
        self, lib: Any, handle: int, kinds: Mapping[str, FieldKind], grids: dict[str, Grid]
    ) -> None:
        self._lib, self._handle, self._kinds, self._grids = lib, handle, kinds, grids
        self._views, self._open = Views(), True

    def __getitem__(self, field: str) -> Array:
        count = c_size_t()
        place = self._lib.cosim_input(self._asked(field), field.encode(), byref(count), None)
        if not place:
            raise MissingInput(field)
        return self._view(field, place, count.value)

    def __iter__(self) -> Iterator[str]:
        return iter(self._kinds)

    def __len__(self) -> int:
        return len(self._kinds)

    def __contains__(self, field: object) -> bool:
        return field in self._kinds

    def grid(self, field: str) -> Grid:
        """Return the grid of an input."""
        now, known = library.Grid(), self._grids.get(field)
        self._lib.cosim_input(self._asked(field), field.encode(), None, byref(now))
        if known is None or known.revision != now.revision:
            known = self._grids[field] = _grid_of(now, known)
        return known

    def start(self, field: str) -> Array | None:
        """Return the values at the start of the window, read-only, in the shape of `inputs[field]`.

        Within the window the field varies linearly from these values to those of `inputs[field]`.
        `None` for a field that is constant within a window.
        """
        count = c_size_t()
        place = self._lib.cosim_input_start(self._asked(field), field.encode(), byref(count))
        return self._view(field, place, count.value) if place else None

    def finite(self, field: str) -> Array:
        """Return `inputs[field]`; raises `NonFiniteInput` for NaN and infinity."""
        values = self[field]
        index = first_non_finite(values)
        if index is not None:
            raise NonFiniteInput(field, index, float(values.flat[index]))
        return values

    def _asked(self, field: str) -> int:
        if not self._open:
            raise PortError(f"input `{field}` was accessed after the solve")
        if field not in self._kinds:
            raise MissingInput(field)
        return self._handle

    def _view(self, field: str, place: int, count: int) -> Array:
        kind = self._kinds[field]
        shape = shape_of(kind, count // kind.components)
        return self._views.view(field, place, shape, read_only=True)

    def end(self) -> None:
        """End the solve; raises `KeptView` if a view is left."""
        self._open = False
        self._views.end()


def _grid_of(given: library.Grid, known: Grid | None) -> Grid:
    """Copy a grid obtained from the library; vertices keep the connectivity of the known grid."""
    shape: Structured | Quadrilaterals | Vertices
    if given.kind == library.STRUCTURED:
        shape = Structured(
            tuple(given.origin), tuple(given.step_i), tuple(given.step_j), given.ni, given.nj
        )
    elif given.kind == library.VERTICES:
        points = np.ctypeslib.as_array(given.vertices, (given.vertex_count, 3)).copy()
        before = known.shape if known else None
        if isinstance(before, Vertices):
            shape = replace(before, points_xyz=points)
        else:
            shape = Vertices(points)
    else:
        vertices = np.ctypeslib.as_array(given.vertices, (given.vertex_count, 3))
        elements = np.ctypeslib.as_array(given.elements, (given.points, 4))
        shape = Quadrilaterals(vertices.copy(), elements.copy())
    return Grid(given.name.decode(), shape, given.revision)


class Outputs(Mapping[str, Array]):
    """Outputs of one call, written directly into shared memory.

    `outputs["lower_temperature"]` is a writable view of shared memory, in the shape that `Inputs`
    describes; `outputs["lower_temperature"] = values` copies values there. A field that nobody
    needs is absent: reading it raises a `KeyError`, assigning to it has no effect. Every value of
    every present field must be written.
    """

    def __init__(
        self,
        lib: Any,
        handle: int,
        kinds: Mapping[str, FieldKind],
        described: frozenset[str],
        private: Mapping[str, Array] | None = None,
    ) -> None:
        self._described, self._private = described, private or {}
        self._views, self._open = Views(), True
        self._places: dict[str, tuple[int, tuple[int, ...]]] = {}
        for field, kind in kinds.items():
            count = c_size_t()
            place = lib.cosim_output(handle, field.encode(), byref(count))
            if place:
                self._places[field] = place, shape_of(kind, count.value // kind.components)
        for field in self:
            # NaN reveals unwritten values.
            self[field] = np.nan

    def __getitem__(self, field: str) -> Array:
        if not self._open:
            raise PortError(f"output `{field}` was accessed after the call")
        if field in self._private:
            return self._private[field]
        return self._views.view(field, *self._places[field], read_only=False)

    def __setitem__(self, field: str, values: ArrayLike) -> None:
        if field in self:
            self[field][...] = values
        elif field not in self._described:
            raise KeyError(f"the description provides no `{field}`")

    def __iter__(self) -> Iterator[str]:
        yield from self._places
        yield from self._private

    def __len__(self) -> int:
        return len(self._places) + len(self._private)

    def __contains__(self, field: object) -> bool:
        return field in self._places or field in self._private

    def end(self) -> None:
        """End the call: every value must be written, and no view may be left."""
        for field in self._places:
            values = self[field]
            index = first_non_finite(values)
            if index is not None:
                raise PortError(
                    f"output `{field}` is not finite at index {index} "
                    f"({float(values.flat[index])}), or was not written there"
                )
            del values
        self._open = False
        self._views.end()
