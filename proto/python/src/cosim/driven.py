"""A run driven from Python, window by window.

    run = cosim.drive("case.toml", load={"normal_force": cosim.live("134 kN", "60 kN", "140 kN")})
    with run:
        window = run.step({"load.normal_force": 100e3})
        window["contact.creep_force_x_n"]
        state = run.save()
        run.step()
        run.restore(state)
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import subprocess
import threading
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

from .command import PATIENCE_S, CosimError, case_file, executable, listen, settings

LANGUAGE = 1
"""Version of the line protocol (docs/fmi.md)."""


class NoAnswer(CosimError):
    """A window without a solution; the run stays in its previous state."""


class Refused(CosimError):
    """An invalid request; nothing has changed."""


class Live(NamedTuple):
    """A value that may be set, in SI units."""

    unit: str
    at: float
    least: float
    most: float


class Window(Mapping[str, float]):
    """A solved and accepted window: its figures by key, NaN for figures that do not exist.

    Attributes: `number`, from 0, `start` and `end` [s], `status` and `iterations`.
    """

    def __init__(self, keys: list[str], answer: Mapping[str, Any]) -> None:
        self.number, self.status = int(answer["window"]), str(answer["status"])
        self.start, self.end = float(answer["start"]), float(answer["end"])
        self.iterations = int(answer["iterations"])
        values = (math.nan if value is None else float(value) for value in answer["figures"])
        self._figures = dict(zip(keys, values, strict=True))

    def __getitem__(self, key: str) -> float:
        return self._figures[key]

    def __iter__(self) -> Any:
        return iter(self._figures)

    def __len__(self) -> int:
        return len(self._figures)

    def __repr__(self) -> str:
        return f"<window {self.number}, {self.start} s to {self.end} s: {self.status}>"


def live(at: float | str, least: float | str, most: float | str) -> dict[str, float | str]:
    """Return the case entry of a value given during the run: first value and limits."""
    return {"at": at, "from": least, "to": most}


class Drive:
    """A run driven from outside; ended by `finish`, or at the end of its `with` block."""

    def __init__(
        self, case: str | os.PathLike[str], out: Path | None, replace: bool, tables: Mapping[str, Any]
    ) -> None:
        self._told: list[str] = []
        with ExitStack() as kept:
            path = kept.enter_context(case_file(case))
            command: list[str | os.PathLike[str]] = [executable(), "--color", "never", "drive", path]
            command += [] if out is None else ["--out", out]
            command += ["--replace"] * replace + [*_settings(tables)]
            self._process = subprocess.Popen(
                [os.fspath(word) for word in command],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                encoding="utf-8",
                # An interrupt belongs to the driving program, which then ends the run.
                process_group=0,
            )
            assert self._process.stderr
            arguments = (self._process.stderr, self._told, False)
            self._listener = threading.Thread(target=listen, args=arguments, daemon=True)
            self._listener.start()
            try:
                ready = self._hear()
            except BaseException:
                self.close()
                raise
            if ready["ready"] != LANGUAGE:
                self.close()
                raise CosimError(f"the coordinator speaks version {ready['ready']}", 1)
            # The text of a case has been read by now.
        self.live: dict[str, Live] = {
            one["key"]: Live(one["unit"], one["at"], one["from"], one["to"])
            for one in ready["live"]
        }
        self.figures: list[str] = ready["figures"]
        self.window: float | None = ready["window"]
        self.folder = out

    def set(self, values: Mapping[str, float]) -> None:
        """Set live values by key, in SI units, from the next window on."""
        self._ask({"do": "set", "values": _numbers(values)})

    def step(
        self, values: Mapping[str, float] | None = None, end: float | None = None, observe: bool = False
    ) -> Window:
        """Solve the next window, with these live values, to this time [s]; return its figures.

        `observe` writes the fields of the window. Raises `NoAnswer` and `Refused`.
        """
        request = {"do": "step", "set": _numbers(values or {}), "end": end, "observe": observe}
        return Window(self.figures, self._ask(request))

    def save(self) -> int:
        """Save the state after the last window; return its number."""
        return int(self._ask({"do": "save"})["state"])

    def restore(self, state: int) -> None:
        """Restore a state, which stays available."""
        self._ask({"do": "restore", "state": state})

    def free(self, state: int) -> None:
        """Discard a state."""
        self._ask({"do": "free", "state": state})

    def finish(self) -> None:
        """End the run and write its results."""
        self._ask({"do": "finish"})
        self.close()

    def close(self) -> None:
        """End the run, unless it has already ended."""
        process = self._process
        if process.stdin and not process.stdin.closed:
            with contextlib.suppress(BrokenPipeError):
                process.stdin.close()
        try:
            process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        self._listener.join()
        assert process.stdout and process.stderr
        process.stdout.close()
        process.stderr.close()

    def __enter__(self) -> Drive:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ask(self, request: Mapping[str, Any]) -> dict[str, Any]:
        stdin = self._process.stdin
        if stdin is None or stdin.closed:
            raise Refused("the run has ended", 2)
        with contextlib.suppress(BrokenPipeError):
            stdin.write(json.dumps(request) + "\n")
            stdin.flush()
        return self._hear()

    def _hear(self) -> dict[str, Any]:
        assert self._process.stdout
        line = self._process.stdout.readline()
        if not line:
            code = self._process.wait(PATIENCE_S)
            raise CosimError("".join(self._told).strip().removeprefix("error: "), code)
        answer: dict[str, Any] = json.loads(line)
        if "error" not in answer:
            return answer
        kinds = {"refused": (Refused, 2), "no-answer": (NoAnswer, 3)}
        kind, code = kinds.get(answer["kind"], (CosimError, 1))
        raise kind(answer["error"], code)


def _numbers(values: Mapping[str, float]) -> dict[str, float]:
    return {key: float(value) for key, value in values.items()}


def _settings(tables: Mapping[str, Any]) -> list[str]:
    """Return the options for nested tables, in which a live value counts as one value."""

    def split(table: Mapping[str, Any], prefix: str) -> list[str]:
        found: list[str] = []
        for name, value in table.items():
            if isinstance(value, Mapping) and set(value) == {"at", "from", "to"}:
                text = ", ".join(f"{entry} = {json.dumps(given)}" for entry, given in value.items())
                found += ["--set", f"{prefix}{name}={{ {text} }}"]
            elif isinstance(value, Mapping) and value:
                found += split(value, f"{prefix}{name}.")
            else:
                found += settings({f"{prefix}{name}": value})
        return found

    return split(tables, "")


def drive(
    case: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    replace: bool = False,
    **tables: Any,
) -> Drive:
    """Start a driven run; it waits before its first window.

    `case` and keyword arguments are those of `run`; `live` marks a value that may be set. Without
    `out` no results are kept.
    """
    return Drive(case, None if out is None else Path(out), replace, tables)
