"""Cases run from Python, with the executables named by COSIM_COORDINATOR; called by the system
tests, which have built them."""

import gc
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import matplotlib
import numpy as np
import pytest

import cosim
from cosim import pictures
from cosim.command import toml
from cosim.series import Fault, Field, read

matplotlib.use("Agg")

# Deprecation warnings of other packages do not fail the tests.
pytestmark = [
    pytest.mark.filterwarnings(f"default::{kind}")
    for kind in ("DeprecationWarning", "PendingDeprecationWarning", "FutureWarning")
]

ROOT = Path(__file__).resolve().parents[3]
CASE = ROOT / "cases" / "wheel-rail.toml"
COARSE = {"resolution": 12}


@pytest.fixture(scope="module")
def results():
    return cosim.run(CASE, mech=COARSE, record=True)


def test_figures_are_attributes_and_have_units(results):
    rise = results.temperature.rail.max_rise_k
    assert 200.0 < rise < 240.0
    figure = results.figures["temperature.rail.max_rise_k"]
    assert (figure.value, figure.unit) == (rise, "K")
    assert format(figure, ".1f") == f"{rise:.1f} K"
    assert "rail" in dir(results.temperature)
    with pytest.raises(AttributeError, match=r"no `rial` in the summary\.temperature"):
        _ = results.temperature.rial
    assert "  rail temperature rise: " in repr(results) and results.status == "completed"


def test_a_run_is_driven_window_by_window(tmp_path):
    load, force = "load.normal_force", "contact.creep_force_x_n"
    given = cosim.live("134 kN", "60 kN", 140e3)
    with cosim.drive(CASE, mech=COARSE, load={"normal_force": given}, out=tmp_path / "out") as run:
        assert run.live == {load: cosim.Live("N", 134e3, 60e3, 140e3)} and run.window is None
        first = run.step()
        assert (first.number, first.status, first[load.replace("load", "contact") + "_n"]) == (
            0,
            "completed",
            pytest.approx(134e3),
        )
        state = run.save()
        low = run.step({load: 60e3}, end=0.1)
        assert low[force] < 0.5 * first[force] and low.end == 0.1
        run.restore(state)
        run.set({load: 60e3})
        assert dict(run.step(end=0.1)) == pytest.approx(dict(low), rel=0, abs=0, nan_ok=True)
        with pytest.raises(cosim.Refused, match="window 2: 200000"):
            run.step({load: 200e3})
        run.free(state)
        with pytest.raises(cosim.Refused, match="no state 1"):
            run.restore(state)
        run.finish()
        with pytest.raises(cosim.Refused, match="has ended"):
            run.step()
    assert cosim.Results(tmp_path / "out").status == "completed"
    with pytest.raises(cosim.CosimError, match="is not between"):
        cosim.drive(CASE, load={"normal_force": cosim.live(1.0, 2.0, 3.0)})


def test_fields_are_arrays_with_places(results):
    pressure = results["pressure"]
    assert pressure.unit == "Pa" and pressure.values.shape == (len(pressure.y), len(pressure.x))
    area = np.diff(pressure.x[:2])[0] * np.diff(pressure.y[:2])[0]
    # The field on the grid carries the load, within the rounding of a sum.
    assert pressure.values.sum() * area == pytest.approx(results.contact.normal_force_n, rel=1e-12)
    traction = results["traction"]
    assert traction.values.shape == (*pressure.values.shape, 3)
    assert traction.values[..., 0].sum() * area == pytest.approx(
        results.contact.creep_force_x_n, rel=1e-12
    )
    section = results["rail_section_temperature"]
    assert section.axes == ("z", "x") and section.magnitude.max() == pytest.approx(
        results.temperature.rail.max_rise_k, rel=0.02
    )
    with pytest.raises(KeyError, match="no field `presure`"):
        _ = results["presure"]


def test_frames_and_arrays_of_others(results):
    frame = results.history_frame()
    assert (
        len(frame) == 1
        and frame["contact.approach_m"][0] == results.history["contact.approach_m"][0]
    )
    array = results["traction"].to_xarray()
    assert array.sizes["component"] == 3 and array.attrs["units"] == "Pa"
    assert float(array.x[0]) == results["traction"].x[0]


def test_pictures_have_axes_and_units(results):
    assert results.plot("pressure").get_xlabel() == "x [mm]"
    assert results.plot("traction").get_aspect() == 1.0
    assert results.plot_stick_and_slip().get_legend() is not None
    depth = results.plot_depth("rail_section_temperature")
    assert depth.yaxis_inverted() and depth.get_xlabel() == "rail section temperature [K]"
    with pytest.raises(ValueError, match="not a section"):
        results.plot_depth("pressure")


def test_a_slender_picture_stands_in_the_middle_of_its_figure():
    x, y = np.linspace(-1e-3, 1e-3, 5), np.linspace(-8e-3, 8e-3, 9)
    values = np.outer(y, x)
    figure = pictures.field(Field("pressure", "Pa", 0.0, values, x, y, np.zeros(1))).figure
    figure.canvas.draw()
    box, width = figure.get_tightbbox(), figure.get_figwidth()
    assert abs(box.x0 - (width - box.x1)) < 0.05 * width


def test_a_recording_is_replayed_to_the_bit(results):
    assert "bit-identical" in results.replay("thermal")


def test_a_recording_keeps_the_folder_of_its_run():
    run = {"mech": {"resolution": 6}, "record": True}
    recording = cosim.run(ROOT / "cases" / "falling-friction.toml", **run).recording
    gc.collect()
    assert len(recording["friction_power"]) > 3


def test_a_recording_is_read_as_objects():
    results = cosim.run(
        ROOT / "cases" / "falling-friction.toml", mech={"resolution": 6}, record=True
    )
    recording = results.recording
    assert recording.complete and [one.role for one in recording.participants] == [
        "mech",
        "thermal",
    ]
    residuals = [one.residual for one in recording.iterations]
    assert len(residuals) == results.summary["coupling"]["iterations"] > 3
    assert residuals[-1] == results.coupling.final_residual < 1e-3 < residuals[0]
    power = recording["friction_power"]
    assert power.unit == "W/m2" and power.places[-1] == (0, len(residuals))
    last = power.at(window=0)
    assert (last.producer, last.grid, last.name) == ("mech", "contact", "friction_power")
    assert last.values.shape == (len(last.y), len(last.x)) and last.axes == ("y", "x")
    # The samples of the last iteration are the written fields, to the bit.
    written = results["friction_power"]
    assert np.array_equal(last.values, written.values)
    assert np.allclose(last.x, written.x, rtol=0.0, atol=1e-15)
    assert power.at(0, iteration=1).iteration == 1 and power[0].window == 0
    assert not np.array_equal(power.at(0, iteration=1).values, last.values)
    assert last.to_xarray().attrs["units"] == "W/m2"
    # Iterates of the coordinator share the field's name, and are read by topic.
    iterates = recording["field/coordinator/lower_temperature"]
    assert (
        len(iterates) == len(residuals) and recording["lower_temperature"][0].producer == "thermal"
    )
    assert "bit-identical" in recording.replay("mech")
    with pytest.raises(KeyError, match="no field `heat`"):
        _ = recording["heat"]
    with pytest.raises(KeyError, match="has no sample of window 7"):
        power.at(7)


def test_a_recording_of_a_contact_with_vectors_and_one_that_was_cut(results, tmp_path):
    whole = results.recording
    traction = whole["traction"][-1]
    assert traction.values.shape == (len(traction.y), len(traction.x), 2)
    area = np.diff(traction.x[:2])[0] * np.diff(traction.y[:2])[0]
    force = traction.values[..., 0].sum() * area
    assert force == pytest.approx(results.contact.creep_force_x_n, rel=1e-12)
    # Upper, lower: one element with two components.
    upper, lower = whole["surface_speed"][-1].values.ravel()
    assert upper > lower == 38.889
    # Without the end of the index, all chunks are still read.
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.path.read_bytes()[:-64])
    rest = cosim.Recording(cut)
    assert not rest.complete and len(rest["friction_power"]) == len(whole["friction_power"]) > 0
    assert np.array_equal(rest["friction_power"][0].values, whole["friction_power"][0].values)


def test_progress_is_a_bar_or_lines(capsys, monkeypatch):
    slow = {"mech": {"resolution": 10}, "time": {"end": "5 ms"}}
    cosim.run(ROOT / "cases" / "cold-start.toml", progress=True, **slow)
    shown = capsys.readouterr().err
    assert "windows" in shown and "t = 5.000 ms" in shown and '{"progress"' not in shown
    cosim.run(ROOT / "cases" / "cold-start.toml", **slow)
    assert capsys.readouterr().err == ""
    # Without tqdm the coordinator's own lines are passed on.
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    cosim.run(CASE, mech=COARSE, progress=True)
    assert '{"progress"' not in capsys.readouterr().err


def test_a_study_of_cost_has_rows(tmp_path):
    case = ROOT / "cases" / "full-slip.toml"
    models = {"mech.model": ["hertz-carter"], "thermal.model": ["ertz-knothe"]}
    vary = {**models, "mech.resolution": [5, 10, 20]}
    cost = cosim.cost(case, vary, repeat=1, longest_run=2.0, out=tmp_path / "c", progress=True)
    assert cost.report.exists() and cost.document["case"] == "full-slip"
    shown = cost.frame()
    assert len(shown) == 3 and set(cost.rows) <= set(shown.columns)
    assert len(cost.document["runs"]) == 3


def test_results_are_kept_and_reported(results, tmp_path):
    kept = results.save(tmp_path / "kept")
    assert kept.summary == results.summary
    assert kept.report().read_text().startswith("<!")
    with pytest.raises(FileExistsError):
        results.save(tmp_path / "kept")
    assert results.save(tmp_path / "kept", replace=True).summary == results.summary


def test_the_same_figures_as_the_command_to_the_bit(results, tmp_path):
    command = [
        os.environ["COSIM_COORDINATOR"],
        "run",
        CASE,
        "--set",
        "mech.resolution=12",
        "--out",
        tmp_path / "o",
        "--quiet",
    ]
    subprocess.run(command, check=True)
    plain = cosim.Results(tmp_path / "o")
    assert plain.summary["contact"] == results.summary["contact"]
    assert plain.summary["temperature"] == results.summary["temperature"]


def test_a_case_by_its_scene_or_its_text(results):
    assert cosim.run("wheel-rail", mech=COARSE).contact.approach_m == results.contact.approach_m
    assert cosim.run(CASE.read_text(), mech=COARSE).contact.approach_m == results.contact.approach_m


def test_keys_are_set_and_removed():
    case = cosim.run(
        CASE,
        mech=COARSE,
        motion={"traction_coefficient": None, "creepage": {"xi": -0.002}},
        effects={"friction_heat": None},
        thermal=None,
    )
    assert case.contact.creepage_xi == -0.002
    assert "temperature" not in case.summary


def test_a_plan_says_what_runs():
    plan = cosim.plan(CASE, mech=COARSE)
    assert [one.role for one in plan.participants] == ["mech", "thermal"]


def test_a_sweep_has_columns(tmp_path):
    sweep = cosim.sweep(
        CASE, {"motion.traction_coefficient": [0.1, 0.3]}, mech=COARSE, out=tmp_path / "s", jobs=1
    )
    assert np.all(np.diff(sweep["temperature.rail.max_rise_k"]) > 0.0)
    assert sweep["motion.traction_coefficient"].tolist() == [0.1, 0.3] and sweep.report.exists()
    assert sweep.frame().shape[0] == 2
    axes = sweep.plot("motion.traction_coefficient", "temperature.rail.max_rise_k")
    assert axes.get_xlabel() == "motion.traction_coefficient"
    assert axes.get_ylabel() == "rail temperature rise [K]"
    axes = sweep.plot("contact.creepage_xi", "contact.creep_force_x_n")
    assert axes.get_ylabel() == "creep force x [N]"


def test_a_package_that_is_missing_is_named_with_its_extra(results, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'cosim-participant\[frames\]'"):
        results["pressure"].to_xarray()


def test_errors_are_what_the_coordinator_says(tmp_path):
    with pytest.raises(cosim.CosimError, match=r"mech\.resolutoin: unknown key") as caught:
        cosim.run(CASE, mech={"resolutoin": 12})
    assert caught.value.exit_code == 2 and "fix: write `mech.resolution`" in str(caught.value)
    with pytest.raises(cosim.CosimError, match="there is no such scene"):
        cosim.run("no-such-scene")
    with pytest.raises(cosim.CosimError, match=r"nothing\.toml"):
        cosim.run(tmp_path / "nothing.toml")


def test_values_are_written_as_toml():
    values = {"a b": [1, 2.5, np.float64(0.1), np.int64(3)], "c": {}}
    assert toml(values) == '{"a b" = [1, 2.5, 0.1, 3], "c" = {}}'
    assert [toml(one) for one in (True, "60 MPa", 'a "b"\n', 1e-300)] == [
        "true",
        '"60 MPa"',
        '"a \\"b\\"\\n"',
        "1e-300",
    ]
    with pytest.raises(TypeError, match="not a valid case value"):
        toml(object())


def test_no_executable_is_said(monkeypatch):
    monkeypatch.setenv("COSIM_COORDINATOR", "/nowhere/coordinator")
    with pytest.raises(FileNotFoundError, match="cargo build --release"):
        cosim.run(CASE)


def test_damaged_series_are_faults(results):
    source = results.folder / "fields" / "mech_contact_000000.vti"
    whole, random = source.read_bytes(), np.random.default_rng(1)
    damaged = results.folder / "damaged.vti"
    faults = 0
    for _ in range(400):
        data = bytearray(
            whole[: random.integers(1, len(whole))] if random.random() < 0.3 else whole
        )
        for _ in range(random.integers(1, 8)):
            # Mostly in the description, which is the parsed part.
            data[random.integers(0, min(len(data), 3000))] = random.integers(0, 256)
        damaged.write_bytes(data)
        try:
            field = read(damaged, "pressure", 0.0)
        except Fault:
            faults += 1
        else:
            assert field.values.shape == (len(field.y), len(field.x))
    assert faults > 100


def test_an_interrupted_run_leaves_no_process(tmp_path):
    case, out = ROOT / "cases" / "cold-start.toml", tmp_path / "o"
    more = "mech={'resolution': 60}, time={'end': 1.0}"
    script = f"import cosim; cosim.run({str(case)!r}, out={str(out)!r}, {more})"
    process = subprocess.Popen(
        [sys.executable, "-c", script],
        start_new_session=True,
        stderr=subprocess.PIPE,
        text=True,
        # A shell makes background processes ignore Ctrl-C, and children inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 60.0
    while not (tmp_path / "o" / "history.csv").exists():
        assert time.monotonic() < deadline and process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=60.0)
    assert "KeyboardInterrupt" in told
    # Participants are in their own process groups; none may have this folder's run any more.
    left = subprocess.run(
        ["pgrep", "-f", str(tmp_path / "o")], check=False, capture_output=True, text=True
    ).stdout
    assert left == ""


def test_the_notebook_runs():
    import nbformat
    from nbclient import NotebookClient

    path = ROOT / "proto" / "python" / "examples" / "flash_temperature.ipynb"
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    outputs = [one for cell in notebook.cells for one in cell.get("outputs", ())]
    said = "".join(one.get("text", "") for one in outputs)
    assert "temperature rise: 227.6 K" in said
    # A bar under the transient run, shown until its end.
    assert "windows" in said and "100%" in said, said
    assert sum("image/png" in one.get("data", {}) for one in outputs) == 2
