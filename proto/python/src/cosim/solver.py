"""Base class of solvers, and the objects passed to it.

The calls of a participant, in order (docs/ARCHITECTURE.md, "A run"):

    configure → build → first_outputs → ( solve … solve → accept → [observe] ) … → summary

and `save` and `restore` between windows. A window may be solved any number of times: `solve` always
starts from the accepted state, and only `accept` advances it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO, ClassVar

import numpy as np

from .configuration import Configuration, Layout
from .description import Effect, Figure, Key, ModelSpec
from .fields import FieldKind
from .grids import Array, Grid

if TYPE_CHECKING:
    from .ports import Inputs, Outputs


class StepError(Exception):
    """A failed solve; the coordinator reports its text."""


class NonFiniteInput(StepError):
    """An input holds a NaN or an infinity."""

    def __init__(self, field: str, index: int, value: float) -> None:
        super().__init__(f"input `{field}` is not finite at index {index} ({value})")
        self.field, self.index, self.value = field, index, value


class MissingInput(StepError, KeyError):
    """A required input is missing."""

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
    """Iteration within the window, from 1; 0 marks the first outputs before any solve."""
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
    """Report of a solve, besides its outputs."""

    substeps: int = 1
    """Number of steps inside the window."""
    inner_iterations: int = 0
    """Number of iterations of the inner solver."""
    work: int = 0
    """Number of elementary operations, in the model's own unit."""
    received_power: float | None = None
    """Mean power received through conservative inputs over the window [W]."""
    wanted_window: float | None = None
    """Longest window that the model accepts from the start of this one [s]."""


def first_non_finite(values: Array) -> int | None:
    """Return the index of the first NaN or infinity, in memory order; `None` if every value is
    finite.

    One pass without a temporary: a sum is finite only if all its terms are. The search runs only if
    the sum is not finite, which also happens when finite values overflow.
    """
    with np.errstate(all="ignore"):
        if np.isfinite(np.add.reduce(values, axis=None)):
            return None
    bad = ~np.isfinite(values).ravel()
    return int(bad.argmax()) if bad.any() else None


class Solver:
    """Program of a participant; subclass it and pass the class to `cosim.main`.

    Only `configure` and `solve` are required. A solver without memory of earlier windows needs
    nothing else. A solver with memory implements `accept`, and `save` and `restore` if its runs are
    to be resumed.
    """

    name: ClassVar[str] = ""
    """Name of the program; the class name if empty."""
    version: ClassVar[str] = "0"
    """Version of the program."""
    role: ClassVar[str] = ""
    """Role of the participant: `mech`, `thermal`, or another word that a case uses as a table
    name."""
    standalone: ClassVar[bool] = False
    """The participant has a result even if no effect is active."""
    estimates: ClassVar[bool] = True
    """Whether `configure` is cheap, so that a plan may ask for the grids."""
    reusable: ClassVar[bool] = True
    """The process can take part in several runs in succession, each with its own object. Nothing of
    a run may be kept in the class, in a module or in a library."""
    follows_moving_grids: ClassVar[bool] = False
    """The solver calls `inputs.grid(field)` in every solve, so the grids of its inputs may move."""
    models: ClassVar[Sequence[ModelSpec]] = ()
    """Models, cheapest first."""
    effects: ClassVar[Sequence[Effect]] = ()
    """Effects that the participant supports."""
    keys: ClassVar[Sequence[Key]] = ()
    """Case keys read by every model; keys of a single model or effect stand in that model or
    effect."""
    fields: ClassVar[Sequence[FieldKind]] = ()
    """Fields that are missing from `cosim.fields.TABLE`."""
    figures: ClassVar[Sequence[Figure]] = ()
    """Figures of the summary, in reading order."""

    _report: Callable[[int, int, str], None] | None = None

    def configure(self, configuration: Configuration) -> Layout:
        """Check a configuration. Cheap; allocates no fields.

        Returns grids, placement of the fields and expected cost; raises `Refusal` for an
        unsupported case. The grid of an input may still be unknown in a plan.
        """
        raise NotImplementedError

    def build(self) -> None:
        """Allocate everything needed by solves. May raise `Refusal`."""

    def first_outputs(self, outputs: Outputs) -> None:
        """Write the initial outputs, before the first solve; zero unless overridden."""
        for name in outputs:
            outputs[name] = 0.0

    def solve(self, step: Step, inputs: Inputs, outputs: Outputs) -> StepReport | None:
        """Solve one window from the accepted state, and write every value of the outputs.

        Inputs and outputs are views of shared memory that end with this call; copy values that must
        be kept. Any exception ends the run with its text.
        """
        raise NotImplementedError

    def accept(self) -> None:
        """Make the last solve the accepted state."""

    def observe(self, outputs: Outputs) -> None:
        """Write the observed fields of the accepted state.

        If this is not overridden, observed fields are among the outputs of `solve`, and the values
        written by the accepted solve are sent.
        """

    def moved_grids(self) -> Sequence[Grid]:
        """Return the grids of `Layout.moving` and the volumes, in the accepted state.

        Called after `build`, `accept` and `restore`; see `Grid.moved`. Solves start from these
        grids until the next call.
        """
        return ()

    def save(self, file: BinaryIO) -> None:
        """Write the accepted state; nothing for a solver without memory."""

    def restore(self, file: BinaryIO) -> None:
        """Restore a saved state; raises `StateError` if it does not fit."""
        if file.read(1):
            raise StateError("the file has data, but the solver has no memory")

    def progress(self, done: int, of: int = 0, what: str = "") -> None:
        """Report the progress of `build` or `solve`, as often as needed and from any thread.

        `done` of `of` units of work are done; `of` is 0 if unknown. `what` names the activity in
        one ASCII word of at most 31 letters ("factorising"). Whenever the report changes, the
        coordinator restarts its deadline and shows the report to the user.
        """
        if self._report is not None:
            self._report(done, of, what)

    def report_to(self, report: Callable[[int, int, str], None]) -> None:
        """Set the destination of `progress`; called by the library."""
        self._report = report

    def summary(self) -> dict[str, Any]:
        """Return the solver's sections of `summary.json`, such as `{"temperature": {...}}`."""
        return {}

    @classmethod
    def title(cls) -> str:
        """Return the name of the program, or of its class."""
        return cls.name or cls.__name__

    @classmethod
    def description(cls) -> dict[str, Any]:
        """Return the description; the library adds the version of the contract."""
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
