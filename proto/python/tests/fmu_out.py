"""FMUs of cases, in FMPy: run by the system tests, which set the paths of the executables.

Every figure is compared bit by bit with that of a plain run over the same windows.
"""

import csv
import math
import os
import signal
import stat
import subprocess
import sys
import threading
import time
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmpy.util import create_plotly_figure
from fmpy.validation import validate_fmu

ROOT = Path(__file__).resolve().parents[3]
COORDINATOR = os.environ["COSIM_COORDINATOR"]
CASE = ROOT / "cases" / "wheel-rail.toml"
LOAD, TRACTION = "load.normal_force", "motion.traction_coefficient"
LIVE = {
    LOAD: '{ at = "134 kN", from = "60 kN", to = "140 kN" }',
    TRACTION: "{ at = 0.4, from = 0.1, to = 0.7 }",
}
LOADS = [134e3, 60e3, 140e3, 100e3]
TRACTIONS = [0.4, 0.1, 0.58, 0.2]
STEP = 0.125
TRANSIENT = ["time.mode=transient", "time.window=1e-4", "time.end=4e-4"]


def sets(*settings):
    return [word for setting in settings for word in ("--set", setting)]


def coordinator(*arguments, code=0):
    done = subprocess.run(
        [COORDINATOR, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=170
    )
    assert done.returncode == code, done.stderr
    return done


def make(path, *settings, case=CASE, live=LIVE):
    lively = [f"{key}={value}" for key, value in live.items()]
    coordinator("fmu", case, *sets(*settings, *lively), "-o", path)
    return path


def rows(folder):
    with (folder / "history.csv").open() as file:
        return list(csv.DictReader(file))


def plain(folder, *settings, times=None):
    """Return the history of a plain run whose values are the rows of a table, or hold at its
    times."""
    corners = [(x, y) for x in (60e3, 140e3) for y in (0.1, 0.7)]
    steady = times is None
    table = list(zip(LOADS, TRACTIONS))
    lines = [(k if steady else times[k], *row) for k, row in enumerate(table)]
    # Gives both runs the same layout; rows after the last window change nothing.
    lines += [(lines[-1][0] + k + 1, *corner) for k, corner in enumerate(corners)]
    file = folder / "rows.csv"
    file.write_text("t,N,mu\n" + "".join(f"{t!r},{n!r},{mu!r}\n" for t, n, mu in lines))
    columns = {LOAD: "N", TRACTION: "mu", "time.history": "t"}
    named = [f'{key}={{ file = "{file}", column = "{column}" }}' for key, column in columns.items()]
    mode = ["time.mode=sequence", "time.on_failure=skip"] if steady else TRANSIENT
    out = folder / "plain"
    coordinator("--quiet", "run", CASE, *sets(*settings, *mode, *named), "--out", out)
    return rows(out)[: len(table)]


def same(found, expected, keys):
    """Every figure of a step equals that of the row, to the bit; absent figures are NaN.

    The table of a complete run has no column for a figure that is absent in every row.
    """
    assert len(keys) > 20
    for key in keys:
        value, text = float(found[key]), expected.get(key, "")
        assert math.isnan(value) if text == "" else value == float(text), key


def instance(path, folder):
    description = fmpy.read_model_description(path)
    unpacked = fmpy.extract(str(path), unzipdir=str(folder))
    fmu = FMU3Slave(
        guid=description.guid,
        unzipDirectory=unpacked,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=folder.name,
    )
    references = {one.name: one.valueReference for one in description.modelVariables}
    return fmu, references


def begin(fmu, log=None):
    def tell(_environment, status, _category, message):
        log.append((status, message.decode()))

    fmu.instantiate(loggingOn=True, logMessage=None if log is None else tell)
    fmu.enterInitializationMode(startTime=0.0)
    fmu.exitInitializationMode()


def step(fmu, references, k, length=STEP):
    fmu.setFloat64([references[LOAD], references[TRACTION]], [LOADS[k], TRACTIONS[k]])
    fmu.doStep(currentCommunicationPoint=k * length, communicationStepSize=length)
    names = [name for name in references if name not in {"time", LOAD, TRACTION}]
    return dict(zip(names, fmu.getFloat64([references[name] for name in names])))


def children():
    """Return the living child processes of this process."""
    return {
        int(pid)
        for task in Path("/proc/self/task").iterdir()
        for pid in (task / "children").read_text().split()
    }


@pytest.fixture(scope="module")
def steady(tmp_path_factory):
    return make(tmp_path_factory.mktemp("steady") / "contact.fmu", "mech.resolution=10")


def test_a_simulation_in_fmpy_is_the_plain_run(steady, tmp_path):
    assert validate_fmu(str(steady)) == []
    before = children()
    given = np.array(
        [(k * STEP, n, mu) for k, (n, mu) in enumerate(zip(LOADS, TRACTIONS))],
        dtype=[("time", "f8"), (LOAD, "f8"), (TRACTION, "f8")],
    )
    description = fmpy.read_model_description(str(steady))
    outputs = [one.name for one in description.modelVariables if one.causality == "output"]
    found = fmpy.simulate_fmu(
        str(steady), input=given, stop_time=4 * STEP, step_size=STEP, output_interval=STEP, output=outputs
    )
    assert len(found) == 5 and np.isnan(found[0]["contact.creep_force_x_n"])
    for row, expected in zip(found[1:], plain(tmp_path, "mech.resolution=10"), strict=True):
        same(row, expected, outputs)
    assert children() == before
    shown = ["contact.creep_force_x_n", "temperature.rail.max_rise_k"]
    figure = create_plotly_figure(found, names=shown)
    assert [list(trace.y[1:]) for trace in figure.data] == [list(found[name][1:]) for name in shown]


def test_windows_in_time_are_those_of_the_plain_run(tmp_path):
    path = make(tmp_path / "contact.fmu", "mech.resolution=10", *TRANSIENT)
    fmu, references = instance(path, tmp_path / "unpacked")
    begin(fmu)
    found = [step(fmu, references, k, 1e-4) for k in range(4)]
    fmu.freeInstance()
    middles = [0.5 * (k * 1e-4 + (k + 1) * 1e-4) for k in range(4)]
    for row, expected in zip(found, plain(tmp_path, "mech.resolution=10", times=middles), strict=True):
        same(row, expected, list(row))


def test_states_and_two_instances_in_one_process(steady, tmp_path):
    expected = plain(tmp_path, "mech.resolution=10")
    one, references = instance(steady, tmp_path / "one")
    other, _ = instance(steady, tmp_path / "other")
    before = children()
    begin(one)
    begin(other)
    at_first = one.getFMUState()
    same(step(one, references, 0), expected[0], ["contact.creep_force_x_n"] * 21)
    kept = one.getFMUState()
    straight = [step(one, references, k) for k in (1, 2, 3)]
    # The other instance runs independently in the meantime.
    apart = [step(other, references, k) for k in (0, 1, 2, 3)]
    one.setFMUState(kept)
    again = [step(one, references, k) for k in (1, 2, 3)]
    one.setFMUState(at_first)
    anew = [step(one, references, k) for k in (0, 1, 2, 3)]
    # A state from before the return to the beginning is still available.
    one.setFMUState(kept)
    late = [step(one, references, k) for k in (1, 2, 3)]
    for results in (straight, again, apart[1:], anew[1:], late):
        for row, known in zip(results, expected[1:], strict=True):
            same(row, known, list(row))
    one.freeFMUState(kept)
    one.freeFMUState(at_first)
    one.reset()
    one.enterInitializationMode(startTime=0.0)
    one.exitInitializationMode()
    same(step(one, references, 0), expected[0], ["contact.creep_force_x_n"] * 21)
    one.freeInstance()
    other.freeInstance()
    assert children() == before


def test_what_is_wrong_reaches_the_log_of_the_host(steady, tmp_path):
    fmu, references = instance(steady, tmp_path / "unpacked")
    log = []
    begin(fmu, log)
    step(fmu, references, 0)
    kept = fmu.getFMUState()
    fmu.setFloat64([references[LOAD]], [150e3])
    with pytest.raises(FMICallException):
        fmu.doStep(STEP, STEP)
    assert "window 1: 150000 of `load.normal_force` is not between 60000 and 140000" in log[-1][1]
    fmu.setFloat64([references[LOAD], references[TRACTION]], [134e3, 0.65])
    with pytest.raises(FMICallException):
        fmu.doStep(STEP, STEP)
    assert "window 1" in log[-1][1], log
    # The earlier state is still available.
    fmu.setFMUState(kept)
    step(fmu, references, 1)
    with pytest.raises(FMICallException):
        fmu.setFloat64([references["contact.creep_force_x_n"]], [1.0])
    assert "is not an input" in log[-1][1]
    with pytest.raises(FMICallException):
        fmu.getInt32([references[LOAD]])
    assert "fmi3GetInt32 is not supported" in log[-1][1]
    # Killing the coordinator is an error for the host, not a signal.
    (child,) = [pid for pid in children() if "coordinator" in Path(f"/proc/{pid}/cmdline").read_text()]
    os.kill(child, signal.SIGKILL)
    with pytest.raises(FMICallException):
        step(fmu, references, 2)
    assert "has ended" in log[-1][1]
    fmu.freeInstance()


def test_a_step_to_no_time_is_refused(steady, tmp_path):
    """NaN and infinity are not valid ends of a window; the instance continues from its state."""
    expected = plain(tmp_path, "mech.resolution=10")
    fmu, references = instance(steady, tmp_path / "unpacked")
    log = []
    begin(fmu, log)
    for start, length in [(0.0, math.nan), (0.0, math.inf), (math.nan, STEP), (-math.inf, STEP)]:
        with pytest.raises(FMICallException) as refused:
            fmu.doStep(start, length)
        assert refused.value.status == 3 and "does not end at a finite time" in log[-1][1], log
    assert math.isnan(fmu.getFloat64([references["contact.creep_force_x_n"]])[0]), "no window was solved"
    same(step(fmu, references, 0), expected[0], ["contact.creep_force_x_n"] * 21)
    fmu.reset()
    with pytest.raises(FMICallException):
        fmu.enterInitializationMode(startTime=math.nan)
    assert "the time is NaN, not a finite number" in log[-1][1]
    fmu.freeInstance()


def test_a_call_from_a_second_thread_is_an_error(steady, tmp_path):
    fmu, references = instance(steady, tmp_path / "unpacked")
    log = []
    begin(fmu, log)
    refused = 0

    def insist(k):
        while True:
            try:
                return fmu.doStep(k * STEP, STEP)
            except FMICallException:
                pass

    for k in range(4):
        stepping = threading.Thread(target=insist, args=(k,))
        stepping.start()
        while stepping.is_alive():
            try:
                fmu.getFloat64([references[LOAD]])
            except FMICallException as error:
                assert error.status == 3
                refused += 1
        stepping.join()
    assert refused > 0
    assert {message for _, message in log} == {"another call of this instance has not returned yet"}
    assert math.isfinite(fmu.getFloat64([references["contact.creep_force_x_n"]])[0])
    fmu.freeInstance()


def test_a_host_that_is_killed_leaves_nothing(steady, tmp_path):
    unpacked = tmp_path / "unpacked"
    fmpy.extract(str(steady), unzipdir=str(unpacked))
    script = tmp_path / "host.py"
    script.write_text(
        "import sys, time\n"
        f"sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
        "from pathlib import Path\n"
        "import fmu_out as t\n"
        f"fmu, references = t.instance({str(steady)!r}, Path({str(unpacked)!r}))\n"
        "t.begin(fmu)\n"
        "t.step(fmu, references, 0)\n"
        "print(*t.children(), flush=True)\n"
        "time.sleep(600)\n"
    )
    host = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True)
    assert host.stdout is not None
    started = [int(pid) for pid in host.stdout.readline().split()]
    assert started
    host.kill()
    host.wait(timeout=60)
    host.stdout.close()
    deadline = time.monotonic() + 120
    while any(Path(f"/proc/{pid}").exists() for pid in started):
        assert time.monotonic() < deadline, "the coordinator outlives its host"
        time.sleep(0.01)
    runs = Path(os.environ["COSIM_RUNTIME_DIR"])
    while list(runs.glob("cosim-*/*")):
        assert time.monotonic() < deadline, list(runs.glob("cosim-*/*"))
        time.sleep(0.01)


def test_files_of_the_case_and_lost_bits(tmp_path):
    """The case's files are inside the FMU; executables get back the permission bit lost by a
    tool."""
    live = {"wheelset.y": "{ at = 0.003, from = 0.0, to = 0.004 }"}
    case = ROOT / "cases" / "wheel-on-track.toml"
    path = make(tmp_path / "track.fmu", "mech.resolution=10", case=case, live=live)
    names = zipfile.ZipFile(path).namelist()
    assert "resources/files/bodies.wheel.profile.csv" in names, names
    fmu, references = instance(path, tmp_path / "unpacked")
    for program in (tmp_path / "unpacked" / "resources").glob("*-solver"):
        program.chmod(program.stat().st_mode & ~(stat.S_IXUSR | stat.S_IXGRP | stat.S_IXOTH))
    begin(fmu)
    fmu.doStep(0.0, STEP)
    found = fmu.getFloat64([references["contact.normal_force_n"]])
    out = tmp_path / "plain"
    coordinator(
        "--quiet", "run", case, *sets("mech.resolution=10", f"wheelset.y={live['wheelset.y']}"), "--out", out
    )
    assert found[0] == float(rows(out)[0]["contact.normal_force_n"])
    fmu.freeInstance()


def test_a_case_without_inputs_says_which_there_could_be(tmp_path):
    done = coordinator("fmu", CASE, "-o", tmp_path / "none.fmu", code=2)
    text = " ".join(done.stderr.split())
    assert "this case has none" in text and "load.normal_force" in text
    assert not list(tmp_path.iterdir())


def test_the_same_case_gives_the_same_fmu(steady, tmp_path):
    again = make(tmp_path / "again.fmu", "mech.resolution=10")
    assert again.read_bytes() == steady.read_bytes()
