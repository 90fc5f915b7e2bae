"""Solvers in Python for the contact co-simulation.

A solver is a subclass of `Solver` with `configure` and `solve`; `main` is its whole main. Fields
are numpy arrays over shared memory, read and written in place.
"""

from . import fields
from .configuration import Case, Configuration, Input, Layout, Refusal, Simplification
from .description import Effect, Figure, Key, Model
from .fields import FieldKind
from .grids import Array, Grid, Quadrilaterals, Structured
from .main import main
from .messages import PROTOCOL_VERSION
from .ports import Inputs, Outputs
from .solver import (
    MissingInput,
    NonFiniteInput,
    Solver,
    StateError,
    Step,
    StepError,
    StepReport,
    first_non_finite,
)
from .volumes import Volume

__all__ = [
    "PROTOCOL_VERSION",
    "Array",
    "Case",
    "Configuration",
    "Effect",
    "FieldKind",
    "Figure",
    "Grid",
    "Input",
    "Inputs",
    "Key",
    "Layout",
    "MissingInput",
    "Model",
    "NonFiniteInput",
    "Outputs",
    "Quadrilaterals",
    "Refusal",
    "Simplification",
    "Solver",
    "StateError",
    "Step",
    "StepError",
    "StepReport",
    "Structured",
    "Volume",
    "fields",
    "first_non_finite",
    "main",
]
