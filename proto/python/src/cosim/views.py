"""numpy views of shared memory, with detection of views kept too long.

numpy cannot take back the memory of an array. Therefore every view is based on a `Place`:

- The array's `base` is the place, so the place lives as long as any array, slice or reshape of it.
  At the end of a call, every place must be gone. A place that remains was kept by the solver and
  raises an error with the name of the field, because its memory belongs to the library again.
- A place of an input offers read-only memory and no writable buffer, so that numpy refuses both
  a write and `setflags(write=True)`. The memory is mapped read-only; a write would end the process.
"""

from __future__ import annotations

import gc
import weakref

import numpy as np

from .grids import Array


class KeptView(Exception):
    """The solver has kept an array of an input or output beyond the end of its call."""

    def __init__(self, field: str) -> None:
        super().__init__(
            f"an array of `{field}` was kept beyond the call; it is a view of shared memory: "
            f"keep a copy, as in `numpy.array(inputs[{field!r}])`"
        )


class Place:
    """Memory on which arrays may be based."""

    __slots__ = ("__array_interface__", "__weakref__")

    def __init__(self, pointer: int, shape: tuple[int, ...], read_only: bool) -> None:
        self.__array_interface__ = {
            "version": 3,
            "shape": shape,
            "typestr": "<f8",
            "data": (pointer, read_only),
        }


class Views:
    """Views handed out during one call."""

    def __init__(self) -> None:
        self._places: list[tuple[str, weakref.ref[Place]]] = []

    def view(
        self, field: str, pointer: int, shape: tuple[int, ...], *, read_only: bool
    ) -> Array:
        """Return a new array over doubles at `pointer`."""
        place = Place(pointer, shape, read_only)
        self._places.append((field, weakref.ref(place)))
        return np.asarray(place)

    def end(self) -> None:
        """Check that no view is left; raises `KeptView`."""
        if self._kept() is not None:
            # Views in unreachable cycles are not kept by the solver.
            gc.collect()
            kept = self._kept()
            if kept is not None:
                self._places.clear()
                raise KeptView(kept)
        self._places.clear()

    def _kept(self) -> str | None:
        return next((field for field, place in self._places if place() is not None), None)
