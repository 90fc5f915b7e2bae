"""Grids, on which fields have their values.

Values belong to element centres, on vertices to the points. On a structured grid the value of element (i, j) stands at
`j * ni + i`. In the contact plane, `step_i` points along x, the rolling direction, and `step_j`
along y, to the left. Fields on volumes (`cosim.volumes`) are output only.
"""

from __future__ import annotations

from dataclasses import dataclass, field
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
    """Vector from one element to the next in i [m]."""
    step_j: tuple[float, float, float]
    """Vector from one element to the next in j [m]."""
    ni: int
    """Number of elements in i."""
    nj: int
    """Number of elements in j."""

    kind: ClassVar[str] = "structured"

    @classmethod
    def contact_plane(
        cls, x0: float, y0: float, dx: float, dy: float, nx: int, ny: int
    ) -> Structured:
        """Return a grid in the plane z = 0 with its first element centred on (x0, y0) [m]."""
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
        """Return true if rows run along +x and columns along +y."""
        return (
            self.step_i[1:] == (0.0, 0.0)
            and (self.step_j[0], self.step_j[2]) == (0.0, 0.0)
            and self.dx > 0.0
            and self.dy > 0.0
        )

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
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

    An element is the bilinear patch through its corners. Its centre is the mean of the corners, and
    its area half the length of the cross product of the diagonals.
    """

    points_xyz: Array
    """Vertices [m], shape (vertices, 3)."""
    elements: NDArray[np.uint32]
    """The four vertices of each element, in order around the element, shape (elements, 4)."""

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
        """Convert to JSON."""
        points, elements = self.points_xyz.tolist(), self.elements.tolist()
        return {"kind": self.kind, "points": points, "elements": elements}


def _no_elements(corners: int) -> NDArray[np.uint32]:
    return np.empty((0, corners), dtype=np.uint32)


@dataclass(frozen=True, eq=False)
class Vertices:
    """Points that carry values, with optional edges and triangles between them."""

    points_xyz: Array
    """Points [m], shape (points, 3); z = 0 in a plane mesh."""
    edges: NDArray[np.uint32] = field(default_factory=lambda: _no_elements(2))
    """The two ends of each edge, shape (edges, 2)."""
    triangles: NDArray[np.uint32] = field(default_factory=lambda: _no_elements(3))
    """The three corners of each triangle, shape (triangles, 3)."""
    measure: str = "unknown"
    """Meaning of a conservative field's values: totals of points (`per-point`), densities
    (`per-area`), or densities at points whose areas are `unknown`."""

    kind: ClassVar[str] = "vertices"

    @property
    def points(self) -> int:
        """Number of points."""
        return len(self.points_xyz)

    def centres(self) -> Array:
        """Points [m], shape (points, 3)."""
        return self.points_xyz

    def areas(self) -> Array:
        """Areas of the points, shape (points,).

        Shares of triangles or edges [m²], 1 for totals, 0 for unknown areas.
        """
        if self.measure != "per-area":
            return np.full(self.points, 1.0 if self.measure == "per-point" else 0.0)
        elements = self.triangles if len(self.triangles) else self.edges
        first, *others = np.moveaxis(self.points_xyz[elements], 1, 0)
        sides = [other - first for other in others]
        across = sides[0] if len(sides) == 1 else 0.5 * np.cross(sides[0], sides[1])
        share = np.linalg.norm(across, axis=1) / (1 + len(sides))
        shares, areas = np.repeat(share, 1 + len(sides)), np.zeros(self.points)
        np.add.at(areas, elements.ravel(), shares)
        return areas

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
        return {
            "kind": self.kind,
            "points": self.points_xyz.tolist(),
            "edges": self.edges.tolist(),
            "triangles": self.triangles.tolist(),
            "measure": self.measure,
        }


@dataclass(frozen=True)
class Grid:
    """A named grid with a revision that increases whenever its geometry changes."""

    name: str
    """Name, unique within the participant that owns the grid; at most 31 bytes of ASCII."""
    shape: Structured | Quadrilaterals | Vertices | Volume
    """Geometry."""
    revision: int = -1
    """Revision, from 1; 0 is an announced volume without geometry."""

    def __post_init__(self) -> None:
        """Set the first revision."""
        if self.revision < 0:
            object.__setattr__(self, "revision", 0 if self.is_announced else 1)

    @property
    def is_announced(self) -> bool:
        """True for a volume whose geometry is to follow."""
        return isinstance(self.shape, Volume) and self.shape.geometry is None

    def announced(self) -> Grid:
        """Return the grid as declared in a layout: for a volume only the elements."""
        if isinstance(self.shape, Volume):
            return Grid(self.name, self.shape.announced())
        return self

    @property
    def points(self) -> int:
        """Number of elements or vertices, that is, of values of a one-component field."""
        return self.shape.points

    def centres(self) -> Array:
        """Element centres [m], shape (points, 3)."""
        return self.shape.centres()

    def areas(self) -> Array:
        """Element areas [m²], shape (points,)."""
        return self._surface().areas()

    def integrate(self, values: Array) -> float:
        """Return the surface integral of a one-component field [unit m²], by pairwise summation."""
        if isinstance(self.shape, Structured):
            return self.shape.element_area * float(np.sum(values))
        return float(np.sum(self.areas() * values))

    def moved(self, shape: Structured | Quadrilaterals | Vertices | Volume) -> Grid:
        """Return this grid with another geometry, in the next revision.

        Quadrilaterals, vertices and volumes move only their points.
        """
        return Grid(self.name, shape, self.revision + 1)

    def encoded_geometry(self) -> Array:
        """Return the geometry as the values of a field [m], shape (3, vectors).

        A structured grid has its origin, its steps and (ni, nj, 1); quadrilaterals and
        vertices have their points, and a volume has `Volume.geometry`; see `proto/grids/src/geometry.rs`.
        """
        shape = self.shape
        if isinstance(shape, Volume):
            return shape.known()
        if isinstance(shape, Structured):
            counts = (float(shape.ni), float(shape.nj), 1.0)
            return np.array([shape.origin, shape.step_i, shape.step_j, counts]).T
        return shape.points_xyz.T

    def is_where(self, other: Grid) -> bool:
        """Return true if both grids have the same geometry."""
        if self.is_announced or other.is_announced:
            return self.is_announced == other.is_announced
        return np.array_equal(self.encoded_geometry(), other.encoded_geometry())

    def _surface(self) -> Structured | Quadrilaterals | Vertices:
        if isinstance(self.shape, Volume):
            raise TypeError(f"`{self.name}` is a volume, without areas")
        return self.shape

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
        return {"name": self.name, "revision": self.revision, **self.shape.to_json()}

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> Grid:
        """Read the grid of an input from JSON."""
        shape: Structured | Quadrilaterals | Vertices
        if value["kind"] == Structured.kind:
            origin, step_i, step_j = (
                _vector(value[name]) for name in ("origin", "step_i", "step_j")
            )
            shape = Structured(origin, step_i, step_j, int(value["ni"]), int(value["nj"]))
        elif value["kind"] == Quadrilaterals.kind:
            vertices = np.array(value["points"], dtype=np.float64).reshape(-1, 3)
            elements = np.array(value["elements"], dtype=np.uint32).reshape(-1, 4)
            shape = Quadrilaterals(vertices, elements)
        elif value["kind"] == Vertices.kind:
            points = np.array(value["points"], dtype=np.float64).reshape(-1, 3)
            edges = np.array(value.get("edges", []), dtype=np.uint32).reshape(-1, 2)
            triangles = np.array(value.get("triangles", []), dtype=np.uint32).reshape(-1, 3)
            shape = Vertices(points, edges, triangles, value["measure"])
        else:
            raise ValueError(f"unknown kind of grid `{value['kind']}`")
        return cls(value["name"], shape, int(value["revision"]))


def _vector(values: list[float]) -> tuple[float, float, float]:
    x, y, z = map(float, values)
    return x, y, z
