"""Results of a run: figures as attributes, fields and history as arrays."""

from __future__ import annotations

import csv
import functools
import json
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import pictures
from .command import call
from .progress import needs
from .series import Array, Field, Fields

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

    from .recording import Recording


class Section(Mapping[str, Any]):
    """A part of a summary, with its entries also as attributes:
    `results.temperature.rail.max_rise_k`."""

    def __init__(self, entries: Mapping[str, Any], place: str) -> None:
        self._entries, self._place = entries, place

    def __getitem__(self, name: str) -> Any:
        if name not in self._entries:
            there = ", ".join(self._entries) or "nothing"
            raise KeyError(f"no `{name}` in {self._place}; there is {there}")
        return wrapped(self._entries[name], f"{self._place}.{name}")

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._entries]

    def __repr__(self) -> str:
        return f"<{self._place}: {', '.join(self._entries)}>"


def wrapped(value: Any, place: str) -> Any:
    """Wrap tables, also those in lists, as sections."""
    if isinstance(value, dict):
        return Section(value, place)
    if isinstance(value, list):
        return [wrapped(one, f"{place}[{k}]") for k, one in enumerate(value)]
    return value


@dataclass(frozen=True)
class Figure:
    """A number of a summary: its key, value, unit and meaning."""

    key: str
    value: float
    unit: str
    words: str

    def __format__(self, spec: str) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.value:{spec or '.5g'}}{unit}"

    def __str__(self) -> str:
        return format(self, "")


@functools.cache
def described() -> list[dict[str, Any]]:
    """Return all figures that the installed solvers describe."""
    figures: list[dict[str, Any]] = json.loads(call(["figures", "--json"], progress=False))
    return figures


def named(pattern: str, key: str) -> list[str] | None:
    """Return the names in a key that match each `*` of a pattern; None if the key does not match.

    A `#` in a pattern matches any index in a list.
    """
    parts, given = pattern.split("."), key.split(".")
    pairs = list(zip(parts, given))
    fits = all(p in ("*", q) or (p == "#" and q.isdigit()) for p, q in pairs)
    names = [q for p, q in pairs if p == "*"]
    return names if fits and len(parts) == len(given) else None


def description(key: str) -> dict[str, Any] | None:
    """Return the description of a key of a summary, with the name of the body in its words."""
    for figure in described():
        names = named(figure["key"], key)
        if names is not None:
            return {**figure, "words": " ".join([*names, figure["words"]])}
    return None


@functools.cache
def keys() -> list[dict[str, Any]]:
    """Return all keys that a case may have."""
    known: list[dict[str, Any]] = json.loads(call(["keys", "--json"], progress=False))
    return known


def label(name: str) -> str:
    """Return the axis label of a column of a study: the words of a figure, or the key of a case,
    with the unit."""
    said = description(name)
    words = name if said is None else said["words"]
    fitting = (key for key in keys() if named(key["path"], name) is not None)
    unit = said["unit"] if said is not None else next(fitting, {}).get("unit", "1")
    return words if unit == "1" else f"{words} [{unit}]"


class Results:
    """Results of a run.

    Sections of the summary are attributes (`results.contact.max_pressure_pa`). `results.figures`
    has the same numbers with units, `results.fields["pressure"]` a field at the last time,
    `results.history` the figures of every window. The folder of a run without `out` lasts as long
    as this object; `save` keeps it.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.summary: dict[str, Any] = json.loads(
            (self.folder / "summary.json").read_text(encoding="utf-8")
        )

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "summary":
            raise AttributeError(name)
        return getattr(Section(self.summary, "the summary"), name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.summary]

    @functools.cached_property
    def figures(self) -> dict[str, Figure]:
        """All described numbers of the summary, by key."""
        found = {}
        for key, value in leaves(self.summary):
            said = description(key)
            if said is not None and value is not None:
                found[key] = Figure(key, float(value), said["unit"], said["words"])
        return found

    @functools.cached_property
    def fields(self) -> Fields:
        """Fields written by the run on grids of equal elements."""
        return Fields(self.folder / "fields")

    def __getitem__(self, field: str) -> Field:
        return self.fields[field]

    @functools.cached_property
    def history(self) -> dict[str, Array]:
        """Times and figures of every window, by the columns of history.csv; NaN for absent
        values."""
        return table(self.folder / "history.csv")

    def history_frame(self) -> pandas.DataFrame:
        """Return the history as a data frame; needs pandas."""
        with needs("frames"):
            import pandas  # noqa: PLC0415

        return pandas.read_csv(self.folder / "history.csv")

    def plot(self, name: str, axes: Axes | None = None) -> Axes:
        """Plot a field; needs matplotlib."""
        return pictures.field(self.fields[name], axes)

    def plot_stick_and_slip(self, axes: Axes | None = None) -> Axes:
        """Plot the stick and slip zones."""
        return pictures.stick_and_slip(self, axes)

    def plot_depth(self, section: str, axes: Axes | None = None, label: str | None = None) -> Axes:
        """Plot a section's field over depth, below its largest value."""
        return pictures.depth_profile(self.fields[section], axes, label)

    @functools.cached_property
    def recording(self) -> Recording:
        """Recording of a run with `record=True`."""
        from .recording import Recording  # noqa: PLC0415

        recording = Recording(self.folder / "recording.mcap")
        # A temporary folder is removed with these results.
        recording.results = self
        return recording

    def replay(self, role: str, *options: str) -> str:
        """Drive a participant through the recording, and compare all its messages; return the
        output.

        A difference raises a CosimError that names the first one.
        """
        return call(
            ["replay", self.folder / "recording.mcap", "--only", role, *options], progress=False
        )

    def report(self) -> Path:
        """Write report.html as a single file; return its path."""
        call(["report", self.folder], progress=False)
        return self.folder / "report.html"

    def save(self, folder: str | Path, *, replace: bool = False) -> Results:
        """Copy the folder to another name; return the results there."""
        target = Path(folder)
        if replace and (target / "summary.json").exists():
            shutil.rmtree(target)
        return Results(Path(shutil.copytree(self.folder, target)))

    def __repr__(self) -> str:
        """Return the headline figures, as printed by the coordinator."""
        heads = [
            figure
            for key, figure in self.figures.items()
            if (description(key) or {}).get("headline")
        ]
        lines = [f"{self.summary['case']}: {self.summary['status']}"]
        lines += [f"  {figure.words}: {figure} ({figure.key})" for figure in heads]
        return "\n".join(lines)


def leaves(value: Any, prefix: str = "") -> Iterator[tuple[str, float | None]]:
    """Yield numbers of nested tables and lists, by dotted keys."""
    if isinstance(value, dict | list):
        entries = value.items() if isinstance(value, dict) else enumerate(value)
        for name, one in entries:
            yield from leaves(one, f"{prefix}{name}.")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield prefix[:-1], value


def table(path: Path) -> dict[str, Array]:
    """Return the columns of numbers of a CSV file; columns of words are omitted."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    columns: dict[str, Array] = {}
    for name in rows[0] if rows else ():
        try:
            columns[name] = np.array([float(row[name]) if row[name] else np.nan for row in rows])
        except ValueError:
            continue
    return columns
