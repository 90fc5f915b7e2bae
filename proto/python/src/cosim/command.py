"""The `coordinator` as a process: found, started, interrupted, its errors as exceptions."""

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
"""Names the executable where it is neither beside this package nor on the PATH."""

PATIENCE_S = 30.0
"""How long an interrupted run may take to end its participants."""


class CosimError(RuntimeError):
    """A command of the coordinator that ended badly; the text is what it says.

    Attributes: `exit_code`, that of the command (1: a participant failed, 2: the case or the
    options are wrong, 3: no convergence or not accurate, 4: a difference), and `folder`, that of
    the results as far as they came, or None.
    """

    def __init__(self, message: str, exit_code: int, folder: Path | None = None) -> None:
        super().__init__(message)
        self.exit_code, self.folder = exit_code, folder


def executable() -> Path:
    """The coordinator: named by COSIM_COORDINATOR, inside this package, or on the PATH."""
    named = os.environ.get(EXECUTABLE)
    inside = Path(__file__).parent / "bin" / "coordinator"
    if named is None and inside.is_file():
        return inside
    found = named or shutil.which("coordinator")
    if found is None or not Path(found).is_file():
        where = f"{EXECUTABLE}={named} is no file" if named else "it is not on the PATH"
        built = f"{EXECUTABLE}=.../target/release/coordinator"
        advice = f"build it with `cargo build --release` and set {built}"
        raise FileNotFoundError(f"no executable `coordinator`: {where}; {advice}")
    return Path(found)


def settings(tables: Mapping[str, Any]) -> Iterator[str]:
    """Options `--set KEY=VALUE` of nested tables, `--unset KEY` where a value is None."""
    for key, value in flat(tables):
        yield from ("--unset", key) if value is None else ("--set", f"{key}={toml(value)}")


def flat(tables: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys of nested tables; an empty table is a value."""
    for name, value in tables.items():
        key = f"{prefix}{name}"
        if isinstance(value, Mapping) and value:
            yield from flat(value, f"{key}.")
        else:
            yield key, value


def toml(value: object) -> str:
    """A value as TOML has it."""
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
            f"{value!r} is no value of a case: give a number, a text, a list or a table"
        )
    return (
        str(int(number)) if isinstance(value, int) or hasattr(value, "__index__") else repr(number)
    )


@contextmanager
def case_file(case: str | os.PathLike[str]) -> Iterator[Path]:
    """The file of a case: its path, its text, or the name of a scene that the coordinator has."""
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
    """Run the coordinator with these arguments; what it prints.

    An error has `folder` among its attributes. Standard error, with the progress of long work, is
    passed on where someone looks at it, in a terminal and in a notebook, or as `progress` says;
    how far the command is shows a bar where tqdm is installed.
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
            # A notebook interrupts its kernel alone: the coordinator ends its participants itself.
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
    """Keep the lines of a stream, and pass them on; those about progress go into the bar."""
    for line in stream:
        if display and display.takes(line):
            continue
        told.append(line)
        if shown and not line.startswith("error: "):
            print(line, end="", file=sys.stderr, flush=True)


@contextmanager
def results_folder(out: str | os.PathLike[str] | None) -> Iterator[Path]:
    """The folder named for results, or one of its own, which goes when they cannot be had."""
    if out is not None:
        yield Path(out)
        return
    folder = Path(mkdtemp(prefix="cosim-")) / "results"
    try:
        yield folder
    except CosimError as error:
        # As long as someone may look into the log that the error names.
        remove_with(error, folder)
        raise
    except BaseException:
        shutil.rmtree(folder.parent, ignore_errors=True)
        raise


def remove_with(owner: object, folder: Path) -> None:
    """Remove a folder that was made for an object together with it."""
    weakref.finalize(owner, shutil.rmtree, folder.parent, ignore_errors=True)


def watched() -> bool:
    """Whether someone looks at standard error: a terminal or a notebook."""
    return sys.stderr.isatty() or "ipykernel" in sys.modules
