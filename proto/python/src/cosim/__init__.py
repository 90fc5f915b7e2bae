"""The contact co-simulation from Python: cases are run, and solvers written.

`run`, `plan`, `sweep` and `cost` are commands of the coordinator that answer with objects:
`cosim.run("case.toml").contact.approach_m`.

A solver is a subclass of `Solver` with `configure` and `solve`; `main` is its whole main. Fields
are numpy arrays over shared memory, read and written in place.
"""

from . import fields
from .command import CosimError
from .configuration import Case, Configuration, Input, Layout, Refusal, Simplification
from .description import Effect, Figure, Key, Model
from .fields import FieldKind
from .front import Study, cost, plan, run, sweep
from .grids import Array, Grid, Quadrilaterals, Structured
from .main import main
from .messages import PROTOCOL_VERSION
from .ports import Inputs, Outputs
from .results import Results, Section
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
    "CosimError",
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
    "Results",
    "Section",
    "Simplification",
    "Solver",
    "StateError",
    "Step",
    "StepError",
    "StepReport",
    "Structured",
    "Study",
    "Volume",
    "cost",
    "fields",
    "first_non_finite",
    "main",
    "plan",
    "run",
    "sweep",
]
