"""numpy views of shared memory that cannot be kept unnoticed.

numpy has no way to take an array's memory back. Therefore every view stands on a `Place`:

- the array's `base` is the place, so that the place lives as long as any array, slice or reshape of
  it. When a call is over, every place must be gone. One that is not was kept, and is an error with
  the name of the field: what it shows is the library's again.
- A place of an input offers its memory read-only and no writable buffer, so that numpy refuses both
  a write and `setflags(write=True)`. The memory is mapped read-only; a write would end the process.
"""

from __future__ import annotations

import gc
import weakref

import numpy as np

from .grids import Array


class KeptView(Exception):
    """A solver has kept an array of an input or output beyond the call that it was given to."""

    def __init__(self, field: str) -> None:
        super().__init__(
            f"an array of `{field}` was kept beyond the call; it is a view of shared memory: "
            f"keep a copy, as in `numpy.array(inputs[{field!r}])`"
        )


class Place:
    """Memory that arrays may stand on."""

    __slots__ = ("__array_interface__", "__weakref__")

    def __init__(self, pointer: int, shape: tuple[int, ...], read_only: bool) -> None:
        self.__array_interface__ = {
            "version": 3,
            "shape": shape,
            "typestr": "<f8",
            "data": (pointer, read_only),
        }


class Views:
    """The views given out during one call."""

    def __init__(self) -> None:
        self._places: list[tuple[str, weakref.ref[Place]]] = []

    def view(
        self, field: str, pointer: int, shape: tuple[int, ...], *, read_only: bool
    ) -> Array:
        """A new array over doubles at `pointer`."""
        place = Place(pointer, shape, read_only)
        self._places.append((field, weakref.ref(place)))
        return np.asarray(place)

    def end(self) -> None:
        """Demand that no view is left; raises `KeptView`."""
        if self._kept() is not None:
            # Views in a cycle of garbage are nobody's.
            gc.collect()
            kept = self._kept()
            if kept is not None:
                self._places.clear()
                raise KeptView(kept)
        self._places.clear()

    def _kept(self) -> str | None:
        return next((field for field, place in self._places if place() is not None), None)
