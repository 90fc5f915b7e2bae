//! Reading of a configuration: elements, look-ups, errors with their lines.

use crate::texts::{FULL, SMALL, line, with};
use precice_config::acceleration::{AccelerationKind, FilterKind, PreconditionerKind};
use precice_config::configuration::DataKind;
use precice_config::participant::{Constraint, Direction, MappingKind, MeshData};
use precice_config::scheme::{Limit, SchemeKind, Window};
use precice_config::{ConfigError, Configuration};

fn parse(text: &str) -> Configuration {
    Configuration::parse(text).unwrap_or_else(|error| panic!("{error}"))
}

fn fault(text: &str) -> ConfigError {
    Configuration::parse(text).expect_err("the text has an error")
}

#[test]
fn participants_have_all_their_elements() {
    let configuration = parse(FULL);
    assert_eq!(configuration.unknown, []);
    assert_eq!(configuration.services.len(), 2);
    let data: Vec<_> = configuration
        .data
        .iter()
        .map(|data| (data.name.as_str(), data.kind, data.waveform_degree, data.bounded))
        .collect();
    let expected =
        [("Pressure", DataKind::Scalar, 0, false), ("Motion", DataKind::Vector, 1, true)];
    assert_eq!(data, expected);

    let stream = configuration.participant("Stream").unwrap();
    assert_eq!(stream.receives[0].safety_factor, 1.5);
    assert!(!stream.receives[0].api_access);
    let [write, read] = stream.mappings.as_slice() else { panic!("{:?}", stream.mappings) };
    assert_eq!(write.kind, MappingKind::RbfPumDirect);
    assert_eq!((write.direction, write.constraint), (Direction::Write, Constraint::Conservative));
    assert_eq!(write.basis.as_ref().unwrap().support_radius, Some(0.25));
    let options = [("vertices-per-cluster", "80"), ("executor", "openmp")];
    assert_eq!(write.options, options.map(|(name, value)| (name.to_owned(), value.to_owned())));
    assert_eq!((write.line, read.line), (line(FULL, "<mapping:rbf"), line(FULL, "<mapping:near")));
    assert_eq!(stream.exports[0].every_windows, 5);
    assert!(stream.exports[0].every_iteration && stream.intra_comm.is_some());

    let plate = configuration.participant("Plate").unwrap();
    let watched: Vec<_> = plate.watches.iter().map(|watch| watch.element.as_str()).collect();
    assert_eq!(watched, ["watch-point", "watch-integral"]);
    assert_eq!(plate.actions[0].targets, ["Pressure"]);
    assert_eq!(configuration.connections[0].acceptor, "Stream");
}

#[test]
fn schemes_have_all_their_elements() {
    let configuration = parse(FULL);
    let [scheme] = configuration.schemes.as_slice() else { panic!("one scheme") };
    assert_eq!(scheme.kind, SchemeKind::ParallelImplicit);
    assert_eq!(scheme.participants, ["Stream", "Plate"]);
    assert_eq!(scheme.window.value, Window::Fixed(0.1));
    assert_eq!(scheme.max_time.unwrap().value, 7.0);
    let counts = [scheme.max_time_windows, scheme.min_iterations, scheme.max_iterations];
    assert_eq!(counts.map(|count| count.unwrap().value), [3, 2, 40]);
    let flags: Vec<_> = scheme.exchanges.iter().map(|one| (one.initialize, one.substeps)).collect();
    assert_eq!(flags, [(true, None), (false, Some(true))]);
    let limits: Vec<_> = scheme.measures.iter().map(|measure| measure.limit).collect();
    let expected = [
        Limit::Relative(1e-3),
        Limit::Absolute(1e-5),
        Limit::ResidualRelative(1e-4),
        Limit::AbsoluteOrRelative { absolute: 1.0, relative: 1e-4 },
    ];
    assert_eq!(limits, expected);
    let words: Vec<_> = scheme.measures.iter().map(|one| (one.strict, one.suffices)).collect();
    assert_eq!(words, [(true, false), (false, true), (false, false), (false, false)]);

    let acceleration = scheme.acceleration.as_ref().unwrap();
    assert_eq!(acceleration.kind, AccelerationKind::IqnImvj);
    assert_eq!(acceleration.relaxation.unwrap().value, 0.2);
    assert!(acceleration.enforce_initial);
    assert_eq!(acceleration.data[0].scaling, 2.0);
    let filter = acceleration.filter.as_ref().unwrap();
    assert_eq!((filter.kind, filter.limit), (FilterKind::Qr1, 1e-9));
    let preconditioner = acceleration.preconditioner.as_ref().unwrap();
    assert_eq!(preconditioner.kind, PreconditionerKind::Constant);
    assert_eq!(preconditioner.freeze_after, 4);
    assert_eq!(acceleration.restart.as_ref().unwrap().chunk_size, 6);
}

#[test]
fn components_follow_data_and_mesh() {
    let of = |data: &str| MeshData { mesh: "Wet".into(), data: data.into(), line: 0 };
    let plane = parse(FULL);
    let space = parse(&with(FULL, "dimensions=\"2\"", "dimensions=\"3\""));
    assert_eq!(["Pressure", "Motion"].map(|data| plane.components(&of(data))), [1, 2]);
    assert_eq!(["Pressure", "Motion"].map(|data| space.components(&of(data))), [1, 3]);
    let stream = space.participant("Stream").unwrap();
    let meshes: Vec<_> =
        space.provided_meshes(stream).map(|mesh| (mesh.name.as_str(), mesh.dimensions)).collect();
    assert_eq!(meshes, [("Wet", 3)]);
    assert_eq!(space.participant("stream"), None);
}

#[test]
fn initial_data_reach_the_mesh_of_the_exchange() {
    let writes = |text: &str, participant: &str| {
        let configuration = parse(text);
        let participant = configuration.participant(participant).unwrap();
        configuration.writes_initially(participant, &participant.writes[0])
    };
    // Through the mapping from `Wet` to `Body`.
    assert!(writes(FULL, "Stream"));
    assert!(!writes(FULL, "Plate"));
    assert!(!writes(&with(FULL, "initialize=\"on\"", "initialize=\"off\""), "Stream"));
    // On the same mesh.
    let direct = with(FULL, "substeps=\"true\"", "initialize=\"true\"");
    assert!(writes(&direct, "Plate"));
}

#[test]
fn one_conservative_mapping_makes_data_conservative() {
    let configuration = parse(FULL);
    assert!(configuration.is_conservative("Pressure"));
    assert!(!configuration.is_conservative("Motion"));
    let scaled = parse(&with(FULL, "\"conservative\"", "\"scaled-consistent-surface\""));
    assert!(!scaled.is_conservative("Pressure"));
    // A mapping without a mesh on one side moves the data of the other side.
    let free = parse(&with(FULL, "from=\"Wet\" to=\"Body\"", "to=\"Body\""));
    assert!(!free.is_conservative("Pressure"), "Stream writes nothing on `Body`");
    let free = parse(&with(
        &with(FULL, "from=\"Wet\" to", "to"),
        "Pressure\" mesh=\"Wet",
        "Pressure\" mesh=\"Body",
    ));
    assert!(free.is_conservative("Pressure"));
}

#[test]
fn declared_prefixes_change_nothing() {
    let declared = with(
        FULL,
        "<precice-configuration ",
        "<precice-configuration xmlns:data=\"urn:x\" xmlns:mapping='urn:y' ",
    );
    assert_eq!(parse(&declared), parse(FULL));
    let lines = format!("\u{feff}{}", with(FULL, "\n", "\r\n"));
    assert_eq!(parse(&lines), parse(FULL));
}

#[test]
fn the_order_of_attributes_changes_nothing() {
    let turned = with(
        SMALL,
        "direction=\"read\" from=\"Point\" to=\"Other\"",
        "to='Other' from='Point' direction='read'",
    );
    assert_eq!(parse(&turned), parse(SMALL));
}

#[test]
fn unknown_elements_and_attributes_are_collected() {
    let more = with(
        &with(
            SMALL,
            "<data:scalar name=\"Force\" />",
            "<data:scalar name=\"Force\" colour=\"red\" /><data:tensor name=\"T\" /><x:y />",
        ),
        "<max-time value=\"2\" />",
        "<max-time value=\"2\" /><extrapolation-order value=\"2\" />",
    );
    let configuration = parse(&more);
    let found: Vec<_> = configuration
        .unknown
        .iter()
        .map(|one| (one.line, one.element.as_str(), one.attribute.as_deref()))
        .collect();
    let expected = [
        (2, "data:scalar", Some("colour")),
        (2, "data:tensor", None),
        (2, "x:y", None),
        (line(SMALL, "<max-time"), "extrapolation-order", None),
    ];
    assert_eq!(found, expected);
    assert_eq!(Configuration { unknown: Vec::new(), ..configuration }, parse(SMALL));
}

#[test]
fn a_window_may_belong_to_the_first_participant() {
    let window = |text: &str| {
        let text = with(SMALL, "<time-window-size value=\"0.5\" />", text);
        parse(&text).schemes[0].window.value
    };
    for first in [
        "<time-window-size method=\"first-participant\" />",
        "<time-window-size value=\"-1\" method=\"first-participant\" />",
        "<time-window-size value=\"-1\" />",
    ] {
        assert_eq!(window(first), Window::FirstParticipant, "{first}");
    }
    assert_eq!(window("<time-window-size value=\"1/8\" />"), Window::Fixed(0.125));
    assert_eq!(window("<time-window-size value=\" 2. \" />"), Window::Fixed(2.0));
}

#[test]
fn errors_name_line_and_reason() {
    let cases = [
        ("dimensions=\"3\"", "dimensions=\"4\"", 4, "dimensions=\"4\" is not one of 2, 3"),
        (" dimensions=\"3\"", "", 4, "<mesh> has no attribute `dimensions`"),
        ("value=\"0.5\"", "value=\"half\"", 21, "value=\"half\" is not a finite number"),
        ("value=\"0.5\"", "value=\"1/0\"", 21, "\"1/0\" is not a finite number"),
        ("value=\"0.5\"", "value=\"inf\"", 21, "\"inf\" is not a finite number"),
        ("value=\"0.5\"", "value=\"0\"", 21, "\"0\" is not a number above 0"),
        (
            "name=\"Way\" mesh=\"Other\"",
            "name=\"Wy\" mesh=\"Other\"",
            15,
            "the data \"Wy\" is not defined; defined are: Force, Way",
        ),
        (
            "mesh name=\"Other\"",
            "mesh name=\"Point\"",
            5,
            "the mesh \"Point\" is defined a second time",
        ),
        (
            "provide-mesh name=\"Other\"",
            "provide-mesh name=\"Point\"",
            14,
            "\"Right\" neither provides nor receives the mesh \"Other\"",
        ),
        (
            "from=\"Right\" to=\"Left\"",
            "from=\"Up\" to=\"Left\"",
            24,
            "the participant \"Up\" is not defined",
        ),
        (
            "<max-time value=\"2\" />",
            "",
            19,
            "<coupling-scheme:serial-explicit> has no element <max-time>",
        ),
        ("<time-window-size value=\"0.5\" />", "", 19, "has no element <time-window-size>"),
        (
            "<participants first=\"Left\" second=\"Right\" />",
            "",
            19,
            "has no element <participants>",
        ),
        ("direction=\"read\"", "direction=\"up\"", 16, "\"up\" is not one of write, read"),
        (
            "</precice-configuration>",
            "</precice>",
            26,
            "not XML: expected 'precice-configuration' tag",
        ),
    ];
    for (from, to, line, reason) in cases {
        let text = with(SMALL, from, to);
        let message = fault(&text).to_string();
        assert!(message.starts_with(&format!("line {line}: ")), "{message}");
        assert!(message.contains(reason), "{message}");
    }
    let carried = with(
        SMALL,
        "<mesh name=\"Other\" dimensions=\"3\"><use-data name=\"Force\" />",
        "<mesh name=\"Other\" dimensions=\"3\">",
    );
    assert!(matches!(fault(&carried), ConfigError::DataOfMesh { line: 14, .. }));
}

/// Names and elements that are defined, but stand where preCICE refuses them as well.
#[test]
fn what_contradicts_itself_is_refused() {
    let implicit = SMALL.replace("serial-explicit", "serial-implicit");
    let inside = |elements: &str| {
        with(&implicit, "<max-time value=\"2\" />", &format!("<max-time value=\"2\" />{elements}"))
    };
    let accelerated = |data: &str| {
        inside(&format!(
            "<acceleration:aitken><data name=\"{data}\" mesh=\"Point\" /></acceleration:aitken>"
        ))
    };
    let measured = |mesh: &str| {
        inside(&format!(
            "<relative-convergence-measure data=\"Way\" mesh=\"{mesh}\" limit=\"1e-4\" />"
        ))
    };
    assert!(Configuration::parse(&accelerated("Way")).is_ok());
    assert!(Configuration::parse(&measured("Point")).is_ok());
    let radial = |function: &str| {
        with(
            SMALL,
            "<mapping:nearest-neighbor direction=\"read\" from=\"Point\" to=\"Other\" constraint=\"consistent\" />",
            &format!(
                "<mapping:rbf direction=\"read\" from=\"Point\" to=\"Other\" constraint=\"consistent\">\
                 {function}</mapping:rbf>"
            ),
        )
    };
    for (text, line, reason) in [
        (inside("<max-time value=\"1\" />"), 22, "has a second <max-time>; remove one of them"),
        (inside("<time-window-size value=\"1\" />"), 22, "a second <time-window-size>"),
        (
            inside("<acceleration:IQN-ILS /><acceleration:constant />"),
            22,
            "a second <acceleration:constant>",
        ),
        (
            inside(
                "<acceleration:aitken><initial-relaxation value=\"1\" /><initial-relaxation value=\"2\" /></acceleration:aitken>",
            ),
            22,
            "<acceleration:aitken> has a second <initial-relaxation>",
        ),
        (accelerated("Force"), 22, "a serial scheme accelerates the data that return"),
        (measured("Other"), 22, "\"Way\" on the mesh \"Other\" is not exchanged in this scheme"),
        (measured("Other"), 22, "it is exchanged on \"Point\""),
        (
            inside("<min-iterations value=\"3\" /><max-iterations value=\"2\" />"),
            22,
            "min-iterations 3 is above max-iterations 2",
        ),
        (inside("<max-iterations value=\"0\" />"), 22, "is not a whole number from 1"),
        (
            with(SMALL, "name=\"Point\" from=\"Left\"", "name=\"Point\" from=\"Right\""),
            12,
            "\"Right\" receives the mesh \"Point\" from itself; write <provide-mesh",
        ),
        (
            with(
                SMALL,
                "<provide-mesh name=\"Point\" />",
                "<receive-mesh name=\"Point\" from=\"Right\" />",
            ),
            7,
            "from \"Right\", which does not provide it; it is provided by nobody",
        ),
        (with(SMALL, "second=\"Right\"", "second=\"Left\""), 19, "\"Left\" is coupled with itself"),
        (
            with(SMALL, "from=\"Right\" to=\"Left\"", "from=\"Left\" to=\"Left\""),
            24,
            "\"Way\" goes from \"Left\" to itself",
        ),
        (
            with(SMALL, "direction=\"read\" from", "direction=\"write\" from"),
            16,
            "a mapping with direction=\"write\"",
        ),
        (
            with(SMALL, "value=\"0.5\"", "value=\"0.5\" method=\"last-participant\""),
            21,
            "is not one of fixed, first-participant",
        ),
        (
            with(
                &SMALL.replace("serial-explicit", "parallel-explicit"),
                "value=\"0.5\"",
                "method=\"first-participant\"",
            ),
            21,
            "the only choice of a parallel scheme",
        ),
        (
            radial("<basis-function:compact-polynomial-c2 support-radius=\"0\" />"),
            16,
            "\"0\" is not a number above 0",
        ),
        (
            radial("<basis-function:volume-splines /><basis-function:thin-plate-splines />"),
            16,
            "<mapping:rbf> has a second <basis-function:thin-plate-splines>",
        ),
    ] {
        let message = fault(&text).to_string();
        assert!(message.starts_with(&format!("line {line}: ")), "{message}");
        assert!(message.contains(reason), "{message}");
    }
}

/// Names are shown in messages and become names of fields; they fit a line, and are seen.
#[test]
fn names_are_short_and_visible() {
    for hard in ["Wall&#10;Heat", "&#x9b;2J", "&#x202e;Force", &"x".repeat(300)] {
        let message = fault(&with(SMALL, "\"Force\"", &format!("\"{hard}\""))).to_string();
        assert!(message.starts_with("line 2: <data:scalar>: name="), "{message}");
        assert!(message.contains("is not a name of at most 255 bytes"), "{message}");
        assert!(message.len() < 300 && message.chars().all(|c| !c.is_control()), "{message}");
    }
    let value = fault(&with(SMALL, "\"0.5\"", "\"&#x9b;[2J\"")).to_string();
    assert!(value.contains("value=\"?[2J\" is not a finite number"), "{value}");
    let tag = "y".repeat(900_000);
    let message = fault(&format!("<precice-configuration><{tag}></precice-configuration>"));
    assert!(message.to_string().len() < 300);
}

/// The XML parser compares each attribute with all others of its element.
#[test]
fn attributes_of_an_element_are_limited() {
    let with_more = |count: usize| {
        let more: String = (0..count).map(|n| format!(" a{n}=\"1\"")).collect();
        with(SMALL, "<data:scalar name=\"Way\"", &format!("<data:scalar name=\"Way\"{more}"))
    };
    let begun = std::time::Instant::now();
    assert_eq!(fault(&with_more(40_000)), ConfigError::Attributes { line: 3, most: 64 });
    assert!(begun.elapsed().as_secs() < 5);
    // The name is one of the 64.
    parse(&with_more(63));
    assert_eq!(fault(&with_more(64)), ConfigError::Attributes { line: 3, most: 64 });
}

#[test]
fn other_files_are_refused() {
    assert!(matches!(fault(""), ConfigError::Xml { .. }));
    assert!(matches!(fault("<other/>"), ConfigError::Root { line: 1, .. }));
    let older = "<?xml version=\"1.0\"?>\n<solver-interface dimensions=\"3\"/>";
    assert!(fault(older).to_string().contains("version 2"), "{}", fault(older));
    let entity = "<!DOCTYPE x [<!ENTITY a \"b\">]><precice-configuration/>";
    assert!(matches!(fault(entity), ConfigError::Xml { .. }));
}

#[test]
fn size_and_depth_are_limited() {
    let long = with(
        SMALL,
        "</precice-configuration>",
        &format!("{}</precice-configuration>", " ".repeat(1 << 20)),
    );
    assert!(matches!(fault(&long), ConfigError::Size { .. }));
    let deep = format!("<precice-configuration>{}", "<a>".repeat(100_000));
    assert!(matches!(fault(&deep), ConfigError::Depth { line: 1, .. }));
    let many = format!("<precice-configuration>{}</precice-configuration>", "<a/>".repeat(110_000));
    assert!(matches!(fault(&many), ConfigError::Xml { .. }));
}
