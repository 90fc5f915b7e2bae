//! `coordinator conform`: our solvers and the examples pass. A participant that breaks a rule is
//! told which one, and every check can fail.

mod contract;

use crate::harness::compiled::Compiled;
use crate::harness::python::interpreter;
use crate::harness::{Ended, Place, case, programs, root, toy};
use serde_json::Value;

/// Runs the conformance checks on a program; returns the outcome and the report.
fn conform(role: &str, case: &str, options: &[&str], command: &[String]) -> (Ended, Value) {
    let place = Place::new();
    let mut arguments = vec!["conform", "--role", role, "--case", case, "--json"];
    arguments.extend(options);
    if !command.is_empty() {
        arguments.push("--");
    }
    arguments.extend(command.iter().map(String::as_str));
    let ended = place.start(&arguments).wait();
    place.assert_nothing_left();
    let report = serde_json::from_str(&ended.stdout).unwrap_or_default();
    (ended, report)
}

/// Names of the checks with this verdict.
fn with_verdict<'a>(report: &'a Value, verdict: &str) -> Vec<&'a str> {
    let rows = report["checks"].as_array().unwrap().iter();
    rows.filter(|row| row["verdict"] == verdict).map(|row| row["name"].as_str().unwrap()).collect()
}

/// Asserts that every applicable check passes; returns the number of settings.
fn assert_conforms(
    role: &str,
    case: &str,
    (options, command): (&[&str], &[String]),
    inapplicable: &[&str],
) -> usize {
    let (ended, report) = conform(role, case, options, command);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stderr, ended.stdout);
    assert_eq!(with_verdict(&report, "failed"), Vec::<&str>::new());
    assert_eq!(with_verdict(&report, "inapplicable"), inapplicable);
    assert!(!with_verdict(&report, "passed").is_empty());
    report["settings"].as_array().unwrap().len()
}

/// Asserts that exactly one check was made, and failed with these words.
fn assert_fails((ended, report): &(Ended, Value), check: &str, words: &str) {
    assert_eq!(ended.code, Some(1), "{check}: {}\n{}", ended.stderr, ended.stdout);
    assert_eq!(with_verdict(report, "failed"), [check], "{}", ended.stdout);
    let seen = report["checks"][0]["seen"].as_str().unwrap();
    assert!(seen.contains(words), "{check}: `{words}` is missing in: {seen}");
    assert!(ended.stderr.contains(check), "{}", ended.stderr);
}

/// Coarse grids: the size of the inputs follows from the contact they are generated for.
const COARSE: [&str; 2] = ["--set", "mech.resolution=2"];

/// Also prescribed creepage, so that no model searches for it.
const CREEPAGE: [&str; 6] = [
    COARSE[0],
    COARSE[1],
    "--unset",
    "motion.traction_coefficient",
    "--set",
    "motion.creepage.xi=-0.003",
];

/// Checks that do not apply to a mechanical solver that runs alone.
const ALONE: [&str; 6] =
    ["received-power", "growing-grids", "volumes", "missing-sample", "wrong-sample", "not-finite"];

/// Asserts that a solver of ours passes with every model, on coarse grids, in the given number of
/// settings.
fn ours_conform(role: &str, name: &str, options: &[&str], inapplicable: &[&str], settings: usize) {
    assert_eq!(assert_conforms(role, &case(name), (options, &[]), inapplicable), settings);
}

/// Checks that concern the model rather than the participant; all checks run in the target
/// `nightly`.
const OF_MODELS: [&str; 6] = ["configure", "initialise", "solve", "repeat", "restore", "figures"];

#[test]
fn the_mechanical_solver_conforms_with_every_model() {
    // Heavy steel lets explicit elements take longer steps.
    let mut options = [&CREEPAGE[..], &["--set", "materials.steel.density=1e6"]].concat();
    options.extend(OF_MODELS.iter().flat_map(|check| ["--only", *check]));
    ours_conform("mech", "wheel-rail.toml", &options, &[], 10);
}

/// Mechanics that read temperatures: models whose friction depends on them. One model goes through
/// all checks.
#[test]
fn the_mechanical_solver_conforms_in_a_loop() {
    let name = "falling-friction.toml";
    let quick = [&COARSE[..], &["--quick"]].concat();
    let steady = ["received-power", "other-end", "no-duration", "volumes"];
    ours_conform("mech", name, &quick, &steady, 1);
    let of_inputs = ["missing-sample", "wrong-sample", "not-finite"];
    let only = OF_MODELS.iter().chain(&of_inputs).flat_map(|check| ["--only", *check]);
    let options: Vec<&str> = COARSE.into_iter().chain(only).collect();
    ours_conform("mech", name, &options, &[], 6);
}

/// A fixed volume, and one that moves in every window.
#[test]
fn a_participant_with_a_volume_conforms() {
    let command = toy("volume");
    let mut alone = vec!["missing-key"];
    alone.extend(ALONE.iter().filter(|check| **check != "volumes"));
    alone.push("figures");
    for set in ["volume.hexahedra=rectilinear", "volume.swells=true"] {
        let options = &["--set", set][..];
        assert_eq!(assert_conforms("volume", &case("volume.toml"), (options, &command), &alone), 2);
    }
    let script = root().join("tests/tests/system/python/volume.py").display().to_string();
    let compiled = Compiled::from("proto/c/tests/volume.c");
    let volume = case("volume.toml");
    assert_eq!(assert_conforms("volume", &volume, (&[], &[compiled.path()]), &alone), 2);
    // Python starts slowly: one setting, which is steady.
    let python = [interpreter().display().to_string(), script];
    let mut steady = alone.clone();
    steady.splice(2..2, ["other-end", "no-duration"]);
    assert_eq!(assert_conforms("volume", &volume, (&["--quick"], &python), &steady), 1);
    for (fault, words) in [
        ("missing", "the geometry of the volume `block` is not given"),
        ("mirrored", "the volume `block` is given without geometry"),
    ] {
        let fault = format!("volume.fault={fault}");
        let options = ["--only", "volumes", "--set", &fault];
        assert_fails(
            &conform("volume", &case("volume.toml"), &options, &command),
            "volumes",
            words,
        );
    }
}

/// Quick checks only. Both modes and grids of 200 000 elements are in the target `nightly`.
#[test]
fn strip_columns_in_python_conform() {
    let program = root().join("proto/python/examples/strip_columns.py");
    let command = [interpreter(), &program].map(|path| path.display().to_string());
    let options = ["--quick", COARSE[0], COARSE[1]];
    let quick = (&options[..], &command[..]);
    let steady = ["other-end", "no-duration", "volumes"];
    let settings = assert_conforms("thermal", &case("falling-friction.toml"), quick, &steady);
    assert_eq!(settings, 1);
}

#[test]
fn the_closed_form_in_c_conforms() {
    let program = Compiled::from("proto/c/examples/closed_form.c");
    let steady = ["other-end", "no-duration", "volumes"];
    let command = [program.path()];
    let settings = assert_conforms("thermal", &case("wheel-rail.toml"), (&[], &command), &steady);
    assert_eq!(settings, 1);
}

/// Participant that counts its starts with `--join`.
pub(crate) fn counted(folder: &std::path::Path, program: &[String]) -> Vec<String> {
    let (first, arguments) = program.split_first().unwrap();
    let program = programs().join(first).display().to_string();
    let count = folder.join("count").display().to_string();
    let script = format!(
        "case \"$1\" in --join) echo >> {count};; esac; exec {program} {} \"$@\"",
        arguments.join(" ")
    );
    ["sh", "-c", &script, "sh"].map(str::to_owned).to_vec()
}

/// Further checks that concern the state of a model.
const OF_STATES: [&str; 7] =
    ["received-power", "other-end", "no-duration", "accept", "observe", "damaged-state", "reuse"];

/// The thermal solver passes with every model. Checks share processes, and `--quick` tests one
/// model on small grids, with all checks; those of every model are in the target `nightly`.
#[test]
fn the_thermal_solver_conforms_with_every_model_in_few_processes() {
    let folder = tempfile::tempdir().unwrap();
    let command = counted(folder.path(), &["thermal-solver".to_owned()]);
    let names = check_names();
    let only = OF_MODELS.iter().chain(&OF_STATES).flat_map(|check| ["--only", *check]);
    let options: Vec<&str> = COARSE.into_iter().chain(only).collect();
    let conforms = assert_conforms("thermal", &case("wheel-rail.toml"), (&options, &command), &[]);
    assert_eq!(conforms, 7);
    let starts = || {
        let count = std::fs::read_to_string(folder.path().join("count")).unwrap();
        std::fs::remove_file(folder.path().join("count")).unwrap();
        count.lines().count()
    };
    let all = starts();
    // Some checks start a run of their own, once or twice in each setting.
    assert!(all <= 146, "{all} processes for seven settings");
    let (ended, report) = conform("thermal", &case("wheel-rail.toml"), &["--quick"], &command);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(report["settings"].as_array().unwrap().len(), 1);
    assert!(report["left_out"][0].as_str().unwrap().contains("--quick"), "{report:#}");
    assert_eq!(report["checks"].as_array().unwrap().len(), names.len());
    let quick = starts();
    assert!(quick <= 29, "{quick} processes for a quick look");
}

/// A program that describes itself but fails to join: one failure, with its last words.
#[test]
fn a_participant_that_cannot_start_is_told_once() {
    let program = toy("left").join(" ");
    let script =
        format!("case \"$1\" in --join) echo no licence >&2; exit 3;; esac; exec {program} \"$@\"");
    let command = ["sh", "-c", &script, "sh"].map(str::to_owned);
    let (ended, report) = conform("left", &case("exchange.toml"), &[], &command);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert_eq!(with_verdict(&report, "failed"), ["describe"]);
    assert_eq!(with_verdict(&report, "not-made").len(), check_names().len() - 1);
    let seen = report["checks"][0]["seen"].as_str().unwrap();
    assert!(seen.contains("exit code 3") && seen.contains("no licence"), "{seen}");
}

/// The same message in several checks is reported as one cause.
#[test]
fn a_cause_is_told_once() {
    let rogue = toy("rogue");
    let checks = ["solve", "repeat", "accept"];
    let mut options = vec!["--set", "left.fault=silence"];
    options.extend(checks.iter().flat_map(|name| ["--only", name]));
    let (ended, report) = conform("left", &case("exchange.toml"), &options, &rogue);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert_eq!(with_verdict(&report, "failed"), checks);
    let same: Vec<_> =
        report["checks"].as_array().unwrap().iter().map(|row| &row["same_as"]).collect();
    assert!(same[0].is_null() && same[1..].iter().all(|one| *one == "solve"), "{report:#}");
}

/// Recorded fields replace generated ones: the heat is that of the run.
#[test]
fn recorded_inputs_are_used() {
    let place = Place::new();
    let summary = place.summary(&case("wheel-rail.toml"), &["--record"]);
    let recording = place.out().join("recording.mcap").display().to_string();
    let options = ["--recording", &recording, "--only", "received-power"];
    let (ended, report) = conform("thermal", &case("wheel-rail.toml"), &options, &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let power = summary["contact"]["friction_power_w"].as_f64().unwrap();
    let seen = report["checks"][0]["seen"].as_str().unwrap();
    assert!(seen.contains(&format!("{:.3} kW", 1e-3 * power)), "{seen}: {power:e} W");
}

/// The rogue breaks a label, a length or a number.
fn the_rogue_is_told(fault: &str, words: &str) {
    let rogue = toy("rogue");
    let fault = format!("left.fault={fault}");
    let options = ["--only", "solve", "--set", &fault];
    assert_fails(&conform("left", &case("exchange.toml"), &options, &rogue), "solve", words);
}

table_of_tests! { the_rogue_is_told:
    the_rogue_is_told_of_a_short_field("short", "field `left_value` has 999 values");
    the_rogue_is_told_of_a_wrong_label("label", "is labelled \"pressure\"");
    the_rogue_is_told_of_a_gap("sequence", "has sequence number 3, not 2");
    the_rogue_is_told_of_its_silence("silence", "it does not send `left_value`");
    the_rogue_is_told_of_an_old_reply("old-reply", "its reply has protocol 0");
    the_rogue_is_told_of_a_wrong_answer("wrong-answer", "it answers command 3 instead of 4");
}

/// If the rogue has no fault set, it solves correctly but sends no heartbeat and does not check its
/// inputs. All checks run, and none affects another.
#[test]
fn an_honest_rogue_goes_through_all_checks() {
    let rogue = toy("rogue");
    let options = ["--deadline", "10"];
    let (ended, report) = conform("left", &case("exchange.toml"), &options, &rogue);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let failed = with_verdict(&report, "failed");
    for check in ["version", "missing-sample", "malformed", "coordinator-dies", "heart"] {
        assert!(failed.contains(&check), "{check} passed: {failed:?}");
    }
    for check in ["describe", "configure", "initialise", "solve"] {
        assert!(with_verdict(&report, "passed").contains(&check), "{check} did not pass");
    }
    assert_eq!(report["checks"].as_array().unwrap().len(), check_names().len());
}

#[test]
fn a_participant_that_hangs_spoils_no_other_check() {
    let command = toy("left");
    let checks = ["describe", "solve", "unknown-command"];
    let mut options = vec!["--deadline", "4", "--set", "left.fault=hang"];
    options.extend(checks.iter().flat_map(|name| ["--only", name]));
    let (ended, report) = conform("left", &case("exchange.toml"), &options, &command);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert_eq!(with_verdict(&report, "failed"), ["solve"]);
    assert_eq!(with_verdict(&report, "passed"), ["describe", "unknown-command"]);
    let seen = report["checks"][1]["seen"].as_str().unwrap();
    assert!(seen.contains("Solve: no answer within 4 s"), "{seen}");
}

/// Python script of the tests, with a word before the standard arguments.
fn script(name: &str, word: &str) -> Vec<String> {
    let examples = root().join("proto/python/examples");
    let script = format!(
        "PYTHONPATH={} exec {} tests/tests/system/{name} {word} \"$@\"",
        examples.display(),
        interpreter().display()
    );
    ["sh", "-c", &script, "sh"].map(str::to_owned).to_vec()
}

fn faulty_python_is_told(fault: &str, check: &str, words: &str, deadline: &str) {
    let options = ["--only", check, "--deadline", deadline, COARSE[0], COARSE[1]];
    let command = script("python/faulty.py", fault);
    let told = conform("thermal", &case("falling-friction.toml"), &options, &command);
    assert_fails(&told, check, words);
}

table_of_tests! { faulty_python_is_told:
    python_is_told_of_an_error("raise", "solve", "ValueError: told to fail", "30");
    python_is_told_what_it_has_not_written("unwritten", "solve", "lower_temperature", "30");
    python_is_told_what_it_has_kept("keep-input", "solve", "friction_power", "30");
    python_is_told_of_its_end("exit", "solve", "ended with exit code 9", "30");
    python_is_told_that_it_sleeps("sleep", "solve", "no answer within 10 s", "10");
    python_is_told_of_an_error_in_accept("accept", "accept", "ValueError: told to fail", "30");
    python_is_told_of_its_refusal("refuse", "configure", "told to refuse", "30");
}

/// Names of all checks, from a report.
fn check_names() -> Vec<String> {
    let command = toy("future");
    let (_, report) = conform("left", &case("exchange.toml"), &[], &command);
    let rows = report["checks"].as_array().unwrap().iter();
    rows.map(|row| row["name"].as_str().unwrap().to_owned()).collect()
}

/// Each check has a participant that fails it for the tested reason.
mod every_check_can_fail {
    use super::{COARSE, assert_fails, case, check_names, conform, script, toy};
    use std::collections::BTreeSet;

    /// Nobody consumes a temperature in the scene of the tutorial: the observed field is checked.
    fn goes_astray_unconsumed(check: &str, words: &str) {
        let options = ["--only", check, COARSE[0], COARSE[1]];
        let command = script("conform/astray.py", check);
        assert_fails(
            &conform("thermal", &case("wheel-rail.toml"), &options, &command),
            check,
            words,
        );
    }

    table_of_tests! { goes_astray_unconsumed:
        repeat_can_fail_where_nobody_consumes("repeat", "accepted after several solves: `lower_temperature`");
        accept_can_fail_where_nobody_consumes("accept", "after an iteration that was not the last");
        restore_can_fail_where_nobody_consumes("restore", "the restored process continues differently");
    }

    fn goes_astray(check: &str, words: &str) {
        let options = ["--only", check, COARSE[0], COARSE[1]];
        let command = script("conform/astray.py", check);
        let told = conform("thermal", &case("falling-friction.toml"), &options, &command);
        assert_fails(&told, check, words);
    }

    /// The rogue fails checks that the library satisfies for every other participant.
    fn goes_rogue(check: &str, words: &str) {
        let rogue = toy("rogue");
        let options = ["--only", check, "--deadline", "10"];
        assert_fails(&conform("left", &case("exchange.toml"), &options, &rogue), check, words);
    }

    /// Defines a test for each check, with the same name.
    macro_rules! checks {
        ($($by:ident { $($check:ident: $words:literal,)+ })+) => {
            $($(
                #[test]
                fn $check() {
                    $by(&stringify!($check).replace('_', "-"), $words);
                }
            )+)+

            #[test]
            fn every_check_is_here() {
                let here = [$($(stringify!($check)),+),+].map(|check| check.replace('_', "-"));
                let sorted = |names: Vec<String>| BTreeSet::from_iter(names);
                assert_eq!(sorted(here.to_vec()), sorted(check_names()));
            }
        };
    }

    checks! {
        goes_astray {
            describe: "no summary or cites no source",
            configure: "a second Configure answers with another layout",
            missing_key: "is refused with the key `case`",
            initialise: "`lower_temperature` is not finite at index 0",
            solve: "`lower_temperature` is not finite at index 0",
            received_power: "the integral",
            repeat: "solved again with the same samples: `lower_temperature`[0]",
            other_end: "after another one",
            no_duration: "ended with exit code 3",
            accept: "after an iteration that was not the last",
            observe: "observing changes the next solve",
            restore: "the restored process continues differently",
            damaged_state: "in spite of a state truncated to 0 of",
            growing_grids: "too many elements",
            volumes: "element 0 has the volume -",
            figures: "instead of",
            reuse: "after another run of the process: `lower_temperature`[0]",
            finish: "`temperature.rail` of its summary is null",
        }
        goes_rogue {
            version: "999 is not named",
            unknown_model: "in spite of a model that does not exist",
            unknown_effect: "in spite of an effect that does not exist",
            unknown_field: "in spite of a field that it does not provide",
            missing_sample: "in spite of a sample that never arrived",
            wrong_sample: "in spite of a gap in the sequence numbers",
            not_finite: "in spite of NaN",
            unknown_command: "ended with exit code 1",
            malformed: "ended with exit code 1",
            out_of_order: "in spite of being sent too early",
            heart: "no heartbeat for",
            coordinator_dies: "it still runs 2 s later",
        }
    }
}

#[test]
fn what_cannot_be_asked_is_refused() {
    for (options, words) in [
        (["--only", "no-such-check"], "unknown check `no-such-check`; known checks: describe"),
        (["--deadline", "0"], "--deadline must be a number of seconds above 0"),
        (["--recording", "no-such.mcap"], "there is no recording no-such.mcap"),
        (["--set", "nonsense"], "has no `=`"),
    ] {
        let (ended, _) = conform("thermal", &case("wheel-rail.toml"), &options, &[]);
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        assert!(ended.stderr.contains(words), "{}", ended.stderr);
    }
    let missing = ["no-such-program".to_owned()];
    let (ended, _) = conform("thermal", &case("wheel-rail.toml"), &[], &missing);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("there is no program `no-such-program`"), "{}", ended.stderr);
}

/// The printed table has a line for each check, and details only for failed ones.
#[test]
fn the_table_is_for_people() {
    let place = Place::new();
    let [program, name] = toy("rogue");
    let exchange = case("exchange.toml");
    let only = ["--only", "describe", "--only", "solve", "--set", "left.fault=silence"];
    let mut arguments = vec!["conform", "--role", "left", "--case", &exchange];
    arguments.extend(only);
    arguments.extend(["--", &program, &name]);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let line = |word: &str| ended.stdout.lines().find(|line| line.contains(word)).unwrap();
    assert!(line(" describe ").contains(" ok "), "{}", ended.stdout);
    assert!(line(" solve ").contains(" FAIL "), "{}", ended.stdout);
    assert_eq!(ended.stdout.matches("  look at ").count(), 1, "{}", ended.stdout);
    assert!(ended.stdout.contains("1 passed, 1 failed, 0 do not apply"), "{}", ended.stdout);
    place.assert_nothing_left();
}
