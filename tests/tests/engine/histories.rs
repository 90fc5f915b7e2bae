//! Histories: columns of tables, sequences of steady contacts, and rows without a solution.

use crate::harness::{Place, case, sets};
use std::fs;
use std::path::{Path, PathBuf};

/// Table in a folder of its own, used as a source of key values.
struct Data {
    folder: tempfile::TempDir,
}

impl Data {
    fn new(text: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("run.csv"), text).unwrap();
        Self { folder }
    }

    fn file(&self) -> PathBuf {
        self.folder.path().join("run.csv")
    }

    /// Option that sets a key to a column of the table: `--set key={column of the table}`.
    fn column(&self, key: &str, name: &str) -> String {
        format!("{key}={{file=\"{}\",column=\"{name}\"}}", self.file().display())
    }
}

/// Reads columns of a table by their names.
pub(crate) fn rows(file: &Path, columns: &[&str]) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at: Vec<usize> = columns
        .iter()
        .map(|column| names.iter().position(|name| name == column).expect(column))
        .collect();
    let number = |text: &str| if text.is_empty() { f64::NAN } else { text.parse().unwrap() };
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            at.iter().map(|index| number(cells[*index])).collect()
        })
        .collect()
}

const RISE: &str = "temperature.rail.max_rise_k";
const FORCE: &str = "contact.creep_force_x_n";
const CREEP: &str = "contact.creepage_xi";

/// Every row of a sequence equals the steady case with its values on the same grids: bit for bit
/// after a cold start, and within the accuracy of the solver after a warm start. The slip zones are
/// longer than a/2: elements of steady cases follow shorter ones.
#[test]
fn a_row_is_a_steady_case_of_its_own() {
    let data = Data::new("t [s], mu\n0, 0.36\n1, 0.5\n2.5, 0.4\n");
    let column = data.column("motion.traction_coefficient", "mu");
    for model in ["hertz-carter", "fastsim", "half-space"] {
        let model = format!("mech.model={model}");
        let common = [model.as_str(), "mech.resolution=10"];
        for start in ["cold", "warm"] {
            let start = format!("mech.start={start}");
            let place = Place::new();
            let mut set: Vec<&str> = common.to_vec();
            set.extend([column.as_str(), "time.mode=sequence", &start]);
            let summary = place.summary(&case("wheel-rail.toml"), &sets(&set));
            assert_eq!(summary["coupling"]["windows"], 3);
            let found = rows(&place.out().join("history.csv"), &[FORCE, CREEP, RISE]);
            assert_eq!(found.len(), 3);
            for (mu, row) in ["0.36", "0.5", "0.4"].into_iter().zip(&found) {
                let alone = format!("motion.traction_coefficient={mu}");
                let set = [common[0], common[1], &alone];
                let alone = Place::new().summary(&case("wheel-rail.toml"), &sets(&set));
                for (key, value) in [FORCE, CREEP, RISE].into_iter().zip(row) {
                    let expected = key.split('.').fold(&alone, |at, part| &at[part]);
                    let expected = expected.as_f64().unwrap();
                    // Residual of the tractions accepted by the solver, 1e-4 of the largest
                    // traction.
                    let tolerance = if start.ends_with("warm") { 1e-4 } else { 0.0 };
                    let error = (value / expected - 1.0).abs();
                    assert!(error <= tolerance, "{model} {start} {mu} {key}: {value} {expected}");
                }
            }
        }
    }
}

/// A force beyond the friction limit has no solution: the run ends at that row, or skips and
/// reports it.
#[test]
fn a_row_without_an_answer_ends_the_run_or_is_marked() {
    let data = Data::new("t [s], mu\n0, 0.2\n1, 0.9\n2, 0.25\n");
    let column = data.column("motion.traction_coefficient", "mu");
    let common = ["mech.model=hertz-carter", "mech.resolution=5", "time.mode=sequence", &column];
    let place = Place::new();
    let ended = place.run(&case("wheel-rail.toml"), &sets(&common));
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("in window 1"), "{}", ended.stderr);
    assert!(ended.stderr.contains("friction limit"), "{}", ended.stderr);
    let place = Place::new();
    let skip = [&common[..], &["time.on_failure=skip"]].concat();
    let summary = place.summary(&case("wheel-rail.toml"), &sets(&skip));
    assert_eq!(summary["coupling"]["rows_without_answer"], 1);
    assert_eq!(summary["coupling"]["windows"], 2);
    assert_eq!(summary["warnings"][0]["key"], "time.on_failure", "{}", summary["warnings"]);
    let found = rows(&place.out().join("history.csv"), &["window", FORCE]);
    let [first, second, third] = &found[..] else { panic!("{found:?}") };
    assert_eq!([first[0], second[0], third[0]], [0.0, 1.0, 2.0]);
    assert!(first[1] > 0.0 && second[1].is_nan() && third[1] > first[1], "{found:?}");
}

/// The last row is as plausible as the first one; the middle one slides and glows.
#[test]
fn what_is_implausible_in_any_row_is_told() {
    let data = Data::new("t [s], xi\n0, -0.001\n1, -0.3\n2, -0.001\n");
    let column = data.column("motion.creepage.xi", "xi");
    let more = ["mech.model=hertz-carter", "mech.resolution=5", "time.mode=sequence", &column];
    let place = Place::new();
    let unset = ["--unset", "motion.traction_coefficient"];
    let summary = place.summary(&case("wheel-rail.toml"), &[&sets(&more)[..], &unset].concat());
    let told = |key: &str| {
        let list = summary["warnings"].as_array().unwrap();
        let found = list.iter().find(|warning| warning["key"] == key);
        let found = found.unwrap_or_else(|| panic!("{key}: {list:?}"));
        assert_eq!(found["quantity"], "value in row 2", "{found}");
        found["value"].as_f64().unwrap()
    };
    assert_eq!(told("contact.creepage_xi"), -0.3);
    assert!(told("temperature.rail.max_rise_k") > 700.0);
}

/// The summary of a sequence contains the extremes with their rows, besides the figures of the last
/// row. Its table contains the varying inputs with units, and no empty column.
#[test]
fn a_sequence_is_summarised_by_its_extremes() {
    let data = Data::new("t, v [km/h]\n0, 40\n7.9, 140\n10, 60\n");
    let column = data.column("motion.speed", "v");
    let time = data.column("time.history", "t");
    let place = Place::new();
    let set = ["mech.resolution=8", "time.mode=sequence", &column, &time];
    let ended = place.run(&case("wheel-rail.toml"), &sets(&set));
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary = place.read_summary();
    let found = rows(&place.out().join("history.csv"), &["end_s", "motion.speed [m/s]", RISE]);
    assert!((found[1][1] - 140.0 / 3.6).abs() < 1e-12, "{found:?}");
    let number = |pointer: &str| summary.pointer(pointer).unwrap().as_f64().unwrap();
    assert_eq!(number("/extremes/largest/temperature/rail/max_rise_k"), found[1][2]);
    assert_eq!(number("/extremes/smallest/temperature/rail/max_rise_k"), found[0][2]);
    assert_eq!(number("/temperature/rail/max_rise_k"), found[2][2]);
    assert_eq!(summary["extremes"]["rows"], 3);
    for told in ["over all", "at 7.900 s", "the lines below describe the last row"] {
        assert!(ended.stdout.contains(told), "{told}: {}", ended.stdout);
    }
    let text = fs::read_to_string(place.out().join("history.csv")).unwrap();
    let cells: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    for (n, name) in cells[0].iter().enumerate() {
        assert!(cells[1..].iter().any(|row| !row[n].is_empty()), "{name}");
    }
}

/// The summary describes the last row with a solution.
#[test]
fn a_last_row_without_an_answer_leaves_the_summary_of_the_one_before() {
    let data = Data::new("mu\n0.2\n0.9\n");
    let column = data.column("motion.traction_coefficient", "mu");
    let common = ["mech.resolution=5", "time.mode=sequence", "time.on_failure=skip", &column];
    for model in ["mech.model=hertz-carter", "mech.model=fastsim", "mech.model=half-space"] {
        let place = Place::new();
        let summary =
            place.summary(&case("wheel-rail.toml"), &sets(&[&common[..], &[model]].concat()));
        assert_eq!(summary["coupling"]["rows_without_answer"], 1, "{model}");
        let carried = summary["contact"]["traction_coefficient"].as_f64().unwrap();
        assert!(
            (carried / 0.2 - 1.0).abs() < 1e-4,
            "tolerance of the tractions, {model}: {carried}"
        );
    }
}

/// A row that is solved but rejected does not affect the summary, including wear: the result equals
/// that of a run without the row.
#[test]
fn a_row_that_wears_too_much_leaves_nothing() {
    let rows = "row, passages, N [kN]\n0, 100, 60\n1, 100, 60\n";
    let [without, with] = [rows.to_owned(), format!("{rows}2, 4e8, 130\n")].map(|table| {
        let data = Data::new(&table);
        let [passes, load, row] = [
            ("effects.wear.passes", "passages"),
            ("load.normal_force", "N"),
            ("time.history", "row"),
        ]
        .map(|(key, name)| data.column(key, name));
        let set = ["mech.resolution=8", "time.on_failure=skip", &passes, &load, &row];
        let mut summary = Place::new().summary(&case("worn-profile.toml"), &sets(&set));
        let skipped = summary["coupling"]["rows_without_answer"].take();
        (["contact", "wear", "temperature"].map(|section| summary[section].take()), skipped)
    });
    assert_eq!((&without.1, &with.1), (&serde_json::json!(0), &serde_json::json!(1)));
    // Both grids have the size of their largest row; the tolerance is that of the tractions.
    for body in ["wheel", "rail"] {
        for key in ["depth_per_passage_m", "max_depth_m", "worn_area_m2"] {
            let [one, other] = [&without, &with].map(|run| run.0[1][body][key].as_f64().unwrap());
            assert!((one / other - 1.0).abs() < 1e-4, "{body} {key}: {one} {other}");
        }
    }
    assert!(without.0[1].to_string().contains("depth_per_passage_m"), "{}", without.0[1]);
    let number = |of: &serde_json::Value| of["max_pressure_pa"].as_f64().unwrap();
    assert!((number(&with.0[0]) / number(&without.0[0]) - 1.0).abs() < 0.05, "{with:?}");
}

/// Friction that falls with temperature does not converge in two iterations, in any row.
#[test]
fn a_sequence_without_any_answer_has_failed() {
    let data = Data::new("V [m/s]\n38\n39\n");
    let place = Place::new();
    let set = [
        "mech.model=half-space",
        "mech.resolution=8",
        "time.mode=sequence",
        "time.on_failure=skip",
        "coupling.max_iterations=2",
        &data.column("motion.speed", "V"),
    ];
    let ended = place.run(&case("falling-friction.toml"), &sets(&set));
    assert_eq!(ended.code, Some(3), "{}", ended.stderr);
    assert!(ended.stderr.contains("not converged in window 1"), "{}", ended.stderr);
    let summary = fs::read_to_string(place.out().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "failed");
    assert_eq!(summary["coupling"]["rows_without_answer"], 2);
}

/// A transient case interpolates linearly between rows, and keeps the last values beyond the last
/// row if the case says so.
#[test]
fn a_transient_case_interpolates() {
    let data = Data::new("t [ms], Q [kN]\n0, 60\n1, 80\n2, 80\n");
    let (load, time) = (data.column("load.normal_force", "Q"), data.column("time.history", "t"));
    let place = Place::new();
    let set = [
        "mech.model=hertz-carter",
        "mech.resolution=5",
        "time.mode=transient",
        "time.window=0.25 ms",
        "time.end=3 ms",
        &load,
        &time,
    ];
    let refused = Place::new().run(&case("wheel-rail.toml"), &sets(&set));
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    let told = "the rows are from 0 to 0.002 s, and the run is from 0 to 0.003 s";
    assert!(refused.stderr.contains(told), "{}", refused.stderr);
    let set = [&set[..], &["time.beyond=hold"]].concat();
    place.summary(&case("wheel-rail.toml"), &sets(&set));
    let found = rows(&place.out().join("history.csv"), &["end_s", "contact.normal_force_n"]);
    assert_eq!(found.len(), 12);
    for row in found {
        // Middle of the window.
        let expected = 60e3 + 20e3 * ((row[0] - 0.125e-3) / 1e-3).min(1.0);
        assert!((row[1] / expected - 1.0).abs() < 1e-12, "rounding: {row:?} {expected}");
    }
}

#[test]
fn what_is_wrong_with_a_history_is_told() {
    let data = Data::new("t [s], Q [kN]\n0, 60\n1, -5\n");
    let good = data.column("load.normal_force", "Q");
    let told = |set: &[&str], text: &str| {
        let ended = Place::new().run(&case("wheel-rail.toml"), &sets(set));
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        assert!(ended.stderr.contains(text), "`{text}` is missing in:\n{}", ended.stderr);
    };
    told(&[&good, "time.mode=sequence"], "-5000 N in line 3 is not above 0 N");
    let data = Data::new("t [s], Q [kN]\n1, 60\n0, 50\n");
    let (load, time) = (data.column("load.normal_force", "Q"), data.column("time.history", "t"));
    told(&[&load], "a steady case has a single instant");
    told(
        &[&load, &time, "time.mode=sequence"],
        "does not rise in column `t` from line 2 to line 3",
    );
    told(&[&data.column("load.normal_force", "q"), "time.mode=sequence"], "did you mean `Q`?");
    told(&[&data.column("mech.resolution", "Q"), "time.mode=sequence"], "accepts only a number");
    let transient = ["time.mode=transient", "time.window=1 ms", "time.end=2 ms"];
    told(&[&[load.as_str()], &transient[..]].concat(), "time.history");
}

/// Tables in the formats of vehicle dynamics programs give the same run. An invalid table is
/// reported once.
#[test]
fn tables_of_other_programs_are_read() {
    let plain = "t [s], v [km/h], Q [kN]\n0, 108, 60\n1, 90, 80.5\n";
    let others = [
        "\u{feff}Q;v;state;t\r\nkN;km/h;-;s\r\n60;108;run;0\r\n80,5;90;brake;1\r\n",
        "t\tstate\tv [m/s]\tQ (kN)\n0\trun\t30,0\t60\n1\tbrake\t25\t80,5\n",
    ];
    let history = |text: &str| {
        let data = Data::new(text);
        let [time, speed, load] =
            [("time.history", "t"), ("motion.speed", "v"), ("load.normal_force", "Q")]
                .map(|(key, name)| data.column(key, name));
        let set = ["mech.model=hertz-carter", "time.mode=sequence", &time, &speed, &load];
        let place = Place::new();
        place.summary(&case("wheel-rail.toml"), &sets(&set));
        fs::read_to_string(place.out().join("history.csv")).unwrap()
    };
    let expected = history(plain);
    for text in others {
        assert_eq!(history(text), expected, "{text}");
    }
    let broken = Data::new("t,v,Q\n0,30,60\n1,25\n");
    let set = [
        "time.mode=sequence",
        &broken.column("time.history", "t"),
        &broken.column("motion.speed", "v"),
    ]
    .map(str::to_owned);
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    let ended = Place::new().run(&case("wheel-rail.toml"), &sets(&set));
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert_eq!(ended.stderr.matches("2 cells in line 3").count(), 1, "{}", ended.stderr);
    assert!(ended.stderr.contains("1 error"), "{}", ended.stderr);
}

/// Different units in the header and in the case are ambiguous and are rejected.
#[test]
fn units_of_the_header_and_of_the_case_must_agree() {
    let data = Data::new("t [s], v [km/h]\n0, 108\n");
    let speed = |unit: &str| {
        let column =
            format!("motion.speed={{file={:?},column=\"v\",unit=\"{unit}\"}}", data.file());
        Place::new().run(
            &case("wheel-rail.toml"),
            &sets(&["time.mode=sequence", "mech.model=hertz-carter", &column]),
        )
    };
    assert_eq!(speed("km/h").code, Some(0));
    let ended = speed("m/s");
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    let told = "has the unit km/h in the header of column `v`, and the case says m/s";
    assert!(ended.stderr.contains(told), "{}", ended.stderr);
}

/// Implausible values in tables warn like those of keys: absolute temperatures in °C, columns in
/// the wrong order, a row of a history.
#[test]
fn unlikely_values_of_tables_are_told() {
    let data = Data::new("20, 53, 440\n1200, 30, 650\n");
    let told = |name: &str, set: &[&str], text: &str| {
        let ended = Place::new().plan(&case(name), &sets(set));
        let said = crate::harness::flat(&format!("{}{}", ended.stdout, ended.stderr));
        assert!(said.contains(text), "`{text}` is missing in:\n{said}");
    };
    let table = format!("materials.steel.thermal_table={}", data.file().display());
    told(
        "hot-steel.toml",
        &[&table],
        "has a temperature in line 1 of 20 K, at least 100 K is expected",
    );
    let data = Data::new("293, 440, 53\n1473, 650, 30\n");
    let table = format!("materials.steel.thermal_table={}", data.file().display());
    told("hot-steel.toml", &[&table], "has a conductivity in line 1 of 440 W/(m K)");
    let data = Data::new("v [m/s]\n30\n300\n");
    let speed = data.column("motion.speed", "v");
    let set = ["time.mode=sequence", "mech.model=hertz-carter", &speed];
    told("wheel-rail.toml", &set, "motion.speed has a value in row 2 of its table of 300 m/s");
    told(
        "falling-friction.toml",
        &["coupling.relative=2"],
        "coupling.relative is 2, at most 1 is expected",
    );
}

/// The run warns of a peak between the middles of adaptive windows. The advised `time.window_max`
/// finds it.
#[test]
fn a_peak_that_adaptive_windows_miss_is_told() {
    let data = Data::new("t [s],Q [kN]\n0,100\n0.0006,100\n0.0007,300\n0.0008,100\n0.04,100\n");
    let settings = [
        data.column("load.normal_force", "Q"),
        data.column("time.history", "t"),
        "time.end=1.4 ms".to_owned(),
        "time.tolerance=0.1".to_owned(),
        "time.control=adaptive".to_owned(),
        "mech.model=hertz-carter".to_owned(),
        "mech.resolution=5".to_owned(),
    ];
    let warned = |window: &str, longest: &str| {
        let times = [format!("time.window={window}"), format!("time.window_max={longest}")];
        let words: Vec<&str> = settings.iter().chain(&times).map(String::as_str).collect();
        let summary = Place::new().summary(&case("cold-start.toml"), &sets(&words));
        let warnings = summary["warnings"].as_array().cloned().unwrap_or_default();
        warnings
            .into_iter()
            .filter(|warning| warning["key"] == "load.normal_force")
            .collect::<Vec<_>>()
    };
    let told = warned("0.3 ms", "1 ms");
    let [warning] = told.as_slice() else { panic!("{told:?}") };
    let reason = warning["reason"].as_str().unwrap();
    assert!(reason.contains("reaches 300000 N at 7e-4 s"), "{reason}");
    let advised = warning["fix"].as_str().unwrap().split('"').nth(1).unwrap();
    let none: Vec<serde_json::Value> = Vec::new();
    assert_eq!(warned(advised, advised), none, "{advised}");
}
