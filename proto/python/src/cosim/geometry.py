"""Grids that move, and volumes.

What a participant publishes of its own, and what it receives of others'.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .fields import FieldKind
from .grids import Grid
from .messages import PROTOCOL_VERSION, FieldHeader, text_of
from .solver import Step
from .views import Views
from .volumes import Volume

if TYPE_CHECKING:
    from .transport import Endpoint, FieldWriter, Receiver

GEOMETRY = FieldKind("geometry", "m", 3)


class GeometryError(Exception):
    """A geometry that cannot be, or that did not come."""


@dataclass(frozen=True)
class GeometryTopic:
    """A service that carries the geometry of one grid."""

    grid: str
    service: str
    subscribers: int

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> GeometryTopic:
        """As it travelled."""
        return cls(value["grid"], value["service"], int(value["subscribers"]))


class GeometryPort:
    """One grid of this participant, as it was published last."""

    def __init__(self, grid: Grid, producer: str, writer: FieldWriter) -> None:
        self.grid, self.writer = grid, writer
        self._header = FieldHeader(
            protocol=PROTOCOL_VERSION,
            components=GEOMETRY.components,
            name=GEOMETRY.name.encode(),
            unit=GEOMETRY.unit.encode(),
            producer=producer.encode(),
            grid=grid.name.encode(),
        )

    def publish(self, moved: Grid, step: Step) -> bool:
        """Publish the grid if it has moved; whether it has."""
        try:
            self.grid.check_moved(moved)
        except ValueError as error:
            raise GeometryError(str(error)) from error
        if moved.is_announced:
            raise GeometryError(f"the volume `{moved.name}` is given without geometry")
        if moved.revision == self.grid.revision:
            return False
        values, header = moved.encoded_geometry(), self._header
        loan = self.writer.loan(values.size)
        views = Views()
        owner = (loan.sample, loan.publisher)
        views.view(GEOMETRY.name, loan.pointer, values.shape, owner, read_only=False)[...] = values
        views.end()
        header.sequence += 1
        header.points, header.grid_revision = values.shape[1], moved.revision
        header.window, header.iteration = step.window, step.iteration
        header.start, header.end = step.start, step.end
        self.writer.publish(loan, header)
        self.grid = moved
        return True


class GeometryPorts:
    """The grids of this participant that others follow."""

    def __init__(
        self,
        endpoint: Endpoint,
        topics: Sequence[GeometryTopic],
        producer: str,
        grids: Sequence[Grid],
    ) -> None:
        known = {grid.name: grid for grid in grids}
        self._ports = []
        for topic in topics:
            if topic.grid not in known:
                raise GeometryError(f"there is no grid `{topic.grid}` in the layout")
            grid = known[topic.grid]
            values = 3 * grid.geometry_vectors
            writer = endpoint.field_writer(topic.service, values, topic.subscribers)
            self._ports.append(GeometryPort(grid, producer, writer))

    def __bool__(self) -> bool:
        return bool(self._ports)

    def wait_for_subscribers(self, deadline: float) -> None:
        """Wait until all that follow them are there; `deadline` is monotonic."""
        for port in self._ports:
            port.writer.wait_for_subscribers(deadline)

    def publish(self, grids: Sequence[Grid], step: Step, moved: Callable[[Grid], None]) -> None:
        """Publish those of the grids that have moved, and give each of these to `moved`.

        A volume whose geometry is out need not be given again.
        """
        given = {grid.name: grid for grid in grids}
        for port in self._ports:
            grid = given.get(port.grid.name)
            if grid is None:
                if isinstance(port.grid.shape, Volume):
                    if port.grid.is_announced:
                        name = port.grid.name
                        raise GeometryError(f"the geometry of the volume `{name}` is not given")
                    continue
                raise GeometryError(f"the grid `{port.grid.name}`, which may move, is not given")
            if port.publish(grid, step):
                moved(grid)


class InputGrid:
    """The grid of one input."""

    def __init__(self, grid: Grid, own: bool, reader: Receiver[FieldHeader] | None) -> None:
        self.grid, self._own, self._reader, self._sequence = grid, own, reader, 0

    def moved(self, grid: Grid) -> None:
        """A grid of this very participant has moved."""
        if self._own and grid.name == self.grid.name:
            self.grid = grid

    def follow(self, field: str, revision: int) -> None:
        """Bring the grid to the revision that a sample of `field` is on."""
        while self._reader is not None and self.grid.revision < revision:
            sample = self._reader.receive()
            if sample is None:
                break
            self._sequence += 1
            header, name = sample.header, self.grid.name
            label = (text_of(header.name), text_of(header.grid), header.sequence)
            if label != (GEOMETRY.name, name, self._sequence):
                raise GeometryError(
                    f"the topic of the geometry of `{name}`, number {self._sequence}, carries "
                    f"`{label[0]}` of `{label[1]}`, number {label[2]}"
                )
            vectors = self.grid.geometry_vectors
            if sample.length != 3 * vectors:
                raise GeometryError(
                    f"the geometry of grid `{name}` has {sample.length} values, not {3 * vectors}"
                )
            views = Views()
            shape, owner = (3, vectors), sample.sample
            view = views.view(GEOMETRY.name, sample.pointer, shape, owner, read_only=True)
            values = np.array(view)
            del view
            views.end()
            try:
                self.grid = self.grid.with_geometry(values, header.grid_revision)
            except ValueError as error:
                raise GeometryError(str(error)) from error
        if self.grid.revision != revision:
            raise GeometryError(
                f"input `{field}` is on revision {revision} of grid `{self.grid.name}`, whose "
                f"geometry is known in revision {self.grid.revision}"
            )
