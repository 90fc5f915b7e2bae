"""The state machine that serves a solver: one command, one answer."""

from __future__ import annotations

import gc
import json
import math
import time
import traceback
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from .configuration import Configuration, Histories, Refusal, utf8
from .fields import TABLE
from .geometry import GeometryError, GeometryPorts, GeometryTopic
from .grids import Array, Grid
from .heart import Heart
from .messages import (
    FIGURES,
    OBSERVE,
    PROTOCOL_VERSION,
    STAY,
    Command,
    CommandKind,
    Reply,
    Status,
)
from .ports import (
    InputPort,
    Inputs,
    OutputPort,
    Outputs,
    PortError,
    Topic,
    advance,
    open_inputs,
    open_outputs,
)
from .run_dir import Membership, forget_peak_resident_memory, peak_resident_memory
from .solver import Solver, StateError, Step, StepError, StepReport, checked_layout
from .transport import Endpoint, TransportError
from .views import KeptView


class ProtocolError(Exception):
    """A command that cannot be understood, or not now."""


class StateFileError(Exception):
    """A state file that cannot be written or read."""


#: Errors that say enough by themselves; of all others the kind is reported too.
PLAIN = (
    StepError,
    StateError,
    StateFileError,
    PortError,
    GeometryError,
    KeptView,
    TransportError,
    ProtocolError,
)


@dataclass
class Connected:
    """The ports of a solver that has not been built yet."""

    inputs: dict[str, InputPort]
    outputs: dict[str, OutputPort]
    observed: dict[str, OutputPort]
    geometry: GeometryPorts
    figures: Sequence[str]
    """Keys of the figures that are asked for with `FIGURES`."""
    patience: float
    """Longest time to wait for the other side's ports [s]."""


@dataclass
class Running:
    """The ports of a solver that has been built."""

    inputs: dict[str, InputPort]
    outputs: dict[str, OutputPort]
    observed: dict[str, OutputPort]
    geometry: GeometryPorts
    figures: Sequence[str]
    step: Step
    unpublished: dict[str, Array]
    """What the last solve wrote of observed fields, for a solver that does not observe itself."""

    def move_to(self, grids: Sequence[Grid], step: Step) -> None:
        """Publish the geometry of those of these grids that have moved.

        Samples are on the moved grids from here on.
        """
        self.geometry.publish(grids, step, self._moved)

    def _moved(self, grid: Grid) -> None:
        for port in (*self.outputs.values(), *self.observed.values()):
            port.moved(grid)
            if port.kind.name in self.unpublished:
                self.unpublished[port.kind.name] = np.zeros(port.shape)
        for given in self.inputs.values():
            given.place.moved(grid)


class Server:
    """Answers the commands of one run after the other, with a new solver for each configuration."""

    def __init__(
        self, kind: type[Solver], membership: Membership, role: str, heart: Heart
    ) -> None:
        self._kind, self._role, self._heart = kind, role, heart
        self._solver = kind()
        self._connected: Connected | None = None
        self._configuration: Configuration | None = None
        self._grids: Sequence[Grid] = ()
        self._running: Running | None = None
        self._finished = False
        self._live: Histories | None = None
        self._model_seconds = 0.0
        self._late: Exception | None = None
        self._spent_before = 0.0
        self._endpoint = Endpoint(membership.info)
        self._doorbell = self._endpoint.doorbell(role)
        self._replies = self._endpoint.reply_sender(role)
        self._coordinator = self._endpoint.ringer("coordinator")
        self._commands = self._endpoint.command_receiver(role)
        self._coordinator.ring()

    def serve(self) -> None:
        """Answer until the run is finished. The heart ends the process with the coordinator."""
        while not self._finished:
            message = self._doorbell.wait(self._commands.receive)
            command, body = message.header, message.body()
            del message
            self._heart.busy(command.sequence)
            try:
                answer = self._handle(command, body)
            except Exception as error:
                answer = _failed(command, error)
            if answer is not None:
                self._replies.send(*answer)
                self._coordinator.ring()
            self._heart.idle_after(command.sequence)

    def _handle(self, command: Command, body: bytes) -> tuple[Reply, bytes] | None:  # noqa: PLR0912
        if command.protocol != PROTOCOL_VERSION:
            raise ProtocolError(
                f"the coordinator speaks protocol {command.protocol}, this program "
                f"{PROTOCOL_VERSION}"
            )
        if command.kind not in set(CommandKind):
            raise ProtocolError(f"unknown command {command.kind}")
        late, self._late = self._late, None
        if late is not None:
            raise late
        kind = CommandKind(command.kind)
        done = _reply(Status.DONE, command)
        match kind:
            case CommandKind.DESCRIBE:
                return done, to_json(self._kind.description())
            case CommandKind.CONFIGURE:
                return done, self._configure(body)
            case CommandKind.CONNECT:
                self._connect(parse(body))
            case CommandKind.INITIALISE:
                self._initialise()
            case CommandKind.SOLVE:
                self._solve(self._ready(kind), command, done)
            case CommandKind.ACCEPT:
                running = self._ready(kind)
                if not command.flags and not running.geometry:
                    self._accept()
                    return None
                return done, self._accept_answered(running, command.flags, done)
            case CommandKind.SAVE:
                self._ready(kind)
                self._save(Path(parse(body)["path"]))
            case CommandKind.RESTORE:
                self._restore(self._ready(kind), command, parse(body))
            case CommandKind.FINISH:
                return done, self._finish(stays=bool(command.flags & STAY))
        return done, b""

    def _ready(self, kind: CommandKind) -> Running:
        if self._running is None:
            raise ProtocolError(f"{kind.name.title()} before Initialise")
        return self._running

    def _timed(self, call: Any, *arguments: Any) -> tuple[Any, float]:
        start = time.perf_counter()
        try:
            result = call(*arguments)
        finally:
            spent = time.perf_counter() - start
            self._model_seconds += spent
        return result, spent

    def _configure(self, body: bytes) -> bytes:
        configuration = understood(Configuration.from_json, parse(body))
        self._solver = self._kind()
        self._solver.report_to(self._heart.report)
        layout = checked_layout(self._solver, configuration)
        self._configuration, self._grids = configuration, layout.grids
        return to_json(layout.to_json())

    def _connect(self, topics: dict[str, Any]) -> None:
        configuration, self._configuration = self._configuration, None
        if configuration is None:
            raise ProtocolError("Connect before Configure")
        histories = configuration.histories
        self._live = histories if histories is not None and histories.live is not None else None
        kinds = {**{kind.name: kind for kind in self._kind.fields}, **TABLE}
        inputs, outputs = (
            [understood(Topic.from_json, topic) for topic in topics[name]]
            for name in ("inputs", "outputs")
        )
        received = [given.field for given in configuration.inputs]
        interpolation = topics.get("interpolation", "constant")
        published = [topic for topic in outputs if topic.field in configuration.outputs]
        observed = [topic for topic in outputs if topic.field not in configuration.outputs]
        geometry = [understood(GeometryTopic.from_json, t) for t in topics.get("geometry", [])]
        self._connected = Connected(
            open_inputs(self._endpoint, inputs, received, interpolation, geometry),
            open_outputs(self._endpoint, published, self._role, kinds),
            open_outputs(self._endpoint, observed, self._role, kinds),
            GeometryPorts(self._endpoint, geometry, self._role, self._grids),
            [str(key) for key in topics.get("figures", [])],
            min(max(float(topics["deadline"]), 0.0), 1e6),
        )

    def _initialise(self) -> None:
        connected, self._connected = self._connected, None
        if connected is None:
            raise ProtocolError("Initialise before Connect")
        deadline = time.monotonic() + connected.patience
        for port in [*connected.outputs.values(), *connected.observed.values()]:
            port.writer.wait_for_subscribers(deadline)
        connected.geometry.wait_for_subscribers(deadline)
        self._timed(self._solver.build)
        running = Running(
            connected.inputs,
            connected.outputs,
            connected.observed,
            connected.geometry,
            connected.figures,
            Step(0, 0, 0.0, 0.0),
            {},
        )
        if self._kind.observe is Solver.observe:
            ports = running.observed.items()
            running.unpublished = {name: np.zeros(port.shape) for name, port in ports}
        running.move_to(self._moved_grids(running), running.step)
        self._write(running.outputs, running.step, self._solver.first_outputs)
        self._running = running

    def _write(
        self,
        ports: Mapping[str, OutputPort],
        step: Step,
        write: Any,
        inputs: Inputs | None = None,
    ) -> float:
        """Let `write` fill loans, and publish them; seconds spent."""
        private = None if inputs is None or self._running is None else self._running.unpublished
        outputs = Outputs(ports, self._provided, private)
        try:
            _, spent = self._timed(write, outputs)
            if inputs is not None:
                inputs.end()
            outputs.publish(step)
        finally:
            outputs.discard()
        return spent

    @cached_property
    def _provided(self) -> frozenset[str]:
        claims = [model.provides for model in self._kind.models]
        claims += [effect.provides for effect in self._kind.effects]
        return frozenset(name for claim in claims for name in claim)

    def _solve(self, running: Running, command: Command, done: Reply) -> None:
        advance(running.inputs, command)
        running.step = _step(command)
        inputs = Inputs(running.inputs)
        if self._live is not None:
            for key in self._live.values:
                if key in inputs:
                    self._live.given[key] = float(inputs.finite(key).flat[0])
        report = StepReport()

        def solve(outputs: Outputs) -> None:
            nonlocal report
            report = self._solver.solve(running.step, inputs, outputs) or StepReport()

            heat = report.heat_received
            if heat is not None and not math.isfinite(heat):
                raise StepError(f"the model reports {heat} W of heat received")

        spent = self._write(running.outputs, running.step, solve, inputs)
        done.work, done.substeps = report.work, report.substeps
        done.inner_iterations = report.inner_iterations
        if report.heat_received is not None:
            done.heat_received = report.heat_received
        done.wanted_window = report.wanted_window or 0.0
        done.model_seconds = spent

    def _accept(self) -> None:
        """Nobody waits for an answer: an error is reported with the answer to the next command."""
        try:
            self._timed(self._solver.accept)
        except Exception as error:
            self._late = error

    def _accept_answered(self, running: Running, flags: int, done: Reply) -> bytes:
        _, done.model_seconds = self._timed(self._solver.accept)
        if flags & OBSERVE:
            observe = self._solver.observe
            if running.unpublished:
                observe = partial(_assign, running.unpublished)
            done.model_seconds += self._write(running.observed, running.step, observe)
        running.move_to(self._moved_grids(running), running.step)
        return self._figures(running) if flags & FIGURES else b""

    def _figures(self, running: Running) -> bytes:
        """The figures that are asked for, NaN for one that there is not."""
        summary, _ = self._timed(self._solver.summary)
        return np.array([_figure(summary, key) for key in running.figures], "<f8").tobytes()

    def _moved_grids(self, running: Running) -> Sequence[Grid]:
        """Asked for only where somebody follows a grid."""
        return self._solver.moved_grids() if running.geometry else ()

    def _save(self, path: Path) -> None:
        unfinished = path.with_suffix(".partial")
        try:
            with unfinished.open("wb") as file:
                self._solver.save(file)
            unfinished.rename(path)
        except OSError as error:
            raise StateFileError(f"state file {path}: {error}") from error

    def _restore(self, running: Running, command: Command, file: dict[str, Any]) -> None:
        path = Path(file["path"])
        try:
            with path.open("rb") as state:
                self._solver.restore(state)
        except OSError as error:
            raise StateFileError(f"state file {path}: {error}") from error
        running.step = _step(command)
        recorded = [Grid.from_json(grid) for grid in file.get("geometry", [])]
        running.move_to(recorded, running.step)
        files = {output["field"]: Path(output["path"]) for output in file.get("outputs", [])}
        self._write(running.outputs, running.step, lambda outputs: outputs.read(files))
        running.move_to(self._moved_grids(running), running.step)

    def _finish(self, *, stays: bool) -> bytes:
        """End the run. Its ports are closed before the coordinator hears of it."""
        self._finished = not stays
        finished: dict[str, Any] = {"summary": None, "model_seconds": 0.0, "peak_rss_bytes": 0}
        if self._running is not None:
            finished = {
                "summary": self._solver.summary(),
                "model_seconds": self._model_seconds,
                "peak_rss_bytes": peak_resident_memory(),
                "cpu_seconds": time.process_time() - self._spent_before,
            }
        said = to_json(finished)
        if stays:
            self._solver = self._kind()
            self._connected = self._running = self._configuration = self._live = None
            self._grids, self._model_seconds = (), 0.0
            gc.collect()
            self._spent_before = time.process_time()
            forget_peak_resident_memory()
        return said


def parse(body: bytes) -> dict[str, Any]:
    """An object from JSON; raises `ProtocolError` for anything else."""
    try:
        value = json.loads(body)
    except ValueError as error:
        raise ProtocolError(f"malformed message: {error}") from error
    if not isinstance(value, dict):
        raise ProtocolError(f"malformed message: {type(value).__name__} is not an object")
    return value


def understood(read: Any, value: Any) -> Any:
    """`read(value)`; raises `ProtocolError` where something is missing or of another kind."""
    try:
        return read(value)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ProtocolError(f"malformed message: {error!r}") from error


def to_json(value: Any) -> bytes:
    """JSON of plain values and numpy's; numbers that are not finite become null, texts UTF-8."""
    return json.dumps(plain(value), allow_nan=False).encode()


def plain(value: Any) -> Any:
    """The value in Python's own types."""
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


def _figure(summary: Any, key: str) -> float:
    """The number under a dotted key of a summary."""
    for part in key.split("."):
        summary = summary.get(part) if isinstance(summary, Mapping) else None
    return float(summary) if isinstance(summary, int | float | np.number) else math.nan


def _assign(values: Mapping[str, Array], outputs: Outputs) -> None:
    for name, array in values.items():
        outputs[name] = array


def _step(command: Command) -> Step:
    return Step(command.window, command.iteration, command.start, command.end)


def _reply(status: Status, command: Command) -> Reply:
    return Reply(
        protocol=PROTOCOL_VERSION,
        status=status,
        sequence=command.sequence,
        heat_received=math.nan,
    )


def _failed(command: Command, error: Exception) -> tuple[Reply, bytes]:
    if isinstance(error, Refusal):
        return _reply(Status.REFUSED, command), to_json(error.to_json())
    with suppress(OSError):
        traceback.print_exception(error)
    message = str(error) if isinstance(error, PLAIN) else f"{type(error).__name__}: {error}"
    return _reply(Status.FAILED, command), to_json({"error": message})
