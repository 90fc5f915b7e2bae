"""Cases as functions of arrays, with the executables named by COSIM_COORDINATOR; called by the
system tests, which have built them."""

import functools
import multiprocessing
import pickle
import shutil
from pathlib import Path

import fit_creep_curve
import numpy as np
import probability
import pytest
import sensitivity
from scipy.integrate import quad
from scipy.optimize import minimize
from scipy.stats import chi2, lognorm, norm

import cosim
from cosim.command import executable

# Deprecation warnings of other packages do not fail the tests.
pytestmark = [
    pytest.mark.filterwarnings(f"default::{kind}")
    for kind in ("DeprecationWarning", "PendingDeprecationWarning", "FutureWarning")
]

CASES = Path(__file__).resolve().parents[3] / "cases"
RAIL, WHEEL = "temperature.rail.max_rise_k", "temperature.wheel.max_rise_k"
LOAD = {"friction": "friction.coefficient", "load": "load.normal_force [kN]"}
COARSE = {"mech": {"resolution": 8}}
FULL_SLIP = {
    "friction": ("friction.coefficient", 0.4, 0.8),
    "speed": ("motion.speed", 20.0, 60.0),
    "conductivity": ("materials.steel.conductivity", 25.0, 60.0),
}
EXPONENTS = np.array([1.0, 0.5, -0.5])
"""Full slip: the rise is proportional to f √V/√λ."""


def rolling(tmp_path, outputs=(RAIL, WHEEL), inputs=LOAD, **more):
    options = {"cache": tmp_path / "cache", **COARSE, **more}
    return cosim.Model(CASES / "wheel-rail.toml", inputs, outputs, **options)


def sliding(tmp_path, ranges=FULL_SLIP, **more):
    inputs = {name: key for name, (key, *_) in ranges.items()}
    return cosim.Model(CASES / "full-slip.toml", inputs, [RAIL], cache=tmp_path / "cache", **more)


def test_a_point_has_the_figures_of_its_run_to_the_bit(tmp_path):
    model = rolling(tmp_path)
    found = model([[0.6, 134.0], [0.65, 90.0], [0.6, 134.0]])
    assert found.shape == (3, 2) and model([0.65, 90.0]).shape == (2,)
    assert model.runs == 2 and model.failures == []
    for (friction, load), values in zip([(0.6, 134e3), (0.65, 90e3)], found):
        single = cosim.run(
            CASES / "wheel-rail.toml",
            load={"normal_force": load},
            friction={"coefficient": friction},
            **COARSE,
        )
        expected = [single.temperature.rail.max_rise_k, single.temperature.wheel.max_rise_k]
        assert values.tolist() == expected


def test_a_case_may_be_a_scene_or_a_text_and_keys_a_list(tmp_path):
    keys = ["friction.coefficient", "mech.resolution"]
    expected = rolling(tmp_path, inputs=keys)([0.6, 6.0])
    text = (CASES / "wheel-rail.toml").read_text()
    for case in ("wheel-rail", text):
        model = cosim.Model(case, keys, [RAIL, WHEEL], cache=False)
        assert model.inputs == tuple(keys) and model([0.6, 6.0]).tolist() == expected.tolist()


def test_conditions_are_values_of_every_point(tmp_path):
    speeds = [20.0, 40.0]
    model = rolling(tmp_path, conditions={"motion.speed": speeds})
    found = model([[0.6, 134.0], [0.65, 134.0]])
    single = rolling(tmp_path, inputs={**LOAD, "speed": "motion.speed"})
    for friction, values in zip([0.6, 0.65], found):
        expected = single([[friction, 134.0, speed] for speed in speeds])
        assert values.tolist() == expected.T.ravel().tolist()
    assert model.jacobian([0.65, 134.0], step=[0.01, 1.0]).shape == (4, 2)


def test_mistakes_are_errors_at_construction(tmp_path):
    def refused(words, inputs=LOAD, outputs=(RAIL,), **more):
        with pytest.raises(ValueError, match=words):
            rolling(tmp_path, inputs=inputs, outputs=outputs, **more)

    refused(
        r"`friction\.coeficient`.*mean `friction\.coefficient` or `effects", ["friction.coeficient"]
    )
    refused(r"`bodies\.rial\.radius_y`.*`bodies\.rail\.radius_y`", ["bodies.rial.radius_y"])
    refused("no number of this case", ["thermal.model"])
    refused("is no key; write", ["motion speed"])
    refused(
        r"no figure `temperature\.rail\.rise_k`.*max_rise_k", outputs=["temperature.rail.rise_k"]
    )
    refused("at least one", inputs=[])
    refused("same length", conditions={"motion.speed": [1.0], "load.normal_force": [1.0, 2.0]})
    with pytest.raises(TypeError, match=r"cosim\.ModelSpec"):
        cosim.Model("short", "a summary", "a source")
    with pytest.raises(cosim.CosimError, match=r"mech\.resolutoin"):
        rolling(tmp_path, mech={"resolutoin": 8})
    with pytest.raises(ValueError, match=r"shape \(2,\) or \(n, 2\), not \(3,\)"):
        rolling(tmp_path)([1.0, 2.0, 3.0])
    with pytest.raises(cosim.CosimError, match="nothing in this case reads it"):
        rolling(tmp_path, ["contact.creepage_xi"], ["mech.slope_factor"])([[1.0], [2.0]])


def test_points_without_a_result_are_nan_with_reasons(tmp_path):
    model = rolling(tmp_path)
    # The plan of a sweep is that of its first point, so a bad one in front is a case of its own.
    found = model([[-1.0, 134.0], [0.6, 134.0], [0.5, 134.0], [np.nan, 134.0], [0.6, 0.0]])
    assert np.isfinite(found[1]).all() and np.isnan(found[[0, 2, 3, 4]]).all()
    reasons = {tuple(one.point.values()): one.reason for one in model.failures}
    assert set(model.failures[0].point) == {"friction", "load"} and len(reasons) == 4
    assert "not above 0" in reasons[-1.0, 134.0]
    assert "traction_coefficient" in reasons[0.5, 134.0]
    assert "normal_force" in reasons[0.6, 0.0]
    assert sum(one.reason == "the point is not finite" for one in model.failures) == 1
    # A failed point is not in the cache.
    again = rolling(tmp_path)
    assert np.isnan(again([0.5, 134.0])).all() and len(again.failures) == 1
    absent = rolling(tmp_path, outputs=["contact.layer_power_w"])
    assert np.isnan(absent([0.6, 134.0])).all()
    assert absent.failures[0].reason == "the run has no value of contact.layer_power_w"


def copied(tmp_path):
    return Path(shutil.copy(CASES / "wheel-rail.toml", tmp_path))


def test_values_are_kept_by_content(tmp_path, monkeypatch):
    case, point = copied(tmp_path), [0.6, 134.0]

    def runs(**more):
        model = cosim.Model(case, LOAD, [RAIL], cache=tmp_path / "cache", **{**COARSE, **more})
        value = model(point)
        return model.runs, value.tolist()

    first, value = runs()
    assert (first, runs()) == (1, (0, value))
    # Another setting, another content, another program, another version: each computed again.
    assert runs(mech={"resolution": 9})[0] == 1
    text = case.read_text()
    case.write_text(text.replace("conductivity = 50", "conductivity = 40"))
    changed, other = runs()
    assert changed == 1 and other[0] > value[0]
    case.write_text(text)
    assert runs() == (0, value)
    monkeypatch.setattr("cosim.model.FORMAT", 0)
    assert runs() == (1, value)
    monkeypatch.undo()
    # A damaged file is computed again, and its value is right.
    for file in (tmp_path / "cache").iterdir():
        data = file.read_bytes()
        file.write_bytes(data.replace(b"]]", b"1]]"))
    assert runs() == (1, value) and runs() == (0, value)


def test_files_count_that_a_case_names_and_that_these_name(tmp_path):
    case = Path(shutil.copy(CASES / "rail-transition.toml", tmp_path))
    for name in ("histories", "profiles"):
        shutil.copytree(CASES / name, tmp_path / name)
    slices = tmp_path / "profiles" / "rail-wearing.slices"
    inner = tmp_path / "profiles" / "rail-60e1-worn.csv"
    assert slices.name in case.read_text() and inner.name in slices.read_text()
    model = cosim.Model(case, ["mech.resolution"], ["contact.max_pressure_pa"], cache=False)
    contents = {model._content(), model._content()}
    assert len(contents) == 1
    for path in (case, slices, inner, tmp_path / "histories" / "way.csv"):
        path.write_text(path.read_text() + "\n")
        contents.add(model._content())
    assert len(contents) == 5


def test_a_case_that_changes_during_a_call_is_an_error(tmp_path, monkeypatch):
    case = copied(tmp_path)
    model = cosim.Model(case, LOAD, [RAIL], cache=tmp_path / "cache", **COARSE)
    run = cosim.model.call

    def edited(*arguments, **more):
        answer = run(*arguments, **more)
        case.write_text(case.read_text() + "\n# another comment\n")
        return answer

    monkeypatch.setattr("cosim.model.call", edited)
    with pytest.raises(cosim.CosimError, match="changed during the evaluation"):
        model([0.6, 134.0])
    monkeypatch.undo()
    assert np.isfinite(model([0.6, 134.0])).all() and model.runs == 2


def evaluate(model, points):
    return model(points), model.runs


def test_a_model_is_pickled_and_processes_share_its_cache(tmp_path):
    model = sliding(tmp_path)
    points = np.random.default_rng(1).uniform([0.4, 20.0, 25.0], [0.8, 60.0, 60.0], (12, 3))
    same = pickle.loads(pickle.dumps(model))
    assert same(points[0]).tolist() == model(points[0]).tolist()
    with multiprocessing.get_context("spawn").Pool(3) as pool:
        parts = pool.map(functools.partial(evaluate, model), [points[:8], points[4:], points])
    expected, runs = evaluate(sliding(tmp_path), points)
    assert runs == 0, "all values are on disk"
    for (values, _), part in zip(parts, [expected[:8], expected[4:], expected]):
        assert np.array_equal(values, part)


def test_derivatives_are_those_of_the_closed_form(tmp_path):
    model = sliding(tmp_path)
    point = np.array([0.6, 40.0, 50.0])
    slopes = model.jacobian(point)
    expected = EXPONENTS * model(point)[0] / point
    # The remainder of a power law is below h²/2, and h follows from the error.
    step = (3.0 * model.error) ** (1.0 / 3.0)
    assert 1e-9 <= model.error < 1e-7
    np.testing.assert_allclose(slopes, [expected], rtol=step**2)
    assert np.array_equal(model.gradient(point), slopes[0])
    both = model.jacobian([point, 1.01 * point])
    assert both.shape == (2, 1, 3) and np.array_equal(both[0], slopes)
    # A longer step has the remainder of fourth order.
    errors = [
        abs(model.jacobian(point, step=part * point)[0, 1] / expected[1] - 1.0)
        for part in (0.4, 0.2)
    ]
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)
    with pytest.raises(ValueError, match="step of `friction` is not positive"):
        model.jacobian([0.0, 40.0, 50.0])
    with pytest.raises(ValueError, match="several has a jacobian"):
        rolling(tmp_path).gradient([0.6, 134.0])


def test_the_errors_of_derivatives_cover_a_finer_grid(tmp_path):
    """Creepage and rise at a/20 jump with the edges of elements, so that steps are long."""
    inputs = {"friction": "friction.coefficient", "traction": "motion.traction_coefficient"}
    point = np.array([0.6, 0.4])

    def found(resolution):
        model = rolling(
            tmp_path, ["contact.creepage_xi", RAIL], inputs, mech={"resolution": resolution}
        )
        return (*model.derivatives(point), model(point))

    coarse, errors, values = found(20)
    fine, fine_errors, _ = found(60)
    off = np.abs(coarse - fine)
    assert np.all(off <= errors + fine_errors), (off, errors, fine_errors)
    # The stated errors are of the size of the true ones: a tenth of the output or less.
    assert np.all(errors * point < 0.1 * np.abs(values)[:, None]), errors


def test_a_changed_program_is_noticed(tmp_path, monkeypatch):
    """A program found on the search path, and one whose new build only its description tells."""
    solver = executable().with_name("thermal-solver")
    script = tmp_path / "bin" / "my-thermal"
    script.parent.mkdir()

    def wrap(remark):
        script.write_text(f'#!/bin/sh\n# {remark}\nexec {solver} "$@"\n')
        script.chmod(0o755)

    monkeypatch.setenv("PATH", f"{script.parent}:/usr/bin:/bin")
    wrap("one")
    command = {"thermal": {"command": ["my-thermal"]}}
    first = rolling(tmp_path, **command)
    value = first([0.6, 134.0]).tolist()
    assert first.runs == 1
    again = rolling(tmp_path, **command)
    assert again([0.6, 134.0]).tolist() == value and again.runs == 0
    wrap("another")
    assert again([0.6, 134.0]).tolist() == value and again.runs == 1
    changed = rolling(tmp_path, **command)
    assert changed([0.6, 134.0]).tolist() == value and changed.runs == 0
    # Another build is noticed after the run, whose values are not kept under the old one.
    changed._builds["thermal"] = "of another build"
    with pytest.raises(cosim.CosimError, match="changed during the evaluation"):
        changed([0.61, 134.0])
    assert np.isfinite(changed([0.61, 134.0])).all()


def test_a_cache_that_cannot_be_written_loses_no_value(tmp_path):
    (tmp_path / "cache").write_text("a file in the place of the folder")
    model = rolling(tmp_path)
    with pytest.warns(RuntimeWarning, match="kept in memory only"):
        found = model([0.6, 134.0])
    assert np.isfinite(found).all() and model([0.6, 134.0]).tolist() == found.tolist()
    assert model.runs == 1


def test_a_neighbour_without_a_value_leaves_a_one_sided_difference(tmp_path):
    # With a traction coefficient of 0.58 there is no contact below a friction of 0.58.
    model = rolling(tmp_path, outputs=["contact.creepage_xi"])
    point, step = [0.6, 134.0], [0.03, 1.0]
    slopes = model.derivatives(point, step).values
    one_sided = (model([0.63, 134.0]) - model(point)) / 0.03
    assert slopes[0, 0] == pytest.approx(one_sided[0], rel=1e-12)
    assert len(model.failures) == 1 and model.failures[0].point["friction"] == pytest.approx(0.57)
    assert np.isnan(model.derivatives([0.5, 134.0], [0.01, 1.0]).values).all()


def test_scipy_minimises_with_the_gradient(tmp_path):
    speed = {"speed": ("motion.speed", 20.0, 60.0)}
    model = sliding(tmp_path, speed)
    target = model([45.0])[0]
    found = minimize(
        lambda x: (model(x)[0] - target) ** 2,
        [30.0],
        jac=lambda x: 2.0 * (model(x)[0] - target) * model.gradient(x),
        method="BFGS",
    )
    assert found.x[0] == pytest.approx(45.0, rel=1e-4)


def test_a_fit_finds_the_parameters_behind_the_data(tmp_path):
    model = fit_creep_curve.creep_curve(cache=tmp_path / "cache")
    seeds = 3
    fits = [
        fit_creep_curve.fit(model, fit_creep_curve.measure(model, seed)) for seed in range(seeds)
    ]
    distances = np.array([one.distance(fit_creep_curve.TRUE) for one in fits])
    assert np.all(distances < chi2.ppf(fit_creep_curve.LEVEL, 2)), distances
    # The region is not too wide either: distances and sums of squares have their distributions.
    squares = [one.squares for one in fits]
    for total, freedom in ((distances.sum(), 2 * seeds), (sum(squares), 6 * seeds)):
        assert chi2.ppf(0.001, freedom) < total < chi2.ppf(0.999, freedom)


def test_indices_are_those_of_the_closed_form(tmp_path):
    model = sliding(tmp_path)
    found, rises = sensitivity.indices(model, FULL_SLIP, 128)
    assert len(rises) == 128 * 5

    def mean(power, least, largest):
        return quad(lambda x: x**power, least, largest)[0] / (largest - least)

    # The mean of x^(2p) over the square of that of x^p; independent factors multiply.
    ratios = np.array(
        [
            mean(2.0 * p, *ends) / mean(p, *ends) ** 2
            for p, (_, *ends) in zip(EXPONENTS, FULL_SLIP.values())
        ]
    )
    variance = np.prod(ratios) - 1.0
    first = (ratios - 1.0) / variance
    total = (ratios - 1.0) * (np.prod(ratios) / ratios) / variance
    # 1.5 times the 95 % interval of the bootstrap: 99.7 %.
    assert np.all(np.abs(found["S1"] - first) < 1.5 * found["S1_conf"])
    assert np.all(np.abs(found["ST"] - total) < 1.5 * found["ST_conf"])
    assert np.all(found["ST_conf"] < 0.2)


def test_a_probability_is_that_of_the_closed_form(tmp_path):
    model = sliding(tmp_path, {name: FULL_SLIP[name] for name in ("friction", "speed")})
    spreads = np.array([0.10, 0.20])
    distributions = [lognorm(s=spreads[0], scale=0.6), lognorm(s=spreads[1], scale=40.0)]
    # The logarithm of the rise is normal.
    deviation = np.linalg.norm(EXPONENTS[:2] * spreads)
    limit = model([0.6, 40.0])[0] * np.exp(2.5 * deviation)
    form = probability.design_point(model, distributions, limit)
    assert form.beta == pytest.approx(2.5, abs=1e-3)
    random = np.random.default_rng(1)
    found = probability.importance_sampling(model, distributions, limit, form.normal, 400, random)
    expected = norm.cdf(-2.5)
    assert abs(found.value - expected) < 3.3 * found.error and found.error < 0.1 * expected
    assert found.interval()[0] < found.value < found.interval()[1]
