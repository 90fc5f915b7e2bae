//! Implicit coupling of the linear pair: number of iterations, accuracy, and the error message on
//! failure to converge.

use crate::harness::{Place, case, sets};
use serde_json::Value;

/// Runs the pair with these settings and asserts convergence. Returns the summary.
fn linear(place: &Place, settings: &[&str]) -> Value {
    let more = sets(settings);
    let summary = place.summary(&case("linear.toml"), &more);
    assert_eq!(summary["status"], "converged", "{settings:?}");
    assert_eq!(summary["coupling"]["windows"], 10);
    summary
}

/// Number of iterations over ten windows. The bound on the relative error is the tolerance 1e-6
/// divided by 0.05, the smallest eigenvalue of I − M.
fn iterations(settings: &[&str]) -> u64 {
    let summary = linear(&Place::new(), settings);
    let error = summary["linear"]["true_error"].as_f64().unwrap();
    assert!(error <= 1e-6 / 0.05, "{settings:?}: {error:e}");
    assert!(summary["coupling"]["final_residual"].as_f64().unwrap() <= 1e-6);
    summary["coupling"]["iterations"].as_u64().unwrap()
}

fn counts(acceleration: &str, problems: &[&str]) -> Vec<u64> {
    let acceleration = format!("coupling.acceleration={acceleration}");
    let of = |name: &&str| iterations(&[&acceleration, &format!("linear.problem={name}")]);
    problems.iter().map(of).collect()
}

const ALL: [&str; 6] = ["P1", "P2", "P3", "P4", "P5", "P6"];

/// preCICE's IQN-ILS needs 73, 48, 34, 34, 92 and 117 iterations.
#[test]
fn work_of_quasi_newton() {
    assert_eq!(counts("iqn-ils", &ALL), [73, 46, 33, 34, 92, 117]);
    assert_eq!(counts("iqn-imvj", &ALL), [116, 96, 46, 44, 160, 216]);
    assert_eq!(counts("anderson", &ALL), [323, 145, 91, 131, 544, 874]);
}

/// preCICE's Aitken needs 453, 160, 107, 274 and 2002 iterations.
#[test]
fn work_of_aitken() {
    assert_eq!(counts("aitken", &ALL[..5]), [453, 160, 107, 274, 2002]);
}

#[test]
fn what_diverges_ends_with_exit_code_3_and_says_so() {
    for (problem, acceleration) in
        [("P6", "aitken"), ("P6", "constant"), ("P6", "none"), ("P2", "none"), ("P3", "none")]
    {
        let place = Place::new();
        let problem = format!("linear.problem={problem}");
        let acceleration = format!("coupling.acceleration={acceleration}");
        let more = ["--set", &problem, "--set", &acceleration];
        let ended = place.run(&case("linear.toml"), &more);
        assert_eq!(ended.code, Some(3), "{more:?}: {}", ended.stderr);
        let told = "error: the coupling diverged in window 0, iteration ";
        assert!(ended.stderr.contains(told), "{}", ended.stderr);
        assert!(ended.stderr.contains("set coupling.acceleration to \"iqn-ils\""));
        let summary = place.read_summary();
        assert_eq!(summary["status"], "failed");
        assert!(summary["reason"].as_str().unwrap().contains("diverged"));
    }
}

#[test]
fn too_few_iterations_end_the_run_unless_the_case_is_not_strict() {
    let place = Place::new();
    let few = ["--set", "coupling.max_iterations=5"];
    let ended = place.run(&case("linear.toml"), &few);
    assert_eq!(ended.code, Some(3));
    let told = "the coupling has not converged in window 0, iteration 5: the relative residual of \
                `operator_value`";
    assert!(ended.stderr.contains(told), "{}", ended.stderr);
    let table = std::fs::read_to_string(place.out().join("iterations.csv")).unwrap();
    assert_eq!(table.lines().count(), 6, "every iteration is told");
    let lenient = [&few[..], &["--set", "coupling.strict=false"]].concat();
    let summary = place.summary(&case("linear.toml"), &lenient);
    assert_eq!(summary["status"], "completed");
    assert!(summary["reason"].as_str().unwrap().contains(" windows have not converged"));
}

/// A parallel scheme feeds back both fields and finds the same fixed point.
#[test]
fn a_parallel_scheme_finds_the_same_solution() {
    let settings = ["coupling.scheme=parallel-implicit", "linear.problem=P3"];
    let (serial, parallel) = (Place::new(), Place::new());
    linear(&serial, &settings[1..]);
    let summary = linear(&parallel, &settings);
    assert!(summary["linear"]["true_error"].as_f64().unwrap() <= 2e-5);
    let table = std::fs::read_to_string(parallel.out().join("iterations.csv")).unwrap();
    assert!(table.starts_with("window,iteration,start_s,end_s,residual,residual_relay_value,"));
    let iterations = summary["coupling"]["iterations"].as_u64().unwrap();
    assert_eq!(iterations, 61, "33 in a serial scheme: two passes do the work of one");
}

#[test]
fn every_iteration_has_a_row_that_tells_its_residual_and_its_columns() {
    let place = Place::new();
    let summary = linear(&place, &["linear.problem=P4", "linear.seed=7"]);
    let table = place.table("iterations.csv");
    let (at, rows) = (|name: &str| table.find(name).unwrap(), &table.rows);
    assert_eq!(rows.len() as u64, summary["coupling"]["iterations"].as_u64().unwrap());
    for pair in rows.windows(2) {
        let (row, next) = (&pair[0], &pair[1]);
        let residual: f64 = row[at("residual_operator_value")].parse().unwrap();
        let last = row[0] != next[0];
        assert_eq!(residual <= 1e-6, last, "{row:?}");
        assert_eq!(row[at("columns")].is_empty(), last, "{row:?}");
        assert!(row[at("operator_s")].parse::<f64>().unwrap() >= 0.0);
    }
    assert_eq!(rows[0][at("relaxation")], "5e-1", "the first iteration has nothing to go by");
    assert_eq!(rows[1][at("relaxation")], "");
}

#[test]
fn a_field_can_have_a_tolerance_of_its_own() {
    let place = Place::new();
    let own = ["coupling.fields.operator_value.relative=1e-3", "linear.problem=P4"];
    let more = sets(&own);
    let loose = place.summary(&case("linear.toml"), &more);
    let iterations = loose["coupling"]["iterations"].as_u64().unwrap();
    assert!(iterations < 34, "{iterations}: 34 are needed for 1e-6");
}

/// A field that goes forward follows the iterates. If it has a tolerance of its own, this tolerance
/// takes effect, and its residual has a column.
#[test]
fn a_field_that_goes_forward_can_be_tested() {
    let loose = ["coupling.fields.operator_value.relative=0.5", "linear.problem=P4"];
    let tight = [&loose[..], &["coupling.fields.relay_value.relative=1e-6"]].concat();
    let places = [Place::new(), Place::new()];
    let [few, many] = [(&places[0], &loose[..]), (&places[1], &tight)].map(|(place, set)| {
        place.summary(&case("linear.toml"), &sets(set));
        place.table("iterations.csv")
    });
    assert_eq!(few.find("residual_relay_value"), None);
    let columns = ["residual_operator_value", "residual_relay_value"];
    let columns = columns.map(|name| many.find(name).unwrap());
    for pair in many.rows.windows(2) {
        let [operator, relay] = columns.map(|at| pair[0][at].parse::<f64>().unwrap());
        assert_eq!(operator <= 0.5 && relay <= 1e-6, pair[0][0] != pair[1][0], "{pair:?}");
    }
    assert!(2 * few.rows.len() < many.rows.len(), "{} {}", few.rows.len(), many.rows.len());
}
