"""A case as a function of numbers: points in, figures out, for optimisers and samplers.

    model = cosim.Model(
        "cases/wheel-rail.toml",
        inputs={"friction": "friction.coefficient", "load": "load.normal_force [kN]"},
        outputs=["temperature.rail.max_rise_k"],
    )
    model([0.6, 134.0])                 # (2,) to (1,)
    model([[0.6, 134.0], [0.5, 90.0]])  # (2, 2) to (2, 1)
    model.jacobian([0.6, 134.0])        # (1, 2)

The points of a call are one `coordinator sweep`: several at a time, by participants that stay from
point to point. Values are kept in memory and on disk.
"""

from __future__ import annotations

import contextlib
import csv
import difflib
import functools
import hashlib
import json
import os
import re
import shutil
import stat
import tomllib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from .cache import Cache
from .command import CosimError, call, case_file, executable, settings
from .front import Source, plan
from .results import keys, named
from .series import Array

FORMAT = 1
"""Version of the content of a cache."""
BATCH = 1000
"""Most points of one sweep; their values are on disk before the next sweep begins."""
LONGEST = 1 << 20
"""Size up to which a file of a case is searched for names of further files [byte]."""
SPACING = 0.005
"""Relative distance of the points that show the scatter of the outputs."""
ORDER = 5
"""Order of the differences of these points, which removes the smooth part of an output."""
LEAST_ERROR, UNKNOWN_ERROR, LARGEST_ERROR = 1e-9, 1e-6, 1e-3
"""Relative errors for the steps of differences: limits, and the value where none is measured."""
DISTANCES = np.array([-1.0, -0.5, 0.5, 1.0])
"""Places of the neighbours that give a derivative, in steps."""
SCATTER = 1.9
"""Scatter of an extrapolated difference, in units of ε |y| / h: √((4/3)² 2 + (1/3)²/2)."""
SAFETY = 4.0
"""Factor of safety of errors: edges jump over longer distances than nine close points show."""
DOUBTFUL = 0.2
"""Error of a derivative, times its input and over its output, from which a warning tells."""
SPEC = re.compile(r"\s*([^\s\[\]]+)\s*(?:\[([^\[\]]+)\])?\s*")
"""A key, and in brackets the unit of its numbers."""


class Failure(NamedTuple):
    """A point without a value: its numbers by name, and the reason."""

    point: dict[str, float]
    reason: str


class Derivatives(NamedTuple):
    """Derivatives of outputs by inputs, and their estimated errors."""

    values: Array
    errors: Array


class Model:
    """A case as a function from points to figures.

    Arguments:

    - `case` and `tables`: as for `cosim.run`.
    - `inputs`: a name for each key that varies, with a unit in brackets if its numbers are not in
      the SI unit: `{"load": "load.normal_force [kN]"}`. In a list each key is its own name.
    - `outputs`: keys of figures, in SI units.
    - `conditions`: values of further keys at which every point is evaluated, such as the creepages
      of a measured curve: `{"motion.creepage.xi": [-1e-3, -2e-3]}`. All have the same length m.
    - `jobs`: points computed at a time; by default all cores that this process may use.
    - `cache`: folder for values, or False for memory only. The default is `COSIM_CACHE`, or `cosim`
      in the user's folder for caches.
    - `error`: relative error of the outputs, for the steps of differences; see `derivatives`.

    With d inputs and k values, a call takes shape (d,) or (n, d) and returns (k,) or (n, k). There
    are k = m values for each output, first those of the first output. How other packages call it:

    - SciPy: `least_squares(lambda p: model(p) - data, start, jac=model.jacobian)`, and with one
      value `minimize(model, start, jac=model.gradient)`
    - SALib: `model(sample)[:, 0]`, with `model.inputs` as `names`
    - emcee: `EnsembleSampler(walkers, d, log_probability, vectorize=True)`, whose function gets
      (walkers, d)
    - OpenTURNS: `PythonFunction(d, k, func=model, func_sample=model)`
    - BoTorch: `torch.from_numpy(model(x.numpy()))` for points x of (n, d)

    A point without a result has NaN, and an entry with the reason in `failures`; it is computed
    again when it is needed again. Raises `ValueError` for an unknown key or output and for another
    shape, and `CosimError` for a case that is wrong at any point, or a program that cannot start.

    A value belongs to the content of the case, its files and its programs. A change of a module
    that a Python solver loads is noticed at the next run. Of a program that states no build, only
    the files that its command names are compared.

    Attributes: `inputs` (names), `outputs` (keys), `failures`, and `runs`, the number of runs.
    Values from the cache take no run. A model can be pickled.
    """

    def __init__(
        self,
        case: Source,
        inputs: Mapping[str, str] | Sequence[str],
        outputs: Sequence[str],
        *,
        conditions: Mapping[str, Sequence[float] | Array] | None = None,
        jobs: int | None = None,
        cache: Source | bool = True,
        error: float | None = None,
        progress: bool | None = None,
        **tables: Any,
    ) -> None:
        if isinstance(inputs, str) or isinstance(outputs, str):
            raise TypeError(
                "inputs and outputs are collections of keys; a solver describes its own models "
                "with cosim.ModelSpec"
            )
        given = dict(inputs if isinstance(inputs, Mapping) else zip(inputs, inputs))
        fixed = {key: np.asarray(values, float) for key, values in (conditions or {}).items()}
        if not given or not outputs:
            raise ValueError("a model needs at least one input and one output")
        if len({one.shape for one in fixed.values()}) > 1 or any(
            one.ndim != 1 for one in fixed.values()
        ):
            raise ValueError("the values of all conditions are lists of the same length")
        self.inputs, self.outputs, self.runs = tuple(given), tuple(outputs), 0
        self.failures: list[Failure] = []
        self.error = error
        self._names = (*given, *fixed)
        self._conditions = np.stack([*fixed.values()], axis=1) if fixed else np.empty((1, 0))
        self._jobs, self._progress = jobs, progress
        self._settings = list(settings(tables))
        self._values: dict[bytes, Array] = {}
        self._caches: dict[str, Cache] = {}
        self._folder = cache_folder(cache)
        # A case given by its text or a scene has no file that could change.
        with case_file(case) as path:
            self._source: Path | str = (
                path.resolve() if path == Path(case) else path.read_text("utf-8")
            )
            merged = merge(tomllib.loads(path.read_text("utf-8")), tables)
            self._columns = [column(spec, merged) for spec in [*given.values(), *fixed]]
            planned = plan(path, **tables)
        self._commands = commands(merged)
        self._programs = [str(one.program) for one in planned.participants]
        self._builds = {str(one.role): str(one.checksum) for one in planned.participants}
        figures = [str(one.key) for one in planned.figures]
        for key in outputs:
            if not any(named(figure, key) is not None for figure in figures):
                raise ValueError(f"this case has no figure `{key}`{nearest(key, figures)}")

    def __call__(self, x: ArrayLike) -> Array:
        """Return the outputs at a point (d,) or at points (n, d): shape (k,) or (n, k)."""
        points = self._points(x)
        count = len(self._conditions)
        repeated = np.repeat(points, count, axis=0)
        rows = np.hstack([repeated, np.tile(self._conditions, (len(points), 1))])
        values = self._evaluate(rows).reshape(len(points), count, len(self.outputs))
        flat = values.swapaxes(1, 2).reshape(len(points), count * len(self.outputs))
        return flat[0] if np.ndim(x) == 1 else flat

    def derivatives(self, x: ArrayLike, step: ArrayLike | None = None) -> Derivatives:
        """Return the derivatives of the outputs by the inputs with their errors: each of shape
        (k, d), or (n, k, d).

        The derivatives are central differences D at two distances, extrapolated:

            D = (4 D(h/2) - D(h)) / 3

        `step` is the distance h of the outer neighbours from x, in units of the inputs: a number,
        or one for each input. Its default is

            h = |x| (3 ε)^(1/3)

        with the relative error ε of the outputs. This h minimises the sum of the scatter ε/h and
        the remainder h²/6 of a plain difference of an output that varies on the scale of x. ε is
        `error`, or the scatter at the first x: the root mean square, over the outputs, of the fifth
        differences of nine points 0.5 % apart, for h between 1e-9 and 1e-3. This scatter contains
        tolerances of iterations and the jumps of edges between elements. It is kept in `error`, so
        later derivatives have equal steps.

        The error is four times the sum of the change by the extrapolation, |D - D(h/2)|, which an
        output on a shorter scale than x makes large, and twice the scatter of D, 2 · 1.9 ε |y|/h.
        The factor covers jumps of edges over longer distances than the nine points show.

        A neighbour without a value is replaced by x itself, and D is D(h) alone. If both have none,
        the derivative is NaN. Raises `ValueError` for an input that is 0, which needs `step`.
        """
        found, errors, _ = self._differences(self._points(x), step)
        return Derivatives(found[0], errors[0]) if np.ndim(x) == 1 else Derivatives(found, errors)

    def jacobian(self, x: ArrayLike, step: ArrayLike | None = None) -> Array:
        """Return the derivatives of the outputs by the inputs: shape (k, d), or (n, k, d).

        These are the values of `derivatives`. A warning tells if the error of one, times its input,
        exceeds a fifth of the output.
        """
        points = self._points(x)
        found, errors, centre = self._differences(points, step)
        doubtful = errors * np.abs(points)[:, None] > DOUBTFUL * np.abs(centre).swapaxes(1, 2)
        if doubtful.any():
            _, output, number = np.argwhere(doubtful)[0]
            key = self.outputs[output // len(self._conditions)]
            warnings.warn(
                f"the derivative of {key} by {self.inputs[number]} is uncertain by more than a "
                f"fifth of {key}; use a finer resolution, or see the errors of `derivatives`",
                RuntimeWarning,
                2,
            )
        return found[0] if np.ndim(x) == 1 else found

    def _differences(self, points: Array, step: ArrayLike | None) -> tuple[Array, Array, Array]:
        """Return derivatives and errors (n, k, d), and outputs near the points (n, 1 or d, k)."""
        (count, width), k = points.shape, len(self.outputs) * len(self._conditions)
        steps = self._steps(points, step)
        shifts = np.multiply.outer(DISTANCES, steps[:, :, None] * np.eye(width))
        values = self((points[:, None] + shifts).reshape(-1, width))
        values = values.reshape(len(DISTANCES), count, width, k)
        centre = self(points)[:, None] if np.isnan(values).any() else np.mean(values, axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            outer, inner = (
                slopes(values[pair], centre, DISTANCES[pair], steps) for pair in ([0, 3], [1, 2])
            )
            whole = np.isfinite(values).all(axis=0)
            found = np.where(whole, (4.0 * inner - outer) / 3.0, outer)
            scatter = SCATTER * (self.error or 0.0) * np.abs(centre) / steps[..., None]
            errors = SAFETY * (np.abs(found - inner) + 2.0 * scatter)
        return found.swapaxes(1, 2), errors.swapaxes(1, 2), centre

    def gradient(self, x: ArrayLike, step: ArrayLike | None = None) -> Array:
        """Return the derivatives of the only value of a model: shape (d,), or (n, d).

        The steps are those of `jacobian`. Raises `ValueError` if the model has several values.
        """
        if len(self.outputs) * len(self._conditions) != 1:
            raise ValueError("the gradient is that of one value; a model of several has a jacobian")
        row: Array = self.jacobian(x, step)[..., 0, :]
        return row

    def close(self) -> None:
        """Forget the values in memory. Between calls a model holds no processes or open files."""
        self._values.clear()
        self._caches.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        source = self._source if isinstance(self._source, Path) else "a case"
        return f"<model of {source}: {', '.join(self.inputs)} to {', '.join(self.outputs)}>"

    def _points(self, x: ArrayLike) -> Array:
        points = np.atleast_2d(np.asarray(x, float))
        width = len(self.inputs)
        if np.ndim(x) not in (1, 2) or points.shape[1] != width:
            raise ValueError(f"points have the shape ({width},) or (n, {width}), not {np.shape(x)}")
        return points

    def _steps(self, points: Array, step: ArrayLike | None) -> Array:
        if step is not None:
            steps = np.broadcast_to(np.asarray(step, float), points.shape)
        else:
            if self.error is None and len(points):
                self.error = self._scatter(points[0])
            error = min(self.error or UNKNOWN_ERROR, LARGEST_ERROR)
            steps = np.abs(points) * (3.0 * error) ** (1.0 / 3.0)
        if not (steps > 0.0).all():
            name = self.inputs[int(np.argmin(steps.min(axis=0)))]
            raise ValueError(f"the step of `{name}` is not positive; pass step=, as at 0")
        return steps

    def _scatter(self, point: Array) -> float:
        """Measure the relative error of the outputs: what is not smooth along a line."""
        places = SPACING * np.arange(-4, 5)
        # Inputs move by different amounts, so that no ratio of them stays constant.
        rates = np.linspace(1.0, 0.5, len(point)) * (-1.0) ** np.arange(len(point))
        values = self(point * (1.0 + np.outer(places, rates)))
        if not np.isfinite(values).all():
            return UNKNOWN_ERROR
        # Independent errors of variance s² have n-th differences of variance s² (2n)!/(n!)².
        growth = np.prod(np.arange(ORDER + 1, 2 * ORDER + 1) / np.arange(1, ORDER + 1))
        scatter = np.mean(np.diff(values, ORDER, axis=0) ** 2, axis=0) / growth
        size = np.max(np.abs(values), axis=0)
        relative = scatter[size > 0.0] / size[size > 0.0] ** 2
        found = float(np.sqrt(np.mean(relative))) if len(relative) else UNKNOWN_ERROR
        return max(found, LEAST_ERROR)

    def _evaluate(self, rows: Array) -> Array:
        """Return the outputs of rows of inputs and conditions, each computed at most once."""
        rows = rows + 0.0  # -0 and 0 are one value
        content = self._content()
        cache = self._cache(content)
        unknown = np.full(len(self.outputs), np.nan)
        wanted = {row.tobytes(): row for row in rows}
        missing = [row for name, row in wanted.items() if name not in self._values]
        for begin in range(0, len(missing), BATCH):
            batch = missing[begin : begin + BATCH]
            finite = [row for row in batch if np.isfinite(row).all()]
            found = {
                row.tobytes(): outcome
                for row, outcome in zip(finite, self._run(finite), strict=True)
            }
            if self._content() != content:
                changed = "the case, one of its files or a program changed during the evaluation"
                raise CosimError(f"{changed}; call again", 2)
            good = []
            for row in batch:
                values, reason = found.get(row.tobytes(), (unknown, "the point is not finite"))
                if reason is None:
                    self._values[row.tobytes()] = values
                    good.append((row, values))
                else:
                    point = dict(zip(self._names, row.tolist()))
                    self.failures.append(Failure(point, reason))
            if cache and self._folder:
                self._keep(cache, good)
        return np.array([self._values.get(row.tobytes(), unknown) for row in rows])

    def _run(self, rows: Sequence[Array]) -> list[tuple[Array, str | None]]:
        """Compute rows; return the outputs of each, and the reason if one is missing.

        A sweep begins with the plan of its first row. If this plan is refused, the other rows are
        computed without it.
        """
        found: list[tuple[Array, str | None]] = []
        while len(found) < len(rows):
            rest = rows[len(found) :]
            try:
                found += self._sweep(rest)
                self.runs += len(rest)
            except CosimError as error:
                reason = str(error)
                if error.exit_code != 2 or "nothing in this case reads it" in reason:
                    raise
                found.append((np.full(len(self.outputs), np.nan), reason))
        return found

    def _sweep(self, rows: Sequence[Array]) -> list[tuple[Array, str | None]]:
        """Compute rows by one sweep; raises `CosimError` if its plan is refused."""
        with TemporaryDirectory(prefix="cosim-") as name:
            folder = Path(name)
            table, out, path = folder / "points.csv", folder / "sweep", self._source
            if not isinstance(path, Path):
                path = folder / "case.toml"
                path.write_text(str(self._source), "utf-8")
            with table.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow(one.heading for one in self._columns)
                for row in rows:
                    cells = zip(self._columns, row.tolist(), strict=True)
                    writer.writerow(one.cell(value) for one, value in cells)
            options: list[Source] = ["--table", table, "--out", out]
            if self._jobs is not None:
                options += ["--jobs", str(self._jobs)]
            try:
                call(["sweep", path, *options, *self._settings], progress=self._progress)
            except CosimError:
                # If every point fails, so does the sweep, with a table of the reasons.
                if not (out / "sweep.csv").exists():
                    raise
            # The descriptions of the programs tell what the files of their commands do not show.
            identity = json.loads((out / "sweep.json").read_text("utf-8"))["identity"]["programs"]
            self._builds |= {
                role: identity[role]["description"] for role in self._builds if role in identity
            }
            with (out / "sweep.csv").open(newline="", encoding="utf-8") as file:
                found = [self._outcome(row) for row in csv.DictReader(file)]
        if len(found) != len(rows):
            raise CosimError(f"the sweep has {len(found)} of {len(rows)} points", 1)
        return found

    def _outcome(self, row: Mapping[str, str]) -> tuple[Array, str | None]:
        values = np.array([float(row.get(key) or "nan") for key in self.outputs])
        if row["failed"]:
            return values, row["failed"]
        missing = [key for key, value in zip(self.outputs, values) if not np.isfinite(value)]
        return values, f"the run has no value of {', '.join(missing)}" if missing else None

    def _cache(self, content: str) -> Cache | None:
        """Return the cache of a content, after reading its news; another content is forgotten."""
        if content not in self._caches:
            self.close()
            self._caches[content] = Cache(self._folder or Path(), content)
        if self._folder is None:
            return None
        sizes = (len(self._names), len(self.outputs))
        for point, values in self._caches[content].news(sizes):
            self._values[point.tobytes()] = values
        return self._caches[content]

    def _keep(self, cache: Cache, rows: Sequence[tuple[Array, Array]]) -> None:
        """Write values to the cache; a folder that cannot be written does not lose them."""
        try:
            cache.add(rows)
        except OSError as error:
            reason = f"{error.strerror or error}: {error.filename or self._folder}"
            warnings.warn(f"values are kept in memory only: {reason}", RuntimeWarning, 4)
            self._folder = None

    def _content(self) -> str:
        """Return a hash of all that determines the values: case, files, programs, keys."""
        own: list[object] = [FORMAT, self._settings, [one.heading for one in self._columns]]
        own += [self.outputs, sorted(self._builds.items())]
        digest = hashlib.sha256(repr(own).encode())
        coordinator = executable().resolve()
        programs = [coordinator.with_name(name) for name in self._programs]
        text, folder = str(self._source), Path.cwd()
        files: list[Path] = []
        if isinstance(self._source, Path):
            files, text, folder = (
                [self._source],
                self._source.read_text("utf-8"),
                self._source.parent,
            )
        digest.update(text.encode())
        words = [
            *strings(tomllib.loads(text)),
            *re.findall(r'[^\s"\'=,\[\]]+', " ".join(self._settings)),
            # A name on the search path is the program that starts now.
            *filter(None, map(shutil.which, self._commands)),
        ]
        files += [coordinator, *filter(Path.is_file, programs), *named_files(words, folder)]
        for path in files:
            digest.update(f"{path.name} {hash_of(path, *status(path))}\n".encode())
        return digest.hexdigest()


class Column(NamedTuple):
    """A column of the points: a key, with unit, and whether its numbers are whole."""

    heading: str
    whole: bool

    def cell(self, value: float) -> str:
        """Return a number as text, exactly."""
        return str(int(value)) if self.whole and value.is_integer() else repr(value)


def column(spec: str, case: Mapping[str, Any]) -> Column:
    """Return the column of a key, with the unit of its numbers; raises `ValueError` with advice."""
    match = SPEC.fullmatch(spec)
    if match is None:
        raise ValueError(f"`{spec}` is no key; write `motion.speed` or `motion.speed [km/h]`")
    key = match[1]
    kinds = {"quantity", "integer"}
    numbers = [one for one in keys() if one["type"] in kinds]
    known = [(filled, one) for one in numbers for filled in fill(str(one["path"]), case)]
    found = next((one for filled, one in known if filled == key), None)
    if found is None:
        raise ValueError(
            f"`{key}` is no number of this case{nearest(key, [filled for filled, _ in known])}"
        )
    return Column(spec.strip(), found["type"] == "integer")


def fill(pattern: str, case: Mapping[str, Any]) -> Iterator[str]:
    """Yield the keys of a pattern, with the names of the case's tables in place of `*`."""
    before, star, after = pattern.partition("*")
    if not star:
        yield pattern
        return
    table: Any = case
    for name in filter(None, before.split(".")):
        table = table.get(name, {}) if isinstance(table, Mapping) else {}
    for name in table if isinstance(table, Mapping) else ():
        yield from fill(f"{before}{name}{after}", case)


def nearest(key: str, known: Sequence[str]) -> str:
    """Return advice with the most similar known keys."""
    close = difflib.get_close_matches(key, list(dict.fromkeys(known)), 3, 0.5)
    return f"; did you mean {' or '.join(f'`{one}`' for one in close)}?" if close else ""


def commands(case: Mapping[str, Any]) -> list[str]:
    """Return the words of all commands of a case."""
    tables = (one for one in case.values() if isinstance(one, Mapping))
    return [word for table in tables for word in strings(table.get("command", []))]


def merge(case: Mapping[str, Any], tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return a case with the values of tables; None removes a key."""
    merged = dict(case)
    for name, value in tables.items():
        if value is None:
            merged.pop(name, None)
        elif isinstance(value, Mapping):
            below = merged.get(name)
            merged[name] = merge(below if isinstance(below, Mapping) else {}, value)
        else:
            merged[name] = value
    return merged


def cache_folder(cache: Source | bool) -> Path | None:
    """Return the folder for values, or None without one."""
    if cache is False:
        return None
    if cache is not True:
        return Path(cache).resolve()
    users = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get("COSIM_CACHE") or Path(users) / "cosim").resolve()


def slopes(values: Array, centre: Array, places: Array, steps: Array) -> Array:
    """Return the slopes between pairs of neighbours; the centre stands in for one without a
    value."""
    missing = np.isnan(values)
    values = np.where(missing, centre, values)
    places = np.where(missing, 0.0, places[:, None, None, None] * steps[..., None])
    found: Array = (values[1] - values[0]) / (places[1] - places[0])
    return found


def strings(value: Any) -> Iterator[str]:
    """Yield all texts of nested tables and lists."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list):
        for one in value.values() if isinstance(value, Mapping) else value:
            yield from strings(one)


def named_files(words: Sequence[str], folder: Path, seen: set[Path] | None = None) -> list[Path]:
    """Return the files named by words, beside a file or in the working directory, and files that
    these name in turn."""
    seen = set() if seen is None else seen
    for word in words:
        for path in {folder / word, Path.cwd() / word}:
            with contextlib.suppress(OSError, ValueError):
                if path.is_file() and path.resolve() not in seen:
                    seen.add(path.resolve())
                    named_files(words_of(path, *status(path)), path.parent, seen)
    return sorted(seen)


def status(path: Path) -> tuple[int, ...]:
    """Return numbers that change with the content of a file; raises `OSError` for another thing."""
    found = path.stat()
    if not stat.S_ISREG(found.st_mode):
        raise OSError(f"{path} is not a regular file")
    return found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


@functools.lru_cache(1024)
def hash_of(path: Path, *_: int) -> str:
    """Return the hash of a file; the further arguments are its status."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@functools.lru_cache(1024)
def words_of(path: Path, *_: int) -> tuple[str, ...]:
    """Return words of a file of text that may name files; the further arguments are its status."""
    data = path.read_bytes() if path.stat().st_size <= LONGEST else b"\0"
    text = "" if b"\0" in data else data.decode("utf-8", "replace")
    return tuple(dict.fromkeys(re.findall(r"[\w./+-]+\.[A-Za-z]\w*", text)))
