//! Restart: a run that is stopped in any window and resumed gives the same results as an
//! uninterrupted run, bit for bit. Runs whose process is killed are in `system/resume.rs`.

use crate::harness::{Place, Table, case, field_files, sets, solvers_that_stop_at};
use serde_json::Value;

/// Results of a run that do not depend on the speed of the machine.
#[derive(Debug, PartialEq)]
struct Results {
    /// Content of every field file.
    fields: Vec<(String, Vec<u8>)>,
    /// Table of iterations without run times.
    table: Table,
    /// Figures of every window.
    history: Table,
    /// Summary, with the cost reduced to the bytes exchanged.
    summary: Value,
}

fn results(place: &Place) -> Results {
    let timeless = |head: &str| !head.ends_with("_s") || head == "start_s" || head == "end_s";
    let mut summary = place.read_summary();
    let cost = summary.as_object_mut().unwrap().remove("cost").unwrap();
    summary["bytes_exchanged"] = cost["bytes_exchanged"].clone();
    let table = place.table("iterations.csv").of(timeless);
    let history = place.table("history.csv");
    Results { fields: field_files(&place.out()), table, history, summary }
}

/// Runs a case without interruption; then stops it by a window without solution, in the middle and
/// at the last window, and resumes it. All results must be identical.
fn stopped_and_resumed(name: &str, settings: &[&str]) {
    let (case, more) = (case(name), sets(settings));
    let undisturbed = Place::new();
    let windows = undisturbed.summary(&case, &more)["coupling"]["windows"].as_u64().unwrap();
    let expected = results(&undisturbed);
    let every = settings.iter().find_map(|set| set.strip_prefix("output.checkpoint_every="));
    let every: u64 = every.unwrap().parse().unwrap();
    for window in [(windows + every) / 2, windows - 1] {
        let place = Place::new();
        let stopped = place.run_with(&case, &more, &solvers_that_stop_at(window));
        assert_eq!(stopped.code, Some(1), "{settings:?}: {}", stopped.stderr);
        assert_eq!(place.read_summary()["status"], "failed");
        let ended = place.resume();
        assert_eq!(ended.code, Some(0), "{settings:?}: {}", ended.stderr);
        let resumed_at = place.read_summary()["cost"]["resumed_at_window"].as_u64().unwrap();
        assert_eq!(resumed_at, window / every * every, "{settings:?}");
        let found = results(&place);
        assert_eq!(found.summary, expected.summary, "{settings:?}");
        assert_eq!(found.table, expected.table, "{settings:?}");
        assert_eq!(found.history, expected.history, "{settings:?}");
        assert!(found.fields == expected.fields, "{settings:?}: a field file differs");
    }
}

fn history_survives(acceleration: &str, scheme: &str) {
    let acceleration = format!("coupling.acceleration={acceleration}");
    let scheme = format!("coupling.scheme={scheme}");
    let settings = [
        acceleration.as_str(),
        &scheme,
        "coupling.predictor=linear",
        "linear.problem=P4",
        "linear.size=500",
        "coupling.relative=1e-9",
        "time.end=60",
        "output.fields=all",
        "output.every=7",
        "output.checkpoint_every=5",
    ];
    stopped_and_resumed("linear.toml", &settings);
}

table_of_tests! { history_survives:
    the_history_of_iqn_ils_survives("iqn-ils", "serial-implicit");
    the_history_of_iqn_imvj_survives("iqn-imvj", "serial-implicit");
    the_history_of_iqn_ils_in_parallel_survives("iqn-ils", "parallel-implicit");
    the_history_of_aitken_in_parallel_survives("aitken", "parallel-implicit");
}

/// Fields delayed by a window in an explicit scheme are restored.
fn a_late_window_survives(scheme: &str) {
    let scheme = format!("coupling.scheme={scheme}");
    let settings =
        [scheme.as_str(), "time.end=60", "output.fields=all", "output.checkpoint_every=10"];
    stopped_and_resumed("exchange.toml", &settings);
}

table_of_tests! { a_late_window_survives:
    what_is_a_window_late_in_series_survives("serial-explicit");
    what_is_a_window_late_in_parallel_survives("parallel-explicit");
}

#[test]
fn adaptive_windows_and_interpolation_survive() {
    let settings = [
        "time.control=adaptive",
        "coupling.interpolation=linear",
        "coupling.predictor=linear",
        "source.substeps=7",
        "time.tolerance=5e-3",
        "time.end=10",
        "output.fields=all",
        "output.every=10",
        "output.checkpoint_every=8",
    ];
    stopped_and_resumed("lumped.toml", &settings);
}

/// The real solvers: mechanics without memory, a thermal solver with memory of all windows.
#[test]
fn a_transient_of_the_real_solvers_survives() {
    let settings = ["mech.resolution=16", "output.every=5", "output.checkpoint_every=3"];
    stopped_and_resumed("cold-start.toml", &settings);
}

/// A restart restores the steel of each body: the wheel transforms, the rail stays below A_c1.
#[test]
fn transforming_steel_survives() {
    let settings = ["mech.resolution=10", "output.every=5", "output.checkpoint_every=3"];
    stopped_and_resumed("locked-wheel-white-layer.toml", &settings);
}

/// Elements in motion, on an axle that rises over a joint. Steps in heavy steel are longer.
#[test]
fn elements_that_roll_over_a_joint_survive() {
    let settings = [
        "mech.resolution=2",
        "effects.suspension.at=5e-2",
        "materials.steel.density=1e5",
        "time.end=6e-4",
        "output.every=3",
        "output.checkpoint_every=2",
    ];
    stopped_and_resumed("rail-joint.toml", &settings);
}

/// Mapped fields and the tractions of transient rolling are restored.
#[test]
fn mapping_and_transient_rolling_survive() {
    let settings = [
        "mech.resolution=10",
        "thermal.resolution=27",
        "mech.model=half-space",
        "mech.rolling=transient",
        "output.every=5",
        "output.checkpoint_every=3",
    ];
    stopped_and_resumed("cold-start.toml", &settings);
}

/// Moving grids are restored to their positions, and the last outputs to the grids they were on.
fn a_moving_grid_survives(motion: &str, scheme: &str, (direct, interpolation): (bool, &str)) {
    let motion = format!("mover.motion={motion}");
    let scheme = format!("coupling.scheme={scheme}");
    let direct = format!("plate.direct={direct}");
    let interpolation = format!("coupling.interpolation={interpolation}");
    let settings = [
        motion.as_str(),
        &scheme,
        &direct,
        &interpolation,
        "moving.gain=0.1",
        "time.end=24",
        "plate.resolution=40",
        "output.fields=all",
        "output.every=3",
        "output.checkpoint_every=2",
    ];
    stopped_and_resumed("moving.toml", &settings);
}

table_of_tests! { a_moving_grid_survives:
    a_patch_that_moves_survives("translate", "serial-implicit", (false, "linear"));
    a_patch_that_grows_survives("grow", "serial-explicit", (false, "constant"));
    a_patch_that_grows_and_is_heard_on_survives("grow", "serial-implicit", (true, "constant"));
    a_patch_that_stretches_survives("stretch", "parallel-implicit", (false, "linear"));
    a_patch_that_stretches_and_is_heard_on_survives("stretch", "parallel-implicit", (true, "constant"));
}

/// A checkpoint does not contain a volume: its geometry follows from the state of its participant.
fn a_volume_survives(hexahedra: &str, swells: &str) {
    let (hexahedra, swells) =
        (format!("volume.hexahedra={hexahedra}"), format!("volume.swells={swells}"));
    let settings = [
        hexahedra.as_str(),
        &swells,
        "volume.elements=48",
        "time.end=40",
        "output.every=3",
        "output.checkpoint_every=2",
    ];
    stopped_and_resumed("volume.toml", &settings);
}

table_of_tests! { a_volume_survives:
    a_volume_that_stays_survives("rectilinear", "false");
    a_volume_that_moves_survives("unstructured", "true");
}
