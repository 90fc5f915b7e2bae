"""The `coordinator` as a process: locates, starts and interrupts it, and converts errors to
exceptions."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import weakref
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import IO, Any

from .progress import FORM, Bar, bar

EXECUTABLE = "COSIM_COORDINATOR"
"""Names the executable if it is neither in this package nor on the PATH."""

PATIENCE_S = 30.0
"""Longest time for an interrupted run to end its participants [s]."""


class CosimError(RuntimeError):
    """A failed command of the coordinator; the text is its error message.

    Attributes: `exit_code` of the command (1: a participant failed, 2: the case or the options are
    wrong, 3: no convergence or not accurate, 4: a difference), and `folder` with the incomplete
    results, or None.
    """

    def __init__(self, message: str, exit_code: int, folder: Path | None = None) -> None:
        super().__init__(message)
        self.exit_code, self.folder = exit_code, folder


def executable() -> Path:
    """Locate the coordinator: named by COSIM_COORDINATOR, in this package, or on the PATH."""
    named = os.environ.get(EXECUTABLE)
    inside = Path(__file__).parent / "bin" / "coordinator"
    if named is None and inside.is_file():
        return inside
    found = named or shutil.which("coordinator")
    if found is None or not Path(found).is_file():
        where = f"{EXECUTABLE}={named} is not a file" if named else "it is not on the PATH"
        built = f"{EXECUTABLE}=.../target/release/coordinator"
        advice = f"build it with `cargo build --release` and set {built}"
        raise FileNotFoundError(f"no executable `coordinator`: {where}; {advice}")
    return Path(found)


def settings(tables: Mapping[str, Any]) -> Iterator[str]:
    """Yield options `--set KEY=VALUE` for nested tables, and `--unset KEY` for values that are
    None."""
    for key, value in flat(tables):
        yield from ("--unset", key) if value is None else ("--set", f"{key}={toml(value)}")


def flat(tables: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield dotted keys of nested tables; an empty table counts as a value."""
    for name, value in tables.items():
        key = f"{prefix}{name}"
        if isinstance(value, Mapping) and value:
            yield from flat(value, f"{key}.")
        else:
            yield key, value


def toml(value: object) -> str:
    """Write a value as TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str | os.PathLike):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, Iterable):
        return "[" + ", ".join(map(toml, value)) + "]"
    number = float(value) if hasattr(value, "__float__") else None
    if number is None:
        raise TypeError(
            f"{value!r} is not a valid case value: give a number, a text, a list or a table"
        )
    return (
        str(int(number)) if isinstance(value, int) or hasattr(value, "__index__") else repr(number)
    )


@contextmanager
def case_file(case: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield the file of a case, given by its path, its text, or the name of a scene of the
    coordinator."""
    given = os.fspath(case)
    if "\n" not in given and (Path(given).suffix == ".toml" or Path(given).exists()):
        yield Path(given)
        return
    with TemporaryDirectory(prefix="cosim-") as folder:
        if "\n" in given:
            path = Path(folder) / "case.toml"
            path.write_text(given, encoding="utf-8")
        else:
            path = Path(folder) / f"{Path(given).name}.toml"
            call(["new", path.stem, "--scene", given], within=Path(folder))
        yield path


def call(
    arguments: Iterable[str | os.PathLike[str]],
    *,
    within: Path | None = None,
    folder: Path | None = None,
    progress: bool | None = None,
) -> str:
    """Run the coordinator with these arguments; return its output.

    An error has `folder` among its attributes. Standard error, including progress, is passed on in
    a terminal and in a notebook, unless `progress` overrides this. Progress is shown as a bar if
    tqdm is installed.
    """
    command = [os.fspath(executable()), *(os.fspath(one) for one in arguments), "--color", "never"]
    shown = watched() if progress is None else progress
    display = bar() if shown else None
    told: list[str] = []
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=within,
        encoding="utf-8",
        env={**os.environ, **FORM} if display else None,
    ) as process:
        assert process.stdout and process.stderr
        given = (process.stderr, told, shown, display)
        listener = threading.Thread(target=listen, args=given, daemon=True)
        listener.start()
        try:
            answer = process.stdout.read()
            code = process.wait()
        except BaseException:
            # A notebook interrupts only its kernel; the coordinator ends its participants itself.
            process.send_signal(signal.SIGINT)
            try:
                process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                process.kill()
            raise
        finally:
            listener.join()
            if display:
                display.close()
    if code != 0:
        raise CosimError("".join(told).strip().removeprefix("error: "), code, folder)
    return answer


def listen(stream: IO[str], told: list[str], shown: bool, display: Bar | None = None) -> None:
    """Collect the lines of a stream and pass them on; progress lines go to the bar."""
    for line in stream:
        if display and display.takes(line):
            continue
        told.append(line)
        if shown and not line.startswith("error: "):
            print(line, end="", file=sys.stderr, flush=True)


@contextmanager
def results_folder(out: str | os.PathLike[str] | None) -> Iterator[Path]:
    """Yield the folder named for results, or a temporary one, which is removed on failure."""
    if out is not None:
        yield Path(out)
        return
    folder = Path(mkdtemp(prefix="cosim-")) / "results"
    try:
        yield folder
    except CosimError as error:
        # Kept while the error exists, because the error names a log in the folder.
        remove_with(error, folder)
        raise
    except BaseException:
        shutil.rmtree(folder.parent, ignore_errors=True)
        raise


def remove_with(owner: object, folder: Path) -> None:
    """Remove a temporary folder together with its owner."""
    weakref.finalize(owner, shutil.rmtree, folder.parent, ignore_errors=True)


def watched() -> bool:
    """Return true if standard error is visible: in a terminal or a notebook."""
    return sys.stderr.isatty() or "ipykernel" in sys.modules
