//! Results do not depend on the number of threads, bit for bit: for every model of every solver of
//! ours, in every mode it offers. A new model is tested as soon as it is registered.

use crate::harness::{Place, case, sets};
use proto::description::{Description, ModelSpec};
use proto::model::Solver;
use serde_json::Value;

/// Windows of a transient run.
const WINDOWS: &str = r#"time={mode="transient", window="20 us", end="100 us"}"#;

/// Results of a run with this number of threads: fields and figures, without the cost.
fn answer(threads: usize, name: &str, settings: &[&str]) -> (Vec<u8>, Value) {
    let limit = format!("limits.threads={threads}");
    let place = Place::new();
    let mut summary = place.summary(&case(name), &sets(&[settings, &[&limit]].concat()));
    summary.as_object_mut().unwrap().remove("cost");
    let fields = std::fs::read(place.out().join("fields/last.bin")).unwrap();
    let plan = std::fs::read_to_string(place.out().join("plan.json")).unwrap();
    let plan: Value = serde_json::from_str(&plan).unwrap();
    for participant in plan["participants"].as_array().unwrap() {
        assert_eq!(participant["threads"], threads, "in a serial scheme everybody has all");
    }
    (fields, summary)
}

fn same_answers(role: &str, model: &ModelSpec, name: &str, settings: &[&str]) {
    let chosen = format!("{role}.model={}", model.name);
    let modes = [(model.steady, None), (model.transient, Some(WINDOWS))];
    for (_, mode) in modes.into_iter().filter(|(offered, _)| *offered) {
        let settings: Vec<&str> =
            settings.iter().copied().chain([chosen.as_str()]).chain(mode).collect();
        let (one, two) = (answer(1, name, &settings), answer(2, name, &settings));
        assert!(one.0 == two.0, "fields of {} with {settings:?}", model.name);
        assert_eq!(one.1, two.1, "figures of {} with {settings:?}", model.name);
    }
}

/// Tests every model on a suitable case, with these settings.
fn models_of(solver: &Description, case: impl Fn(&str) -> (&'static str, &'static [&'static str])) {
    assert!(!solver.models.is_empty());
    for model in &solver.models {
        let (name, settings) = case(&model.name);
        same_answers(&solver.role, model, name, settings);
    }
}

#[test]
fn mechanical_models_answer_the_same_on_any_number_of_threads() {
    models_of(&mech_solver::MechSolver.description(), |model| match model {
        // Volume elements cost more than surface elements.
        "explicit-fe" => ("wheel-rail.toml", &["mech.resolution=3", "materials.steel.density=2e5"]),
        "periodic" => ("brake-block.toml", &["mech.resolution=64"]),
        "rod" => ("thermo-elastic-rod.toml", &[]),
        "conformal" => ("contact/conformal-corner.toml", &["mech.resolution=8"]),
        "wheel-on-track" => ("wheel-on-track.toml", &["mech.resolution=10"]),
        _ => ("wheel-rail.toml", &["mech.resolution=12"]),
    });
}

/// The grid is large enough for two threads to share it.
#[test]
fn thermal_models_answer_the_same_on_any_number_of_threads() {
    models_of(&thermal_solver::ThermalSolver.description(), |model| match model {
        "periodic" => ("brake-block.toml", &["mech.resolution=64"]),
        "rod" => ("thermo-elastic-rod.toml", &[]),
        _ => ("full-slip.toml", &["mech.resolution=100", "coupling.scheme=serial-explicit"]),
    });
}

/// Threads process independent rows of a history, including one without a solution.
#[test]
fn rows_of_a_history_are_the_same_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let rows = folder.path().join("rows.csv");
    let places = (0..11).map(|row| if row == 6 { 0.2 } else { 5e-4 * f64::from(row) });
    let lines: String = places.enumerate().map(|(row, y)| format!("{row}, {y}\n")).collect();
    std::fs::write(&rows, format!("row, y\n{lines}")).unwrap();
    let column =
        |key: &str, name: &str| format!("{key}={{file='{}', column='{name}'}}", rows.display());
    let [y, row] = [column("wheelset.y", "y"), column("time.history", "row")];
    let history = |threads: usize| {
        let place = Place::new();
        let limit = format!("limits.threads={threads}");
        let settings = [y.as_str(), &row, "mech.resolution=5", &limit];
        let summary = place.summary(&case("wheelset-lateral.toml"), &sets(&settings));
        assert_eq!(summary["coupling"]["windows"], 10);
        std::fs::read_to_string(place.out().join("history.csv")).unwrap()
    };
    let one = history(1);
    assert_eq!(one, history(2));
    assert_eq!(one, history(3));
    assert_eq!(one.lines().count(), 12);
}

/// Participants that solve in parallel share the threads: the remainder goes to the first ones, and
/// each has at least one.
#[test]
fn a_parallel_scheme_shares_the_threads() {
    for (limit, shares) in [(5, [3, 2]), (1, [1, 1])] {
        let place = Place::new();
        let limit = format!("limits.threads={limit}");
        let settings = ["time.end=2", "coupling.scheme=parallel-explicit", &limit];
        place.summary(&case("exchange.toml"), &sets(&settings));
        let plan = std::fs::read_to_string(place.out().join("plan.json")).unwrap();
        let plan: Value = serde_json::from_str(&plan).unwrap();
        let threads = [0, 1].map(|index| plan["participants"][index]["threads"].as_u64().unwrap());
        assert_eq!(threads, shares);
        let text = std::fs::read_to_string(place.out().join("plan.txt")).unwrap();
        assert!(text.contains(&format!("toy, {} thread", shares[0])), "{text}");
    }
}
