//! Invalid cases: exit code 2, all errors listed, no process started. Each kind of error is in the
//! target `engine`.

use crate::harness::{Place, case, changed, root};

/// `run` and `check` reject a case with the same errors; nothing is started.
#[test]
fn all_errors_are_listed_at_once() {
    let text = changed(&[
        ("speed = 38.889 ", "sped = 38.889 "),
        ("134 kN", "134 kPa"),
        ("= 0.58 ", "= 0.75 "),
        ("\"half-space\"", "\"halfspace\""),
        ("[effects.partial_slip]", "[effects.magnetism]"),
    ]);
    let parts = ["motion.sped", "kPa", "0.75", "halfspace", "magnetism", "fix: ", "5 errors in"];
    let (place, folder) = (Place::new(), tempfile::tempdir().unwrap());
    let file = folder.path().join("bad.toml");
    std::fs::write(&file, text).unwrap();
    let file = file.display().to_string();
    for ended in [place.run(&file, &[]), place.start(&["check", &file]).wait()] {
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        for part in parts {
            assert!(ended.stderr.contains(part), "`{part}` is missing in:\n{}", ended.stderr);
        }
    }
    assert!(!place.out().exists(), "nothing is started and nothing written");
    place.assert_nothing_left();
}

/// `check` prints what docs/mistakes.md quotes: errors of a case, and warnings.
#[test]
fn the_page_of_mistakes_quotes_the_command() {
    let page = std::fs::read_to_string(root().join("docs/mistakes.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (change, code) in [(("[friction]", "[frction]"), 2), (("= 0.46", "= 420"), 0)] {
        std::fs::write(folder.path().join("case.toml"), changed(&[change])).unwrap();
        let place = Place::new();
        let mut command = place.command(&["check", "case.toml"]);
        command.current_dir(folder.path());
        let ended = place.launch(command).wait();
        let said = [ended.stdout, ended.stderr].concat();
        assert_eq!(ended.code, Some(code), "{said}");
        assert!(page.contains(&format!("```text\n{}\n```", said.trim_end())), "{said}");
    }
}

#[test]
fn a_good_case_passes_the_check_and_starts_nothing() {
    for name in ["wheel-rail.toml", "exchange.toml"] {
        let place = Place::new();
        let ended = place.start(&["check", &case(name)]).wait();
        assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
        assert!(ended.stdout.ends_with("no errors\n"), "{}", ended.stdout);
        place.assert_nothing_left();
    }
}

#[test]
fn a_file_that_is_not_there() {
    let place = Place::new();
    let ended = place.run("no/such/case.toml", &[]);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("no/such/case.toml"), "{}", ended.stderr);
}

#[test]
fn bad_usage() {
    let place = Place::new();
    for arguments in [vec!["run"], vec!["rum", "x"], vec![], vec!["run", "x", "--set"]] {
        assert_eq!(place.start(&arguments).wait().code, Some(2), "{arguments:?}");
    }
}
