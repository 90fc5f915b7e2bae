//! Cases of configurations: keys, names, and notes on everything else.

use crate::texts::{FULL, SMALL, line, with};
use precice_config::{
    Configuration, Import, ImportError, ImportOptions, NoteKind, Refusal, case_of, names,
};
use std::collections::BTreeMap;
use toml::{Table, Value};

fn options() -> ImportOptions {
    let commands = [("Left", "./left"), ("Right", "./right")];
    ImportOptions {
        name: "pair".to_owned(),
        path: "precice-config.xml".to_owned(),
        commands: commands.map(|(name, word)| (name.to_owned(), vec![word.to_owned()])).into(),
        ..ImportOptions::default()
    }
}

fn import(text: &str) -> Import {
    let configuration = Configuration::parse(text).unwrap_or_else(|error| panic!("{error}"));
    let mut options = options();
    options.commands.retain(|name, _| configuration.participant(name).is_some());
    case_of(&configuration, &options).expect("the configuration has a scheme")
}

fn case(text: &str) -> Table {
    let import = import(text);
    import.text.parse().unwrap_or_else(|error| panic!("{error}\n{}", import.text))
}

/// Returns the value at a dotted key.
fn at<'a>(case: &'a Table, key: &str) -> Option<&'a Value> {
    let (section, name) = key.rsplit_once('.').expect("a key has a section");
    let table = section.split('.').try_fold(case, |table, part| table.get(part)?.as_table());
    table?.get(name)
}

/// Checks some values; `None` for an absent key.
fn check(text: &str, expected: &[(&str, Option<Value>)]) {
    let case = case(text);
    for (key, value) in expected {
        assert_eq!(at(&case, key), value.as_ref(), "{key}\n{case}");
    }
}

fn some(value: impl Into<Value>) -> Option<Value> {
    Some(value.into())
}

/// Returns a small configuration with an implicit scheme and these elements in it.
fn implicit(kind: &str, elements: &str) -> String {
    let text = with(SMALL, "coupling-scheme:serial-explicit", &format!("coupling-scheme:{kind}"));
    with(&text, "<max-time value=\"2\" />", &format!("<max-time value=\"2\" />{elements}"))
}

const MEASURES: &str = "<relative-convergence-measure data=\"Force\" mesh=\"Point\" limit=\"1e-4\" />\
                        <relative-convergence-measure data=\"Way\" mesh=\"Point\" limit=\"1e-4\" />";

#[test]
fn a_small_case_reads_like_a_written_one() {
    let expected = r#"# Imported from precice-config.xml, a configuration of preCICE.
[case]
name = "pair"
title = "Left and Right"

[left]
model = "program"
command = ["precice-participant", "precice-config.xml", "--participant", "Left",
    "--", "./left"]
[right]
model = "program"
command = ["precice-participant", "precice-config.xml", "--participant", "Right",
    "--", "./right"]

[time]
mode = "transient"
window = 0.5
end = 2
[coupling]
scheme = "serial-explicit"
interpolation = "linear"          # of values within a window
[mapping]
method = "nearest-neighbour"
"#;
    assert_eq!(import(SMALL), Import { text: expected.to_owned(), notes: Vec::new() });
}

#[test]
fn every_scheme_has_its_word() {
    for kind in ["serial-explicit", "parallel-explicit", "serial-implicit", "parallel-implicit"] {
        check(&implicit(kind, ""), &[("coupling.scheme", some(kind))]);
    }
    let multi = with(
        &implicit("multi", MEASURES),
        "<participants first=\"Left\" second=\"Right\" />",
        "<participant name=\"Right\" control=\"yes\" /><participant name=\"Left\" />",
    );
    check(&multi, &[("coupling.scheme", some("parallel-implicit"))]);
    // The order is that of the scheme.
    let text = import(&multi).text;
    assert!(line(&text, "[right]") < line(&text, "[left]"), "{text}");
}

#[test]
fn the_earlier_end_holds() {
    let end =
        |text: &str| case(&with(SMALL, "<max-time value=\"2\" />", text))["time"]["end"].clone();
    assert_eq!(end("<max-time-windows value=\"3\" />"), Value::from(1.5));
    assert_eq!(end("<max-time value=\"2\" /><max-time-windows value=\"3\" />"), Value::from(1.5));
    assert_eq!(end("<max-time value=\"1\" /><max-time-windows value=\"3\" />"), Value::from(1));
    // The only window is as long as the run.
    let short = with(SMALL, "<max-time value=\"2\" />", "<max-time value=\"0.25\" />");
    check(&short, &[("time.end", some(0.25)), ("time.window", some(0.25))]);
    let note = import(&short).notes[0].to_string();
    assert!(note.contains("the run ends within its first window"), "{note}");
    // Three windows of 0.1 s end at 0.3 s, without an error of rounding.
    let windows = with(
        &with(SMALL, "value=\"0.5\"", "value=\"0.1\""),
        "<max-time value=\"2\" />",
        "<max-time-windows value=\"3\" />",
    );
    check(&windows, &[("time.end", some(0.3)), ("time.window", some(0.1))]);
}

#[test]
fn windows_of_the_first_participant_become_adaptive() {
    let first = |text: &str| with(text, "value=\"0.5\"", "method=\"first-participant\"");
    let adaptive = first(&implicit("serial-implicit", MEASURES));
    let windows = [("time.window", some(0.02)), ("time.end", some(2))];
    check(&adaptive, &[&windows[..], &[("time.control", some("adaptive"))]].concat());
    let of_windows = |text: &str| {
        let mut notes = import(text).notes.into_iter();
        let note = notes.find(|note| note.element == "time-window-size").unwrap();
        assert_eq!(note.lines, [line(SMALL, "<time-window-size")]);
        note
    };
    assert_eq!(of_windows(&adaptive).kind, NoteKind::Changed);
    // An explicit scheme cannot repeat a window, which adaptive windows may need.
    let fixed = first(SMALL);
    check(&fixed, &[&windows[..], &[("time.control", None)]].concat());
    let note = of_windows(&fixed);
    assert_eq!(note.kind, NoteKind::Todo);
    assert!(note.to_string().contains("set time.window to the time step of"), "{note}");
}

#[test]
fn accelerations_have_the_defaults_of_precice() {
    let of = |kind: &str, inside: &str| {
        let data = "<data name=\"Way\" mesh=\"Point\" />";
        let element = format!("<acceleration:{kind}>{data}{inside}</acceleration:{kind}>");
        implicit("serial-implicit", &format!("{MEASURES}{element}"))
    };
    check(&implicit("serial-implicit", MEASURES), &[("coupling.acceleration", some("none"))]);
    check(
        &of("constant", "<relaxation value=\"0.3\" />"),
        &[
            ("coupling.acceleration", some("constant")),
            ("coupling.relaxation", some(0.3)),
            ("coupling.max_columns", None),
        ],
    );
    check(
        &of("aitken", ""),
        &[("coupling.acceleration", some("aitken")), ("coupling.relaxation", some(0.5))],
    );
    check(
        &of("IQN-ILS", ""),
        &[
            ("coupling.acceleration", some("iqn-ils")),
            ("coupling.relaxation", some(0.1)),
            ("coupling.max_columns", some(100)),
            ("coupling.reuse_windows", some(10)),
            ("coupling.filter", some(0.01)),
            ("coupling.preconditioner", None),
        ],
    );
    check(
        &of("IQN-IMVJ", "<max-used-iterations value=\"7\" /><preconditioner type=\"value\" />"),
        &[
            ("coupling.acceleration", some("iqn-imvj")),
            ("coupling.max_columns", some(7)),
            ("coupling.reuse_windows", some(0)),
            ("coupling.preconditioner", some("value")),
        ],
    );
}

#[test]
fn one_limit_for_all_fields_is_one_key() {
    check(
        &implicit("parallel-implicit", MEASURES),
        &[("coupling.relative", some(1e-4)), ("coupling.fields.Force.relative", None)],
    );
    let different = with(
        MEASURES,
        "<relative-convergence-measure data=\"Way\" mesh=\"Point\" limit=\"1e-4\" />",
        "<absolute-convergence-measure data=\"Way\" mesh=\"Point\" limit=\"2\" />\
         <residual-relative-convergence-measure data=\"Way\" mesh=\"Point\" limit=\"0.1\" />",
    );
    check(
        &implicit("parallel-implicit", &different),
        &[
            ("coupling.relative", some(1e-4)),
            ("coupling.fields.Force.relative", None),
            ("coupling.fields.Way.absolute", some(2)),
            ("coupling.fields.Way.relative", None),
            ("coupling.fields.Way.residual_relative", some(0.1)),
        ],
    );
}

#[test]
fn a_serial_scheme_also_tests_the_data_that_go_forward() {
    let measures = with(
        MEASURES,
        "mesh=\"Point\" limit=\"1e-4\" /><rel",
        "mesh=\"Point\" limit=\"1e-2\" /><rel",
    );
    let text = implicit("serial-implicit", &measures);
    check(
        &text,
        &[("coupling.relative", some(1e-4)), ("coupling.fields.Force.relative", some(0.01))],
    );
    // Without a measure of the data that return, the limit is that of the others.
    let forward = measures.split_inclusive("/>").next().unwrap();
    check(
        &implicit("serial-implicit", forward),
        &[("coupling.relative", some(0.01)), ("coupling.fields.Force.relative", some(0.01))],
    );
}

#[test]
fn windows_without_convergence_end_the_run_if_they_did() {
    let strict = with(MEASURES, "limit=\"1e-4\" />", "limit=\"1e-4\" strict=\"true\" />");
    check(&implicit("serial-implicit", &strict), &[("coupling.strict", None)]);
    check(&implicit("serial-implicit", MEASURES), &[("coupling.strict", some(false))]);
}

#[test]
fn methods_are_written_by_field_where_they_differ() {
    let mixed = with(
        SMALL,
        "mapping:nearest-neighbor direction=\"read\"",
        "mapping:nearest-projection direction=\"read\"",
    );
    check(
        &mixed,
        &[
            ("mapping.method", None),
            ("mapping.fields.Force.method", some("nearest-projection")),
            ("mapping.fields.Way.method", some("nearest-neighbour")),
        ],
    );
    let rbf = with(SMALL, "mapping:nearest-neighbor", "mapping:rbf");
    check(&rbf, &[("mapping.method", some("radial-basis"))]);
    assert_eq!(import(&rbf).notes[0].lines.len(), 2, "one note on two lines");
}

/// Returns the small configuration with radial basis functions of these attributes and this
/// function.
fn radial(kind: &str, attributes: &str, function: &str) -> String {
    let mut text = SMALL.to_owned();
    while let Some(start) = text.find("<mapping:nearest-neighbor") {
        let end = start + text[start..].find("/>").expect("an element ends");
        let common = &text[start + "<mapping:nearest-neighbor".len()..end];
        let element = format!(
            "<mapping:{kind} {attributes} {common}><basis-function:{function} /></mapping:{kind}>"
        );
        text.replace_range(start..end + 2, &element);
    }
    text
}

#[test]
fn radial_basis_functions_keep_function_and_length() {
    let long = "support-radius=\"0.25\"";
    let shape = "shape-parameter=\"0.25\"";
    let gauss = (9.0 * std::f64::consts::LN_10).sqrt() / 0.25;
    for (function, basis, radius) in [
        (format!("compact-polynomial-c0 {long}"), "wendland-c0", some(0.25)),
        (format!("compact-polynomial-c2 {long}"), "wendland-c2", some(0.25)),
        (format!("compact-polynomial-c4 {long}"), "wendland-c4", some(0.25)),
        (format!("compact-polynomial-c6 {long}"), "wendland-c6", some(0.25)),
        (format!("compact-polynomial-c8 {long}"), "wendland-c8", some(0.25)),
        (format!("compact-tps-c2 {long}"), "compact-thin-plate-splines-c2", some(0.25)),
        (format!("gaussian {long}"), "gaussian", some(0.25)),
        (format!("gaussian {shape}"), "gaussian", some(gauss)),
        (format!("multiquadrics {shape}"), "multiquadrics", some(0.25)),
        (format!("inverse-multiquadrics {shape}"), "inverse-multiquadrics", some(0.25)),
        ("thin-plate-splines".to_owned(), "thin-plate-splines", None),
        ("volume-splines".to_owned(), "volume-splines", None),
    ] {
        for kind in ["rbf", "rbf-pum-direct"] {
            let text = radial(kind, "polynomial=\"on\"", &function);
            let expected = [
                ("mapping.method", some("radial-basis")),
                ("mapping.basis", some(basis)),
                ("mapping.radius", radius.clone()),
            ];
            check(&text, &expected);
            assert_eq!(import(&text).notes, Vec::new(), "{function}: nothing differs");
        }
    }
}

#[test]
fn differences_of_radial_basis_functions_have_notes() {
    let function = "compact-polynomial-c6 support-radius=\"0.25\"";
    let notes = |kind: &str, attributes: &str, function: &str| -> Vec<(String, String)> {
        let notes = import(&radial(kind, attributes, function)).notes;
        notes.into_iter().map(|note| (note.element, note.reason)).collect()
    };
    let pair = |element: &str, reason: &str| (element.to_owned(), reason.to_owned());
    let together = "a linear polynomial, solved together with the functions";
    assert_eq!(notes("rbf", "", function), [pair("mapping:rbf, polynomial", together)]);
    assert_eq!(
        notes("rbf", "polynomial=\"off\"", function),
        [pair("mapping:rbf, polynomial", "a linear polynomial all the same")]
    );
    let clusters = "more than 2000 points are interpolated in overlapping clusters";
    assert_eq!(
        notes("rbf-global-iterative", "polynomial=\"on\" solver-rtol=\"1e-6\"", function),
        [
            pair("mapping:rbf-global-iterative", clusters),
            pair("mapping:rbf-global-iterative, solver-rtol", "no counterpart of \"1e-6\""),
        ]
    );
    let stencil = "a local stencil without a support radius, in place of compact-polynomial-c6";
    assert_eq!(
        notes("rbf", "", "compact-polynomial-c6"),
        [pair("mapping:rbf", stencil)],
        "a function without its length"
    );
}

#[test]
fn invalid_names_of_data_are_wired() {
    let named = with(SMALL, "\"Force\"", "\"Normal Force [N]\"");
    let text = import(&named).text;
    let wire = |arrow: &str| format!(r#""--wire", "\"Normal Force [N]\" {arrow} Normal_Force_N""#);
    assert!(text.contains(&wire("->")) && text.contains(&wire("<-")), "{text}");
    assert!(!text.contains("Way"), "{text}");
}

#[test]
fn data_of_two_writers_become_two_fields() {
    let same = with(
        &with(SMALL, "\"Way\"", "\"Force\""),
        "<use-data name=\"Force\" /><use-data name=\"Force\" />",
        "<use-data name=\"Force\" />",
    );
    let same = with(&same, "  <data:scalar name=\"Force\" />\n  <data", "  <data");
    let text = import(&same).text;
    let wires: Vec<&str> =
        text.lines().filter(|line| line.contains("--wire")).map(str::trim).collect();
    let expected = [
        "\"--wire\", \"Force -> left_Force\",",
        "\"--wire\", \"Force <- right_Force\",",
        "\"--wire\", \"Force -> right_Force\",",
        "\"--wire\", \"Force <- left_Force\",",
    ];
    assert_eq!(wires, expected, "{text}");
}

/// A field of the table has a unit and a meaning, which data of the same name need not have.
#[test]
fn data_do_not_become_fields_of_the_table_by_their_names() {
    let configuration = Configuration::parse(&with(SMALL, "\"Force\"", "\"traction\"")).unwrap();
    let mut options = options();
    options.reserved = vec!["traction".to_owned(), "Way".to_owned(), "left_traction".to_owned()];
    let import = case_of(&configuration, &options).unwrap();
    let wires: Vec<&str> =
        import.text.lines().filter(|line| line.contains("--wire")).map(str::trim).collect();
    let expected = [
        "\"--wire\", \"traction -> left_traction-2\",",
        "\"--wire\", \"Way <- right_Way\",",
        "\"--wire\", \"Way -> right_Way\",",
        "\"--wire\", \"traction <- left_traction-2\",",
    ];
    assert_eq!(wires, expected, "{}", import.text);
    let told: Vec<String> = import.notes.iter().map(ToString::to_string).collect();
    assert!(told[0].contains("`traction` becomes `left_traction-2`"), "{told:?}");
    assert!(told[1].contains("wire it to Way if it is that field"), "{told:?}");
}

#[test]
fn refusals_of_a_check_are_to_do() {
    let configuration = Configuration::parse(SMALL).unwrap();
    let mut options = options();
    options.refusals = vec![
        Refusal {
            key: "left.command".to_owned(),
            reason: "there is no\nprogram".to_owned(),
            fix: "install it".to_owned(),
        },
        Refusal { reason: "it fails".to_owned(), ..Refusal::default() },
    ];
    let import = case_of(&configuration, &options).unwrap();
    let told: Vec<String> = import.notes.iter().map(ToString::to_string).collect();
    let expected = ["left.command: there is no?program; install it", "coordinator check: it fails"];
    assert_eq!(told, expected);
    assert!(import.text.contains("# To do before the first run:\n# - left.command"));
}

/// Parts that lead to nothing: an exchange of data that its sender does not write, with its
/// measure, and a mapping that moves nothing.
#[test]
fn nothing_is_left_out_without_a_word() {
    let notes = |text: &str| -> Vec<String> {
        import(text).notes.iter().map(ToString::to_string).collect()
    };
    let unsent = with(
        &implicit("serial-implicit", MEASURES),
        "<write-data name=\"Way\" mesh=\"Other\" />",
        "",
    );
    let told = notes(&unsent).join("\n");
    for part in [
        "exchange: Right does not write `Way`, so that nothing is sent",
        "convergence-measure: nobody writes `Way`; the measure is left out",
        "mapping:nearest-neighbor: moves no data that are exchanged, and is left out",
        "read-data: no participant sends `Way`",
    ] {
        assert!(told.contains(part), "{part} is missing in\n{told}");
    }
    let counts = "<min-iterations value=\"2000000\" /><max-iterations value=\"3000000\" />\
        <acceleration:IQN-ILS><max-used-iterations value=\"2000\" />\
        <time-windows-reused value=\"2000000\" /></acceleration:IQN-ILS>";
    let told = notes(&implicit("serial-implicit", &format!("{MEASURES}{counts}"))).join("\n");
    for part in [
        "min-iterations: at most 1000000",
        "max-iterations: at most 1000000",
        "max-used-iterations: at most 1000",
        "time-windows-reused: at most 1000000",
    ] {
        assert!(told.contains(part), "{part} is missing in\n{told}");
    }
}

#[test]
fn roles_are_unique() {
    let text = with(&with(SMALL, "\"Left\"", "\"Solver A\""), "\"Right\"", "\"solver_a\"");
    let case = case(&text);
    assert!(case.contains_key("solver_a") && case.contains_key("solver_a-2"), "{case}");
    let second = case["solver_a-2"]["command"].to_string();
    assert!(second.contains("\"--role\", \"solver_a-2\""), "{second}");
}

#[test]
fn an_unknown_program_is_named_in_case_and_notes() {
    let configuration = Configuration::parse(SMALL).unwrap();
    let mut options = options();
    options.commands.remove("Right");
    let import = case_of(&configuration, &options).unwrap();
    let word = names::placeholder("Right");
    assert_eq!(import.notes[0].kind, NoteKind::Todo);
    assert!(import.notes[0].to_string().contains(&word) && import.text.contains(&word));
    options.commands.insert("Middle".to_owned(), vec!["./middle".to_owned()]);
    let error = case_of(&configuration, &options).unwrap_err();
    let known = vec!["Left".to_owned(), "Right".to_owned()];
    assert_eq!(error, ImportError::Participant { name: "Middle".to_owned(), known });
}

#[test]
fn a_configuration_without_a_scheme_has_no_case() {
    let (start, end) = (SMALL.find("  <coupling").unwrap(), SMALL.find("</precice").unwrap());
    let configuration = Configuration::parse(&format!("{}{}", &SMALL[..start], &SMALL[end..]));
    let case = case_of(&configuration.unwrap(), &ImportOptions::default());
    assert_eq!(case, Err(ImportError::NoScheme));
}

#[test]
fn an_implicit_scheme_leads() {
    let other = "<coupling-scheme:serial-implicit>\
        <participants first=\"Right\" second=\"Left\" /><max-time value=\"2\" />\
        <time-window-size value=\"0.5\" /></coupling-scheme:serial-implicit></precice-configuration>";
    let text = with(SMALL, "</precice-configuration>", other);
    check(&text, &[("coupling.scheme", some("serial-implicit"))]);
    let notes = import(&text).notes;
    let of_scheme = notes.iter().find(|note| note.element == "coupling-scheme:serial-explicit");
    assert_eq!(of_scheme.unwrap().lines, [line(SMALL, "<coupling-scheme")]);
}

#[test]
fn everything_without_a_counterpart_has_a_note() {
    let import = import(FULL);
    let mut expected: BTreeMap<&str, usize> = BTreeMap::new();
    for (element, part) in [
        ("log", "<log>"),
        ("profiling", "<profiling"),
        ("data, bounds", "<data:vector"),
        ("data, waveform-degree", "<data:scalar name=\"Pressure\""),
        ("receive-mesh, safety-factor", "<receive-mesh"),
        ("mapping:rbf-pum-direct, polynomial", "<mapping:rbf"),
        ("mapping:rbf-pum-direct, executor", "<mapping:rbf"),
        ("mapping:rbf-pum-direct, vertices-per-cluster", "<mapping:rbf"),
        ("export:vtu", "<export"),
        ("export:vtu, every-iteration", "<export"),
        ("intra-comm", "<intra-comm"),
        ("watch-point", "<watch-point"),
        ("watch-integral", "<watch-integral"),
        ("action:divide-by-area", "<action"),
        ("m2n:sockets", "<m2n"),
        ("exchange, substeps", "<exchange data=\"Motion\""),
        ("convergence-measure, suffices", "<absolute-convergence"),
        ("absolute-or-relative-convergence-measure", "<absolute-or"),
        ("acceleration:IQN-IMVJ, always-build-jacobian", "<acceleration"),
        ("acceleration, data", "<acceleration"),
        ("acceleration, scaling", "<data name=\"Motion\""),
        ("preconditioner, constant", "<preconditioner"),
        ("preconditioner, freeze-after", "<preconditioner"),
        ("filter, type", "<filter"),
        ("filter, limit", "<filter"),
        ("initial-relaxation, enforce", "<initial-relaxation"),
        ("imvj-restart-mode", "<imvj"),
    ] {
        expected.insert(element, line(FULL, part));
    }
    let others = ["participant", "data"];
    let found: BTreeMap<&str, usize> = import
        .notes
        .iter()
        .filter(|note| !others.contains(&note.element.as_str()))
        .map(|note| (note.element.as_str(), note.lines[0]))
        .collect();
    assert_eq!(found, expected);
    for note in &import.notes {
        let first = note.to_string();
        let first: String = first.split_whitespace().take(4).collect::<Vec<_>>().join(" ");
        assert!(import.text.contains(&format!("# - {first}")), "{first}\n{}", import.text);
    }
    assert!(import.text.lines().all(|line| line.chars().count() <= 100), "{}", import.text);
}

#[test]
fn direct_access_and_several_meshes_are_named() {
    let direct = with(SMALL, "name=\"Way\" mesh=\"Other\"", "name=\"Way\" mesh=\"Point\"");
    let notes = import(&direct).notes;
    assert!(notes.iter().any(|note| note.reason.contains("direct access")), "{notes:?}");
    let twice = with(
        SMALL,
        "<write-data name=\"Way\" mesh=\"Other\" />",
        "<write-data name=\"Way\" mesh=\"Other\" />\n<write-data name=\"Way\" mesh=\"Point\" />",
    );
    let notes = import(&twice).notes;
    assert!(notes.iter().any(|note| note.reason.contains("several meshes")), "{notes:?}");
}

#[test]
fn names_cannot_break_the_case() {
    let hard = with(SMALL, "\"Force\"", "\"a&quot;] [case] b\\ -> ß\"");
    let hard = with(&hard, "\"Right\"", "\"R [x] &quot;\"");
    let import = import(&hard);
    let case: Table =
        import.text.parse().unwrap_or_else(|error| panic!("{error}\n{}", import.text));
    let tables: Vec<&String> = case.keys().collect();
    assert_eq!(tables, ["case", "coupling", "left", "mapping", "r_x", "time"]);
}
