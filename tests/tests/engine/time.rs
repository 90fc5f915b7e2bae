//! Time: adaptive windows, subcycling, and conservation of heat.

use crate::harness::{Place, case, completed, number, root, sets};
use serde_json::Value;

/// Runs the lumped pair with these settings and returns the summary.
fn lumped(settings: &[&str]) -> Value {
    completed("lumped.toml", settings).1
}

fn error(summary: &Value) -> f64 {
    number(summary, "/body/largest_error")
}

/// Number of windows solved, including repeated ones.
fn solved(summary: &Value) -> u64 {
    let count = |key: &str| summary["coupling"][key].as_u64().unwrap_or(0);
    count("windows") + count("repeated_windows")
}

/// The requested error is met, with or without an announced step, in about half as many windows,
/// including repeated ones, as the coarsest sufficient fixed grid. A run begins with the shortest
/// window, as after a jump, so that the part covered by the first fixed window is judged too. There
/// the cold body warms from zero, and the window length grows with the square root of time. This
/// takes 22 and 44 of the windows, which is why the ratio is not quite one half.
#[test]
fn a_load_step_is_met_with_fewer_windows_than_a_fixed_grid_needs() {
    let page = std::fs::read_to_string(root().join("docs/theory/coupling.md")).unwrap();
    for (tolerance, shown) in [(1e-2, "10⁻²"), (3e-3, "3·10⁻³")] {
        let mut counts = Vec::new();
        let fixed = (0..)
            .map(|n| 400.0 * 1.25_f64.powi(n))
            .map(|windows| lumped(&[&format!("time.window={}", 40.0 / windows.round())]))
            .find(|summary| error(summary) <= tolerance)
            .unwrap();
        for announce in [false, true] {
            let adaptive = lumped(&[
                "time.control=adaptive",
                &format!("time.tolerance={tolerance}"),
                &format!("source.announce={announce}"),
            ]);
            let (found, windows) = (error(&adaptive), solved(&adaptive));
            assert!(found <= tolerance, "{tolerance}, {announce}: {found:e}");
            let most = solved(&fixed);
            println!("{tolerance} {announce}: {windows} with {found:e}, {most} fixed");
            assert!(20 * windows < 11 * most, "{tolerance}, {announce}: {windows} against {most}");
            let lengths = ["/coupling/shortest_window_s", "/coupling/longest_window_s"];
            let [shortest, longest] = lengths.map(|pointer| number(&adaptive, pointer));
            assert!(longest / shortest > 100.0, "{shortest} to {longest}");
            counts.push(windows);
        }
        counts.push(solved(&fixed));
        let row = page.lines().find(|line| line.starts_with(&format!("| {shown} |"))).unwrap();
        let words = row.split('|').filter_map(|cell| cell.split_whitespace().next());
        let told: Vec<u64> = words.filter_map(|word| word.parse().ok()).collect();
        assert_eq!(told, counts, "docs/theory/coupling.md is stale at {shown}");
    }
}

/// A window that is shortened to end at the announced step ends there, and the last window ends at
/// the end of the run.
#[test]
fn windows_end_where_a_participant_wants_and_at_the_end() {
    let place = Place::new();
    let more = ["time.control=adaptive", "time.tolerance=1e-2", "source.announce=true"];
    place.summary(&case("lumped.toml"), &sets(&more));
    let ends = place.table("iterations.csv").numbers("end_s");
    assert_eq!(*ends.last().unwrap(), 40.0);
    // start + (step − start) rounds once.
    let step = 3.1234;
    assert!(ends.iter().any(|end| (end - step).abs() <= f64::EPSILON * step));
}

/// A window that does not converge is halved until it does: plain iteration converges only if the
/// gain of the loop, which grows with the window, is below one.
#[test]
fn a_window_that_does_not_converge_is_repeated_with_a_shorter_one() {
    let stiff = ["lumped.gain=20", "coupling.acceleration=none", "time.window=0.5", "time.end=4"];
    let place = Place::new();
    let more = sets(&stiff);
    let ended = place.run(&case("lumped.toml"), &more);
    assert_eq!(ended.code, Some(3), "fixed windows end the run: {}", ended.stderr);
    let adaptive = lumped(&[&stiff[..], &["time.control=adaptive", "time.tolerance=0.1"]].concat());
    assert_eq!(adaptive["status"], "converged");
    assert!(adaptive["coupling"]["repeated_windows"].as_u64().unwrap() >= 2, "{adaptive}");
}

/// Repeating a window requires inputs that can be supplied again.
#[test]
fn adaptive_windows_with_a_late_field_are_refused() {
    let place = Place::new();
    let more = ["time.control=adaptive", "coupling.scheme=serial-explicit"];
    let ended = place.run(&case("lumped.toml"), &sets(&more));
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("lags by one window"), "{}", ended.stderr);
}

/// Over a run with subcycling, the heat sent by the source, the heat received by the body, and the
/// heat stored and lost are equal. The tolerance 1e-10 is far above the rounding of some thousand
/// windows and far below the error of a step.
fn heat_is_conserved(source: u32, body: u32, course: &str) {
    let substeps = [format!("source.substeps={source}"), format!("body.substeps={body}")];
    let course = format!("coupling.interpolation={course}");
    for control in ["time.control=fixed", "time.control=adaptive"] {
        let more = [&substeps[0], &substeps[1], &course, control, "time.end=10"];
        let summary = lumped(&more);
        let books = ["/source/sent_j", "/body/received_j", "/body/stored_j", "/body/lost_j"];
        let [sent, received, stored, lost] = books.map(|at| number(&summary, at));
        assert!(sent > 5.0, "{sent} J");
        assert!((sent - received).abs() <= 1e-10 * sent, "{more:?}: {sent} {received}");
        assert!((received - stored - lost).abs() <= 1e-10 * sent, "{more:?}");
        assert!(number(&summary, "/coupling/energy_imbalance") <= 1e-10);
    }
}

table_of_tests! { heat_is_conserved:
    heat_is_conserved_by_one_substep_against_seven(1, 7, "constant");
    heat_is_conserved_by_seven_substeps_against_one(7, 1, "constant");
    heat_is_conserved_by_three_substeps_against_seven(3, 7, "constant");
    heat_is_conserved_by_one_substep_against_seven_on_a_line(1, 7, "linear");
    heat_is_conserved_by_seven_substeps_against_one_on_a_line(7, 1, "linear");
    heat_is_conserved_by_three_substeps_against_seven_on_a_line(3, 7, "linear");
}

/// The coupling is of first order with a constant temperature within a window, and of second order
/// with a linear one, resolved by seven midpoints.
#[test]
fn a_straight_line_within_the_window_raises_the_order() {
    // Windows aligned with the step, which would otherwise limit the order.
    let base = ["lumped.step_at=2", "time.end=8", "source.substeps=7", "body.substeps=7"];
    let order = |course: &str| {
        let errors = ["0.1", "0.05", "0.025"].map(|window| {
            let (course, window) =
                (format!("coupling.interpolation={course}"), format!("time.window={window}"));
            error(&lumped(&[&base[..], &[&course, &window]].concat()))
        });
        println!("{course}: {errors:?}");
        (errors[1] / errors[2]).log2()
    };
    let (constant, linear) = (order("constant"), order("linear"));
    assert!((0.9..1.1).contains(&constant), "{constant}");
    assert!((1.9..2.1).contains(&linear), "{linear}");
}
