"""Description of a participant, available before any run: `--describe` prints it as JSON.

The coordinator knows no physics. From the descriptions it learns which models and effects exist,
which case keys they read, in which unit and range, and which fields they exchange.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True)
class Key:
    """A key of the case file: its type, range and meaning."""

    path: str
    """Dotted path; `*` stands for any one name (`materials.*.density`)."""
    help: str
    """Meaning of the key, in one line."""
    type: str = "quantity"
    """`quantity`, `integer`, `flag`, `choice`, `text`, `file` or `name-in`."""
    unit: str | None = None
    """For a quantity: the SI unit, as an expression; "1" for a dimensionless number."""
    of: Sequence[str] | None = None
    """For a choice: the permitted words."""
    table: str | None = None
    """For a name: path of the table that contains it."""
    required: bool = False
    """The key is required in every case that reaches the participant."""
    default: Any = None
    """Value used when the key is absent (SI)."""
    above: float | None = None
    """Exclusive lower bound of numbers."""
    at_least: float | None = None
    """Inclusive lower bound of numbers."""
    at_most: float | None = None
    """Inclusive upper bound of numbers."""
    magnitude_below: Sequence[str] = ()
    """Keys whose product is the exclusive upper bound of the magnitude."""
    one_of: str | None = None
    """Group of alternatives: exactly one of the keys with the same group name must be given."""
    together: str | None = None
    """Group of keys that must be given together or not at all."""
    varies: bool = False
    """A case may give a column of a table; see `Configuration.case_at`."""
    consumes: Mapping[str, Sequence[str]] = field(default_factory=dict, hash=False)
    """Additional fields consumed, by the value of the key that requests them."""

    @classmethod
    def quantity(cls, path: str, unit: str, help: str, **more: Any) -> Key:
        """Return a key of a number with a unit."""
        return cls(path, help, "quantity", unit=unit, **more)

    @classmethod
    def number(cls, path: str, help: str, **more: Any) -> Key:
        """Return a key of a dimensionless number."""
        return cls(path, help, "quantity", unit="1", **more)

    @classmethod
    def integer(cls, path: str, help: str, **more: Any) -> Key:
        """Return a key of a whole number."""
        return cls(path, help, "integer", **more)

    @classmethod
    def flag(cls, path: str, help: str, **more: Any) -> Key:
        """Return a key of a Boolean."""
        return cls(path, help, "flag", **more)

    @classmethod
    def choice(cls, path: str, of: Sequence[str], help: str, **more: Any) -> Key:
        """Return a key of one of several words."""
        return cls(path, help, "choice", of=of, **more)

    @classmethod
    def text(cls, path: str, help: str, **more: Any) -> Key:
        """Return a key of any text."""
        return cls(path, help, "text", **more)

    @classmethod
    def file(cls, path: str, help: str, **more: Any) -> Key:
        """Return a key of a file; the participant receives an absolute path."""
        return cls(path, help, "file", **more)

    @classmethod
    def name_in(cls, path: str, table: str, help: str, **more: Any) -> Key:
        """Return a key of the name of a table under `table`."""
        return cls(path, help, "name-in", table=table, **more)

    @classmethod
    def position(cls) -> Key:
        """Return the key of the position of a body `[bodies.NAME]`; see `Case.bodies`."""
        of = ("upper", "lower")
        return cls.choice("bodies.*.position", of, "which of the two bodies it is", required=True)

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON, without absent values."""
        absent: tuple[Any, ...] = (None, (), {})
        value = {name: given for name, given in asdict(self).items() if given not in absent}
        for name in ("of", "magnitude_below"):
            if name in value:
                value[name] = list(value[name])
        if self.consumes:
            value["consumes"] = {word: list(fields) for word, fields in self.consumes.items()}
        return value


@dataclass(frozen=True)
class ModelSpec:
    """One model (fidelity level) of a participant."""

    name: str
    """Name in the case file, `[ROLE] model = "NAME"`."""
    summary: str
    """Summary of the model, in one line."""
    source: str
    """Source of the equations."""
    steady: bool = True
    """The model supports steady cases."""
    transient: bool = False
    """The model supports transient cases."""
    consumes: Sequence[str] = ()
    """Names of the fields that the model always consumes."""
    provides: Sequence[str] = ()
    """Names of the fields that the model can always provide."""
    keys: Sequence[Key] = ()
    """Case keys that only this model reads."""
    accuracy: Mapping[str, Any] = field(default_factory=dict)
    """Expected errors: `refinement` and `simplifications`, see docs/write-a-solver.md."""
    rewinds: bool = True
    """The model can solve a window repeatedly, each time from the accepted state."""
    varies_step: bool = True
    """Windows may differ in length."""

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
        return _with_keys(self)


@dataclass(frozen=True)
class Effect:
    """A participant's part in an effect. Several participants may claim the same effect."""

    name: str
    """Name in the case file, `[effects.NAME]`."""
    law: str
    """The law, as a formula or a sentence."""
    source: str
    """Source of the law."""
    models: Sequence[str] = ()
    """Names of the participant's models that support the effect."""
    consumes: Sequence[str] = ()
    """Names of the fields that the effect consumes."""
    provides: Sequence[str] = ()
    """Names of the fields that the effect provides."""
    keys: Sequence[Key] = field(default=())
    """Parameters: keys under `effects.NAME` and elsewhere."""

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON."""
        return _with_keys(self)


@dataclass(frozen=True)
class Figure:
    """One figure of the summary; docs/write-a-solver.md states the defaults of absent values."""

    key: str
    """Dotted path in `summary.json`; `*` stands for the name of a body of the case."""
    unit: str
    """SI unit, "1" for a dimensionless number."""
    words: str
    """Meaning of the figure, in words; for a figure of a body, the name of the body is put in
    front."""
    line: str | None = None
    """Line of the terminal on which the figure is printed."""
    short: str | None = None
    """Name of the figure on its line."""
    headline: bool | None = None
    """The figure is printed large in a report, and the following figures of its line small below
    it."""
    digits: int | None = None
    """Number of significant digits."""
    style: str | None = None
    """`number`, `percent`, `signed`, `place` or `count`."""
    hidden: str | Mapping[str, Any] | None = None
    """Condition for omitting the figure: `zero`, `{"below": [KEY]}` or `{"several": KEY}`."""
    measure: str | None = None
    """Reference of an error: `relative`, `absolute` or `itself`."""
    rank: int | None = None
    """Rank among the figures that studies compare."""
    driven_by: str | None = None
    """Key of a figure whose error also affects this one."""
    derived: Mapping[str, Any] | None = None
    """Rule by which the coordinator derives the figure: `{"ratio": {"of": [KEY], "over": KEY}}`."""

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON, without absent values."""
        return {name: given for name, given in asdict(self).items() if given is not None}


def _with_keys(spec: ModelSpec | Effect) -> dict[str, Any]:
    value = {name: getattr(spec, name) for name in spec.__dataclass_fields__}
    value["keys"] = [key.to_json() for key in spec.keys]
    return {name: list(v) if isinstance(v, tuple) else v for name, v in value.items()}
