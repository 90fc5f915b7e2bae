//! FMUs as participants: comparison with FMPy, invalid uses, and failures inside the FMU.

use crate::harness::{Ended, Place, case, programs, root, sets};
use crate::resume::killed_and_resumed;
use serde_json::Value;
use std::fs;
use std::process::Command;
use tempfile::TempDir;

/// FMU of `tests/fmus`, as a participant.
struct Fmu {
    folder: TempDir,
    role: &'static str,
    wires: Vec<&'static str>,
}

impl Fmu {
    /// Compiles and packs an FMU, with replacements in its description.
    fn make(model: &str, role: &'static str, wires: &[&'static str], changes: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let made = Command::new("python3")
            .args(["tests/fmus/make.py", model])
            .arg(folder.path().join("a.fmu"))
            .args(changes)
            .current_dir(root())
            .output()
            .unwrap();
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        Self { folder, role, wires: wires.to_vec() }
    }

    /// Program with its arguments.
    fn words(&self) -> Vec<String> {
        let program = programs().join("fmu-participant").display().to_string();
        let path = self.folder.path().join("a.fmu").display().to_string();
        let mut words = vec![program, path, "--role".to_owned(), self.role.to_owned()];
        words.extend(self.wires.iter().flat_map(|wire| ["--wire".to_owned(), (*wire).to_owned()]));
        words
    }

    /// Setting that makes the FMU a participant of a case.
    fn command(&self) -> String {
        format!("{}.command={:?}", self.role, self.words())
    }

    /// Case with the FMU as the only participant, over eight windows.
    fn alone(&self, more: &str) -> String {
        let (role, words) = (self.role, self.words());
        let text = format!(
            "[case]\nname = \"fmu\"\n[{role}]\nmodel = \"co-simulation\"\ncommand = {words:?}\n\
             [time]\nmode = \"transient\"\nwindow = 0.125\nend = 1\n{more}"
        );
        let path = self.folder.path().join("case.toml");
        fs::write(&path, text).unwrap();
        path.display().to_string()
    }
}

const ON_THE_RAIL: [&str; 3] =
    ["Q -> load.normal_force", "xi -> motion.creepage.xi", "Fx, Fy, Fz <- contact_force"];

/// Outputs of the vehicle set live values of the case.
const LIVE: [&str; 8] = [
    "load.normal_force={at=122625.0,from=4e4,to=2.4e5}",
    "motion.creepage.xi={at=-1e-4,from=-1e-2,to=1e-2}",
    "vehicle.model=co-simulation",
    "mech.model=hertz-carter",
    "mech.resolution=10",
    "time.mode=transient",
    "time.window=0.001",
    "time.end=0.01",
];

const WITHOUT_STATES: [&str; 2] =
    ["canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"", ""];

/// An FMU that cannot save states is rejected if windows are repeated, and runs otherwise.
#[test]
fn an_fmu_that_cannot_go_back_is_never_asked_to() {
    let vehicle = Fmu::make("vehicle", "vehicle", &ON_THE_RAIL, &WITHOUT_STATES);
    let command = vehicle.command();
    let run = |scheme: &str| {
        let scheme = format!("coupling.scheme={scheme}");
        let set = [&LIVE[..], &[&command, &scheme]].concat();
        let place = Place::new();
        let ended = place.run(&case("wheel-rail.toml"), &sets(&set));
        place.assert_nothing_left();
        (ended, place)
    };
    for scheme in ["serial-implicit", "parallel-implicit"] {
        let (ended, place) = run(scheme);
        let said = crate::harness::flat(&ended.stderr);
        let part = "vehicle.model: `co-simulation` can solve a window only once, and";
        assert!(ended.code == Some(2) && said.contains(part), "{said}");
        assert!(said.contains("set coupling.scheme to \"serial-explicit\""), "{said}");
        assert!(!place.out().exists());
    }
    let (ended, place) = run("serial-explicit");
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let with = Fmu::make("vehicle", "vehicle", &ON_THE_RAIL, &[]);
    let command = with.command();
    let other = Place::new();
    let set = [&LIVE[..], &[&command, "coupling.scheme=serial-explicit"]].concat();
    other.summary(&case("wheel-rail.toml"), &sets(&set));
    let history = |place: &Place| fs::read_to_string(place.out().join("history.csv")).unwrap();
    assert_eq!(history(&place), history(&other), "states that are kept change nothing");
    // A row has the values with which its window was solved, not those for the next one.
    let column = |name: &str| other.table("history.csv").numbers(name);
    let [live, used] = ["load.normal_force [N]", "contact.normal_force_n"].map(column);
    assert!(live.len() == 10 && live[0] != live[9], "{live:?}");
    assert_eq!(live, used);
}

/// Without `--role` the FMU plays the role of its file's name. `check`, `plan` and `run` say so, in
/// place of an error about its keys.
#[test]
fn an_fmu_of_another_role_is_refused_alike_by_all_commands() {
    let vehicle = Fmu::make("vehicle", "vehicle", &ON_THE_RAIL, &[]);
    let mut words = vehicle.words();
    words.drain(2..4);
    let command = format!("vehicle.command={words:?}");
    let set = [&LIVE[..], &[&command, "vehicle.start.speed=20"]].concat();
    let place = Place::new();
    for name in ["check", "plan", "run"] {
        let ended =
            place.start(&[&[name, &case("wheel-rail.toml")][..], &sets(&set)].concat()).wait();
        let said = crate::harness::flat(&ended.stderr);
        assert_eq!(ended.code, Some(2), "{name}: {said}");
        assert!(said.contains("vehicle.command: its program plays the role `a`"), "{name}: {said}");
        assert!(!said.contains("unknown key"), "{name}: {said}");
    }
}

/// An FMU with steps of constant length rejects windows of different lengths: at `check` if the
/// case has them, at the window if the driver of the run requests them.
#[test]
fn an_fmu_with_steps_of_one_length_is_asked_for_no_other() {
    let fixed = ["canHandleVariableCommunicationStepSize=\"true\"", ""];
    let clock = Fmu::make("space", "clock", &[], &fixed);
    let check = |more: &[&str]| {
        let place = Place::new();
        let path = clock.alone("");
        let words = [&["check", path.as_str()], more].concat();
        let ended = place.start(&words).wait();
        (ended.code, crate::harness::flat(&ended.stderr))
    };
    assert_eq!(check(&[]).0, Some(0), "{}", check(&[]).1);
    for (set, key, what) in [
        ("time.end=0.3", "time.end", "the last window is cut at time.end"),
        ("time.control=adaptive", "time.control", "the lengths of adaptive windows differ"),
    ] {
        let (code, said) = check(&["--set", set]);
        assert!(code == Some(2) && said.contains(key) && said.contains(what), "{set}: {said}");
        assert!(said.contains("`co-simulation` solves windows of one length only"), "{said}");
    }
    let other = Fmu::make("space", "clock", &[], &[]);
    let place = Place::new();
    let ended = place.start(&["check", &other.alone(""), "--set", "time.end=0.3"]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);

    let place = Place::new();
    let lines = "{\"do\":\"step\",\"end\":0.1}\n{\"do\":\"step\",\"end\":0.2}\n{\"do\":\"step\",\"end\":0.25}\n";
    let input = clock.folder.path().join("lines");
    fs::write(&input, lines).unwrap();
    let mut drive = place.command(&["drive", &clock.alone("")]);
    drive.stdin(fs::File::open(&input).unwrap());
    let ended = place.launch(drive).wait();
    let answers: Vec<Value> =
        ended.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers[2]["window"], 1, "{}", ended.stdout);
    let words = "the FMU requires steps of constant length 0.1 s, got 0.0";
    assert_eq!(answers[3]["kind"], "no-answer", "{}", ended.stdout);
    assert!(answers[3]["error"].as_str().unwrap().contains(words), "{}", ended.stdout);
}

/// Runs the model that fails in the third window, in one of several ways.
fn troubled(how: u32) -> Ended {
    let trouble = Fmu::make("trouble", "clock", &[], &[]);
    let place = Place::new();
    let ended = place.run(&trouble.alone(&format!("[clock.start]\nhow = {how}\n")), &[]);
    place.assert_nothing_left();
    ended
}

#[test]
fn what_goes_wrong_in_an_fmu_is_named() {
    let who = "clock (fmu-participant) failed";
    let told = |how, what: &str| {
        let ended = troubled(how);
        let line =
            ended.stderr.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
        for part in [who, "window 2", what] {
            assert!(line.contains(part), "{how}: `{part}` is missing in: {}", ended.stderr);
        }
        assert_eq!(ended.code, Some(1));
    };
    told(1, "fmi2DoStep returned fmiError: no step from: 0.25");
    told(2, "fmi2DoStep returned fmiFatal: no step from: 0.25");
    told(4, "killed by signal 11");
    assert_eq!(troubled(0).code, Some(0));
}

/// The FMU hears end and tolerance before it starts. A start other than 0 is a warning. Whoever
/// drives a run chooses its end, so that no stop time is known.
#[test]
fn an_fmu_hears_of_its_experiment() {
    let changes = [r#"startTime="0""#, r#"startTime="5" tolerance="1e-5""#];
    let fmu = Fmu::make("trouble", "clock", &[], &changes);
    let place = Place::new();
    let ended = place.run(&fmu.alone(""), &["--set", "time.end=0.5"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary = place.read_summary();
    let told = |name: &str| summary["clock"][name].as_f64();
    assert_eq!((told("stop"), told("tolerance")), (Some(0.5), Some(1e-5)), "{summary}");
    let log = fs::read_to_string(place.out().join("log.jsonl")).unwrap();
    assert!(log.contains("proposes to start at 5 s; its time begins at 0 s"), "{log}");

    let place = Place::new();
    let input = fmu.folder.path().join("lines");
    fs::write(&input, "{\"do\":\"step\"}\n{\"do\":\"finish\"}\n").unwrap();
    let out = place.out().display().to_string();
    let mut drive = place.command(&["drive", &fmu.alone(""), "--out", &out]);
    drive.stdin(fs::File::open(&input).unwrap());
    let ended = place.launch(drive).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary = place.read_summary();
    assert_eq!(summary["clock"]["stop"], -1.0, "{summary}");
}

/// NaN gives no figure; in a field it is an error.
#[test]
fn an_output_that_is_no_number_is_refused() {
    let wired = Fmu::make("trouble", "clock", &["y -> clock_time"], &[]);
    let place = Place::new();
    let ended =
        place.run(&wired.alone("[clock.start]\nhow = 3\n[output]\nfields = \"all\"\n"), &[]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("the FMU returned NaN for `y`"), "{}", ended.stderr);
    place.assert_nothing_left();
}

/// A resumed run equals the uninterrupted run, bit for bit, also within an implicit scheme.
#[test]
fn the_state_of_an_fmu_is_in_the_checkpoints() {
    let vehicle = Fmu::make("vehicle", "vehicle", &ON_THE_RAIL, &[]);
    let command = vehicle.command();
    let more = ["coupling.scheme=serial-implicit", "output.checkpoint_every=5", "time.end=0.2"];
    let settings = [&LIVE[..], &[&command], &more].concat();
    killed_and_resumed(&case("wheel-rail.toml"), &settings, 8, &mut 35);
}

/// An FMU that cannot serialise its state reports why there is no checkpoint.
#[test]
fn an_fmu_without_bytes_has_no_checkpoints() {
    let ball = Fmu::make("ball", "ball", &[], &[]);
    let place = Place::new();
    let ended = place.run(&ball.alone("[output]\ncheckpoint_every = 3\n"), &[]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("cannot serialise its state"), "{}", ended.stderr);
    place.assert_nothing_left();
}

/// FMUs in place of the thermal solver: a body of uniform temperature, and one whose surface is an
/// array.
#[test]
fn an_fmu_plays_the_thermal_solver() {
    let settings = [
        "thermal.model=co-simulation",
        "mech.model=hertz-carter",
        "mech.resolution=10",
        "time.mode=transient",
        "time.window=1e-4",
        "time.end=1e-3",
        "output.fields=all",
    ];
    let run = |fmu: &Fmu, more: &[&str]| -> (Place, Value) {
        let command = fmu.command();
        let set = [&settings[..], &[&command], more].concat();
        let place = Place::new();
        let summary = place.summary(&case("wheel-rail.toml"), &sets(&set));
        (place, summary)
    };
    let number =
        |summary: &Value, pointer: &str| summary.pointer(pointer).unwrap().as_f64().unwrap();
    let lump = Fmu::make(
        "body",
        "thermal",
        &["P <- integral(friction_power)", "T -> lower_temperature"],
        &[],
    );
    let (place, summary) = run(&lump, &["thermal.start.C=\"0.5 kJ/K\""]);
    let power = number(&summary, "/contact/friction_power_w");
    let rise = number(&summary, "/thermal/T");
    // Capacity C = 500 J/K, with a loss that is small over this time: T = P/2G (1 − exp(−G t/C)).
    let exact = power / 20.0 * (1.0 - (-10.0 * 1e-3 / 500.0_f64).exp());
    assert!((rise / exact - 1.0).abs() < 1e-6, "{rise} K, {exact} K: Euler's steps, G h/2C");
    assert!(number(&summary, "/coupling/energy_imbalance") <= 1e-12);
    let field = place.field("thermal_contact_000009.vti", "rail_temperature");
    assert!(field.iter().all(|value| *value == rise));
    let grid = [
        "thermal.grid.x_from=-0.012",
        "thermal.grid.x_to=0.012",
        "thermal.grid.y_from=-0.008",
        "thermal.grid.y_to=0.008",
        "thermal.grid.nx=12",
        "thermal.grid.ny=8",
    ];
    let film =
        Fmu::make("body", "thermal", &["q <- friction_power", "surface -> lower_temperature"], &[]);
    let (place, summary) = run(&film, &grid);
    let field = place.field("thermal_fmu_000009.vti", "rail_temperature");
    // The sum of r q/2 over the elements gives the power received through the mapping.
    let area = 0.024 / 12.0 * 0.016 / 8.0;
    let come = field.iter().sum::<f64>() * area * 2.0 / 1e-9;
    let power = number(&summary, "/contact/friction_power_w");
    assert!((come / power - 1.0).abs() < 1e-10, "{come} W, {power} W: what a mapping keeps");
    assert!(number(&summary, "/coupling/energy_imbalance") <= 1e-10);
}

/// All conformance checks for a program without effects.
#[test]
fn an_fmu_conforms() {
    let wires = ["q <- friction_power", "surface -> lower_temperature"];
    let body = Fmu::make("body", "thermal", &wires, &[]);
    let place = Place::new();
    let case = case("wheel-rail.toml");
    let mut words = vec!["conform", "--role", "thermal", "--case", &case, "--json"];
    words.extend(["--set", "mech.model=hertz-carter", "--set", "mech.resolution=4"]);
    let grid = ["x_from=-0.012", "x_to=0.012", "y_from=-0.008", "y_to=0.008", "nx=12", "ny=8"];
    let grid = grid.map(|key| format!("thermal.grid.{key}"));
    words.extend(grid.iter().flat_map(|key| ["--set", key]));
    let program = body.words();
    words.push("--");
    words.extend(program.iter().map(String::as_str));
    let ended = place.start(&words).wait();
    place.assert_nothing_left();
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    let report: Value = serde_json::from_str(&ended.stdout).unwrap();
    let passed =
        report["checks"].as_array().unwrap().iter().filter(|row| row["verdict"] == "passed");
    assert!(passed.count() > 20, "{}", ended.stdout);
}
