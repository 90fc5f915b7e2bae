//! `coordinator sweep`: a row a point, failed points kept, a stopped sweep gone on with.

use crate::harness::Table;
use crate::harness::{Place, case, wait_until};
use crate::sweeps::points;
use std::path::Path;

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
    // Twice the speed takes twice the power and heats √2 times as much.
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

/// Killed in its middle: what it has found is there, a point or two that it was at are run again.
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

/// The rows of a table, the last of which asks for more than friction allows; and a Latin hypercube, the same with the same seed.
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

/// Two of three parts, made apart: the third is run by the sweep that collects them, whose table is that of one sweep alone.
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
    assert!(ended.stderr.contains("is of other points"), "{}", ended.stderr);
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
    told("motion.speed", "names no key with values");
    told("motion.speed=1..x/3", "an end that is no number");
    told("motion.sped=1,2", "motion.speed");
}
