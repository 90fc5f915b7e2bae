"""The base class of a solver, and what passes through it.

A participant's life, in the order of the calls (docs/ARCHITECTURE.md, "A run"):

    configure → build → first_outputs → ( solve … solve → accept → [observe] ) … → summary

and between windows `save` and `restore`. A window may be solved any number of times: `solve` always
starts from the accepted state, and only `accept` moves on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO, ClassVar

import numpy as np

from .configuration import Configuration, Layout
from .description import Effect, Figure, Key, Model
from .fields import FieldKind
from .grids import Array, Grid

if TYPE_CHECKING:
    from .ports import Inputs, Outputs


class StepError(Exception):
    """A solve that failed; its text is what the coordinator tells."""


class NonFiniteInput(StepError):
    """An input holds a NaN or an infinity."""

    def __init__(self, field: str, index: int, value: float) -> None:
        super().__init__(f"input `{field}` is not finite at index {index} ({value})")
        self.field, self.index, self.value = field, index, value


class MissingInput(StepError, KeyError):
    """An input that the model cannot do without is missing."""

    def __init__(self, field: str) -> None:
        super().__init__(f"input `{field}` is missing")
        self.field = field

    def __str__(self) -> str:
        return str(self.args[0])


class StateError(Exception):
    """A state that cannot be restored."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"state does not fit: {reason}")
        self.reason = reason


@dataclass(frozen=True)
class Step:
    """One iteration of one window."""

    window: int
    """Number of the window, from 0."""
    iteration: int
    """Iteration within the window, from 1; 0 stands for the first outputs before any solve."""
    start: float
    """Start of the window [s]."""
    end: float
    """End of the window [s]; equal to `start` in a steady case."""

    @property
    def duration(self) -> float:
        """Length of the window [s]."""
        return self.end - self.start


@dataclass
class StepReport:
    """What a solve says besides its outputs."""

    substeps: int = 1
    """Steps taken inside the window."""
    inner_iterations: int = 0
    """Iterations of the inner solver."""
    work: int = 0
    """Number of elementary operations in the model's own measure."""
    heat_received: float | None = None
    """Heat received through conservative inputs, as the mean power over the window [W]."""
    wanted_window: float | None = None
    """Longest window that the model would take from this one's start [s]."""


def first_non_finite(values: Array) -> int | None:
    """Index of the first NaN or infinity, in memory order; `None` if every value is finite.

    One pass without a temporary: a sum is finite only if all its terms are. The search is made only
    where the sum is not, which finite values that overflow reach too.
    """
    with np.errstate(all="ignore"):
        if np.isfinite(np.add.reduce(values, axis=None)):
            return None
    bad = ~np.isfinite(values).ravel()
    return int(bad.argmax()) if bad.any() else None


class Solver:
    """A participant's program; subclass it and hand the class to `cosim.main`.

    Only `configure` and `solve` must be written. A solver without memory of earlier windows needs
    nothing else; one with memory writes `accept`, and `save` and `restore` if its runs are to be
    resumed.
    """

    name: ClassVar[str] = ""
    """Name of the program; the class's name where it is empty."""
    version: ClassVar[str] = "0"
    """Version of the program."""
    role: ClassVar[str] = ""
    """The role it plays: `mech`, `thermal`, or another word that a case names as a table."""
    standalone: ClassVar[bool] = False
    """It has an answer of its own even if no effect is active."""
    estimates: ClassVar[bool] = True
    """It answers `--estimate`, so that a plan knows its grids."""
    reusable: ClassVar[bool] = True
    """Its process can take part in one run after the other, each with an object of its own: nothing
    of a run is kept in the class, in a module or in a library."""
    follows_moving_grids: ClassVar[bool] = False
    """It asks `inputs.grid(field)` in every solve, so that the grids of its inputs may move."""
    models: ClassVar[Sequence[Model]] = ()
    """Models, cheapest first."""
    effects: ClassVar[Sequence[Effect]] = ()
    """Effects it can take part in."""
    keys: ClassVar[Sequence[Key]] = ()
    """Case keys it reads whatever the model; keys of a model or an effect stand there."""
    fields: ClassVar[Sequence[FieldKind]] = ()
    """Fields that are not in `cosim.fields.TABLE`."""
    figures: ClassVar[Sequence[Figure]] = ()
    """The figures of its summary, in the order in which a person reads them."""

    _report: Callable[[int, int, str], None] | None = None

    def configure(self, configuration: Configuration) -> Layout:
        """Check a configuration; cheap, allocates no field.

        Returns grids, placement of the fields and expected cost; raises `Refusal` for a case that
        it cannot take. The grid of an input may not be known yet (`--estimate`).
        """
        raise NotImplementedError

    def build(self) -> None:
        """Allocate everything that solves need. May raise `Refusal`."""

    def first_outputs(self, outputs: Outputs) -> None:
        """Write the outputs that hold before the first solve; zero unless overridden."""
        for name in outputs:
            outputs[name] = 0.0

    def solve(self, step: Step, inputs: Inputs, outputs: Outputs) -> StepReport | None:
        """Solve one window from the accepted state, and write every value of the outputs.

        Inputs and outputs are views of shared memory that end with this call: what is to be kept
        must be copied. Any exception ends the run with its text.
        """
        raise NotImplementedError

    def accept(self) -> None:
        """Make the last solve the accepted state."""

    def observe(self, outputs: Outputs) -> None:
        """Write the observed fields of the accepted state.

        A solver that does not override this finds them among the outputs of `solve`, and what the
        accepted solve wrote there is sent.
        """

    def moved_grids(self) -> Sequence[Grid]:
        """The grids of `Layout.moving` and the volumes, as they are in the accepted state.

        Asked for after `build`, `accept` and `restore`; see `Grid.moved`. Solves start from these
        grids until the next one.
        """
        return ()

    def save(self, file: BinaryIO) -> None:
        """Write the accepted state; nothing for a solver without memory."""

    def restore(self, file: BinaryIO) -> None:
        """Return to a saved state; raises `StateError` if it does not fit."""
        if file.read(1):
            raise StateError("there is one, for a solver without memory")

    def progress(self, done: int, of: int = 0, what: str = "") -> None:
        """Say how far `build` or `solve` is, as often as you like and from any thread.

        `done` of `of` in any measure, `of` being 0 if nobody knows; `what` is being done, in an
        ASCII word of at most 31 letters ("factorising"). Whenever it changes the coordinator's
        deadline starts anew, and the user sees it.
        """
        if self._report is not None:
            self._report(done, of, what)

    def report_to(self, report: Callable[[int, int, str], None]) -> None:
        """Called by the library: where `progress` goes."""
        self._report = report

    def summary(self) -> dict[str, Any]:
        """Sections of `summary.json` of this solver, such as `{"temperature": {...}}`."""
        return {}

    @classmethod
    def title(cls) -> str:
        """Its name, or that of its class."""
        return cls.name or cls.__name__

    @classmethod
    def description(cls) -> dict[str, Any]:
        """The description that `--describe` prints; the library adds the version of the contract."""
        return {
            "name": cls.title(),
            "version": cls.version,
            "role": cls.role,
            "standalone": cls.standalone,
            "estimates": cls.estimates,
            "reusable": cls.reusable,
            "models": [model.to_json() for model in cls.models],
            "effects": [effect.to_json() for effect in cls.effects],
            "keys": [key.to_json() for key in cls.keys],
            "fields": [kind.to_json() for kind in cls.fields],
            "figures": [figure.to_json() for figure in cls.figures],
        }
