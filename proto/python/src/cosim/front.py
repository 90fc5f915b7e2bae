"""Run, plan and vary cases from Python, by the executables of the project.

    import cosim

    results = cosim.run("case.toml", mech={"resolution": 40})
    results.temperature.rail.max_rise_k
    results.fields["pressure"].values

A case is the path of a file, its text, or the name of a scene (`coordinator new --list`). Keyword
arguments are tables of the case, whose values replace those of the case:
`load={"normal_force": "100 kN"}`, `effects={"partial_slip": {}}`; None removes a key.
"""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import pictures
from .command import call, case_file, remove_with, results_folder, settings, toml
from .progress import needs
from .results import Results, Section, label, table
from .series import Array

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

Source = str | os.PathLike[str]


def run(
    case: Source,
    *,
    out: Source | None = None,
    replace: bool = False,
    record: bool = False,
    accuracy: float | str | None = None,
    extrapolate: bool = False,
    strict: bool = False,
    progress: bool | None = None,
    **tables: Any,
) -> Results:
    """Run a case; return its results.

    `out` is a folder for the results; without it they last as long as the returned object. `record`
    keeps all messages. `accuracy`, `extrapolate`, `strict` are those of `coordinator run`.
    `progress` shows windows and long work during the run, by default in a terminal or a notebook.
    """
    options = ["--record"] * record + ["--extrapolate"] * extrapolate + ["--strict"] * strict
    options += ["--replace"] * replace
    options += [] if accuracy is None else ["--accuracy", str(accuracy)]
    with results_folder(out) as folder, case_file(case) as path:
        call(
            ["run", path, "--out", folder, "--json", *options, *settings(tables)],
            folder=folder,
            progress=progress,
        )
    results = Results(folder)
    if out is None:
        remove_with(results, folder)
    return results


def plan(case: Source, **tables: Any) -> Section:
    """Return the plan of a case as in plan.json: what will run, what will not, the reasons, and
    estimates."""
    with case_file(case) as path:
        answer = call(["plan", path, "--json", *settings(tables)], progress=False)
    return Section(json.loads(answer), "the plan")


class Study:
    """Results of a study.

    `rows` are columns of numbers by name, `document` is the JSON file, `report` the report page.
    """

    def __init__(self, folder: Path, name: str) -> None:
        self.folder, self.name = folder, name

    @property
    def report(self) -> Path:
        """Path of the page with plots."""
        return self.folder / "report.html"

    @functools.cached_property
    def document(self) -> dict[str, Any]:
        """Content of the JSON file of the study."""
        document: dict[str, Any] = json.loads(
            (self.folder / f"{self.name}.json").read_text(encoding="utf-8")
        )
        return document

    @functools.cached_property
    def rows(self) -> dict[str, Array]:
        """Columns of numbers, one row per point."""
        return table(self.folder / f"{self.name}.csv")

    def __getitem__(self, column: str) -> Array:
        return self.rows[column]

    def frame(self) -> pandas.DataFrame:
        """Return the rows as a data frame; needs pandas."""
        with needs("frames"):
            import pandas  # noqa: PLC0415

        return pandas.read_csv(self.folder / f"{self.name}.csv")

    def plot(self, x: str, y: str, axes: Axes | None = None) -> Axes:
        """Plot one column over another; needs matplotlib."""
        return pictures.curve(self, x, y, (label(x), label(y)), axes)

    def __repr__(self) -> str:
        return f"<{self.name} of {self.document.get('case')}: {self.folder}>"


def sweep(
    case: Source,
    vary: Mapping[str, Sequence[Any] | str],
    *,
    paired: bool = False,
    jobs: int | None = None,
    fit: bool = False,
    out: Source | None = None,
    replace: bool = False,
    progress: bool | None = None,
    **tables: Any,
) -> Study:
    """Run a case over values of its keys: lists of values, or `"FROM..TO/COUNT"`.

    `fit` also creates a surrogate.
    """
    options = ["--paired"] * paired + ["--fit"] * fit
    options += [] if jobs is None else ["--jobs", str(jobs)]
    for key, values in vary.items():
        given = values if isinstance(values, str) else ",".join(map(toml, values))
        options += ["--vary", f"{key}={given}"]
    return study("sweep", case, options, out, replace, progress, tables)


def cost(
    case: Source,
    vary: Mapping[str, Sequence[Any]] | None = None,
    *,
    longest_run: float | None = None,
    repeat: int | None = None,
    out: Source | None = None,
    replace: bool = False,
    progress: bool | None = None,
    **tables: Any,
) -> Study:
    """Study accuracy against run time, over models, resolutions, windows and tolerances.

    `vary` gives values of keys, coarsest first, instead of the study's own plan. Runs expected to
    take longer than `longest_run` [s] are omitted, and each run is repeated `repeat` times.
    """
    options = [] if longest_run is None else ["--longest-run", str(longest_run)]
    options += [] if repeat is None else ["--repeat", str(repeat)]
    for key, values in (vary or {}).items():
        options += ["--vary", f"{key}={','.join(map(toml, values))}"]
    return study("cost", case, options, out, replace, progress, tables)


def study(
    name: str,
    case: Source,
    options: Sequence[str],
    out: Source | None,
    replace: bool,
    progress: bool | None,
    tables: Mapping[str, Any],
) -> Study:
    """Run a study of the coordinator, by the name of its command."""
    with results_folder(out) as folder, case_file(case) as path:
        arguments: list[Source] = [
            name,
            path,
            "--out",
            folder,
            *options,
            *["--replace"] * replace,
            *settings(tables),
        ]
        call(arguments, folder=folder, progress=progress)
    written = Study(folder, name)
    if out is None:
        remove_with(written, folder)
    return written
