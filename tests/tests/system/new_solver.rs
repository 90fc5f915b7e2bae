//! `coordinator new-solver`: what is written, and what is refused. The target `external` builds it
//! in every language.

use crate::harness::python::interpreter;
use crate::harness::{Place, case, flat, new_solver};

/// A locked wheel has no steady temperature by conduction normal to the surface: the generated
/// solver refuses it. A solver that neither reads nor receives the speeds computes a rolling wheel,
/// which gives a warning.
#[test]
fn a_locked_wheel_is_refused_or_told() {
    let folder = tempfile::tempdir().unwrap();
    let (code, said) = new_solver(folder.path(), &["mine", "--lang", "python"]);
    assert_eq!(code, Some(0), "{said}");
    let script = folder.path().join("mine/mine.py");
    let python = interpreter().display().to_string();
    let (place, file) = (Place::new(), case("wheel-rail.toml"));
    let start = |verb: &str, more: &[&str]| {
        let program = format!("thermal.command=[{python:?}, {:?}]", script.display().to_string());
        let sets = ["--set", "thermal.model=short", "--set", &program, "--set"];
        let locked = ["bodies.wheel.surface_speed=0", "--unset", "motion.traction_coefficient"];
        let model = ["--set", "mech.model=hertz-carter"];
        place.start(&[&[verb, &file][..], &sets, &locked, &model, more].concat()).wait()
    };
    let out = place.out().display().to_string();
    let refused = start("run", &["--out", &out]);
    assert_ne!(refused.code, Some(0), "{}", refused.stdout);
    assert!(refused.stderr.contains("`surface_speed` > 0"), "{}", refused.stderr);

    let source = std::fs::read_to_string(&script).unwrap();
    let deaf = source
        .replace(", \"surface_speed\")", ",)")
        .replace("inputs.finite(\"surface_speed\").ravel()", "(5.0, 5.0)");
    assert_ne!(deaf, source);
    std::fs::write(&script, deaf).unwrap();
    let told = start("check", &[]);
    let words = "bodies.wheel.surface_speed: has no effect in thermal, which neither reads it nor \
                 receives the field `surface_speed`";
    assert!(told.code == Some(0) && flat(&told.stdout).contains(words), "{}", told.stdout);
}

#[test]
fn nothing_that_is_there_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    let (code, said) = new_solver(folder.path(), &["mine", "--lang", "python"]);
    assert!(code == Some(2) && said.contains("mine is there already"), "{said}");
    let (code, said) = new_solver(folder.path(), &["../mine", "--lang", "python"]);
    assert!(code == Some(2) && said.contains("begins with a letter"), "{said}");
    let (code, said) =
        new_solver(folder.path(), &["other", "--lang", "rust", "--sources", "nowhere"]);
    assert!(code == Some(2) && said.contains("name their folder by --sources"), "{said}");
    assert!(!folder.path().join("other").exists());
}
