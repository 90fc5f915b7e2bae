//! Interrupting and killing a coordinator that waits for a Slurm array.

use rustix::process::Signal;
use std::collections::BTreeSet;
use tests::harness::slurm::Slurm;
use tests::harness::sweeps::{points, table};
use tests::harness::{Place, case, wait_until};

/// Ctrl-C cancels the array and keeps the finished points. If the coordinator is killed, the array
/// continues, and the next coordinator waits for it. No point runs twice.
#[test]
fn a_sweep_that_is_stopped_goes_on() {
    let (place, slurm) = (Place::new(), Slurm::new());
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let vary =
        ["--vary", "motion.traction_coefficient=0.01..0.59/90", "--set", "mech.resolution=10"];
    let fixed = [&["sweep", &file], &vary[..]].concat();
    let through = ["--engine", "slurm", "--parts", "3", "--out", &out];
    let start = || {
        let mut command = place.command(&[&fixed[..], &through].concat());
        command.env("SLURM_CONF", slurm.configuration());
        place.launch(command)
    };
    let begun = |count| {
        let parts = ["1-of-3", "2-of-3", "3-of-3"].map(|part| place.out().join("parts").join(part));
        wait_until("points", || parts.iter().map(|part| points(part).len()).sum::<usize>() > count);
    };
    let sweep = start();
    begun(4);
    sweep.signal(Signal::INT);
    let ended = sweep.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    assert_eq!(slurm.tasks(), 0, "the array is cancelled");
    let first = points(&place.out());
    assert!(!first.is_empty() && first.len() < 90, "{}", first.len());

    let sweep = start();
    begun(first.len() + 4);
    let array = std::fs::read(place.out().join("array.json")).unwrap();
    sweep.signal(Signal::KILL);
    sweep.wait();
    assert!(slurm.tasks() > 0, "the array goes on");
    let other = place.start(&[&fixed[..], &["--out", &out]].concat()).wait();
    assert_eq!(other.code, Some(2), "{}", other.stderr);
    assert!(other.stderr.contains("wait for it with --engine slurm"), "{}", other.stderr);
    let sweep = start();
    let ended = sweep.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(!place.out().join("array.json").exists(), "{array:?} has ended");
    let all: BTreeSet<String> = points(&place.out()).into_iter().collect();
    assert_eq!(all.len(), 90);
    assert!(first.iter().all(|line| all.contains(line)), "run again, they would take another time");
    assert_eq!(table(&place.out()).rows.len(), 90);
    place.assert_nothing_left();
}
