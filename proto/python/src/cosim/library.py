"""`libcosim`, the library that takes part in runs, by its C interface
(`proto/c/include/cosim.h`)."""

from __future__ import annotations

import ctypes
import os
import shutil
from collections.abc import Callable, Iterator
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_char,
    c_char_p,
    c_double,
    c_int,
    c_size_t,
    c_uint32,
    c_uint64,
    c_void_p,
)
from pathlib import Path
from typing import Any, ClassVar

NAME = "libcosim.so"
LIBRARY = "COSIM_LIBRARY"
"""Names the library if it is neither in this package nor beside the executables."""
VERSION = 4
"""Version of the interface, COSIM_VERSION."""

RECEIVED_POWER = 1
"""Flag of a report: the model reports the power that it receives."""
WANTED_WINDOW = 2
"""Flag of a report: the model limits the window."""

STRUCTURED = 1
"""Kind of a grid: a plane patch of equal elements."""
VERTICES = 3
"""Kind of a grid: vertices that carry values."""


class Step(Structure):
    """`cosim_step`."""

    _fields_: ClassVar = [
        ("window", c_uint64),
        ("iteration", c_uint32),
        ("start", c_double),
        ("end", c_double),
    ]


class Report(Structure):
    """`cosim_report`."""

    _fields_: ClassVar = [
        ("substeps", c_uint32),
        ("inner_iterations", c_uint32),
        ("work", c_uint64),
        ("present", c_uint32),
        ("received_power", c_double),
        ("wanted_window", c_double),
    ]


class Grid(Structure):
    """`cosim_grid`."""

    _fields_: ClassVar = [
        ("name", c_char * 32),
        ("revision", c_uint64),
        ("kind", c_int),
        ("points", c_size_t),
        ("origin", c_double * 3),
        ("step_i", c_double * 3),
        ("step_j", c_double * 3),
        ("ni", c_size_t),
        ("nj", c_size_t),
        ("vertex_count", c_size_t),
        ("vertices", POINTER(c_double)),
        ("elements", POINTER(c_uint32)),
    ]


CALLBACKS: dict[str, Any] = {
    "describe": CFUNCTYPE(c_void_p, c_void_p),
    "configure": CFUNCTYPE(c_int, c_void_p, c_void_p, c_void_p),
    "build": CFUNCTYPE(c_int, c_void_p),
    "first_outputs": CFUNCTYPE(c_int, c_void_p, c_void_p),
    "solve": CFUNCTYPE(c_int, c_void_p, POINTER(Step), c_void_p, c_void_p, POINTER(Report)),
    "accept": CFUNCTYPE(c_int, c_void_p),
    "observe": CFUNCTYPE(c_int, c_void_p, c_void_p),
    "save": CFUNCTYPE(c_int, c_void_p, c_void_p),
    "restore": CFUNCTYPE(c_int, c_void_p, c_void_p),
    "summary": CFUNCTYPE(c_void_p, c_void_p),
    "destroy": CFUNCTYPE(None, c_void_p),
    "moved_grids": CFUNCTYPE(c_int, c_void_p, c_void_p),
    "finish": CFUNCTYPE(c_int, c_void_p),
}
"""Callbacks of `cosim_solver`, in order."""


class Solver(Structure):
    """`cosim_solver`."""

    _fields_: ClassVar = [("size", c_size_t), ("version", c_uint32), *CALLBACKS.items()]


FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "cosim_main": (c_int, [c_int, POINTER(c_char_p), POINTER(Solver), c_void_p]),
    "cosim_configuration_json": (c_char_p, [c_void_p]),
    "cosim_layout_json": (c_int, [c_void_p, c_char_p]),
    "cosim_refuse": (c_int, [c_char_p, c_char_p, c_char_p]),
    "cosim_fail": (c_int, [c_char_p]),
    "cosim_input": (c_void_p, [c_void_p, c_char_p, POINTER(c_size_t), POINTER(Grid)]),
    "cosim_input_start": (c_void_p, [c_void_p, c_char_p, POINTER(c_size_t)]),
    "cosim_output": (c_void_p, [c_void_p, c_char_p, POINTER(c_size_t)]),
    "cosim_geometry": (c_void_p, [c_void_p, c_char_p, c_uint64, POINTER(c_size_t)]),
    "cosim_blob_write": (c_int, [c_void_p, c_char_p, c_size_t]),
    "cosim_blob_read_some": (c_size_t, [c_void_p, c_void_p, c_size_t]),
    "cosim_progress": (c_int, [c_uint64, c_uint64, c_char_p]),
}
"""Functions of the library in use, with return and argument types."""


def load() -> Any:
    """Load the library; raises `FileNotFoundError` with advice if there is none."""
    path = next((place for place in places() if place.is_file()), None)
    if path is None:
        raise FileNotFoundError(
            f"there is no {NAME}: build it with `cargo build --release` in the sources of the "
            f"project, or set {LIBRARY}=/path/to/{NAME}"
        )
    library = ctypes.CDLL(os.fspath(path))
    for name, (returns, takes) in FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = returns, takes
    return library


def places() -> Iterator[Path]:
    """Yield possible paths of the library, the most likely first."""
    named = os.environ.get(LIBRARY)
    if named:
        yield Path(named)
        return
    yield Path(__file__).parent / "bin" / NAME
    coordinator = os.environ.get("COSIM_COORDINATOR") or shutil.which("coordinator")
    if coordinator:
        yield Path(coordinator).resolve().with_name(NAME)
    # In the sources of the project, also from an environment inside them.
    for folder in Path(__file__).resolve().parents:
        yield folder / "target" / "release" / NAME


def table(callbacks: dict[str, Callable[..., Any]]) -> Solver:
    """Return a `cosim_solver` with these callbacks, which it keeps alive."""
    solver = Solver(size=ctypes.sizeof(Solver), version=VERSION)
    for name, call in callbacks.items():
        setattr(solver, name, CALLBACKS[name](call))
    return solver
