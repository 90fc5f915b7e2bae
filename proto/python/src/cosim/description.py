"""What a participant says of itself, before any run: `--describe` prints it as JSON.

The coordinator knows no physics. Which models and effects exist, which case keys they read, in
which unit and range, and which fields they exchange, it learns from here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True)
class Key:
    """One key of the case file, its type, its range and what it is for."""

    path: str
    """Dotted path; `*` stands for any one name (`materials.*.density`)."""
    help: str
    """One line for people."""
    type: str = "quantity"
    """`quantity`, `integer`, `flag`, `choice`, `text`, `file` or `name-in`."""
    unit: str | None = None
    """Of a quantity: the SI unit, as an expression; "1" for a plain number."""
    of: Sequence[str] | None = None
    """Of a choice: the words."""
    table: str | None = None
    """Of a name: path of the table that holds it."""
    required: bool = False
    """A case that reaches the participant must have it."""
    default: Any = None
    """Value used when the case does not have it (SI)."""
    above: float | None = None
    """Numbers must be greater than this."""
    at_least: float | None = None
    """Numbers must be at least this."""
    at_most: float | None = None
    """Numbers must be at most this."""
    magnitude_below: Sequence[str] = ()
    """The magnitude must be less than the product of these other keys' values."""
    one_of: str | None = None
    """Of all keys with the same word here exactly one must be given."""
    together: str | None = None
    """Of all keys with the same word here all or none must be given."""
    varies: bool = False
    """A case may give a column of a table; see `Configuration.case_at`."""
    consumes: Mapping[str, Sequence[str]] = field(default_factory=dict, hash=False)
    """Fields that the participant consumes besides, by the word of the key that asks for them."""

    @classmethod
    def quantity(cls, path: str, unit: str, help: str, **more: Any) -> Key:
        """A number with a unit."""
        return cls(path, help, "quantity", unit=unit, **more)

    @classmethod
    def number(cls, path: str, help: str, **more: Any) -> Key:
        """A number without a unit."""
        return cls(path, help, "quantity", unit="1", **more)

    @classmethod
    def integer(cls, path: str, help: str, **more: Any) -> Key:
        """A whole number."""
        return cls(path, help, "integer", **more)

    @classmethod
    def flag(cls, path: str, help: str, **more: Any) -> Key:
        """True or false."""
        return cls(path, help, "flag", **more)

    @classmethod
    def choice(cls, path: str, of: Sequence[str], help: str, **more: Any) -> Key:
        """One of some words."""
        return cls(path, help, "choice", of=of, **more)

    @classmethod
    def text(cls, path: str, help: str, **more: Any) -> Key:
        """Any text."""
        return cls(path, help, "text", **more)

    @classmethod
    def file(cls, path: str, help: str, **more: Any) -> Key:
        """A file; it reaches the participant as an absolute path."""
        return cls(path, help, "file", **more)

    @classmethod
    def name_in(cls, path: str, table: str, help: str, **more: Any) -> Key:
        """The name of a table under `table`."""
        return cls(path, help, "name-in", table=table, **more)

    @classmethod
    def position(cls) -> Key:
        """Which of the two bodies a table `[bodies.NAME]` is; see `Case.bodies`."""
        of = ("upper", "lower")
        return cls.choice("bodies.*.position", of, "which of the two bodies it is", required=True)

    def to_json(self) -> dict[str, Any]:
        """As it travels: what is not given is left out."""
        absent: tuple[Any, ...] = (None, (), {})
        value = {name: given for name, given in asdict(self).items() if given not in absent}
        for name in ("of", "magnitude_below"):
            if name in value:
                value[name] = list(value[name])
        if self.consumes:
            value["consumes"] = {word: list(fields) for word, fields in self.consumes.items()}
        return value


@dataclass(frozen=True)
class Model:
    """One model (fidelity level) of a participant."""

    name: str
    """Name in the case file, `[ROLE] model = "NAME"`."""
    summary: str
    """One line: what it computes."""
    source: str
    """Where the equations come from."""
    steady: bool = True
    """It can answer a steady case."""
    transient: bool = False
    """It can answer a transient case."""
    consumes: Sequence[str] = ()
    """Fields it always consumes, by name."""
    provides: Sequence[str] = ()
    """Fields it always can provide, by name."""
    keys: Sequence[Key] = ()
    """Case keys that only this model reads."""
    accuracy: Mapping[str, Any] = field(default_factory=dict)
    """What is known of its errors: `refinement` and `simplifications`, see docs/write-a-solver.md."""
    rewinds: bool = True
    """It can solve a window more than once, always from the accepted state."""
    varies_step: bool = True
    """Its windows may differ in length."""

    def to_json(self) -> dict[str, Any]:
        """As it travels."""
        return _with_keys(self)


@dataclass(frozen=True)
class Effect:
    """A participant's part in an effect. Several participants may claim the same effect."""

    name: str
    """Name in the case file, `[effects.NAME]`."""
    law: str
    """The law, as a formula or a sentence."""
    source: str
    """Where the law comes from."""
    models: Sequence[str] = ()
    """Models of this participant that support it, by name."""
    consumes: Sequence[str] = ()
    """Fields it consumes, by name."""
    provides: Sequence[str] = ()
    """Fields it provides, by name."""
    keys: Sequence[Key] = field(default=())
    """Parameters: keys under `effects.NAME` (and elsewhere)."""

    def to_json(self) -> dict[str, Any]:
        """As it travels."""
        return _with_keys(self)


@dataclass(frozen=True)
class Figure:
    """One figure of the summary. What is not given is as docs/write-a-solver.md says."""

    key: str
    """Dotted path in `summary.json`; `*` stands for the name of a body of the case."""
    unit: str
    """Its SI unit, "1" for a plain number."""
    words: str
    """What it is, in words; the name of the body goes before those of a figure of a body."""
    line: str | None = None
    """The line of the terminal that it stands on."""
    short: str | None = None
    """Its name on the line."""
    headline: bool | None = None
    """It stands large in a report, and what follows on its line small below it."""
    digits: int | None = None
    """Significant digits."""
    style: str | None = None
    """`number`, `percent`, `signed`, `place` or `count`."""
    hidden: str | Mapping[str, Any] | None = None
    """When it is left out of its line: `zero`, `{"below": [KEY]}` or `{"several": KEY}`."""
    measure: str | None = None
    """What an error is measured against: `relative`, `absolute` or `itself`."""
    rank: int | None = None
    """Its place among the figures that studies compare."""
    driven_by: str | None = None
    """Key of a figure whose error is an error of this one, too."""
    derived: Mapping[str, Any] | None = None
    """How the coordinator makes it of other figures: `{"ratio": {"of": [KEY], "over": KEY}}`."""

    def to_json(self) -> dict[str, Any]:
        """As it travels: what is not given is left out."""
        return {name: given for name, given in asdict(self).items() if given is not None}


def _with_keys(spec: Model | Effect) -> dict[str, Any]:
    value = {name: getattr(spec, name) for name in spec.__dataclass_fields__}
    value["keys"] = [key.to_json() for key in spec.keys]
    return {name: list(v) if isinstance(v, tuple) else v for name, v in value.items()}
