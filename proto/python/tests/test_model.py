"""Parts of a model that need no coordinator: derivatives with their errors, and builds."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cosim

SOURCES = Path(cosim.__file__).resolve().parents[1]


class Formula(cosim.Model):
    """A model whose outputs are a function of rows, without runs."""

    def __init__(self, function, width, outputs=1):
        self.inputs = tuple(f"x{n}" for n in range(width))
        self.outputs = tuple(f"y{n}" for n in range(outputs))
        self.error, self._conditions, self._function = None, np.empty((1, 0)), function

    def _evaluate(self, rows):
        found = [self._function(row) for row in rows]
        return np.array(found, float).reshape(len(rows), len(self.outputs))


def saturating(noise):
    """Return an output on a tenth of the scale of its input, with jumps as of a grid's edges."""

    def function(row):
        jump = noise * np.sin(1e4 * row[0] + 3e3 * row[1])
        return [row[1] * np.tanh(10.0 * (row[0] - 0.9)) * (1.0 + jump) + 2.0]

    return function


@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-4, 1e-3])
def test_the_error_of_a_derivative_is_within_the_stated(noise):
    model = Formula(saturating(noise), 2)
    for place in (0.85, 0.95, 1.0, 1.1):
        found, errors = model.derivatives([place, 1.0])
        inside = 10.0 * (place - 0.9)
        truth = [10.0 / np.cosh(inside) ** 2, np.tanh(inside)]
        assert np.all(np.abs(found[0] - truth) <= errors[0] + 1e-9), (place, found, errors)


def test_a_doubtful_derivative_is_told():
    model = Formula(saturating(1e-2), 2)
    with pytest.warns(RuntimeWarning, match="derivative of y0 by x0 is uncertain"):
        found = model.jacobian([0.85, 1.0])
    assert np.array_equal(found, model.derivatives([0.85, 1.0]).values)
    smooth = Formula(lambda row: [row[0] ** 2 * row[1], row[0]], 2, 2)
    np.testing.assert_allclose(smooth.jacobian([2.0, 3.0]), [[12.0, 4.0], [1.0, 0.0]], atol=1e-6)


def test_no_points_have_no_values():
    model = Formula(lambda row: [row[0], row[1]], 2, 2)
    assert model(np.empty((0, 2))).shape == (0, 2)
    assert model.jacobian(np.empty((0, 2))).shape == (0, 2, 2)
    with pytest.raises(ValueError, match=r"\(2,\) or \(n, 2\), not \(0,\)"):
        model([])


def built(folder, *more):
    """Return the build of a process that imports a module beside its script."""
    script = "import sys; sys.path[:0] = sys.argv[1:]; import inner; from cosim.build import build"
    command = [sys.executable, "-c", f"{script}; print(build())", str(folder), str(SOURCES), *more]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_a_build_changes_with_the_modules_that_are_imported(tmp_path):
    module = tmp_path / "inner.py"
    module.write_text("RISE = 1.0\n")
    first = built(tmp_path)
    assert built(tmp_path) == first
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "inner.py").write_text("RISE = 1.0\n")
    assert built(elsewhere) == first, "the same files elsewhere are the same build"
    module.write_text("RISE = 2.0\n")
    assert built(tmp_path) != first
