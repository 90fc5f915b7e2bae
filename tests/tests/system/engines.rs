//! Sweeps through a scheduler that is absent. The target `external` tests real ones.

use crate::harness::{Place, case};

/// A scheduler that is absent has no log to look into.
#[test]
fn an_absent_scheduler_is_told_with_what_to_do() {
    let place = Place::new();
    let file = case("wheel-rail.toml");
    let vary = ["--vary", "motion.speed=10,20", "--set", "mech.model=hertz-carter"];
    let asked = [&["sweep", &file, "--out", &place.out().display().to_string()], &vary[..]];
    let ended = place.start(&[&asked.concat()[..], &["--engine", "hyperqueue"]].concat()).wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let told = ["hq: No such file", "--engine list", "run-on-a-cluster.md"];
    assert!(told.iter().all(|words| ended.stderr.contains(words)), "{}", ended.stderr);
    assert!(!ended.stderr.contains(".log"), "{}", ended.stderr);
    place.assert_nothing_left();
}
