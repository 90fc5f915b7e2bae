"""Configuration of a participant before a run, and its answer, exchanged as JSON."""

from __future__ import annotations

import copy
import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .fields import FieldKind
from .grids import Grid

if TYPE_CHECKING:
    from .solver import Step


class Refusal(Exception):
    """Refusal of a case; raise it in `configure` or `build`.

    `key` is the dotted key of the case at fault, `reason` states why its value is refused, `fix`
    what to write instead.
    """

    def __init__(self, key: str, reason: str, fix: str) -> None:
        super().__init__(f"{key}: {reason}; {fix}")
        self.key, self.reason, self.fix = key, reason, fix

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
        return {"key": utf8(self.key), "reason": utf8(self.reason), "fix": utf8(self.fix)}


def utf8(text: str) -> str:
    """Return the text with escapes for characters invalid in UTF-8, as in file names of another
    encoding."""
    return text.encode(errors="backslashreplace").decode()


class Case:
    """Case values in SI units, addressed by dotted keys.

    The coordinator has already checked types, units and ranges, and filled in the defaults. With
    another coordinator, a wrong value still raises a `Refusal` that names the key.
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.values = values

    def get(self, key: str, default: Any = None) -> Any:
        """Return the value or table at a dotted key."""
        value: Any = self.values
        for part in key.split("."):
            if not isinstance(value, Mapping) or part not in value:
                return default
            value = value[part]
        return value

    def __contains__(self, key: str) -> bool:
        return self.get(key) is not None

    def number(self, key: str) -> float:
        """Return a required number [SI]."""
        value = self._given(key)
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not math.isfinite(value)
        ):
            raise _wrong(key, value, "a finite number")
        return float(value)

    def integer(self, key: str) -> int:
        """Return a required whole number."""
        value = self._given(key)
        if isinstance(value, bool) or not isinstance(value, int):
            raise _wrong(key, value, "a whole number")
        return value

    def bodies(self) -> tuple[str, str]:
        """Return the names of the upper and the lower body in the case."""
        table = self.get("bodies", {})
        of: dict[str, list[str]] = {position: [] for position in ("upper", "lower")}
        for name in table:
            of.setdefault(self.text(f"bodies.{name}.position"), []).append(name)
        if [len(names) for names in of.values()] != [1, 1]:
            raise Refusal(
                "bodies",
                "there is not one body at each position",
                'write one table [bodies.NAME] with position = "upper" and one with "lower"',
            )
        return of["upper"][0], of["lower"][0]

    def text(self, key: str) -> str:
        """Return a required text or word."""
        value = self._given(key)
        if not isinstance(value, str):
            raise _wrong(key, value, "a text")
        return value

    def _given(self, key: str) -> Any:
        if key not in self:
            raise Refusal(key, "missing", f"add `{key}`")
        return self.get(key)


def _wrong(key: str, value: Any, expected: str) -> Refusal:
    return Refusal(key, f"{value!r} is not {expected}", f"write {expected}")


@dataclass(frozen=True)
class Input:
    """A field that a participant receives."""

    field: FieldKind
    """Kind of the field."""
    producer: str
    """Role of the producer."""
    grid: Grid | None
    """Grid on which the field arrives; `None` while unknown."""
    moves: bool = False
    """The grid changes during the run."""

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> Input:
        """Read from JSON."""
        grid = value.get("grid")
        return cls(
            FieldKind.from_json(value["field"]),
            value["producer"],
            None if grid is None else Grid.from_json(grid),
            bool(value.get("moves", False)),
        )


@dataclass(frozen=True)
class Histories:
    """Varying case values: one value per key for every row of a table."""

    rows: bool
    """Each window is a row; otherwise rows are times, with linear interpolation between them."""
    times: Sequence[float]
    """Times of the rows [s]."""
    values: Mapping[str, Sequence[float]]
    """Values of every row by dotted key, in SI units."""
    live: Mapping[str, Any] | None = None
    """All keys are given from outside, solve by solve, within `limits`; rows span the expected
    values."""
    given: dict[str, float] = field(default_factory=dict, compare=False, repr=False)
    """Latest values of live keys."""

    def at(self, step: Step) -> dict[str, float]:
        """Return the values in a window: at its row or its midpoint; for live keys the latest
        values."""
        if self.live is not None:
            return {key: self.given.get(key, column[0]) for key, column in self.values.items()}
        if self.rows:
            return {key: column[step.window] for key, column in self.values.items()}
        time = 0.5 * (step.start + step.end)
        right = bisect_right(self.times, time)
        left, right = max(right - 1, 0), min(right, len(self.times) - 1)
        span = self.times[right] - self.times[left]
        share = max(time - self.times[left], 0.0) / span if span > 0.0 else 0.0
        return {
            key: column[left] + share * (column[right] - column[left])
            for key, column in self.values.items()
        }


@dataclass(frozen=True)
class Configuration:
    """Configuration of a participant, sent with `Configure`."""

    role: str
    """Role of the participant."""
    model: str
    """Name of the chosen model, from the description."""
    mode: str
    """`steady`: a single window without duration; `transient`: windows of coupling time."""
    case: Case
    """Case values that this participant reads."""
    inputs: Sequence[Input]
    """Received fields."""
    outputs: Sequence[str]
    """Names of the fields to publish in every iteration."""
    observed: Sequence[str]
    """Names of the fields to publish when an accepted window is observed."""
    histories: Histories | None = None
    """Varying case values; `case` holds the values of their first row."""
    windows: Mapping[str, float] | None = None
    """Windows of a transient case [s]: `shortest`, `usual` and, if it is known, the `end`."""
    threads: int = 1
    """Number of threads to compute on. Results must be independent of this number."""

    @property
    def is_steady(self) -> bool:
        """True for a single window without duration."""
        return self.mode == "steady"

    def case_at(self, step: Step) -> Case:
        """Return the case in a window, with varying values at the row or time of the window."""
        if self.histories is None:
            return self.case
        values = copy.deepcopy(dict(self.case.values))
        for key, number in self.histories.at(step).items():
            *way, last = key.split(".")
            table = values
            for part in way:
                table = table.setdefault(part, {})
            table[last] = number
        return Case(values)

    def has_effect(self, name: str) -> bool:
        """Return true if an effect is active and claimed by this participant."""
        return f"effects.{name}" in self.case

    def input(self, name: str) -> Input | None:
        """Return an input, by the name of its field."""
        return next((given for given in self.inputs if given.field.name == name), None)

    def wants(self, name: str) -> bool:
        """Return true if a field must be published, in every iteration or when observed."""
        return name in self.outputs or name in self.observed

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> Configuration:
        """Read from JSON."""
        return cls(
            role=value["role"],
            model=value["model"],
            mode=value["mode"],
            case=Case(value["case"]),
            inputs=[Input.from_json(given) for given in value["inputs"]],
            outputs=list(value["outputs"]),
            observed=list(value["observed"]),
            histories=Histories(**value["histories"]) if "histories" in value else None,
            windows=value.get("windows"),
            threads=int(value.get("threads", 1)),
        )


@dataclass(frozen=True)
class Simplification:
    """A modelling simplification and its expected error."""

    what: str
    """Description of the neglected or replaced physics."""
    error: float
    """Expected relative error."""
    source: str
    """Origin of the number."""
    with_effects: Sequence[str] = ()
    """Effects with which the simplification matters; empty if it always matters."""

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
        value = {"what": self.what, "error": float(self.error), "source": self.source}
        return {**value, "with_effects": list(self.with_effects)}


@dataclass
class Layout:
    """Answer to `configure`: grids, placement of the fields and expected cost."""

    grids: list[Grid] = field(default_factory=list)
    """Grids of the outputs, and requested grids of inputs; volumes are announced."""
    fields: dict[str, str] = field(default_factory=dict)
    """Name of the grid of each output and observed field."""
    inputs: dict[str, str] = field(default_factory=dict)
    """Name of the requested grid of an input; otherwise the input arrives on the producer's
    grid."""
    moving: list[str] = field(default_factory=list)
    """Names of the grids that may move during the run, see `Solver.moved_grids`.

    Volumes need not be listed.
    """
    solve_seconds: float = 0.0
    """Expected processor seconds of one solve."""
    seconds_per_second: float = 0.0
    """Expected additional processor seconds of a solve per second of its window."""
    build_seconds: float = 0.0
    """Expected processor seconds of `build`, from which the deadline for building follows."""
    memory_bytes: int = 0
    """Expected memory of the participant's own arrays [byte]."""
    remarks: list[str] = field(default_factory=list)
    """Remarks for `plan`, one line each."""
    left_out: list[Simplification] = field(default_factory=list)
    """Simplifications in this particular case, in addition to those of the description."""
    closed_forms: dict[str, float] = field(default_factory=dict)
    """Quantities of the summary with a known exact value in this case, by dotted key."""

    def grid(self, name: str) -> Grid | None:
        """Return a grid of the layout, by name."""
        return next((grid for grid in self.grids if grid.name == name), None)

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
        value: dict[str, Any] = {
            "grids": [grid.to_json() for grid in self.grids],
            "fields": _placed(self.fields),
            "solve_seconds": float(self.solve_seconds),
            "memory_bytes": int(self.memory_bytes),
            "remarks": list(self.remarks),
        }
        optional: dict[str, Any] = {
            "inputs": _placed(self.inputs),
            "moving": list(self.moving),
            "seconds_per_second": float(self.seconds_per_second),
            "build_seconds": float(self.build_seconds),
            "left_out": [one.to_json() for one in self.left_out],
            "closed_forms": {key: float(exact) for key, exact in self.closed_forms.items()},
        }
        return {**value, **{name: given for name, given in optional.items() if given}}


def _placed(fields: Mapping[str, str]) -> list[dict[str, str]]:
    return [{"field": name, "grid": grid} for name, grid in fields.items()]
