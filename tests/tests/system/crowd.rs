//! Many simultaneous runs on one machine.

use crate::harness::{Place, case};

#[test]
fn twenty_runs_at_the_same_time_do_not_disturb_each_other() {
    let first = Place::new();
    let places: Vec<Place> = (0..20).map(|_| first.neighbour()).collect();
    let deadlines =
        ["--set", "coupling.start_deadline=120", "--set", "coupling.heartbeat_deadline=120"];
    let runs: Vec<_> = places
        .iter()
        .enumerate()
        .map(|(index, place)| {
            let end = format!("time.end={}", 20 + index);
            let mut more = vec!["--set", &end];
            more.extend(deadlines);
            place.start_run(&case("exchange.toml"), &more)
        })
        .collect();
    for ((index, place), run) in places.iter().enumerate().zip(runs) {
        let ended = run.wait();
        assert_eq!(ended.code, Some(0), "run {index}: {}", ended.stderr);
        assert_eq!(place.read_summary()["coupling"]["windows"], 20 + index);
        place.assert_nothing_left();
    }
    drop(places);
    first.assert_nothing_left();
}
