"""Fields of a result: the VTK series written by a run, as arrays with coordinates and units.

Reads `.vti` files (grids of equal elements) as written by the coordinator, with raw appended arrays
of doubles.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from .progress import needs

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]


class Fault(ValueError):
    """A file that is not a series of the coordinator."""


@dataclass(frozen=True)
class Field:
    """A field at one time.

    `values` has the axes (y, x), or (z, x) for a vertical section; vector components are an
    additional last axis. `x`, `y` and `z` are element centres [m], with a single value along an
    axis that has only one element.
    """

    name: str
    unit: str
    time: float
    values: Array
    x: Array
    y: Array
    z: Array

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes of `values`, without components."""
        return ("z", "x") if len(self.z) > 1 else ("y", "x")

    @property
    def magnitude(self) -> Array:
        """Magnitudes of vectors; for a scalar field its values."""
        return (
            np.asarray(np.linalg.norm(self.values, axis=-1))
            if self.values.ndim == 3
            else self.values
        )

    def to_xarray(self) -> xarray.DataArray:
        """Return the field with its coordinates; needs xarray."""
        with needs("frames"):
            import xarray  # noqa: PLC0415

        axes = [*self.axes, *(("component",) if self.values.ndim == 3 else ())]
        places: dict[str, Any] = {
            name: (name, getattr(self, name), {"units": "m"}) for name in self.axes
        }
        if self.values.ndim == 3:
            places["component"] = ["x", "y", "z"][: self.values.shape[-1]]
        return xarray.DataArray(
            self.values,
            places,
            axes,
            name=self.name,
            attrs={"units": self.unit, "time_s": self.time},
        )


class Fields(Mapping[str, Field]):
    """Fields of a result by name, each at the last time; `at` returns other times."""

    def __init__(self, folder: Path) -> None:
        self._times: dict[Path, float] = {}
        self._files: dict[str, list[Path]] = {}
        for collection in sorted(folder.glob("*.pvd")):
            entries = ElementTree.parse(collection).getroot().iter("DataSet")
            files = [
                (folder / entry.attrib["file"], float(entry.attrib["timestep"]))
                for entry in entries
            ]
            self._times.update(files)
            if not files or files[0][0].suffix != ".vti":
                continue
            for array in header(files[0][0])[1].iter("DataArray"):
                if array.get("format") == "appended":
                    name = array.attrib["Name"].split(" [")[0]
                    self._files.setdefault(name, [path for path, _ in files])

    def __getitem__(self, name: str) -> Field:
        """Return the field at the last time."""
        return self.at(name, -1)

    def __iter__(self) -> Iterator[str]:
        return iter(self._files)

    def __len__(self) -> int:
        return len(self._files)

    def __repr__(self) -> str:
        return f"Fields({', '.join(self)})"

    def times(self, name: str) -> Array:
        """Return the times of a field [s]."""
        return np.array([self._times[path] for path in self._of(name)])

    def at(self, name: str, instant: int) -> Field:
        """Return the field at a time, by index from 0, or from the end by negative indices."""
        path = self._of(name)[instant]
        return read(path, name, self._times[path])

    def _of(self, name: str) -> list[Path]:
        if name not in self._files:
            known = ", ".join(self) or 'none: [output] fields = "none", or volumes alone'
            raise KeyError(f"no field `{name}` on a grid of equal elements; there are {known}")
        return self._files[name]


def header(path: Path) -> tuple[bytes, ElementTree.Element, int]:
    """Return the content of a file, its description, and the offset of its arrays."""
    data = path.read_bytes()
    mark = data.find(b'<AppendedData encoding="raw">')
    start = data.find(b"_", mark) + 1
    if mark < 0 or start == 0:
        raise Fault(f"{path} has no raw appended arrays")
    try:
        return data, ElementTree.fromstring(data[:mark] + b"</VTKFile>"), start
    except ElementTree.ParseError as error:
        raise Fault(f"{path}: {error}") from error


def read(path: Path, name: str, time: float) -> Field:
    """Read an array from a file with equal elements."""
    try:
        return parse(path, name, time)
    except (KeyError, IndexError, ValueError, OverflowError, UnicodeError) as error:
        if isinstance(error, Fault):
            raise
        raise Fault(f"{path} is not a file with equal elements: {error!r}") from error


def parse(path: Path, name: str, time: float) -> Field:
    """Parse an array; a damaged file may raise any error of a value."""
    data, root, start = header(path)
    image = root.find("ImageData")
    if image is None:
        raise Fault(f"{path} has no grid of equal elements")
    ends = [int(one) for one in image.attrib["WholeExtent"].split()]
    counts = [max(ends[2 * k + 1] - ends[2 * k], 1) for k in range(3)]
    origin, side = (
        [float(one) for one in image.attrib[key].split()] for key in ("Origin", "Spacing")
    )
    inside = [0.5 if ends[2 * k + 1] > ends[2 * k] else 0.0 for k in range(3)]
    for array in root.iter("DataArray"):
        label = array.attrib.get("Name", "")
        if array.get("format") != "appended" or label.split(" [")[0] != name:
            continue
        components = int(array.get("NumberOfComponents", "1"))
        count = components * counts[0] * counts[1] * counts[2]
        begin = start + int(array.attrib["offset"])
        if int.from_bytes(data[begin : begin + 8], "little") != 8 * count:
            raise Fault(f"{path}: `{name}` does not have the {count} values of its grid")
        values = np.frombuffer(data, "<f8", count, begin + 8)
        x, y, z = (
            np.asarray(origin[k] + (np.arange(counts[k]) + inside[k]) * side[k], np.float64)
            for k in range(3)
        )
        shape = [counts[2], counts[0]] if counts[2] > 1 else [counts[1], counts[0]]
        values = values.reshape([*shape, components] if components > 1 else shape)
        return Field(name, label.partition(" [")[2].rstrip("]"), time, values, x, y, z)
    raise Fault(f"{path} has no `{name}`")
