//! `coordinator sweep`: one row for each point, failed points are kept, and a stopped sweep can be
//! continued.

use crate::harness::Table;
use crate::harness::python::interpreter;
use crate::harness::{Ended, Place, case, programs, root, sets, wait_until};
use serde_json::Value;
use std::path::Path;
use tests::harness::sweeps::points;

fn table(out: &Path) -> Table {
    Table::read(&out.join("sweep.csv"))
}

#[test]
fn a_grid_has_a_row_a_point_and_keeps_those_without_an_answer() {
    let place = Place::new();
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let vary = ["motion.traction_coefficient=0.2,0.5,0.7", "motion.speed=20..40/2"];
    let arguments = ["sweep", &file, "--set", "mech.resolution=8", "--out", &out];
    let vary = vary.iter().flat_map(|vary| ["--vary", vary]);
    let ended = place.start(&arguments.into_iter().chain(vary).collect::<Vec<_>>()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let table = table(&place.out());
    assert_eq!(table.texts("motion.speed"), ["20.0", "40.0", "20.0", "40.0", "20.0", "40.0"]);
    let rises = table.texts("temperature.rail.max_rise_k");
    let numbers: Vec<f64> = rises[..4].iter().map(|text| text.parse().unwrap()).collect();
    // Twice the speed gives twice the power and √2 times the temperature rise.
    for pair in numbers.chunks(2) {
        assert!((pair[1] / pair[0] - 2f64.sqrt()).abs() < 1e-3, "{numbers:?}");
    }
    assert_eq!(rises[4..], ["", ""], "more than friction allows");
    let failed = table.texts("failed");
    assert!(failed[..4].iter().all(|text| text.is_empty()), "{failed:?}");
    assert!(failed[4].contains("traction"), "{failed:?}");
    assert!(ended.stdout.contains("motion.speed"), "{}", ended.stdout);
    let page = std::fs::read_to_string(place.out().join("report.html")).unwrap();
    assert!(page.contains("Rail temperature rise"), "the figure over what varies");
    place.assert_nothing_left();
}

/// Axes of the page have names and units, not only keys. A sweep of the creepage contains the creep
/// curve, a column of the force, and the creepage once.
#[test]
fn a_sweep_of_the_creepage_has_the_creep_curve() {
    let place = Place::new();
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let vary = ["--vary", "motion.creepage.xi=-0.01..-0.001/4"];
    let arguments = ["sweep", &file, "--set", "mech.resolution=8", "--out", &out];
    let ended = place.start(&[&arguments[..], &vary].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(!ended.stdout.contains("creepage along x"), "{}", ended.stdout);
    let page = std::fs::read_to_string(place.out().join("report.html")).unwrap();
    for told in [
        ">Creep curve<",
        ">Traction coefficient |F|/N<",
        ">Creepage along x [%]<",
        ">Longitudinal creepage<",
        "motion.creepage.xi: longitudinal creepage; negative drives.",
    ] {
        assert!(page.contains(told), "{told}");
    }
    assert!(!page.contains(">motion.creepage.xi</text>"), "an axis has the name of what varies");
}

/// A killed sweep keeps its finished points; the one or two points in progress run again.
#[test]
fn a_sweep_that_was_killed_runs_nothing_twice() {
    let place = Place::new();
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let vary = "motion.traction_coefficient=0.01..0.59/60";
    let arguments =
        ["sweep", &file, "--set", "mech.model=hertz-carter", "--vary", vary, "--out", &out];
    let sweep = place.start(&arguments);
    wait_until("some points", || points(&place.out()).len() > 3);
    sweep.signal(rustix::process::Signal::KILL);
    sweep.wait();
    let before = points(&place.out());
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let after = points(&place.out());
    assert_eq!(after.len(), 60);
    assert_eq!(before, after[..before.len()], "not run again, or it would have taken another time");
    place.assert_nothing_left();
}

/// Sweep of a case file that is edited.
struct Edited<'a> {
    place: &'a Place,
    folder: tempfile::TempDir,
    text: String,
}

impl<'a> Edited<'a> {
    fn new(place: &'a Place) -> Self {
        let text = std::fs::read_to_string(case("wheel-rail.toml")).unwrap();
        let edited = Self { place, folder: tempfile::tempdir().unwrap(), text };
        edited.write(&edited.text);
        edited
    }

    fn file(&self) -> String {
        self.folder.path().join("own.toml").display().to_string()
    }

    fn write(&self, text: &str) {
        std::fs::write(self.file(), text).unwrap();
    }

    /// Reduces the speed of the wheel in the file.
    fn slow_down(&self) {
        assert!(self.text.contains("speed = 38.889"));
        self.write(&self.text.replace("speed = 38.889", "speed = 20.0"));
    }

    fn sweep(&self, out: &Path, more: &[&str]) -> Ended {
        let (file, out) = (self.file(), out.display().to_string());
        let vary =
            ["--vary", "load.normal_force=1e5,1.1e5,1.2e5", "--set", "mech.model=hertz-carter"];
        let arguments = [&["sweep", &file, "--out", &out], &vary[..], more].concat();
        self.place.start(&arguments).wait()
    }
}

/// Marks a sweep as stopped before its last point.
fn stop(out: &Path) {
    let file = out.join("sweep.json");
    let mut study: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    study["complete"] = false.into();
    std::fs::write(&file, study.to_string()).unwrap();
    let file = out.join("points.jsonl");
    let text = std::fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    std::fs::write(&file, lines[..lines.len() - 1].join("\n") + "\n").unwrap();
}

/// A table never mixes points of two cases, neither when a sweep continues nor when it collects;
/// the same holds for two versions of a program.
#[test]
fn points_of_a_case_that_has_changed_are_refused() {
    let place = Place::new();
    let (edited, out) = (Edited::new(&place), place.out());
    let refused = |ended: &Ended, words: &str| {
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    };
    let ended = edited.sweep(&out, &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let whole = table(&out).texts("temperature.rail.max_rise_k").join(" ");
    stop(&out);
    edited.slow_down();
    let words = "motion.speed: was 38.889, is 20.0";
    refused(&edited.sweep(&out, &[]), words);
    let (collected, from) = (out.with_file_name("collected"), out.display().to_string());
    refused(&edited.sweep(&collected, &["--collect", &from]), words);
    // An option has the same effect as an edit.
    edited.write(&edited.text);
    refused(&edited.sweep(&out, &["--set", "motion.speed=20.0"]), words);
    let file = out.join("sweep.json");
    let text = std::fs::read_to_string(&file).unwrap();
    let version = concat!("mech-solver ", env!("CARGO_PKG_VERSION"));
    assert!(text.contains(version), "{text}");
    std::fs::write(&file, text.replace(version, "mech-solver 0.1.0")).unwrap();
    refused(&edited.sweep(&out, &[]), "mech: was mech-solver 0.1.0, is mech-solver");
    // The original case continues, also from a different folder.
    std::fs::write(&file, text).unwrap();
    let ended = edited.sweep(&out, &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(table(&out).texts("temperature.rail.max_rise_k").join(" "), whole);
    place.assert_nothing_left();
}

/// Points of two programs never stand in one table: neither of another file of the same name on the
/// search path, nor of a script whose imported module was edited. A program that states no build is
/// told when its points stay.
#[test]
fn points_of_a_program_that_has_changed_are_refused() {
    let place = Place::new();
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let solver = programs().join("thermal-solver").display().to_string();
    let wrapped = |remark: &str| {
        std::fs::write(at("my-thermal"), format!("#!/bin/sh\n# {remark}\nexec {solver} \"$@\"\n"))
            .unwrap();
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
        std::fs::set_permissions(at("my-thermal"), mode).unwrap();
    };
    let example = root().join("proto/python/examples/short_columns.py");
    let script = std::fs::read_to_string(example).unwrap();
    std::fs::write(
        at("columns.py"),
        format!("{script}\n").replacen("import", "import inner\nimport", 1),
    )
    .unwrap();
    let module = |text: &str| std::fs::write(at("inner.py"), text).unwrap();
    let python = format!(
        "{:?}",
        [interpreter().display().to_string(), at("columns.py").display().to_string()]
    );
    let sweep = |out: &Path, program: &str, more: &[&str]| {
        let (file, out) = (case("wheel-rail.toml"), out.display().to_string());
        let command = format!("thermal.command={program}");
        let vary =
            ["--vary", "load.normal_force=1e5,1.1e5,1.2e5", "--set", "mech.model=hertz-carter"];
        let arguments =
            [&["sweep", &file, "--out", &out, "--set", &command], &vary[..], more].concat();
        let mut command = place.command(&arguments);
        command.env(
            "PATH",
            std::env::join_paths([folder.path(), Path::new("/usr/bin"), Path::new("/bin")])
                .unwrap(),
        );
        place.launch(command).wait()
    };
    type Edit<'a> = &'a dyn Fn(&str);
    let rows: [(&str, &[&str], Edit<'_>, &str); 2] = [
        ("[\"my-thermal\"]", &[], &wrapped, "thermal.command[0]: the content of the file changed"),
        (
            &python,
            &["--set", "thermal.model=short"],
            &|text| module(&format!("# {text}\n")),
            "thermal: another build of",
        ),
    ];
    for (program, more, edit, words) in rows {
        let out = place.out().with_file_name(words.len().to_string());
        edit("one");
        let ended = sweep(&out, program, more);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        stop(&out);
        edit("another");
        let from = out.display().to_string();
        let collected = out.with_extension("collected");
        for refused in [
            sweep(&out, program, more),
            sweep(&collected, program, &[more, &["--collect", &from]].concat()),
        ] {
            assert_eq!(refused.code, Some(2), "{}", refused.stderr);
            assert!(refused.stderr.contains(words), "{words}: {}", refused.stderr);
        }
        edit("one");
        let ended = sweep(&out, program, more);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stderr.contains("2 points of earlier runs stay"), "{}", ended.stderr);
        assert_eq!(
            ended.stderr.contains("thermal states no build"),
            more.is_empty(),
            "{}",
            ended.stderr
        );
    }
    place.assert_nothing_left();
}

/// The points of a surrogate must belong to the sweep in its folder.
#[test]
fn a_surrogate_of_another_sweep_is_refused() {
    let place = Place::new();
    let (edited, out) = (Edited::new(&place), place.out());
    let vary = [
        "--vary",
        "motion.creepage.xi=-0.001,-0.002,-0.003",
        "--unset",
        "motion.traction_coefficient",
    ];
    let ended = edited.sweep(&out, &[&vary[..], &["--fit"]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let fit = std::fs::read(out.join("fit.json")).unwrap();
    edited.slow_down();
    let ended = edited.sweep(&out, &[&vary[..], &["--replace"]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(!out.join("fit.json").exists(), "that of the earlier sweep");
    std::fs::write(out.join("fit.json"), fit).unwrap();
    let folder = out.display().to_string();
    let asked = ["ask", &folder, "load.normal_force=110 kN", "motion.creepage.xi=-0.002"];
    let ended = place.start(&asked).wait();
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("belongs to another sweep"), "{}", ended.stderr);
}

/// A killed process leaves its folder; the next process removes it.
#[test]
fn folders_of_killed_processes_go_with_the_next_start() {
    let place = Place::new();
    let temporary = tempfile::tempdir().unwrap();
    let left = || std::fs::read_dir(temporary.path()).unwrap().count();
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let vary = "motion.traction_coefficient=0.01..0.59/60";
    let arguments =
        ["sweep", &file, "--set", "mech.model=hertz-carter", "--vary", vary, "--out", &out];
    let launch = |arguments: &[&str]| {
        let mut command = place.command(arguments);
        command.env("TMPDIR", temporary.path());
        place.launch(command)
    };
    let sweep = launch(&arguments);
    wait_until("some points", || points(&place.out()).len() > 3);
    sweep.signal(rustix::process::Signal::KILL);
    sweep.wait();
    assert_eq!(left(), 1);
    let ended = launch(&[
        "sweep",
        &file,
        "--set",
        "mech.model=hertz-carter",
        "--vary",
        "motion.traction_coefficient=0.1,0.2",
        "--out",
        &out,
        "--replace",
    ])
    .wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(left(), 0);
    place.assert_nothing_left();
}

/// Points from the rows of a table, where the last one exceeds the friction limit; and from a Latin
/// hypercube, reproducible by its seed.
#[test]
fn points_may_come_from_a_table_or_a_seed() {
    let place = Place::new();
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let points = place.out().with_file_name("points.csv");
    let rows =
        "motion.speed,load.normal_force,motion.traction_coefficient\n20,60 kN,0.3\n40,134 kN,0.7\n";
    std::fs::write(&points, rows).unwrap();
    let points = points.display().to_string();
    let sweep = |more: &[&str]| {
        let fixed =
            ["sweep", &file, "--set", "mech.model=hertz-carter", "--out", &out, "--replace"];
        let ended = place.start(&[&fixed[..], more].concat()).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        table(&place.out())
    };
    let of_table = sweep(&["--table", &points]);
    assert_eq!(of_table.texts("load.normal_force"), ["60 kN", "134 kN"]);
    let failed = of_table.texts("failed");
    assert!(failed[0].is_empty() && failed[1].contains("0.7 is not below"), "{failed:?}");
    let vary =
        ["--vary", "motion.speed=10..60/6", "--vary", "motion.traction_coefficient=0.1..0.5/6"];
    let latin = |seed: &str| -> Vec<String> {
        let table = sweep(&[&vary[..], &["--latin", seed]].concat());
        let values = table.texts("motion.traction_coefficient");
        values.into_iter().map(str::to_owned).collect()
    };
    let [one, same, other] = ["1", "1", "2"].map(latin);
    assert_eq!((&one, one.len()), (&same, 6));
    assert_ne!(one, other);
    place.assert_nothing_left();
}

/// Two of three parts run separately; the sweep that collects them runs the third. The table equals
/// that of a single sweep.
#[test]
fn parts_are_collected_and_what_is_missing_is_run() {
    let place = Place::new();
    let file = case("wheel-rail.toml");
    let vary = "motion.traction_coefficient=0.1..0.7/7";
    let sweep = |name: &str, more: &[&str]| {
        let out = place.out().with_file_name(name).display().to_string();
        let fixed =
            ["sweep", &file, "--set", "mech.model=hertz-carter", "--vary", vary, "--out", &out];
        let ended = place.start(&[&fixed[..], more].concat()).wait();
        (ended, out)
    };
    let parts = ["1/3", "3/3"].map(|part| {
        let (ended, out) = sweep(&part.replace('/', "-"), &["--part", part]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        out
    });
    let rows = |out: &str| table(Path::new(out)).texts("motion.traction_coefficient").len();
    assert_eq!([rows(&parts[0]), rows(&parts[1])], [3, 2]);
    let (ended, collected) = sweep("all", &["--collect", &parts[0], &parts[1]]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("5 points collected, 2 points missing, run now"),
        "{}",
        ended.stderr
    );
    let (ended, whole) = sweep("whole", &["--jobs", "1"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let [collected, whole] = [collected, whole].map(|out| table(Path::new(&out)));
    for key in [
        "motion.traction_coefficient",
        "temperature.rail.max_rise_k",
        "contact.creepage_xi",
        "failed",
    ] {
        assert_eq!(collected.texts(key), whole.texts(key), "{key}");
    }
    let out = place.out().display().to_string();
    let other = ["sweep", &file, "--vary", vary, "--out", &out, "--collect", &parts[0]];
    let ended = place.start(&other).wait();
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    let words = "mech.model: was hertz-carter, is half-space";
    assert!(ended.stderr.contains(words), "{}", ended.stderr);
    place.assert_nothing_left();
}

#[test]
fn what_cannot_vary_is_told() {
    let place = Place::new();
    let told = |vary: &str, text: &str| {
        let ended = place.start(&["sweep", &case("wheel-rail.toml"), "--vary", vary]).wait();
        assert_eq!(ended.code, Some(2), "{vary}: {}", ended.stderr);
        assert!(ended.stderr.contains(text), "{vary}: {}", ended.stderr);
    };
    told("motion.speed", "has no key, or no values");
    told("motion.speed=1..x/3", "an end that is not a number");
    told("motion.sped=1,2", "motion.speed");
}

/// A sweep in which all points fail ends with an error, but writes its table.
#[test]
fn a_sweep_without_any_answer_has_failed() {
    let place = Place::new();
    let (file, out) = (case("falling-friction.toml"), place.out().display().to_string());
    let settings =
        sets(&["mech.model=half-space", "mech.resolution=8", "coupling.max_iterations=2"]);
    let study = ["sweep", &file, "--vary", "motion.speed=38,39", "--out", &out];
    let ended = place.start(&[&study[..], &settings].concat()).wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("failed at every point: "), "{}", ended.stderr);
    assert!(table(&place.out()).texts("failed").iter().all(|why| why.contains("not converged")));
}
