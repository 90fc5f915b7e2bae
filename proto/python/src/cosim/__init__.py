"""Contact co-simulation from Python: run cases, and write solvers.

`run`, `plan`, `sweep` and `cost` are commands of the coordinator that return objects:
`cosim.run("case.toml").contact.approach_m`. `drive` advances a run window by window.

A solver is a subclass of `Solver` with `configure` and `solve`; `main` is its complete main
function. Fields are numpy arrays over shared memory, read and written in place.
"""

from . import fields
from .command import CosimError
from .configuration import Case, Configuration, Input, Layout, Refusal, Simplification
from .description import Effect, Figure, Key, ModelSpec
from .driven import Drive, Live, NoAnswer, Refused, Window, drive, live
from .fields import FieldKind
from .front import Study, cost, plan, run, sweep
from .grids import Array, Grid, Quadrilaterals, Structured, Vertices
from .main import main
from .model import Derivatives, Failure, Model
from .ports import Inputs, Outputs
from .recording import Recording, Sample, Samples
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
    "Array",
    "Case",
    "Configuration",
    "CosimError",
    "Derivatives",
    "Drive",
    "Effect",
    "Failure",
    "FieldKind",
    "Figure",
    "Grid",
    "Input",
    "Inputs",
    "Key",
    "Layout",
    "Live",
    "MissingInput",
    "Model",
    "ModelSpec",
    "NoAnswer",
    "NonFiniteInput",
    "Outputs",
    "Quadrilaterals",
    "Recording",
    "Refusal",
    "Refused",
    "Results",
    "Sample",
    "Samples",
    "Section",
    "Simplification",
    "Solver",
    "StateError",
    "Step",
    "StepError",
    "StepReport",
    "Structured",
    "Study",
    "Vertices",
    "Volume",
    "Window",
    "cost",
    "drive",
    "fields",
    "first_non_finite",
    "live",
    "main",
    "plan",
    "run",
    "sweep",
]
