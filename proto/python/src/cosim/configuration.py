"""What a participant is given before a run, and what it answers. All of it travels as JSON."""

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
    """A case that a participant cannot take; raise it in `configure` or `build`.

    `key` is the dotted key of the case at fault, `reason` why it cannot be, `fix` what to write
    instead.
    """

    def __init__(self, key: str, reason: str, fix: str) -> None:
        super().__init__(f"{key}: {reason}; {fix}")
        self.key, self.reason, self.fix = key, reason, fix

    def to_json(self) -> dict[str, Any]:
        """As it travels."""
        return {"key": utf8(self.key), "reason": utf8(self.reason), "fix": utf8(self.fix)}


def utf8(text: str) -> str:
    """The text with escapes for what UTF-8 does not have, as in names of files of another encoding."""
    return text.encode(errors="backslashreplace").decode()


class Case:
    """Case values in SI units, addressed by dotted keys.

    The coordinator has checked types, units and ranges against the description's keys and filled in
    the defaults; under another coordinator a wrong value still is a `Refusal`, which names the key.
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.values = values

    def get(self, key: str, default: Any = None) -> Any:
        """The value or table at a dotted key."""
        value: Any = self.values
        for part in key.split("."):
            if not isinstance(value, Mapping) or part not in value:
                return default
            value = value[part]
        return value

    def __contains__(self, key: str) -> bool:
        return self.get(key) is not None

    def number(self, key: str) -> float:
        """A number that must be there [SI]."""
        value = self._given(key)
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not math.isfinite(value)
        ):
            raise _wrong(key, value, "a finite number")
        return float(value)

    def integer(self, key: str) -> int:
        """A whole number that must be there."""
        value = self._given(key)
        if isinstance(value, bool) or not isinstance(value, int):
            raise _wrong(key, value, "a whole number")
        return value

    def bodies(self) -> tuple[str, str]:
        """The names that the case gives to the upper and the lower body."""
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
        """A text or word that must be there."""
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
    """Role of the participant that computes it."""
    grid: Grid | None
    """The grid it arrives on; `None` while that is not known yet."""
    moves: bool = False
    """The grid changes during the run."""

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> Input:
        """As it travelled."""
        grid = value.get("grid")
        return cls(
            FieldKind.from_json(value["field"]),
            value["producer"],
            None if grid is None else Grid.from_json(grid),
            bool(value.get("moves", False)),
        )


@dataclass(frozen=True)
class Histories:
    """Values of the case that vary: one of each key for every row of a table."""

    rows: bool
    """Every window is a row; otherwise rows are instants, with straight lines between."""
    times: Sequence[float]
    """Times of the rows [s]."""
    values: Mapping[str, Sequence[float]]
    """The values of every row by dotted key, in SI units."""
    live: Mapping[str, Any] | None = None
    """All keys are given from outside, solve by solve, within `limits`; rows are what to expect."""
    given: dict[str, float] = field(default_factory=dict, compare=False, repr=False)
    """What has been given last of live keys."""

    def at(self, step: Step) -> dict[str, float]:
        """The values in a window: those of its row, or of its middle; of live keys the newest."""
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
    """Sent with `Configure`, and on standard input of `--estimate`."""

    role: str
    """The role to play."""
    model: str
    """The model chosen, one of the description's."""
    mode: str
    """`steady`: a single window without duration; `transient`: windows of coupling time."""
    case: Case
    """The case values this participant reads."""
    inputs: Sequence[Input]
    """Fields it will receive."""
    outputs: Sequence[str]
    """Names of the fields it has to publish in every iteration."""
    observed: Sequence[str]
    """Names of the fields it has to publish when an accepted window is observed."""
    histories: Histories | None = None
    """Values of the case that vary; in `case` they have those of the first row."""
    threads: int = 1
    """Threads that it may compute on at the same time. Results must not depend on it."""

    @property
    def is_steady(self) -> bool:
        """A single window without duration."""
        return self.mode == "steady"

    def case_at(self, step: Step) -> Case:
        """The case in a window: with the values of its row or instant, where any vary."""
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
        """An effect is active and claimed by this participant."""
        return f"effects.{name}" in self.case

    def input(self, name: str) -> Input | None:
        """An input, by the name of its field."""
        return next((given for given in self.inputs if given.field.name == name), None)

    def wants(self, name: str) -> bool:
        """A field has to be published, in every iteration or when observed."""
        return name in self.outputs or name in self.observed

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> Configuration:
        """As it travelled."""
        return cls(
            role=value["role"],
            model=value["model"],
            mode=value["mode"],
            case=Case(value["case"]),
            inputs=[Input.from_json(given) for given in value["inputs"]],
            outputs=list(value["outputs"]),
            observed=list(value["observed"]),
            histories=Histories(**value["histories"]) if "histories" in value else None,
            threads=int(value.get("threads", 1)),
        )


@dataclass(frozen=True)
class Simplification:
    """Something that a model leaves out, and what that is worth."""

    what: str
    """What is left out, or stands for something else."""
    error: float
    """Expected relative error."""
    source: str
    """Where the number comes from."""
    with_effects: Sequence[str] = ()
    """It matters only with one of these effects; empty: always."""

    def to_json(self) -> dict[str, Any]:
        """As it travels."""
        value = {"what": self.what, "error": float(self.error), "source": self.source}
        return {**value, "with_effects": list(self.with_effects)}


@dataclass
class Layout:
    """Answer to `configure`: grids, placement of the fields and expected cost."""

    grids: list[Grid] = field(default_factory=list)
    """The grids of the outputs, and those on which inputs are wanted; volumes are announced."""
    fields: dict[str, str] = field(default_factory=dict)
    """Name of the grid of each output and observed field."""
    inputs: dict[str, str] = field(default_factory=dict)
    """Name of the grid on which an input is wanted; without a wish it arrives on its producer's."""
    moving: list[str] = field(default_factory=list)
    """Names of the grids that may move during the run: see `Solver.moved_grids`.

    A volume need not be named.
    """
    solve_seconds: float = 0.0
    """Expected processor seconds of one solve."""
    seconds_per_second: float = 0.0
    """Expected processor seconds of a solve besides that for each second of its window."""
    build_seconds: float = 0.0
    """Expected processor seconds of `build`; the deadline for building follows it."""
    memory_bytes: int = 0
    """Expected memory of the participant's own arrays [byte]."""
    remarks: list[str] = field(default_factory=list)
    """Remarks for `plan`, one line each."""
    left_out: list[Simplification] = field(default_factory=list)
    """What the model leaves out in this very case, besides what its description says."""
    closed_forms: dict[str, float] = field(default_factory=dict)
    """Quantities of the summary that are known exactly in this case, by their dotted key."""

    def grid(self, name: str) -> Grid | None:
        """A grid of the layout, by name."""
        return next((grid for grid in self.grids if grid.name == name), None)

    def to_json(self) -> dict[str, Any]:
        """As it travels."""
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
