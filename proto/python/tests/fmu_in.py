"""FMUs as participants, compared bit by bit with the same FMUs in FMPy. Run by the system tests,
which set the paths of the programs."""

import csv
import importlib.util
import os
import subprocess
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

ROOT = Path(__file__).resolve().parents[3]
COORDINATOR = os.environ["COSIM_COORDINATOR"]
PARTICIPANT = str(Path(COORDINATOR).with_name("fmu-participant"))
# A power of two, whose multiples are exact, so that FMPy and the coordinator take the same steps.
WINDOW, WINDOWS = 0.125, 24

make = importlib.util.spec_from_file_location("make", ROOT / "tests" / "fmus" / "make.py")
made = importlib.util.module_from_spec(make)
make.loader.exec_module(made)


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    """Return a function that creates each FMU of tests/fmus once."""
    folder = tmp_path_factory.mktemp("fmus")

    def get(name):
        path = folder / f"{name}.fmu"
        return path if path.exists() else made.make(name, path)

    return get


def command(path, role, *wires):
    words = [PARTICIPANT, str(path), "--role", role]
    return words + [word for wire in wires for word in ("--wire", wire)]


def case(folder, commands, more="", window=WINDOW, windows=WINDOWS):
    """Write a case with only these participants."""
    lines = ['[case]\nname = "fmus"\n']
    for role, words in commands.items():
        listed = ", ".join(repr(word).replace('"', '\\"').replace("'", '"') for word in words)
        lines.append(f'[{role}]\nmodel = "co-simulation"\ncommand = [{listed}]\n')
    lines.append(f'[time]\nmode = "transient"\nwindow = {window!r}\nend = {windows * window!r}\n')
    lines.append('[output]\nfields = "none"\n')
    path = folder / "case.toml"
    path.write_text("".join(lines) + more)
    return path


def run(folder, path, *more, code=0):
    out = folder / "out"
    done = subprocess.run(
        [COORDINATOR, "--quiet", "run", path, "--out", out, "--replace", *more],
        capture_output=True,
        text=True,
        check=False,
        timeout=170,
    )
    assert done.returncode == code, done.stderr
    with (out / "history.csv").open() as file:
        return list(csv.DictReader(file))


def column(rows, key):
    return [float(row[key]) for row in rows]


@pytest.mark.parametrize(
    ("name", "outputs", "start", "table"),
    [
        ("dahlquist", ["x"], {}, ""),
        ("dahlquist", ["x"], {"k": 2.5}, "[dahlquist.start]\nk = 2.5\n"),
        ("ball", ["h", "v"], {}, ""),
        ("ball", ["h", "v"], {"g": -1.62, "e": 0.8}, '[ball.start]\ng = "-1620 mm/s2"\ne = 0.8\n'),
    ],
)
def test_alone_it_is_what_fmpy_computes(fmu, tmp_path, name, outputs, start, table):
    path = fmu(name)
    assert validate_fmu(str(path)) == []
    rows = run(tmp_path, case(tmp_path, {name: command(path, name)}, table))
    # With FMPy's steps, without its events; these FMUs have none.
    found = fmpy.simulate_fmu(
        str(path),
        stop_time=WINDOW * WINDOWS,
        output_interval=WINDOW,
        start_values=start,
        output=outputs,
    )
    assert len(rows) == WINDOWS == len(found) - 1
    for output in outputs:
        assert column(rows, f"{name}.{output}") == list(found[output][1:])
        assert len(set(found[output])) > WINDOWS // 2


def instance(path, folder, kind=FMU3Slave, **start):
    description = fmpy.read_model_description(path)
    fmu = kind(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(path), unzipdir=str(folder)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=folder.name,
    )
    fmu.instantiate()
    references = {one.name: one.valueReference for one in description.modelVariables}
    if kind is FMU2Slave:
        fmu.setupExperiment(startTime=0.0)
        fmu.setReal([references[name] for name in start], list(start.values()))
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    return fmu, references


def test_arrays_cross_between_two_fmus(fmu, tmp_path):
    """One FMU sends its outputs to the other: arrays whose elements have positions in the case."""
    path = fmu("space")
    grid = "x_from = 0\nx_to = 3\ny_from = 0\ny_to = 1\nnx = 3\nny = 1\n"
    commands = {"one": command(path, "one", "y -> drive"), "two": command(path, "two", "u <- drive")}
    rows = run(tmp_path, case(tmp_path, commands, f"[one.grid]\n{grid}"))
    one, names = instance(path, tmp_path / "one")
    two, _ = instance(path, tmp_path / "two")
    expected = []
    for k in range(WINDOWS):
        one.doStep(k * WINDOW, WINDOW)
        drive = one.getFloat64([names["y"]], nValues=3)
        two.setFloat64([names["u"]], drive)
        two.doStep(k * WINDOW, WINDOW)
        expected.append((*drive, *two.getFloat64([names["y"]], nValues=3)))
    keys = [f"{role}.y_{n}" for role in ("one", "two") for n in (1, 2, 3)]
    assert [tuple(float(row[key]) for key in keys) for row in rows] == expected
    one.freeInstance()
    two.freeInstance()


WIRES = ["Q -> load.normal_force", "xi -> motion.creepage.xi", "Fx, Fy, Fz <- contact_force"]


def on_the_rail(path, model, window, windows, scheme):
    """Return options for a case in which a vehicle sets load and creepage, and receives the contact
    force."""
    words = ", ".join(f'"{word}"' for word in command(path, "vehicle", *WIRES))
    settings = {
        "vehicle.command": f"[{words}]",
        "vehicle.model": "co-simulation",
        "load.normal_force": "{at=122625.0,from=4e4,to=2.4e5}",
        "motion.creepage.xi": "{at=-1e-4,from=-1e-2,to=1e-2}",
        "mech.model": model,
        "mech.resolution": "10",
        "time.mode": "transient",
        "time.window": repr(window),
        "time.end": repr(windows * window),
        "coupling.scheme": scheme,
        "output.fields": "none",
    }
    return [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]


@pytest.mark.parametrize(
    ("model", "scheme"),
    [
        ("hertz-carter", "serial-explicit"),
        ("hertz-carter", "serial-implicit"),
        ("half-space", "serial-implicit"),
    ],
)
def test_a_vehicle_on_its_suspension(fmu, tmp_path, model, scheme):
    """Every window of the vehicle equals FMPy's result for the contact's forces, whatever was
    iterated before."""
    path, window, windows = fmu("vehicle"), 2.0**-9, 24
    assert validate_fmu(str(path)) == []
    rows = run(tmp_path, ROOT / "cases/wheel-rail.toml", *on_the_rail(path, model, window, windows, scheme))
    vehicle, names = instance(path, tmp_path / "vehicle", FMU2Slave)
    inputs, outputs = ["Fx", "Fy", "Fz"], ["Q", "xi", "utilisation"]
    forces = ["contact.creep_force_x_n", "contact.creep_force_y_n", "contact.normal_force_n"]
    before = None
    for k, row in enumerate(rows):
        vehicle.setReal([names[one] for one in inputs], [float(row[force]) for force in forces])
        vehicle.doStep(k * window, window)
        load, creepage, utilisation = vehicle.getReal([names[one] for one in outputs])
        assert float(row["vehicle.Q"]) == 1e3 * load
        assert float(row["vehicle.xi"]) == creepage
        assert float(row["vehicle.utilisation"]) == utilisation
        # The load of the contact is that of the previous window, or the converged one.
        carried = float(row["contact.normal_force_n"])
        if scheme == "serial-implicit":
            assert abs(carried / (1e3 * load) - 1) < 1e-4, "the tolerance of the coupling"
        elif before is not None:
            assert abs(carried / before - 1) < 1e-12, "rounding"
        before = 1e3 * load
    vehicle.freeInstance()
    assert len(rows) == windows
    loads = column(rows, "vehicle.Q")
    assert max(loads) > 1.1 * min(loads)
    assert column(rows, "contact.creep_force_x_n")[-1] > 1e4


def test_windows_too_long_for_an_explicit_scheme_are_iterated(fmu, tmp_path):
    """The wheel settles within a millisecond or two. Over longer windows its creepage grows, unless
    the window is iterated."""
    path, window = fmu("vehicle"), 2.0**-7
    case = ROOT / "cases/wheel-rail.toml"
    out = tmp_path / "out"
    explicit = on_the_rail(path, "hertz-carter", window, 16, "serial-explicit")
    done = subprocess.run(
        [COORDINATOR, "--quiet", "run", case, "--out", out, *explicit],
        capture_output=True,
        text=True,
        check=False,
        timeout=170,
    )
    assert done.returncode == 1 and "is not between -0.01 and 0.01" in done.stderr, done.stderr
    rows = run(tmp_path, case, *on_the_rail(path, "hertz-carter", window, 16, "serial-implicit"))
    assert len(rows) == 16
