"""Volumes of hexahedra, for output fields only.

A volume is announced by the kind and counts of its elements. The geometry follows as the values of
a field, and is stored in the same layout (`proto/grids/src/volume.rs`). The value of element (i, j,
k) stands at `(k * nj + j) * ni + i`. Corners are in VTK's order: counter-clockwise round one face,
seen from the opposite face, which follows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Array = NDArray[np.float64]

_MOST = 1 << 32


@dataclass(frozen=True, eq=False)
class Volume:
    """Hexahedra, with or without their geometry."""

    hexahedra: str
    """`rectilinear`, `structured` or `unstructured`."""
    counts: tuple[int, ...]
    """Numbers of elements in i, j and k; for unstructured hexahedra those of vertices and
    elements."""
    geometry: _Array | None = None
    """Geometry in the layout of the field [m], shape (3, vectors); `None` while it is to follow."""

    kind: ClassVar[str] = "volume"
    _COUNTS: ClassVar[dict[str, tuple[str, ...]]] = {
        "rectilinear": ("ni", "nj", "nk"),
        "structured": ("ni", "nj", "nk"),
        "unstructured": ("vertices", "elements"),
    }

    @classmethod
    def rectilinear(cls, x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Volume:
        """Return boxes between the nodes of three axes [m], each strictly increasing."""
        axes = [np.asarray(axis, dtype=np.float64) for axis in (x, y, z)]
        geometry = np.zeros((3, max(len(axis) for axis in axes)))
        for row, axis in zip(geometry, axes, strict=True):
            row[: len(axis)] = axis
        return cls("rectilinear", tuple(len(axis) - 1 for axis in axes), geometry)

    @classmethod
    def structured(cls, counts: Sequence[int], vertices: ArrayLike) -> Volume:
        """Return a volume with `counts` elements in i, j, k; vertices [m], shape (vertices, 3), i
        fastest, then j."""
        ni, nj, nk = map(int, counts)
        return cls("structured", (ni, nj, nk), np.array(_vectors(vertices).T))

    @classmethod
    def unstructured(cls, vertices: ArrayLike, elements: ArrayLike) -> Volume:
        """Return a volume from vertices [m], shape (vertices, 3), and the eight vertices of each
        element."""
        places = _vectors(vertices)
        corners = np.asarray(elements, dtype=np.float64).reshape(-1, 8)
        padded = np.column_stack([corners, np.zeros(len(corners))]).reshape(-1, 3)
        geometry = np.array(np.concatenate([places, padded]).T)
        return cls("unstructured", (len(places), len(corners)), geometry)

    def announced(self) -> Volume:
        """Return the same elements, with a geometry that is to follow."""
        return Volume(self.hexahedra, self.counts)

    def known(self) -> _Array:
        """Return the geometry; raises `ValueError` if it is to follow."""
        if self.geometry is None:
            raise ValueError("the geometry of a volume precedes whatever is on it")
        return self.geometry

    @property
    def points(self) -> int:
        """Number of elements."""
        if self.hexahedra == "unstructured":
            return self.counts[1]
        return int(np.prod([int(count) for count in self.counts], dtype=object))

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        if self.hexahedra == "unstructured":
            return self.counts[0]
        return int(np.prod([int(count) + 1 for count in self.counts], dtype=object))

    def vertices(self) -> _Array:
        """Vertices [m], shape (vertices, 3)."""
        geometry = self.known()
        if self.hexahedra == "rectilinear":
            x, y, z = (row[: n + 1] for row, n in zip(geometry, self.counts, strict=True))
            k, j, i = np.meshgrid(z, y, x, indexing="ij")
            return np.column_stack([i.ravel(), j.ravel(), k.ravel()])
        return np.asarray(geometry[:, : self.vertex_count].T)

    def elements(self) -> NDArray[np.int64]:
        """Return the eight vertices of each element, shape (points, 8)."""
        if self.hexahedra == "unstructured":
            numbers = self.known()[:, self.vertex_count :].T.reshape(-1, 9)
            return numbers[:, :8].astype(np.int64)
        ni, nj, nk = self.counts
        in_j, in_k = ni + 1, (ni + 1) * (nj + 1)
        k, j, i = np.meshgrid(np.arange(nk), np.arange(nj), np.arange(ni), indexing="ij")
        first = (k * in_k + j * in_j + i).ravel()[:, None]
        face = np.array([0, 1, 1 + in_j, in_j])
        return np.asarray(first + np.concatenate([face, face + in_k]), dtype=np.int64)

    def centres(self) -> _Array:
        """Element centres, the means of their corners [m], shape (points, 3)."""
        return np.asarray(self.vertices()[self.elements()].mean(axis=1), dtype=np.float64)

    def volumes(self) -> _Array:
        """Volumes of the elements [m³], shape (points,): J. Grandy, UCRL-ID-128886 (1997)."""
        p = self.vertices()[self.elements()].swapaxes(0, 1)
        from_1, from_3, from_4 = p[6] - p[1], p[6] - p[3], p[6] - p[4]
        to_2, to_5, to_7 = p[2] - p[0], p[5] - p[0], p[7] - p[0]
        twelve = _triple(from_1 + to_7, from_3, to_2) + _triple(to_7, from_3 + to_5, from_4)
        return np.asarray((twelve + _triple(from_1, to_5, from_4 + to_2)) / 12.0)

    def to_json(self) -> dict[str, Any]:
        """Convert kind and counts to JSON."""
        counts = zip(self._COUNTS[self.hexahedra], map(int, self.counts), strict=True)
        return {"kind": self.kind, "hexahedra": self.hexahedra, **dict(counts)}


def _vectors(places: ArrayLike) -> _Array:
    return np.asarray(places, dtype=np.float64).reshape(-1, 3)


def _triple(a: _Array, b: _Array, c: _Array) -> _Array:
    return np.asarray(np.einsum("nk,nk->n", a, np.cross(b, c)))
