"""Connects a `Solver` to the callbacks of the library, which handles everything else in a run."""

from __future__ import annotations

import ctypes
import gc
import io
import json
import math
import os
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial, wraps
from typing import Any

import numpy as np

from . import library
from .build import build
from .configuration import Configuration, Layout, Refusal, utf8
from .fields import TABLE, FieldKind
from .grids import Array, Grid
from .ports import Inputs, Outputs, PortError, shape_of
from .solver import Solver, StateError, Step, StepError, StepReport
from .views import KeptView, Views

OK = 0
"""Status of a successful callback."""

#: Errors whose text suffices; for all others the type is reported too.
PLAIN = (StepError, StateError, PortError, KeptView)


class Run:
    """One run: its solver, and the data passed by the library."""

    def __init__(self, solver: Solver, configuration: Configuration) -> None:
        self.solver = solver
        for given in configuration.inputs:
            if given.moves and not solver.follows_moving_grids:
                raise Refusal(
                    f"{given.producer}.model",
                    f"the grid of `{given.field.name}` moves, and `{type(solver).__name__}` requires "
                    "fixed grids",
                    f"name a model of {given.producer} with a fixed grid",
                )
        self.layout: Layout = solver.configure(configuration)
        self.kinds = {**{kind.name: kind for kind in solver.fields}, **TABLE}
        self.inputs = {given.field.name: given.field for given in configuration.inputs}
        self.grids: dict[str, Grid] = {}
        """Latest grids of the inputs."""
        self.outputs = {name: self.kinds[name] for name in configuration.outputs}
        self.observed = {name: self.kinds[name] for name in configuration.observed}
        histories = configuration.histories
        self.live = histories if histories is not None and histories.live is not None else None
        self.own = {grid.name: grid for grid in self.layout.grids}
        self.unpublished: dict[str, Array] = {}
        """Observed fields as written by the last solve, for a solver without `observe`."""

    def make_room(self) -> None:
        """Provide buffers for observed fields written by a solve, on their current grids."""
        if type(self.solver).observe is not Solver.observe:
            return
        for name, kind in self.observed.items():
            shape = shape_of(kind, self.own[self.layout.fields[name]].points)
            if name not in self.unpublished or self.unpublished[name].shape != shape:
                self.unpublished[name] = np.zeros(shape)


def callback(call: Callable[..., int | None]) -> Callable[..., int]:
    """Turn a method into a callback: an exception is reported to the library and becomes a
    status."""

    @wraps(call)
    def guarded(self: Participant, *arguments: Any) -> int:
        try:
            return call(self, *arguments) or OK
        except BaseException as error:
            return self.report(error)

    return guarded


class Participant:
    """Callbacks of a solver class: several runs in succession, each with its own solver object."""

    def __init__(self, kind: type[Solver], lib: Any) -> None:
        self._kind, self._lib = kind, lib
        self._run: Run | None = None
        self._texts: dict[str, Any] = {}
        claims = [model.provides for model in kind.models]
        claims += [effect.provides for effect in kind.effects]
        self._described = frozenset(name for claim in claims for name in claim)

    def main(self, arguments: Sequence[str]) -> int:
        """Pass the callbacks to the library; return the exit code."""
        names = [name for name in library.CALLBACKS if hasattr(self, name)]
        table = library.table({name: partial(_method, getattr(self, name)) for name in names})
        words = [os.fsencode(word) for word in (sys.argv[0], *arguments)]
        argv = (ctypes.c_char_p * (len(words) + 1))(*words, None)
        return int(self._lib.cosim_main(len(words), argv, ctypes.byref(table), None))

    def report(self, error: BaseException) -> int:
        """Report an exception to the library; return the status of the callback."""
        match error:
            case SystemExit() | KeyboardInterrupt():
                _end(error)
            case Refusal():
                texts = (utf8(text).encode() for text in (error.key, error.reason, error.fix))
                return int(self._lib.cosim_refuse(*texts))
        with suppress(OSError):
            traceback.print_exception(error)
        message = str(error) if isinstance(error, PLAIN) else f"{type(error).__name__}: {error}"
        if isinstance(error, StateError):
            # The library adds that the state does not fit.
            message = error.reason
        return int(self._lib.cosim_fail(utf8(message).encode()))

    def _text(self, name: str, value: Any) -> int:
        """Return the address of a value as JSON, valid until the next value of this name."""
        self._texts[name] = text = ctypes.create_string_buffer(to_json(value))
        return ctypes.addressof(text)

    @property
    def _now(self) -> Run:
        assert self._run is not None, "the library configures first"
        return self._run

    def describe(self) -> int | None:
        """Return the address of the description."""
        try:
            description = self._kind.description()
            description.setdefault("build", build(self._lib._name))
            return self._text("description", description)
        except BaseException as error:
            self.report(error)
            return None

    @callback
    def configure(self, configuration: int, layout: int) -> int:
        """Create the solver of a run, and set its layout."""
        self._run = None
        given = json.loads(self._lib.cosim_configuration_json(configuration))
        solver = self._kind()
        solver.report_to(self._progress)
        self._run = Run(solver, Configuration.from_json(given))
        return int(self._lib.cosim_layout_json(layout, to_json(self._run.layout.to_json())))

    def _progress(self, done: int, of: int, what: str) -> None:
        # A NUL would end the word.
        word = what.encode(errors="backslashreplace").replace(b"\0", b" ")
        self._lib.cosim_progress(done, of, word)

    @callback
    def build(self) -> None:
        """Build the solver."""
        self._now.solver.build()

    def _write(
        self,
        outputs: int,
        kinds: Mapping[str, FieldKind],
        write: Callable[[Outputs], None],
        private: Mapping[str, Array] | None = None,
    ) -> None:
        """Let `write` fill outputs; checks that no view of them is kept."""
        places = Outputs(self._lib, outputs, kinds, self._described, private)
        write(places)
        places.end()

    @callback
    def first_outputs(self, outputs: int) -> None:
        """Write the initial outputs, before the first solve."""
        self._write(outputs, self._now.outputs, self._now.solver.first_outputs)

    @callback
    def solve(self, step: Any, given: int, outputs: int, report: Any) -> None:
        """Solve a window."""
        run, now = self._now, step.contents
        inputs = Inputs(self._lib, given, run.inputs, run.grids)
        if run.live is not None:
            for key in run.live.values:
                if key in inputs:
                    run.live.given[key] = float(inputs.finite(key).flat[0])
        run.make_room()
        said = StepReport()

        def solve(outputs: Outputs) -> None:
            nonlocal said
            place = Step(now.window, now.iteration, now.start, now.end)
            said = run.solver.solve(place, inputs, outputs) or said
            inputs.end()

        self._write(outputs, run.outputs, solve, run.unpublished)
        power = said.received_power
        if power is not None and not math.isfinite(power):
            raise StepError(f"the model reports a received power of {power} W")
        answer = report.contents
        answer.substeps, answer.inner_iterations = said.substeps, said.inner_iterations
        answer.work = said.work
        if power is not None:
            answer.received_power = power
            answer.present |= library.RECEIVED_POWER
        if said.wanted_window is not None:
            answer.wanted_window = said.wanted_window
            answer.present |= library.WANTED_WINDOW

    @callback
    def accept(self) -> None:
        """Accept the last solve."""
        self._now.solver.accept()

    @callback
    def observe(self, outputs: int) -> None:
        """Write the observed fields, or those of the accepted solve."""
        run = self._now
        write = partial(_assign, run.unpublished) if run.unpublished else run.solver.observe
        self._write(outputs, run.observed, write)

    @callback
    def moved_grids(self, moves: int) -> None:
        """Supply the geometry of grids that have moved."""
        run = self._now
        for grid in run.solver.moved_grids():
            known, run.own[grid.name] = run.own.get(grid.name), grid
            name, count = grid.name.encode(), ctypes.c_size_t()
            place = self._lib.cosim_geometry(moves, name, grid.revision, ctypes.byref(count))
            if place:
                shape = (3, count.value // 3)
                places = Views().view("geometry", place, shape, read_only=False)
                places[...] = grid.encoded_geometry()
            elif known and known.revision == grid.revision and not known.is_where(grid):
                raise StepError(
                    f"grid `{grid.name}` has moved and still has revision {grid.revision}"
                )

    @callback
    def save(self, blob: int) -> int:
        """Write the accepted state."""
        file = io.BytesIO()
        self._now.solver.save(file)
        state = file.getvalue()
        return int(self._lib.cosim_blob_write(blob, state, len(state)))

    @callback
    def restore(self, blob: int) -> None:
        """Restore a saved state."""
        file, piece = io.BytesIO(), ctypes.create_string_buffer(1 << 16)
        while count := self._lib.cosim_blob_read_some(blob, piece, len(piece)):
            file.write(piece.raw[:count])
        file.seek(0)
        self._now.solver.restore(file)

    def summary(self) -> int | None:
        """Return the address of the solver's sections."""
        try:
            return self._text("summary", self._now.solver.summary())
        except BaseException as error:
            self.report(error)
            return None

    @callback
    def finish(self) -> None:
        """Release a finished run, including garbage in cycles."""
        self._run = None
        gc.collect()


def _method(method: Callable[..., Any], _user: Any, *arguments: Any) -> Any:
    """Drop the user pointer, the first argument of every callback."""
    return method(*arguments)


def _end(error: SystemExit | KeyboardInterrupt) -> None:
    """End the process like Python would, because no exception may pass through the library."""
    code = 130
    if isinstance(error, SystemExit):
        code = error.code if isinstance(error.code, int) else int(error.code is not None)
        if isinstance(error.code, str):
            print(error.code, file=sys.stderr)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def _assign(values: Mapping[str, Array], outputs: Outputs) -> None:
    for name, array in values.items():
        outputs[name] = array


def to_json(value: Any) -> bytes:
    """Convert plain and numpy values to JSON in UTF-8; numbers that are not finite become null."""
    return json.dumps(plain(value), allow_nan=False).encode()


def plain(value: Any) -> Any:
    """Return the value in Python's own types."""
    if isinstance(value, Mapping):
        return {utf8(str(key)): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.generic | np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    if isinstance(value, str):
        return utf8(value)
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
