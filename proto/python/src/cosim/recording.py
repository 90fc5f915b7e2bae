"""Recordings of runs: all messages, as objects.

    recording = cosim.Recording("results/latest/recording.mcap")
    recording.iterations[-1].residual
    recording["friction_power"].at(window=0, iteration=2).values

Events and grids come from `coordinator inspect`, samples from the file itself; reading samples
needs the package mcap.
"""

from __future__ import annotations

import functools
import json
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from .command import call
from .results import Section
from .series import Array, Field

if TYPE_CHECKING:
    import os

LABEL = np.dtype(
    [
        ("protocol", "<u4"),
        ("components", "<u4"),
        ("points", "<u8"),
        ("grid_revision", "<u8"),
        ("window", "<u8"),
        ("iteration", "<u4"),
        ("reserved", "<u4"),
        ("start", "<f8"),
        ("end", "<f8"),
        ("sequence", "<u8"),
        ("name", "S32"),
        ("unit", "S16"),
        ("producer", "S32"),
        ("grid", "S32"),
    ]
)
"""Label in front of the values of a sample."""


@dataclass(frozen=True)
class Sample(Field):
    """A field as sent: `time` is the end of its window [s].

    On a moving grid, or one without equal elements, `values` has the axes (point), or (component,
    point), and `x`, `y` and `z` are empty.
    """

    producer: str
    """Role of the producer."""
    grid: str
    """Name of the grid."""
    window: int
    """Number of the window, from 0."""
    iteration: int
    """Iteration within the window, from 1; 0 before the first solve."""
    start: float
    """Start of the window [s]."""


class Samples(Sequence[Sample]):
    """All samples of a topic, in the order of sending."""

    def __init__(self, topic: Mapping[str, Any], messages: list[bytes], moves: bool) -> None:
        self.topic: str = topic["topic"]
        self.unit: str = topic["unit"]
        self._plane = None if moves else topic["geometry"]
        self._messages = messages

    def __len__(self) -> int:
        return len(self._messages)

    @overload
    def __getitem__(self, place: int) -> Sample: ...
    @overload
    def __getitem__(self, place: slice) -> list[Sample]: ...
    def __getitem__(self, place: int | slice) -> Sample | list[Sample]:
        if isinstance(place, slice):
            return [sample(one, self._plane) for one in self._messages[place]]
        return sample(self._messages[place], self._plane)

    @functools.cached_property
    def places(self) -> list[tuple[int, int]]:
        """Window and iteration of each sample."""
        labels = map(label, self._messages)
        return [(int(one["window"]), int(one["iteration"])) for one in labels]

    def at(self, window: int, iteration: int | None = None) -> Sample:
        """Return the sample of an iteration, by default the last one of its window."""
        found = [
            place
            for place, (in_window, in_iteration) in enumerate(self.places)
            if in_window == window and iteration in (None, in_iteration)
        ]
        if not found:
            which = f"window {window}" + ("" if iteration is None else f", iteration {iteration}")
            raise KeyError(f"{self.topic} has no sample of {which}")
        return self[found[-1]]

    def __repr__(self) -> str:
        return f"<{len(self)} samples of {self.topic} [{self.unit}]>"


class Recording(Mapping[str, Samples]):
    """A recording: its samples by the name of a field, or by topic if a name is ambiguous.

    `iterations` has the convergence data of each iteration (window, start, end, residual,
    residuals, relaxation, heat), `participants` the participants. `complete` is false for a
    truncated file, of which all complete chunks are read.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self.results: object = None
        """Results of the run, which own the file."""
        told = call(["inspect", self.path, "--iterations", "--json"], progress=False)
        self.survey: dict[str, Any] = json.loads(told)
        self.iterations = [
            Section(one, f"iteration {one['iteration']} of window {one['window']}")
            for one in self.survey["details"]["iterations"]
        ]
        self.participants = [
            Section(one, f"the participant {one['role']}") for one in self.survey["participants"]
        ]
        self.complete: bool = self.survey["complete"]
        self._topics = {one["topic"]: one for one in self.survey["fields"]}

    def __getitem__(self, name: str) -> Samples:
        """Return the samples of a field as its participant sent it, or of a topic."""
        ends = [
            topic
            for topic in self._topics
            if topic == name or (topic.startswith("field/") and topic.split("/")[2:] == [name])
        ]
        # Iterates sent by the coordinator have the same field name.
        ends = [one for one in ends if not one.startswith("field/coordinator/")] or ends
        if len(ends) != 1:
            known = ", ".join(self)
            why = f"several are called `{name}`" if ends else f"no field `{name}`"
            raise KeyError(f"{why} in {self.path}; there are {known}")
        return self._samples(ends[0])

    def _samples(self, topic: str) -> Samples:
        about = self._topics[topic]
        kind, role, *_ = topic.split("/")
        moves = kind != "field" or f"geometry/{role}/{about['grid']}" in self._topics
        return Samples(about, self._read(topic), moves)

    def _read(self, topic: str) -> list[bytes]:
        try:
            from mcap.exceptions import McapError  # noqa: PLC0415
            from mcap.reader import NonSeekingReader, SeekingReader  # noqa: PLC0415
        except ImportError as error:
            advice = "samples of a recording need the package mcap: pip install mcap"
            raise ImportError(advice) from error
        kind = SeekingReader if self.complete else NonSeekingReader
        found: list[bytes] = []
        with self.path.open("rb") as file:
            try:
                for _, _, message in kind(file).iter_messages([topic], log_time_order=False):
                    found.append(message.data)
            except (McapError, struct.error, ValueError):
                # The package fails on the remains of the truncated record.
                if self.complete:
                    raise
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._topics)

    def __len__(self) -> int:
        return len(self._topics)

    def replay(self, role: str, *options: str) -> str:
        """Drive a participant through the recording, and compare all its messages; return the
        output.

        A difference raises a CosimError that names the first one.
        """
        return call(["replay", self.path, "--only", role, *options], progress=False)

    def __repr__(self) -> str:
        told = self.survey
        counts = f"{told['windows']} windows, {told['iterations']} iterations"
        return f"<recording of {told['case']}, {told['scheme']}: {counts}; {', '.join(self)}>"


def label(message: bytes) -> np.void:
    """Return the label in front of the values."""
    about: np.void = np.frombuffer(message, LABEL, 1)[0]
    return about


def sample(message: bytes, plane: Mapping[str, Any] | None) -> Sample:
    """Return the values with their coordinates, on a plane of equal elements if there is one."""
    about = label(message)
    values = np.frombuffer(message, "<f8", offset=LABEL.itemsize)
    components = int(about["components"])
    if components > 1:
        values = values.reshape(components, -1)
    x = y = z = np.empty(0)
    if plane is not None and plane["ni"] * plane["nj"] == about["points"]:
        shape = (plane["nj"], plane["ni"])
        values = np.moveaxis(values.reshape(components, *shape), 0, -1)
        values = values[..., 0] if components == 1 else values
        x, y, z = (middles(plane, axis) for axis in range(3))
    return Sample(
        name=about["name"].decode(),
        unit=about["unit"].decode(),
        time=float(about["end"]),
        values=values,
        x=x,
        y=y,
        z=z,
        producer=about["producer"].decode(),
        grid=about["grid"].decode(),
        window=int(about["window"]),
        iteration=int(about["iteration"]),
        start=float(about["start"]),
    )


def middles(plane: Mapping[str, Any], axis: int) -> Array:
    """Return element centres along an axis [m]; a single one if the plane does not extend along
    it."""
    begin, along, across = (plane[key][axis] for key in ("origin", "step_i", "step_j"))
    step, count = (along, plane["ni"]) if along else (across, plane["nj"] if across else 1)
    return np.asarray(begin + step * np.arange(count), np.float64)
