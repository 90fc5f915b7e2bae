"""FMUs of surrogates, in FMPy: run by the system tests, which set the paths of the executables.

Every figure is compared bit by bit with that of `coordinator ask` at the same point.
"""

import csv
import io
import os
import subprocess
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.validation import validate_fmu

ROOT = Path(__file__).resolve().parents[3]
COORDINATOR = os.environ["COSIM_COORDINATOR"]
TRACTION, FRICTION, LOAD = KEYS = (
    "motion.traction_coefficient",
    "friction.coefficient",
    "load.normal_force",
)
POINTS = [(0.1, 0.5, 50e3), (0.3, 0.6, 140e3), (0.2, 0.5, 100e3), (0.25, 0.68, 120e3)]
RISE = "temperature.rail.max_rise_k"


def coordinator(*arguments, code=0, given=None):
    command = [COORDINATOR, *map(str, arguments)]
    done = subprocess.run(
        command, input=given, capture_output=True, text=True, check=False, timeout=170
    )
    assert done.returncode == code, done.stderr
    return done


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep") / "s"
    case = ROOT / "cases" / "wheel-rail.toml"
    ranges = {TRACTION: "0.05..0.4/40", FRICTION: "0.45..0.7/40", LOAD: "40e3..150e3/40"}
    vary = [word for key, values in ranges.items() for word in ("--vary", f"{key}={values}")]
    coarse = ["--set", "mech.resolution=6", "--latin", "1"]
    coordinator("--quiet", "sweep", case, *coarse, *vary, "--out", folder)
    # Traction over friction is a coordinate, so the region of the points is not a box.
    coordinator("--quiet", "fit", folder, "--per", f"{TRACTION}/{FRICTION}")
    return folder


@pytest.fixture(scope="module")
def fmu(sweep):
    path = sweep / "contact.fmu"
    made = coordinator("fmu", sweep / "fit.json", "-o", path)
    assert f"input   {LOAD} [N]" in made.stdout
    return path


def asked(sweep, points):
    """Return figures at points, by key."""
    table = ",".join(KEYS) + "\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in points)
    answer = coordinator("ask", sweep, "--table", "-", given=table).stdout
    return list(csv.DictReader(io.StringIO(answer)))


def instance(path, folder, kind):
    description = fmpy.read_model_description(str(path))
    made = (FMU3Model if kind == "ModelExchange" else FMU3Slave)(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(path), unzipdir=str(folder)),
        modelIdentifier=description.modelExchange.modelIdentifier,
        instanceName=kind,
    )
    references = {one.name: one.valueReference for one in description.modelVariables}
    log = []

    def tell(_environment, status, _category, message):
        log.append((status, message.decode()))

    made.instantiate(loggingOn=True, logMessage=tell)
    made.enterInitializationMode(startTime=0.0)
    made.exitInitializationMode()
    return made, references, log


def at(made, references, point, *keys):
    made.setFloat64([references[key] for key in KEYS], point)
    return made.getFloat64([references[key] for key in keys])


def test_it_says_what_it_has(fmu, sweep):
    assert validate_fmu(str(fmu)) == []
    description = fmpy.read_model_description(str(fmu))
    variables = {one.name: one for one in description.modelVariables}
    rise = variables[RISE]
    assert (rise.unit, rise.causality) == ("K", "output")
    assert rise.description.startswith("rail temperature rise; largest error at points held out")
    load = variables[LOAD]
    assert (load.causality, load.unit) == ("input", "N")
    assert [float(value) for value in (load.min, load.max)] == [40e3, 150e3]
    # The start values have a result: the midpoint of the quotient is used, not that of the box.
    start = [tuple(float(variables[key].start) for key in KEYS)]
    assert len(asked(sweep, start)) == 1


@pytest.mark.parametrize(
    ("kind", "solver"),
    [("CoSimulation", "CVode"), ("ModelExchange", "CVode"), ("ModelExchange", "Euler")],
)
def test_a_simulation_gives_what_ask_gives(fmu, sweep, kind, solver):
    rows = [(float(k), *point) for k, point in enumerate(POINTS)]
    given = np.array(rows, dtype=[("time", "f8"), *((key, "f8") for key in KEYS)])
    description = fmpy.read_model_description(str(fmu))
    figures = [one.name for one in description.modelVariables if one.causality == "output"]
    found = fmpy.simulate_fmu(
        str(fmu),
        fmi_type=kind,
        solver=solver,
        input=given,
        stop_time=3.0,
        step_size=0.5,
        output_interval=0.5,
        output=[*KEYS, *figures],
    )
    assert len(found) == 7 and len(figures) > 20
    points = [tuple(float(row[key]) for key in KEYS) for row in found]
    assert len(set(points)) >= 4
    for row, expected in zip(found, asked(sweep, points), strict=True):
        for key in figures:
            assert row[key] == float(expected[key]), key


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_outside_of_its_box_figures_are_not_numbers_and_the_host_is_warned(
    fmu, sweep, tmp_path, kind
):
    made, references, log = instance(fmu, tmp_path, kind)
    for point, words in (
        ((0.2, 0.5, 200e3), f"{LOAD} = 200000 N is outside 40000 to 150000 N"),
        ((0.4, 0.45, 100e3), f"{TRACTION}/{FRICTION} = 0.888"),
        ((0.2, 0.5, float("nan")), f"{LOAD} = NaN"),
    ):
        assert np.isnan(at(made, references, point, RISE, "contact.friction_power_w")).all()
        # One warning per point, however often it is evaluated.
        assert np.isnan(made.getFloat64([references[RISE]])).all()
        status, message = log.pop()
        assert status == 1 and words in message and "all outputs are NaN" in message
        assert not log
    (rise,) = at(made, references, POINTS[0], RISE)
    assert rise == float(asked(sweep, POINTS[:1])[0][RISE]) and not log
    with pytest.raises(FMICallException):
        made.setFloat64([references[RISE]], [1.0])
    assert "is not an input" in log.pop()[1]
    made.freeInstance()


def test_a_state_is_a_few_bytes(fmu, tmp_path):
    made, references, log = instance(fmu, tmp_path, "CoSimulation")
    expected = at(made, references, POINTS[1], RISE)
    kept = made.getFMUState()
    written = made.serializeFMUState(kept)
    assert len(written) == 8 * (1 + len(KEYS))
    assert at(made, references, POINTS[2], RISE) != expected
    other = made.deserializeFMUState(written)
    for state in (kept, other):
        at(made, references, POINTS[3], RISE)
        made.setFMUState(state)
        assert made.getFloat64([references[RISE]]) == expected
        assert tuple(made.getFloat64([references[key] for key in KEYS])) == POINTS[1]
        made.freeFMUState(state)
    with pytest.raises(FMICallException):
        made.deserializeFMUState(written[:-1])
    assert "31 bytes are not a state of this FMU; expected 32" in log[-1][1]
    made.freeInstance()


def test_a_step_of_an_integrator_changes_nothing(fmu, sweep, tmp_path):
    made, references, log = instance(fmu, tmp_path, "ModelExchange")
    made.enterContinuousTimeMode()
    made.setTime(0.25)
    assert made.getFloat64([references["time"]]) == [0.25]
    assert made.completedIntegratorStep() == (False, False)
    (rise,) = at(made, references, POINTS[0], RISE)
    assert rise == float(asked(sweep, POINTS[:1])[0][RISE])
    made.enterEventMode()
    assert not any(made.updateDiscreteStates()[:5])
    made.freeInstance()
    # Functions for model exchange only are refused in co-simulation.
    slave, _, log = instance(fmu, tmp_path / "slave", "CoSimulation")
    with pytest.raises(FMICallException):
        slave.fmi3SetTime(slave.component, 1.0)
    assert "fmi3SetTime is for model exchange" in log[-1][1]
    slave.freeInstance()


def test_what_is_no_surrogate_is_refused(sweep, tmp_path):
    assert coordinator("fmu", sweep, "-o", tmp_path / "a.fmu").returncode == 0
    coordinator("fmu", sweep / "fit.json", "-o", tmp_path / "b.fmu")
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()
    done = coordinator("fmu", sweep, "--set", "mech.resolution=4", code=2)
    assert "--set and --unset change a case" in done.stderr
    wrong = tmp_path / "wrong.json"
    wrong.write_text('{"schema": 1}')
    done = coordinator("fmu", wrong, code=2)
    assert "does not have the layout of a surrogate" in done.stderr and "coordinator fit" in done.stderr
