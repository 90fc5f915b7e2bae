//! Files of results: fields on the centre line, series, histories, and the summary.

use crate::harness::{Place, case, completed};
use tests::harness::field;

/// Figs. 5 to 7 of the paper: traction along the centre line, at the bound f p in the slip zone at
/// the trailing edge, and below it in the stick zone, where there is no slip.
#[test]
fn the_centre_line_shows_traction_and_slip() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &["--set", "motion.traction_coefficient=0.4"]);
    let contact = place.table("fields/mech_contact_000000.csv");
    let [x, p, t] = ["x [m]", "pressure [Pa]", "traction_x [Pa]"].map(|name| contact.numbers(name));
    let slip = place.table("fields/mech_passage_000000.csv").numbers("slip_velocity_x [m/s]");
    assert_eq!(x.len(), 83);
    let touching: Vec<usize> = (0..x.len()).filter(|&i| p[i] > 0.0).collect();
    let slips = |i: usize| t[i] > 0.6 * p[i] * (1.0 - 1e-9);
    let border = touching.iter().position(|&i| !slips(i)).unwrap();
    assert!(border > 10 && border < 70, "{border}");
    // The bound of the leading element is so small that it may slip too.
    for (k, &i) in touching[..touching.len() - 1].iter().enumerate() {
        assert_eq!(slips(i), k < border, "{i}");
        // The slip in the stick zone is limited by the tolerance of the iteration. The border lies
        // inside an element, which slips on one side of it.
        let slides = slip[i] < 0.0 && k <= border;
        assert!(if k < border { slides } else { slides || slip[i].abs() < 1e-4 }, "{}", slip[i]);
    }
}

/// The stored case reproduces the results.
#[test]
fn the_case_as_run_can_be_run() {
    let (first, second) = (Place::new(), Place::new());
    let set = ["--set", "motion.traction_coefficient=0.4", "--set", "mech.resolution=10"];
    let one = first.summary(&case("wheel-rail.toml"), &set);
    let two = second.summary(&first.out().join("case.toml").display().to_string(), &[]);
    for part in ["contact", "temperature", "effects"] {
        assert_eq!(one[part], two[part]);
    }
}

/// A transient run writes a series of fields, and a row for every window; the last row equals the
/// summary.
#[test]
fn every_window_leaves_its_figures() {
    let place = Place::new();
    let summary = place.summary(&case("cold-start.toml"), &[]);
    let series = std::fs::read_to_string(place.out().join("fields/thermal_contact.pvd")).unwrap();
    // Every tenth of 51 windows, and the last one.
    assert_eq!(series.matches("<DataSet").count(), 6, "{series}");
    assert!(series.contains("thermal_contact_000050.vti"));
    let table = std::fs::read_to_string(place.out().join("iterations.csv")).unwrap();
    assert_eq!(table.lines().count(), 52);
    let history = place.table("history.csv");
    assert_eq!(history.rows.len(), 51);
    assert_eq!(history.head[..5], ["window", "start_s", "end_s", "status", "iterations"]);
    let last = history.rows.last().unwrap();
    assert_eq!(last[3], "completed");
    for (key, cell) in history.head.iter().zip(last).skip(5) {
        let found = summary.pointer(&format!("/{}", key.replace('.', "/")));
        let expected = found.map(|value| value.as_f64().unwrap());
        assert_eq!(cell.parse().ok(), expected, "{key}");
    }
    // No column is empty.
    for name in &history.head {
        assert!(history.texts(name).iter().any(|cell| !cell.is_empty()), "{name}");
    }
    let rise = history.numbers("temperature.rail.max_rise_k");
    // The rise increases until the field is steady; later changes are rounding.
    assert!(rise[..15].is_sorted() && rise[0] < 0.5 * rise[50], "{rise:?}");
}

/// Every third window and the last one leave fields, with time and values of that window: the toys
/// count.
#[test]
fn fields_are_those_of_the_window_that_names_them() {
    let settings = ["time.end=8", "output.fields=all", "output.every=3"];
    let (place, _) = completed("exchange.toml", &settings);
    let folder = place.out().join("fields");
    let series = std::fs::read_to_string(folder.join("left_numbers.pvd")).unwrap();
    let windows = [2_u32, 5, 7];
    assert_eq!(series.matches("<DataSet").count(), windows.len(), "{series}");
    for window in windows {
        let file = format!("left_numbers_{window:06}.vti");
        let entry = format!("timestep=\"{}e0\" file=\"{file}\"", window + 1);
        assert!(series.contains(&entry), "`{entry}` is missing in {series}");
        // Each participant adds one to what it received, twice in a window.
        let values = field(&folder.join(file), "left_value");
        assert_eq!(values, vec![f64::from(2 * window + 1); 1000]);
    }
}

/// A participant that describes no figures is not asked for any.
#[test]
fn a_run_without_figures_has_a_history_of_its_windows() {
    let place = Place::new();
    place.summary(&case("exchange.toml"), &["--set", "time.end=10"]);
    let history = place.table("history.csv");
    assert_eq!((history.head.len(), history.rows.len()), (5, 10));
}

/// A quantity that a model does not provide is absent, never 0.
#[test]
fn absent_is_not_zero() {
    let place = Place::new();
    let summary = place.summary(&case("full-slip.toml"), &[]);
    let contact = summary["contact"].as_object().unwrap();
    assert!(!contact.contains_key("approach_m"), "the patch is given: no approach is known");
    assert!(!contact.contains_key("spin_moment_nm"));
    assert!(contact.contains_key("slip_area_ratio"));
}

#[test]
fn a_name_cannot_lead_out_of_the_results() {
    for name in ["../../evil", "/tmp/abs", "a/b", "", "x\\ny", ".hidden"] {
        let set = format!("case.name=\"{name}\"");
        let ended = Place::new().plan(&case("exchange.toml"), &["--set", &set]);
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        assert!(ended.stderr.contains("case.name: "), "{}", ended.stderr);
    }
}

/// The cost accounts for the whole time of a run: all parts are present, and none exceeds the
/// total.
#[test]
fn the_cost_has_all_its_parts() {
    let place = Place::new();
    let summary = place.summary(&case("exchange.toml"), &["--set", "time.end=100"]);
    let cost = |key: &str| summary["cost"][key].as_f64().unwrap_or_else(|| panic!("no {key}"));
    let parts = ["plan_s", "start_s", "coupling_s", "output_s", "finish_s"].map(cost);
    assert!(parts.iter().all(|part| *part > 0.0), "{}", summary["cost"]);
    assert!(parts.iter().sum::<f64>() <= cost("wall_s"), "{}", summary["cost"]);
}
