//! Sweeps through real schedulers: Slurm, and HyperQueue in a Python process.

use serde_json::Value;
use std::io::Write;
use std::process::{Command, Stdio};
use tests::harness::python::interpreter_with_packages;
use tests::harness::slurm::Slurm;
use tests::harness::sweeps::{points, table};
use tests::harness::{Place, case, root, wait_until};

/// The table equals that of a sweep without a scheduler, bit for bit, even if a task is killed.
/// Only the part of that task is lost; it is reported, submitted again and completed.
#[test]
fn a_task_that_dies_loses_its_part_only() {
    let (place, slurm) = (Place::new(), Slurm::new());
    let file = case("wheel-rail.toml");
    // The last values exceed the friction limit.
    let vary =
        ["--vary", "motion.traction_coefficient=0.01..0.62/60", "--set", "mech.resolution=10"];
    let whole = place.out().with_file_name("whole").display().to_string();
    let fixed = [&["sweep", &file], &vary[..]].concat();
    let ended = place.start(&[&fixed[..], &["--out", &whole]].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);

    let out = place.out().display().to_string();
    let through = [
        "--engine",
        "slurm",
        "--parts",
        "3",
        "--engine-options",
        "--cpus-per-task=1",
        "--out",
        &out,
    ];
    let mut command = place.command(&[&fixed[..], &through].concat());
    command.env("SLURM_CONF", slurm.configuration());
    let sweep = place.launch(command);
    let part = place.out().join("parts/2-of-3");
    wait_until("a point of the second part", || !points(&part).is_empty());
    let array: Value =
        serde_json::from_slice(&std::fs::read(place.out().join("array.json")).unwrap()).unwrap();
    let task = format!("{}_2", array["id"].as_str().unwrap());
    slurm.said("scancel", &["--full", "--signal=KILL", &task]);
    let ended = sweep.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("missing: motion.traction_coefficient = "), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("(part 2)") && !ended.stderr.contains("(part 1)"),
        "{}",
        ended.stderr
    );
    assert_eq!(table(&place.out()), table(whole.as_ref()));
    assert_eq!(slurm.tasks(), 0);
    place.assert_nothing_left();
}

/// Commands of the parts, for any scheduler. After their end the resumed sweep finds no missing
/// points.
#[test]
fn a_list_of_commands_is_run_by_hyperqueue() {
    let place = Place::new();
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let vary = ["--vary", "motion.speed=10..60/7", "--set", "mech.model=hertz-carter"];
    let fixed = [&["sweep", &file], &vary[..], &["--out", &out]].concat();
    let listed = place.start(&[&fixed[..], &["--engine", "list", "--parts", "3"]].concat()).wait();
    assert_eq!(listed.code, Some(0), "{}", listed.stderr);
    assert_eq!(listed.stdout.lines().count(), 3, "{}", listed.stdout);

    let mut cluster = Command::new(interpreter_with_packages())
        .arg(root().join("proto/python/examples/hyperqueue_commands.py"))
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    cluster.stdin.take().unwrap().write_all(listed.stdout.as_bytes()).unwrap();
    let ended = cluster.wait_with_output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    let before: Vec<String> = ["1-of-3", "2-of-3", "3-of-3"]
        .iter()
        .flat_map(|part| points(&place.out().join("parts").join(part)))
        .collect();
    assert_eq!(before.len(), 7);

    let ended = place.start(&fixed).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let after = points(&place.out());
    assert!(
        after.len() == 7 && before.iter().all(|line| after.contains(line)),
        "nothing is run again"
    );
    let whole = place.out().with_file_name("whole").display().to_string();
    let ended = place.start(&[&fixed[..fixed.len() - 1], &[&*whole]].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(table(&place.out()), table(whole.as_ref()));
    place.assert_nothing_left();
}
