"""The field ports of a participant: inputs read in place, outputs written into loans."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .fields import FieldKind
from .geometry import GeometryTopic, InputGrid
from .grids import Array, Grid
from .messages import PROTOCOL_VERSION, Command, FieldHeader, text_of
from .solver import MissingInput, NonFiniteInput, Step, first_non_finite
from .views import Views

if TYPE_CHECKING:
    from .transport import Endpoint, FieldLoan, FieldWriter, Received, Receiver


class PortError(Exception):
    """What is wrong with a sample that arrived, or did not, or cannot be sent."""


@dataclass(frozen=True)
class Topic:
    """A service that carries one field."""

    field: str
    service: str
    grid: Grid
    subscribers: int
    geometry: str | None
    """The service that carries the geometry of the grid, if it may move."""

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> Topic:
        """As it travelled."""
        grid, geometry = Grid.from_json(value["grid"]), value.get("geometry")
        return cls(value["field"], value["service"], grid, int(value["subscribers"]), geometry)


def shape_of(kind: FieldKind, grid: Grid) -> tuple[int, ...]:
    """(points,) for one component, (components, points) for more."""
    return (grid.points,) if kind.components == 1 else (kind.components, grid.points)


class InputPort:
    """One input and the sample that is in use."""

    def __init__(
        self, kind: FieldKind, place: InputGrid, reader: Receiver[FieldHeader], varies: bool
    ) -> None:
        self.kind, self.place = kind, place
        self._reader, self._varies = reader, varies
        self.sample: Received[FieldHeader] | None = None
        self._start: Array | None = None
        self._start_in_use = False

    @property
    def grid(self) -> Grid:
        """The grid that the sample in use is on."""
        return self.place.grid

    @property
    def _sequence(self) -> int:
        return 0 if self.sample is None else int(self.sample.header.sequence)

    def advance(self, expected: int, window: int) -> None:
        """Move on to the sample with this sequence number; every one before must have come too.

        Newer ones stay in the queue: a producer that solves at the same time may be ahead. The last
        sample of an earlier window is the accepted one: its values are those at the start of
        `window`, however often that is begun again.
        """
        while self._sequence < expected:
            sample = self._reader.receive()
            if sample is None:
                break
            if sample.header.sequence != self._sequence + 1:
                raise self._out_of_sequence(sample.header.sequence, self._sequence + 1)
            self._check(sample)
            self._keep_start(window)
            self.sample = sample
        if self._varies:
            self._start_in_use = self._is_earlier(window)
        if self._sequence != expected:
            raise self._out_of_sequence(self._sequence, expected)
        if self.sample is not None:
            self._settle(self.sample)

    def _settle(self, sample: Received[FieldHeader]) -> None:
        """Bring the grid to the sample's revision, and demand a value for each of its points."""
        header, kind = sample.header, self.kind
        self.place.follow(kind.name, int(header.grid_revision))
        expected = self.grid.points * kind.components
        if sample.length != expected:
            raise PortError(
                f"input `{kind.name}` from `{text_of(header.producer)}` has {sample.length} "
                f"values, expected {expected}"
            )
        start = self._start
        if not self._start_in_use and start is not None and start.size != expected:
            raise PortError(
                f"input `{kind.name}` cannot be interpolated linearly from {start.size} values to "
                f'{expected}: its grid has grown; set coupling.interpolation to "constant"'
            )

    def _is_earlier(self, window: int) -> bool:
        if self.sample is None:
            return False
        header = self.sample.header
        return bool(header.window < window or header.iteration == 0)

    def _keep_start(self, window: int) -> None:
        if self._varies and self._is_earlier(window):
            views = Views()
            self._start = np.array(self.view(views))
            self._start.flags.writeable = False

    def _out_of_sequence(self, found: int, expected: int) -> PortError:
        return PortError(
            f"input `{self.kind.name}` has sequence number {found}, expected {expected}: a sample "
            "is missing"
        )

    def _check(self, sample: Received[FieldHeader]) -> None:
        header, kind = sample.header, self.kind
        if header.protocol != PROTOCOL_VERSION:
            raise PortError(f"input `{kind.name}` has protocol version {header.protocol}")
        if text_of(header.name) != kind.name:
            raise PortError(f"the topic of `{kind.name}` carries `{text_of(header.name)}`")

    def view(self, views: Views) -> Array:
        """A read-only view of the sample in use."""
        if self.sample is None:
            raise MissingInput(self.kind.name)
        received, components = self.sample, self.kind.components
        # Of a sample that is about to be replaced, the grid may have moved on already.
        points = received.length // components
        shape = (points,) if components == 1 else (components, points)
        owner = received.sample
        return views.view(self.kind.name, received.pointer, shape, owner, read_only=True)

    def start(self, views: Views) -> Array | None:
        """The values at the start of the window; `None` for an input that does not vary."""
        if not self._varies:
            return None
        return self.view(views) if self._start_in_use else self._start


class Inputs(Mapping[str, Array]):
    """Inputs of one solve, read in place.

    `inputs["friction_power"]` is a read-only view of shared memory, of shape (points,) for a field
    of one component and (components, points) for more. Views end with the solve.
    """

    def __init__(self, ports: Mapping[str, InputPort]) -> None:
        self._ports, self._views, self._open = ports, Views(), True

    def __getitem__(self, field: str) -> Array:
        return self._port(field).view(self._views)

    def __iter__(self) -> Iterator[str]:
        return iter(self._ports)

    def __len__(self) -> int:
        return len(self._ports)

    def __contains__(self, field: object) -> bool:
        return field in self._ports

    def grid(self, field: str) -> Grid:
        """The grid of an input."""
        return self._port(field).grid

    def start(self, field: str) -> Array | None:
        """Values of a field at the start of the window, read-only, of the shape of `inputs[field]`.

        Within the window the field goes in a straight line from these to those. `None` for a field
        that does not vary within a window.
        """
        return self._port(field).start(self._views)

    def finite(self, field: str) -> Array:
        """`inputs[field]`, with NaN and infinity refused; raises `NonFiniteInput`."""
        values = self[field]
        index = first_non_finite(values)
        if index is not None:
            raise NonFiniteInput(field, index, float(values.flat[index]))
        return values

    def _port(self, field: str) -> InputPort:
        if not self._open:
            raise PortError(f"input `{field}` was asked for after the solve")
        if field not in self._ports:
            raise MissingInput(field)
        return self._ports[field]

    def end(self) -> None:
        """The solve is over; raises `KeptView` if a view is left."""
        self._open = False
        self._views.end()


def open_inputs(
    endpoint: Endpoint,
    topics: Sequence[Topic],
    kinds: Sequence[FieldKind],
    interpolation: str,
    own: Sequence[GeometryTopic],
) -> dict[str, InputPort]:
    """The ports of all inputs, in the order of the configuration."""
    ports: dict[str, InputPort] = {}
    places: dict[str, InputGrid] = {}
    for topic, kind in zip(topics, kinds, strict=True):
        if topic.field != kind.name:
            raise PortError(f"the topic of `{kind.name}` carries `{topic.field}`")
        varies = interpolation == "linear" and kind.mapping == "consistent"
        reader = endpoint.field_reader(topic.service)
        # Inputs on one grid that moves share it.
        place = places.get(topic.geometry or "") or _place(endpoint, topic, own)
        if topic.geometry:
            places[topic.geometry] = place
        ports[kind.name] = InputPort(kind, place, reader, varies)
    return ports


def _place(endpoint: Endpoint, topic: Topic, own: Sequence[GeometryTopic]) -> InputGrid:
    is_own = any(geometry.service == topic.geometry for geometry in own)
    follows = topic.geometry is not None and not is_own
    reader = endpoint.field_reader(str(topic.geometry)) if follows else None
    return InputGrid(topic.grid, is_own, reader)


def advance(ports: Mapping[str, InputPort], command: Command) -> None:
    """Move every input on to the sample that a command names."""
    for port, expected in zip(ports.values(), command.expected, strict=False):
        port.advance(expected, command.window)


class OutputPort:
    """One output, its writer, and the loan that is being written."""

    def __init__(self, kind: FieldKind, topic: Topic, producer: str, writer: FieldWriter) -> None:
        self.kind, self.shape, self.writer = kind, shape_of(kind, topic.grid), writer
        self._grid_name, self.values = topic.grid.name, topic.grid.points * kind.components
        self.loan: FieldLoan | None = None
        self.header = FieldHeader(
            protocol=PROTOCOL_VERSION,
            components=kind.components,
            points=topic.grid.points,
            grid_revision=topic.grid.revision,
            name=kind.name.encode(),
            unit=kind.unit.encode(),
            producer=producer.encode(),
            grid=topic.grid.name.encode(),
        )

    def moved(self, grid: Grid) -> None:
        """Samples on this grid are on the moved one from here on."""
        if grid.name == self._grid_name:
            self.shape = shape_of(self.kind, grid)
            self.values = grid.points * self.kind.components
            self.header.points, self.header.grid_revision = grid.points, grid.revision

    def view(self, views: Views) -> Array:
        """A writable view of the loan."""
        loan = self.loan
        assert loan is not None, "loans are taken before outputs are handed out"
        owner = (loan.sample, loan.publisher)
        return views.view(self.kind.name, loan.pointer, self.shape, owner, read_only=False)

    def publish(self, step: Step) -> None:
        """Send the loan, labelled with the step."""
        loan, self.loan = self.loan, None
        assert loan is not None, "loans are taken before outputs are published"
        header = self.header
        header.sequence += 1
        header.window, header.iteration = step.window, step.iteration
        header.start, header.end = step.start, step.end
        self.writer.publish(loan, header)


class Outputs(Mapping[str, Array]):
    """Outputs of one call, written where consumers will read them.

    `outputs["lower_temperature"]` is a writable view of shared memory, of the shape that
    `Inputs` describes; `outputs["lower_temperature"] = values` copies values there. A field that
    nobody needs is not there: reading it is a `KeyError`, assigning to it does nothing. Every
    value of what is there must be written.
    """

    def __init__(
        self,
        ports: Mapping[str, OutputPort],
        described: frozenset[str],
        private: Mapping[str, Array] | None = None,
    ) -> None:
        self._ports, self._described, self._private = ports, described, private or {}
        self._views, self._open = Views(), True
        for port in ports.values():
            port.loan = port.writer.loan(port.values)
        for field in self:
            # What is not written shows.
            self[field] = np.nan

    def __getitem__(self, field: str) -> Array:
        if not self._open:
            raise PortError(f"output `{field}` was asked for after the call")
        if field in self._private:
            return self._private[field]
        return self._ports[field].view(self._views)

    def __setitem__(self, field: str, values: ArrayLike) -> None:
        if field in self:
            self[field][...] = values
        elif field not in self._described:
            raise KeyError(f"the description provides no `{field}`")

    def __iter__(self) -> Iterator[str]:
        return chain(self._ports, self._private)

    def __len__(self) -> int:
        return len(self._ports) + len(self._private)

    def __contains__(self, field: object) -> bool:
        return field in self._ports or field in self._private

    def read(self, files: Mapping[str, Path]) -> None:
        """Fill every output with the doubles of a file."""
        for field in self:
            place, path = self[field], files.get(field)
            try:
                if path is None:
                    raise ValueError("no file is named")
                values = np.fromfile(path, dtype="<f8")
                if path.stat().st_size != place.nbytes:
                    raise ValueError(f"{path.stat().st_size} bytes, expected {place.nbytes}")
            except (OSError, ValueError) as reason:
                raise PortError(f"output `{field}` cannot be restored from {path}: {reason}") from (
                    reason
                )
            place[...] = values.reshape(place.shape)

    def publish(self, step: Step) -> None:
        """Demand that every value was written and that no view is left, and send everything."""
        for field in self._ports:
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
        for port in self._ports.values():
            port.publish(step)

    def discard(self) -> None:
        """Give what was not published back."""
        self._open = False
        for port in self._ports.values():
            port.loan = None


def open_outputs(
    endpoint: Endpoint, topics: Sequence[Topic], producer: str, kinds: Mapping[str, FieldKind]
) -> dict[str, OutputPort]:
    """The ports of a set of outputs that are published together."""
    ports = {}
    for topic in topics:
        if topic.field not in kinds:
            raise PortError(f"this program does not describe the field `{topic.field}`")
        kind = kinds[topic.field]
        values = topic.grid.points * kind.components
        writer = endpoint.field_writer(topic.service, values, topic.subscribers)
        ports[kind.name] = OutputPort(kind, topic, producer, writer)
    return ports
