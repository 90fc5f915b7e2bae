//! `sweep --fit`, `fit` and `ask`: figures between the points of a sweep, within the stated errors,
//! identical from Rust, the command line and Python, and refused outside the box.

use crate::harness::python::interpreter;
use crate::harness::{Ended, Place, case, root};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

const CREEPAGE: &str = "contact.creepage_xi";
const RISE: &str = "temperature.rail.max_rise_k";

fn read(file: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
}

fn started(place: &Place, arguments: &[&str]) -> Ended {
    place.start(arguments).wait()
}

fn done(place: &Place, arguments: &[&str]) -> Ended {
    let ended = started(place, arguments);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended
}

/// Sweep over closed forms: tractions and loads in kN, where one traction exceeds the friction
/// limit.
fn swept(place: &Place, more: &[&str]) -> Ended {
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let sweep = ["sweep", file.as_str(), "--set", "mech.model=hertz-carter", "--out", out.as_str()];
    let vary = [
        "--vary",
        "motion.traction_coefficient=0.05..0.65/9cheb",
        "--vary",
        "load.normal_force=60 kN,100 kN,134 kN",
    ];
    done(place, &[&sweep[..], &vary[..], more].concat())
}

#[test]
fn figures_between_the_points_are_within_their_errors_from_everywhere() {
    let place = Place::new();
    let ended = swept(&place, &["--fit"]);
    assert!(
        ended.stdout.contains("6 points without a result, outside the box"),
        "{}",
        ended.stdout
    );
    let fit = place.out().join("fit.json");
    let largest = read(&fit)["keys"][0]["to"].as_f64().unwrap();
    assert!(
        (0.5..0.6).contains(&largest),
        "the box ends at the last traction that friction allows"
    );

    let file = fit.display().to_string();
    let at = ["motion.traction_coefficient=0.31", "load.normal_force=87 kN"];
    let ended = done(&place, &["ask", &file, at[0], at[1], "--json"]);
    let answer: Value = serde_json::from_str(&ended.stdout).unwrap();
    let (wheel, out) = (case("wheel-rail.toml"), place.out().with_file_name("one"));
    let folder = out.display().to_string();
    let model = "mech.model=hertz-carter";
    let set = ["--set", model, "--set", at[0], "--set", at[1], "--out", folder.as_str()];
    done(&place, &[&["run", wheel.as_str()][..], &set[..]].concat());
    let summary = read(&out.join("summary.json"));
    let truth = [&summary["contact"]["creepage_xi"], &summary["temperature"]["rail"]["max_rise_k"]];
    for (key, truth) in [CREEPAGE, RISE].iter().zip(truth) {
        let [value, error] = ["value", "error"].map(|one| answer[key][one].as_f64().unwrap());
        let truth = truth.as_f64().unwrap();
        assert!(
            (value - truth).abs() <= error && error < 0.2 * truth.abs(),
            "{value} {truth} {error}"
        );
    }

    // Identical results from a table, and from Python.
    let table = place.out().with_file_name("points.csv");
    std::fs::write(&table, "load.normal_force,motion.traction_coefficient\n87 kN,0.31\n61e3,0.1\n")
        .unwrap();
    let ask = ["ask", &file, "--figure", RISE, "--table", &table.display().to_string()];
    let ended = done(&place, &ask);
    let lines: Vec<&str> = ended.stdout.lines().collect();
    assert_eq!(lines[0], format!("load.normal_force,motion.traction_coefficient,{RISE}"));
    assert_eq!(lines.len(), 3);
    let cell = |line: &str| line.rsplit(',').next().unwrap().parse::<f64>().unwrap();
    assert_eq!(Some(cell(lines[1])), answer[RISE]["value"].as_f64());
    let script = format!(
        "import sys, numpy as np\nfrom cosim import surrogate\n\
         asked = surrogate.load({file:?}).ask({{'load.normal_force': np.array([87e3, 61e3]), 'motion.traction_coefficient': [0.31, 0.1]}})\n\
         print(*(repr(float(one)) for one in asked[{RISE:?}]))\n\
         assert not [name for name in sys.modules if 'iceoryx2' in name]"
    );
    let made = Command::new(interpreter()).args(["-c", &script]).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let python = String::from_utf8(made.stdout).unwrap();
    for (python, line) in python.split_whitespace().zip(&lines[1..]) {
        let (python, ours) = (python.parse::<f64>().unwrap(), cell(line));
        // Different order of summation, and a different exponential.
        assert!((python - ours).abs() < 1e-13 * ours, "{python} {ours}");
    }
    place.assert_nothing_left();
}

#[test]
fn nothing_is_said_of_a_point_outside() {
    let place = Place::new();
    swept(&place, &[]);
    let out = place.out().display().to_string();
    // The quotient adds no bound here; it is refused outside its range like a key.
    done(&place, &["fit", &out, "--per", "motion.traction_coefficient/load.normal_force"]);
    let told = |more: &[&str], words: &str| {
        let ended = started(&place, &[&["ask", out.as_str()][..], more].concat());
        assert_eq!(
            (ended.code, ended.stdout.as_str()),
            (Some(2), ""),
            "{more:?}: {}",
            ended.stderr
        );
        assert!(ended.stderr.contains(words), "{more:?}: {}", ended.stderr);
    };
    let [traction, load] = ["motion.traction_coefficient=0.3", "load.normal_force=100 kN"];
    told(
        &[traction, "load.normal_force=150 kN"],
        "load.normal_force = 150000 N is outside 60000 to 134000 N",
    );
    told(&[traction], "missing values: load.normal_force (60000 to 134000 N)");
    told(&[traction, load, "motion.sped=3"], "motion.sped did not vary");
    told(&[traction, "load.normal_force=100 kg"], "unit `kg` cannot be converted to N");
    told(&[traction, load, "--figure", "contact.area_m"], "did you mean `contact.area_m2`");
    let table = place.out().with_file_name("points.csv");
    std::fs::write(
        &table,
        "load.normal_force,motion.traction_coefficient\n87 kN,0.31\n87 kN,0.64\n",
    )
    .unwrap();
    let outside = ["--table", &table.display().to_string()];
    told(&outside, "line 3: motion.traction_coefficient = 0.64 is outside 0.05 to");
    std::fs::write(place.out().join("fit.json"), "{\"schema\": 1}").unwrap();
    told(&[traction, load], "missing field `origin`");
    let ended = started(&place, &["fit", &root().join("cases").display().to_string()]);
    assert_ne!(ended.code, Some(0));
    place.assert_nothing_left();
}
