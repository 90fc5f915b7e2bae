"""The notebooks of the how-to pages on `cosim.Model`, with small samples and the executables named
by COSIM_COORDINATOR; called by the system tests, which have built them."""

import json
import re
from pathlib import Path

import fit_creep_curve
import matplotlib
import numpy as np
import pytest
import sensitivity
from matplotlib import pyplot
from scipy.stats import chi2

matplotlib.use("Agg")

# Deprecation warnings of other packages do not fail the tests.
pytestmark = [
    pytest.mark.filterwarnings(f"default::{kind}")
    for kind in ("DeprecationWarning", "PendingDeprecationWarning", "FutureWarning")
]

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
COLUMNS = 100


def read(name):
    """Return the cells of a notebook: kind, identifier, and text."""
    notebook = json.loads((EXAMPLES / f"{name}.ipynb").read_text("utf-8"))
    return [(cell["cell_type"], cell["id"], "".join(cell["source"])) for cell in notebook["cells"]]


def execute(cells, samples):
    """Run the code cells with another number of samples; return their common namespace."""
    names = {"__name__": "__main__"}
    code = [(identifier, text) for kind, identifier, text in cells if kind == "code"]
    changed = 0
    for identifier, text in code:
        smaller, count = re.subn(r"(?m)^SAMPLES = \d+", f"SAMPLES = {samples}", text)
        changed += count
        exec(compile(smaller, f"cell {identifier}", "exec"), names)
    assert changed == 1, "one line sets SAMPLES"
    return names


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Return a function that runs a notebook in its folder, without values from earlier runs."""
    monkeypatch.chdir(EXAMPLES)
    monkeypatch.setenv("COSIM_CACHE", str(tmp_path))
    yield lambda name, samples: execute(read(name), samples)
    pyplot.close("all")


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_results(path):
    notebook = json.loads(path.read_text("utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    assert notebook["metadata"]["kernelspec"]["name"] == "python3"
    cells = notebook["cells"]
    assert len({cell["id"] for cell in cells}) == len(cells)
    for cell in cells:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None, cell["id"]


@pytest.mark.parametrize("name", ["fit_creep_curve", "sensitivity", "probability"])
def test_lines_are_short_and_links_lead_to_files(name):
    for kind, identifier, text in read(name):
        long = [line for line in text.splitlines() if len(line) > COLUMNS]
        assert not long, (identifier, long)
        for target in re.findall(r"\]\(([^)#]+)", text) if kind == "markdown" else ():
            assert (EXAMPLES / target).is_file(), (identifier, target)


def test_a_cell_that_fails_fails_the_test():
    cells = [("markdown", "a", "1 / 0"), ("code", "b", "SAMPLES = 64"), ("code", "c", "1 / 0")]
    with pytest.raises(ZeroDivisionError):
        execute(cells, 8)
    assert execute(cells[:2], 8)["SAMPLES"] == 8
    with pytest.raises(AssertionError, match="one line sets SAMPLES"):
        execute(cells[:1], 8)


def test_the_fit_finds_the_true_parameters(run, capsys):
    names = run("fit_creep_curve", 2)
    assert len(names["fits"]) == 2
    bound = chi2.ppf(fit_creep_curve.LEVEL, 2)
    assert all(one.distance(fit_creep_curve.TRUE) < bound for one in names["fits"])
    assert names["slopes"].shape == (8, 2)
    # A softer layer takes force, except at the largest creepages, where the whole contact slips.
    friction, flexibility = names["slopes"].T
    assert np.all(friction > 0.0) and np.all(flexibility[:6] < 0.0)
    assert np.all(np.abs(flexibility[6:]) < 1e-3 * np.abs(flexibility).max())
    assert len(names["figure"].axes) == 2
    assert "true parameters in 2 of 2 joint 99.9 % regions" in capsys.readouterr().out


def test_the_indices_are_shares_of_the_variance(run, capsys):
    names = run("sensitivity", 16)
    found, inputs = names["found"], list(sensitivity.RANGES)
    assert len(names["rises"]) == 16 * (len(inputs) + 2)
    assert np.all(found["ST"] > 0.0) and np.all(found["ST"] < 1.0)
    # The linear estimate has no sampling error: both name the same two inputs.
    largest = {inputs[n] for n in np.argsort(-names["linear"])[:2]}
    assert largest == {"creepage [%]", "friction coefficient"}
    assert np.all(np.abs(found["ST"] - names["linear"]) < 1.5 * found["ST_conf"] + 0.05)
    assert len(names["figure"].axes) == 2
    assert "sum of the first order: " in capsys.readouterr().out


def test_the_probability_is_that_of_the_page(run, capsys):
    names = run("probability", 100)
    form, found = names["form"], names["found"]
    # The page gives 1.12e-3 ± 0.13e-3 from 1000 points.
    assert abs(found.value - 1.12e-3) < 3.3 * np.hypot(found.error, 0.065e-3)
    low, high = found.interval()
    assert 0.0 < low < form.probability < high
    assert form.beta == pytest.approx(3.03, abs=0.02)
    assert form.shares.sum() == pytest.approx(1.0) and form.shares.argmax() == 0
    assert found.failed.any() and not found.failed.all()
    assert len(names["figure"].axes) == 2
    assert "plain Monte Carlo needs" in capsys.readouterr().out
