//! `coordinator cost`: references, errors, orders of convergence, Pareto front and recommendations.

use crate::harness::{Place, case, wait_until};
use rustix::process::Signal;
use serde_json::Value;
use std::fs;

/// Runs a study and returns `cost.json`.
fn study(place: &Place, name: &str, more: &[&str]) -> Value {
    let out = place.out().display().to_string();
    let file = case(name);
    let mut arguments = vec!["cost", &file, "--out", &out, "--repeat", "1", "--longest-run", "2"];
    arguments.extend(more);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    serde_json::from_slice(&fs::read(place.out().join("cost.json")).unwrap()).unwrap()
}

fn runs(study: &Value) -> &[Value] {
    study["runs"].as_array().unwrap()
}

fn level(study: &Value, name: &str) -> usize {
    let levels = study["levels"].as_array().unwrap();
    levels.iter().position(|level| level["name"] == name).unwrap_or_else(|| panic!("{name}"))
}

const RISE: &str = "temperature.rail.max_rise_k";

/// Uniform slip: on this ellipse the exact flux gives 260.88 K with heat conducted into the depth
/// only, and the polynomial flux gives 261.94 K. Conduction in all directions reduces this by the
/// factor 261.850/261.872, found by an independent quadrature in three dimensions for the paper's
/// flux.
#[test]
fn errors_are_against_closed_forms_and_limits() {
    let place = Place::new();
    let vary = "mech.resolution=5,10,20,40";
    let study = study(&place, "full-slip.toml", &["--vary", vary]);
    let quantities = study["quantities"].as_array().unwrap();
    assert_eq!(quantities[0]["key"], RISE);
    let reference = quantities[0]["reference"]["value"].as_f64().unwrap();
    // Digits of 260.88, and the uncertainty stated by the study for its own reference.
    let uncertainty = quantities[0]["reference"]["uncertainty"].as_f64().unwrap();
    assert!(uncertainty < 1e-3, "{uncertainty}");
    let known = uncertainty + 2e-5;
    let expected = 260.88 * 261.850 / 261.872;
    assert!((reference / expected - 1.0).abs() <= known, "{reference} ± {uncertainty}");
    let pressure = quantities.iter().find(|one| one["key"] == "contact.max_pressure_pa").unwrap();
    assert_eq!(pressure["reference"]["source"], "closed form");
    assert_eq!(pressure["reference"]["value"], 1.352e9);
    let polynomial = &study["levels"][level(&study, "hertz-carter + ertz-knothe")];
    let error = polynomial["shows"][RISE]["model_error"].as_f64().unwrap();
    assert!((error - (261.94 / expected - 1.0)).abs() <= 2.0 * known, "{error}");
    let columns = &study["levels"][level(&study, "hertz-carter + columns")];
    let order = columns["shows"][RISE]["order"].as_f64().unwrap();
    assert!((order - 2.0).abs() < 0.2, "{order}");
    // Below the error of the polynomial, refinement does not pay off.
    let told = polynomial["stops_paying"].as_str().unwrap();
    assert!(told.contains("mech.resolution"), "{told}");
}

#[test]
fn the_front_and_the_picks_are_the_cheapest_and_closest() {
    let place = Place::new();
    let more =
        ["--vary", "mech.resolution=5,10,20", "--vary", "mech.model=hertz-carter,half-space"];
    let study = study(&place, "wheel-rail.toml", &more);
    assert_eq!(study["levels"].as_array().unwrap().len(), 8);
    assert_eq!(runs(&study).len(), 24);
    let place_of = |run: &Value| {
        (run["cost"]["solve_s"].as_f64().unwrap(), run["errors"][RISE].as_f64().unwrap())
    };
    for run in runs(&study) {
        let (cost, error) = place_of(run);
        let beaten = runs(&study)
            .iter()
            .map(place_of)
            .any(|(other, off)| other <= cost && off <= error && (other < cost || off < error));
        assert_eq!(run["pareto"], !beaten);
        assert!(run["cost"]["wall_s"].as_f64().unwrap() > cost);
        for process in ["mech", "thermal", "coordinator"] {
            assert!(run["cost"]["cpu_s"][process].as_f64().unwrap() > 0.0);
        }
        assert!(run["cost"]["peak_rss_bytes"]["mech"].as_u64().unwrap() > 1_000_000);
    }
    for pick in study["picks"].as_array().unwrap() {
        let target = pick["target"].as_f64().unwrap();
        // All finer runs of the same models must meet the target too: a coarse run may be right by
        // chance.
        let meets = |run: &&Value| {
            let mut finer = runs(&study).iter().filter(|other| {
                other["level"] == run["level"] && other["step"].as_u64() >= run["step"].as_u64()
            });
            finer.all(|other| place_of(other).1 <= target)
        };
        let meeting = runs(&study).iter().filter(meets).map(place_of);
        let cheapest = meeting.map(|(cost, _)| cost).min_by(f64::total_cmp);
        let picked = pick["run"].as_u64().map(|index| place_of(&runs(&study)[index as usize]).0);
        assert_eq!(picked, cheapest);
    }
    // The options of a recommendation reproduce its run.
    let first = &runs(&study)[study["picks"][0]["run"].as_u64().unwrap() as usize];
    let options: Vec<&str> =
        first["options"].as_array().unwrap().iter().map(|o| o.as_str().unwrap()).collect();
    let again = Place::new().summary(&case("wheel-rail.toml"), &options);
    assert_eq!(again["temperature"]["rail"]["max_rise_k"], first["values"][RISE]);
}

/// Tolerances vary in cases with a loop, windows in transient cases; combinations that cannot run
/// are reported.
#[test]
fn tolerances_windows_and_refusals() {
    let place = Place::new();
    let coarse = ["--vary", "mech.resolution=5,10", "--vary", "thermal.model=columns"];
    let more = [&coarse[..], &["--vary", "coupling.relative=1e-1,1e-8"]].concat();
    let implicit = study(&place, "falling-friction.toml", &more);
    let refused = implicit["refused"].as_array().unwrap();
    assert!(refused.iter().any(|one| one[0].as_str().unwrap() == "mech explicit-fe"));
    let iterations = |tolerance: &str| {
        let with = |run: &&Value| run["settings"][1][1] == tolerance;
        let own = runs(&implicit).iter().filter(with);
        own.map(|run| run["cost"]["iterations"].as_u64().unwrap()).sum::<u64>()
    };
    assert!(iterations("1e-1") < iterations("1e-8"));

    let place = Place::new();
    let models = ["--vary", "mech.model=hertz-carter", "--vary", "thermal.model=columns"];
    let more = [&coarse[..2], &models, &["--set", "time.end=0.2 ms"]].concat();
    let transient = study(&place, "cold-start.toml", &more);
    let windows: Vec<f64> = runs(&transient)
        .iter()
        .map(|run| run["settings"][1][1].as_str().unwrap().parse().unwrap())
        .collect();
    assert_eq!(windows[..4], [8e-5, 4e-5, 2e-5, 1e-5]);
}

/// A key given with `--set` is not varied, and appears once in the options of a run.
#[test]
fn what_is_set_is_not_varied() {
    let place = Place::new();
    let set = ["mech.model=hertz-carter", "thermal.model=ertz-knothe", "mech.resolution=7"];
    let options: Vec<&str> = set.iter().flat_map(|key| ["--set", key]).collect();
    let study = study(&place, "wheel-rail.toml", &options);
    let [run] = runs(&study) else { panic!("{}", study["runs"]) };
    let mut given: Vec<&str> =
        run["options"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    given.retain(|option| *option != "--set");
    given.sort_unstable();
    assert_eq!(
        given,
        ["mech.model=hertz-carter", "mech.resolution=7", "thermal.model=ertz-knothe"]
    );
}

#[test]
fn the_files_agree_and_the_report_can_be_made_again() {
    let place = Place::new();
    let study = study(&place, "full-slip.toml", &["--vary", "mech.resolution=5,10"]);
    let csv = fs::read_to_string(place.out().join("cost.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + runs(&study).len());
    assert!(csv.lines().next().unwrap().contains(RISE));
    let page = place.out().join("report.html");
    let before = fs::read_to_string(&page).unwrap();
    fs::remove_file(&page).unwrap();
    let out = place.out().display().to_string();
    assert_eq!(place.start(&["report", &out]).wait().code, Some(0));
    assert_eq!(fs::read_to_string(&page).unwrap(), before);
    assert!(before.contains("error over time") && before.contains("Recommended runs"));
    // It is replaced by a study of its own kind only.
    let ended = place.start(&["ablate", &case("wheel-rail.toml"), "--out", &out]).wait();
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("holds files but no results of `coordinator ablate`"),
        "{}",
        ended.stderr
    );
    // The folders of the runs are removed.
    let mut left: Vec<_> =
        fs::read_dir(place.out()).unwrap().map(|e| e.unwrap().file_name()).collect();
    left.sort();
    let files = [".cosim-results", "cost.csv", "cost.json", "report.html", "work-precision.svg"];
    assert_eq!(left, files);
}

/// Finished runs of an unfinished study.
pub(crate) fn finished_runs(place: &Place) -> Vec<Value> {
    let text = fs::read_to_string(place.out().join("unfinished.jsonl")).unwrap_or_default();
    let lines = text.split_inclusive('\n').skip(1).filter(|line| line.ends_with('\n'));
    lines.map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// A stopped study keeps its finished runs and does not repeat them.
#[test]
fn a_study_that_is_stopped_goes_on() {
    let place = Place::new();
    let (out, file) = (place.out().display().to_string(), case("full-slip.toml"));
    let models = ["--vary", "mech.model=hertz-carter", "--vary", "thermal.model=columns"];
    let levels = ["--vary", "mech.resolution=5,10,15,20,25,30,35,40,45,50,55,60"];
    let arguments = [&["cost", &file, "--out", &out, "--repeat", "1"], &levels[..], &models];
    let arguments = arguments.concat();
    let kept = || finished_runs(&place);
    let running = place.start(&arguments);
    wait_until("finished runs", || kept().len() >= 2);
    running.signal(Signal::INT);
    let ended = running.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    let first = kept();
    let told = format!("{} finished runs are kept", first.len());
    assert!(ended.stderr.contains(&told), "{told}: {}", ended.stderr);
    let other = [&arguments[..], &["--set", "motion.speed=30"]].concat();
    let refused = place.start(&other).wait();
    assert_eq!(refused.code, Some(2), "another study: {}", refused.stderr);
    let words = "motion.speed: was 38.889, is 30";
    assert!(refused.stderr.contains(words), "{}", refused.stderr);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(
        ended.stderr.contains(&format!("{} runs of the interrupted study", first.len())),
        "{}",
        ended.stderr
    );
    let study: Value =
        serde_json::from_slice(&fs::read(place.out().join("cost.json")).unwrap()).unwrap();
    assert_eq!(runs(&study).len(), 12);
    for run in &first {
        // The stored cost shows that the run was not repeated.
        assert!(runs(&study).iter().any(|one| one["cost"] == run["spent"]), "{run}");
    }
    assert!(kept().is_empty());
    place.assert_nothing_left();
}

#[test]
fn what_cannot_be_studied_is_refused() {
    let refused = |more: &[&str], words: &str| {
        let place = Place::new();
        let out = place.out().display().to_string();
        let file = case("full-slip.toml");
        let mut arguments = vec!["cost", &file, "--out", &out, "--vary", "mech.resolution=5"];
        if !more.contains(&"--longest-run") {
            arguments.extend(["--longest-run", "2"]);
        }
        arguments.extend(more);
        let ended = place.start(&arguments).wait();
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        assert!(ended.stderr.contains(words), "{}", ended.stderr);
        place.assert_nothing_left();
        // Finished runs are kept.
        let files = fs::read_dir(place.out()).into_iter().flatten().flatten();
        assert!(
            files
                .map(|f| f.file_name())
                .all(|name| { name == ".cosim-results" || name == "unfinished.jsonl" })
        );
    };
    refused(&["--vary", "mech.resolution"], "write KEY=A,B,C");
    refused(&["--quantity", "contact.colour"], "no run has the quantity `contact.colour`");
    refused(&["--reference", "x=y"], "is not KEY=NUMBER");
    refused(&["--set", "friction.coefficient=-1"], "friction.coefficient");
    refused(
        &["--vary", "mech.resolution=5,banana"],
        "`banana` is not a positive whole number of elements",
    );
    refused(&["--vary", "mech.model=hertz-carter,nonsuch"], "choose from conformal, explicit-fe");
    refused(&["--vary", "load.normal_force=1e3,1e5"], "this key changes the problem");
    refused(&["--reference", "contact.max_pressure_pa=nan"], "is not KEY=NUMBER");
    refused(&["--reference", "contact.colour=1"], "the runs have temperature.rail.max_rise_k");
    refused(&["--repeat", "0"], "--repeat");
    refused(&["--longest-run", "0"], "--longest-run must be a number of seconds");
}
