"""Grids: where the values of a field live.

Values belong to element centres. On a structured grid the value of element (i, j) stands at
`j * ni + i`; for the contact plane `step_i` points along x, the rolling direction, and `step_j`
along y, to the left. Fields on volumes (`cosim.volumes`) are only written out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .volumes import Volume

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Structured:
    """Plane patch of `ni` x `nj` equal parallelogram elements."""

    origin: tuple[float, float, float]
    """Centre of element (0, 0) [m]."""
    step_i: tuple[float, float, float]
    """From one element to the next in i [m]."""
    step_j: tuple[float, float, float]
    """From one element to the next in j [m]."""
    ni: int
    """Number of elements in i."""
    nj: int
    """Number of elements in j."""

    kind: ClassVar[str] = "structured"

    @classmethod
    def contact_plane(
        cls, x0: float, y0: float, dx: float, dy: float, nx: int, ny: int
    ) -> Structured:
        """In the plane z = 0, with its first element centred on (x0, y0) [m]."""
        return cls((x0, y0, 0.0), (dx, 0.0, 0.0), (0.0, dy, 0.0), nx, ny)

    @property
    def points(self) -> int:
        """Number of elements."""
        return self.ni * self.nj

    @property
    def dx(self) -> float:
        """Element length along x of a contact-plane grid [m]."""
        return self.step_i[0]

    @property
    def dy(self) -> float:
        """Element length along y of a contact-plane grid [m]."""
        return self.step_j[1]

    @property
    def x(self) -> Array:
        """x of the columns [m], shape (ni,)."""
        return np.asarray(self.origin[0] + np.arange(self.ni) * self.step_i[0], dtype=np.float64)

    @property
    def y(self) -> Array:
        """y of the rows [m], shape (nj,)."""
        return np.asarray(self.origin[1] + np.arange(self.nj) * self.step_j[1], dtype=np.float64)

    def centres(self) -> Array:
        """Element centres [m], shape (points, 3)."""
        i, j = np.tile(np.arange(self.ni), self.nj), np.repeat(np.arange(self.nj), self.ni)
        origin, along, across = map(np.asarray, (self.origin, self.step_i, self.step_j))
        return np.asarray(origin + i[:, None] * along + j[:, None] * across, dtype=np.float64)

    def areas(self) -> Array:
        """Element areas [m²], shape (points,)."""
        return np.full(self.points, self.element_area)

    @property
    def element_area(self) -> float:
        """Area of one element [m²]."""
        return float(np.linalg.norm(np.cross(self.step_i, self.step_j)))

    def is_contact_plane(self) -> bool:
        """Its rows run along x and its columns along y, both upwards."""
        return (
            self.step_i[1:] == (0.0, 0.0)
            and (self.step_j[0], self.step_j[2]) == (0.0, 0.0)
            and self.dx > 0.0
            and self.dy > 0.0
        )

    def to_json(self) -> dict[str, Any]:
        """As it travels."""
        return {
            "kind": self.kind,
            "origin": [float(v) for v in self.origin],
            "step_i": [float(v) for v in self.step_i],
            "step_j": [float(v) for v in self.step_j],
            "ni": int(self.ni),
            "nj": int(self.nj),
        }


@dataclass(frozen=True, eq=False)
class Quadrilaterals:
    """Unstructured surface of quadrilaterals over shared vertices.

    An element is the bilinear patch through its corners; its centre is their mean, and its area
    half the length of the cross product of its diagonals.
    """

    points_xyz: Array
    """Vertices [m], shape (vertices, 3)."""
    elements: NDArray[np.uint32]
    """The four vertices of each element, in order round it, shape (elements, 4)."""

    kind: ClassVar[str] = "quadrilaterals"

    @property
    def points(self) -> int:
        """Number of elements."""
        return len(self.elements)

    def corners(self) -> Array:
        """Corners of the elements [m], shape (elements, 4, 3)."""
        return self.points_xyz[self.elements]

    def centres(self) -> Array:
        """Element centres [m], shape (points, 3)."""
        return np.asarray(self.corners().mean(axis=1), dtype=np.float64)

    def areas(self) -> Array:
        """Element areas [m²], shape (points,)."""
        a, b, c, d = self.corners().swapaxes(0, 1)
        return np.asarray(0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=1), dtype=np.float64)

    def to_json(self) -> dict[str, Any]:
        """As it travels."""
        points, elements = self.points_xyz.tolist(), self.elements.tolist()
        return {"kind": self.kind, "points": points, "elements": elements}


@dataclass(frozen=True)
class Grid:
    """A named grid with a revision that rises whenever its geometry changes."""

    name: str
    """Unique within the participant that owns it; at most 31 bytes of ASCII."""
    shape: Structured | Quadrilaterals | Volume
    """Geometry."""
    revision: int = -1
    """The first is 1; 0, a volume that is announced, whose geometry is to follow."""

    def __post_init__(self) -> None:
        """Begin with the first revision."""
        if self.revision < 0:
            object.__setattr__(self, "revision", 0 if self.is_announced else 1)

    @property
    def is_announced(self) -> bool:
        """A volume whose geometry is to follow."""
        return isinstance(self.shape, Volume) and self.shape.geometry is None

    def announced(self) -> Grid:
        """What a layout says of the grid: of a volume the elements alone."""
        if isinstance(self.shape, Volume):
            return Grid(self.name, self.shape.announced())
        return self

    @property
    def points(self) -> int:
        """Number of elements, that is, of values of a one-component field."""
        return self.shape.points

    def centres(self) -> Array:
        """Element centres [m], shape (points, 3)."""
        return self.shape.centres()

    def areas(self) -> Array:
        """Element areas [m²], shape (points,)."""
        return self._surface().areas()

    def integrate(self, values: Array) -> float:
        """Surface integral of a one-component field [unit m²]; pairwise summation."""
        if isinstance(self.shape, Structured):
            return self.shape.element_area * float(np.sum(values))
        return float(np.sum(self.areas() * values))

    def moved(self, shape: Structured | Quadrilaterals | Volume) -> Grid:
        """This grid with another geometry, in the next revision.

        Of quadrilaterals and volumes only the vertices move.
        """
        return Grid(self.name, shape, self.revision + 1)

    def encoded_geometry(self) -> Array:
        """The geometry as the values of a field [m], shape (3, vectors).

        For a structured grid its origin, its steps and (ni, nj, 1), for quadrilaterals their
        vertices, and for a volume what `Volume.geometry` is: `proto/grids/src/geometry.rs`.
        """
        shape = self.shape
        if isinstance(shape, Volume):
            return shape.known()
        if isinstance(shape, Structured):
            counts = (float(shape.ni), float(shape.nj), 1.0)
            return np.array([shape.origin, shape.step_i, shape.step_j, counts]).T
        return shape.points_xyz.T

    def is_where(self, other: Grid) -> bool:
        """The other one has the same geometry."""
        if self.is_announced or other.is_announced:
            return self.is_announced == other.is_announced
        return np.array_equal(self.encoded_geometry(), other.encoded_geometry())

    def _surface(self) -> Structured | Quadrilaterals:
        if isinstance(self.shape, Volume):
            raise TypeError(f"`{self.name}` is a volume, without areas")
        return self.shape

    def to_json(self) -> dict[str, Any]:
        """As it travels."""
        return {"name": self.name, "revision": self.revision, **self.shape.to_json()}

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> Grid:
        """As it travelled, of an input."""
        shape: Structured | Quadrilaterals
        if value["kind"] == Structured.kind:
            origin, step_i, step_j = (
                _vector(value[name]) for name in ("origin", "step_i", "step_j")
            )
            shape = Structured(origin, step_i, step_j, int(value["ni"]), int(value["nj"]))
        elif value["kind"] == Quadrilaterals.kind:
            vertices = np.array(value["points"], dtype=np.float64).reshape(-1, 3)
            elements = np.array(value["elements"], dtype=np.uint32).reshape(-1, 4)
            shape = Quadrilaterals(vertices, elements)
        else:
            raise ValueError(f"unknown kind of grid `{value['kind']}`")
        return cls(value["name"], shape, int(value["revision"]))


def _vector(values: list[float]) -> tuple[float, float, float]:
    x, y, z = map(float, values)
    return x, y, z
