//! Recordings of unknown origin: `inspect`, also with `--against`, `export` and `replay` end with a
//! result or an error for any content. They only write files of plain names into the given folder.

use super::configuration::Reconfiguration;
use super::*;
use crate::export::{Exported, Target, export};
use crate::inspect::against::{compare, text as text_of_difference};
use crate::inspect::{ListFilter, survey, text as text_of};
use contract::configuration::{Configuration, Mode};
use contract::description::{Description, KeySpec, ModelSpec};
use contract::grid::{Grid, Structured};
use contract::message::{Command, CommandKind, FieldHeader, Label, Reply, Topic, Topics};
use contract::params::Params;
use proptest::prelude::*;
use proto::recording::{
    CaseFile, Compression, Event, FORMAT, Head, Iteration, Recording, RecordingError,
    RecordingWriter, read_topics,
};
use std::io::Cursor;

fn description() -> Description {
    let model = ModelSpec {
        name: "columns".to_owned(),
        summary: "a model".to_owned(),
        source: "a book".to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes: Vec::new(),
        provides: vec!["lower_temperature".to_owned()],
        keys: vec![KeySpec::number("thermal.depth", "a depth")],
        accuracy: contract::accuracy::Accuracy::default(),
    };
    Description {
        protocol: contract::PROTOCOL_VERSION,
        name: "strips".to_owned(),
        version: "1".to_owned(),
        role: "thermal".to_owned(),
        standalone: true,
        reusable: true,
        models: vec![model],
        ..Description::default()
    }
}

/// Content that may differ from a good recording of one participant with one output.
#[derive(Clone, Debug)]
struct Content {
    role: String,
    program: String,
    service: String,
    field: String,
    producer: String,
    unit: String,
    grid: String,
    case: String,
    counts: [u64; 2],
    label: (u32, u64),
    edits: Vec<(f64, usize, Vec<u8>)>,
    /// Windows that are not accepted.
    rejected: Vec<u64>,
}

impl Content {
    fn good() -> Self {
        let [role, program] = ["thermal", "thermal-solver"].map(str::to_owned);
        let [field, grid] = ["lower_temperature", "contact"].map(str::to_owned);
        let service = format!("field/{role}/{field}");
        let (producer, unit, case) = (role.clone(), "K".to_owned(), "small".to_owned());
        Self {
            role,
            program,
            service,
            field,
            producer,
            unit,
            grid,
            case,
            counts: [3, 2],
            label: (1, 6),
            edits: Vec::new(),
            rejected: Vec::new(),
        }
    }

    fn head(&self) -> Head {
        let participant = Participant {
            role: self.role.clone(),
            program: self.program.clone(),
            description: description(),
        };
        Head {
            format: FORMAT,
            protocol: contract::PROTOCOL_VERSION,
            writer: "test".to_owned(),
            case: self.case.clone(),
            scheme: "serial-explicit".to_owned(),
            acceleration: "none".to_owned(),
            participants: vec![participant],
            files: Vec::new(),
        }
    }

    /// Returns the topics as JSON, with any counts.
    fn topics(&self) -> Vec<u8> {
        let [ni, nj] = self.counts.map(|count| usize::try_from(count).unwrap());
        let shape = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, ni, nj);
        let grid = Grid::structured(&self.grid, shape);
        let (field, service) = (self.field.clone(), self.service.clone());
        let topic = Topic { field, service, grid, subscribers: 1, geometry: None };
        let topics = Topics { outputs: vec![topic], deadline: 1.0, ..Topics::default() };
        serde_json::to_vec(&topics).unwrap()
    }

    /// Returns the bytes of a recording: Describe, Configure, Connect, Initialise, and two windows.
    fn bytes(&self) -> Vec<u8> {
        self.written().map_or_else(|_| Vec::new(), |whole| edited(&whole, &self.edits))
    }

    fn written(&self) -> Result<Vec<u8>, RecordingError> {
        let out = Cursor::new(Vec::new());
        let mut to = RecordingWriter::create(out, Compression::None, &self.head(), &[])?;
        let said = serde_json::to_vec(&description()).unwrap();
        for (kind, given, said) in [
            (CommandKind::Describe, Vec::new(), said),
            (CommandKind::Configure, configuration(), b"{}".to_vec()),
            (CommandKind::Connect, self.topics(), Vec::new()),
            (CommandKind::Initialise, Vec::new(), Vec::new()),
        ] {
            let command = Command::new(kind);
            to.event(&Event::Command { participant: 0, command, body: given })?;
            to.event(&Event::Reply { participant: 0, reply: Reply::default(), body: said })?;
        }
        let (components, points) = self.label;
        let values = vec![1.0; (u64::from(components) * points).min(1000) as usize];
        for window in 0..2 {
            let command = Command { window, iteration: 1, ..Command::new(CommandKind::Solve) };
            to.event(&Event::Command { participant: 0, command, body: Vec::new() })?;
            let header = FieldHeader {
                components,
                points,
                window,
                iteration: 1,
                sequence: window + 1,
                name: Label::new(&self.field),
                unit: Label::new(&self.unit),
                producer: Label::new(&self.producer),
                grid: Label::new(&self.grid),
                ..FieldHeader::default()
            };
            to.sample(&self.service, &header, &values)?;
            to.event(&Event::Reply { participant: 0, reply: Reply::default(), body: Vec::new() })?;
            to.state("thermal", &[7; 5])?;
            to.event(&Event::Iteration(Iteration { window, ..Iteration::default() }))?;
            let accept = Command { window, iteration: 1, ..Command::new(CommandKind::Accept) };
            if !self.rejected.contains(&window) {
                to.event(&Event::Command { participant: 0, command: accept, body: Vec::new() })?;
            }
        }
        Ok(to.finish()?.into_inner())
    }
}

fn configuration() -> Vec<u8> {
    let configuration = Configuration {
        role: "thermal".to_owned(),
        model: "columns".to_owned(),
        mode: Mode::Steady,
        windows: None,
        case: Params(serde_json::json!({"rail": {"profile": "files/bodies.rail.profile"}})),
        histories: None,
        inputs: Vec::new(),
        outputs: Vec::new(),
        observed: ["lower_temperature", "lower_section_temperature"].map(str::to_owned).to_vec(),
        threads: 1,
    };
    serde_json::to_vec(&configuration).unwrap()
}

/// Changes, removes or inserts pieces of a file.
fn edited(whole: &[u8], edits: &[(f64, usize, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for (share, length, piece) in edits {
        let start = (share * bytes.len() as f64) as usize;
        let end = (start + length).min(bytes.len());
        bytes.splice(start..end, piece.iter().copied());
    }
    bytes
}

fn request(recording: &Path, set: &[(&str, serde_json::Value)]) -> Request {
    Request {
        recording: recording.to_owned(),
        only: "thermal".to_owned(),
        program: None,
        serve: false,
        tolerance: None,
        from: None,
        until: None,
        set: set.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect(),
        step: None,
    }
}

/// Inspects and exports the recording, and reads it like a replay. Returns the files written by the
/// export.
fn survive(bytes: &[u8]) -> Result<Vec<String>, TestCaseError> {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("r.mcap");
    std::fs::write(&path, bytes).unwrap();
    let inspected = Recording::open(bytes).map(|mut recording| {
        let wanted = ListFilter { window: Some(0), ..ListFilter::default() };
        text_of(&survey(&mut recording, &wanted), &path)
    });
    if let Ok(text) = inspected {
        prop_assert!(!text.contains(['\u{1b}', '\u{9b}', '\r']), "{text:?}");
    }
    let good = Content::good().bytes();
    let compared = Recording::open(bytes).map(|mut recording| {
        let mut reference = Recording::open(good.as_slice()).unwrap();
        let found = compare((&mut recording, &path), (&mut reference, &path));
        found.map(|found| text_of_difference(&found, [&path, &path]))
    });
    if let Ok(Ok(text)) = compared {
        prop_assert!(!text.contains(['\u{1b}', '\u{9b}', '\r']), "{text:?}");
    }
    let folder = place.path().join("a/b");
    if let Ok(mut recording) = Recording::open(bytes) {
        let (vtk, csv) = (Some(folder.clone()), Some(folder.clone()));
        let _ = export(&path, &mut recording, &Target { vtk, csv, every_iteration: true });
    }
    replayed(&path, bytes);
    let names = |folder: &Path| -> Vec<String> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.file_name().into_string().unwrap()).collect()
    };
    let (outer, middle) = (names(place.path()), names(&place.path().join("a")));
    prop_assert!(outer.iter().all(|name| ["a", "r.mcap"].contains(&name.as_str())), "{outer:?}");
    prop_assert!(middle.iter().all(|name| name == "b"), "{middle:?}");
    let written = names(&folder);
    for name in &written {
        let plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        prop_assert!(name.chars().all(plain), "{name:?}");
        prop_assert!(folder.join(name).metadata().unwrap().len() < 1 << 16, "{name}");
    }
    Ok(written)
}

/// Reads a recording like a replay before it starts a program.
fn replayed(path: &Path, bytes: &[u8]) {
    let _ = last_state_before(path, "thermal", 1);
    let Ok(mut recording) = Recording::open(bytes) else { return };
    let Ok(index) = participant(path, &recording.head().participants, "thermal") else { return };
    let recorded = recording.head().participants[index].clone();
    let program = built_in(path, &recorded);
    assert!(program.is_err(), "there is no solver beside the tests: {program:?}");
    let said = description();
    let request = request(path, &[]);
    while let Ok(Some(entry)) = recording.read() {
        if let Item::Event(Event::Command { body, .. }) = entry.item {
            let (request, recorded, files) = (&request, &recorded, &[]);
            let given = Reconfiguration { request, recorded, description: Some(&said), files };
            let _ = given.configuration(&body);
            if let Ok(topics) = read_topics(&body) {
                assert!(topics.outputs.iter().all(|topic| topic.grid.points() <= 1 << 27));
            }
        }
    }
}

/// Names that a file may claim.
fn name() -> impl Strategy<Value = String> {
    let known = ["..", "../evil", "/etc/x", "", "a/b", "a\nb", "\u{1b}[2J", ".", "a.b", "*", "con"];
    prop_oneof![
        3 => (0..known.len()).prop_map(move |at| known[at].to_owned()),
        2 => Just("thermal".to_owned()),
        1 => ".{0,40}",
    ]
}

fn count() -> impl Strategy<Value = u64> {
    let known = [0, 1, 2, 3, 6, 7, 1 << 20, 7_071_068, 1 << 31, 1 << 33, u64::MAX / 2, u64::MAX];
    (0..known.len()).prop_map(move |at| known[at])
}

/// A good recording with some changes.
fn content() -> impl Strategy<Value = Content> {
    let name = || proptest::option::weighted(0.15, name());
    let texts = [name(), name(), name(), name(), name(), name(), name(), name()];
    let counts = proptest::option::weighted(0.5, [count(), count()]);
    let label = proptest::option::weighted(0.3, (0..5_u32, count()));
    let piece = proptest::collection::vec(any::<u8>(), 0..9);
    let edits = proptest::collection::vec((0.0..1.0_f64, 0..9_usize, piece), 0..3);
    let edits = proptest::option::weighted(0.3, edits);
    (texts, counts, label, edits).prop_map(|(texts, counts, label, edits)| {
        let mut content = Content::good();
        let Content { role, program, service, field, producer, unit, grid, case, .. } =
            &mut content;
        let places = [role, program, service, field, producer, unit, grid, case];
        for (place, text) in places.into_iter().zip(texts) {
            *place = text.unwrap_or_else(|| place.clone());
        }
        content.counts = counts.unwrap_or(content.counts);
        content.label = label.unwrap_or(content.label);
        content.edits = edits.unwrap_or_default();
        content
    })
}

proptest! {
    #![proptest_config(crate::fuzz_config())]

    #[test]
    fn any_recording_is_survived(content in content()) {
        survive(&content.bytes())?;
    }
}

/// A window that was passed over, or in which the run failed, has no results.
#[test]
fn only_accepted_windows_are_exported() {
    for (rejected, instants) in [(vec![], 2), (vec![1], 1), (vec![0], 1), (vec![0, 1], 0)] {
        let place = tempfile::tempdir().unwrap();
        let content = Content { rejected: rejected.clone(), ..Content::good() };
        let bytes = content.bytes();
        let mut recording = Recording::open(bytes.as_slice()).unwrap();
        let target = Target { csv: Some(place.path().to_owned()), ..Target::default() };
        let exported = export(place.path(), &mut recording, &target).unwrap();
        let expected = Exported { instants, rejected: rejected.len() as u64 };
        assert_eq!(exported, expected);
        for window in 0..2 {
            let file = place.path().join(format!("thermal_lower_temperature_{window:06}.csv"));
            assert_eq!(file.is_file(), !rejected.contains(&window), "{rejected:?}");
        }
    }
}

#[test]
fn a_good_recording_is_exported_whole() {
    let mut written = survive(&Content::good().bytes()).unwrap();
    written.sort();
    let expected = |n: usize| {
        [format!("thermal_contact_{n:06}.csv"), format!("thermal_contact_{n:06}.vti")]
            .into_iter()
            .chain([format!("thermal_lower_temperature_{n:06}.csv")])
    };
    for name in expected(0).chain(expected(1)) {
        assert!(written.contains(&name), "{name} is not among {written:?}");
    }
}

/// An impossible grid, or a grid that does not fit its values.
#[test]
fn a_grid_that_does_not_fit_is_an_error_that_names_it() {
    let given = |counts: [u64; 2], label: (u32, u64)| {
        let bytes = Content { counts, label, ..Content::good() }.bytes();
        let place = tempfile::tempdir().unwrap();
        let csv = Some(place.path().join("csv"));
        let mut recording = Recording::open(&bytes[..]).unwrap();
        let target = Target { csv, ..Target::default() };
        let exported = export(Path::new("r.mcap"), &mut recording, &target);
        exported.map_err(|error| error.to_string())
    };
    assert_eq!(given([3, 2], (1, 6)), Ok(Exported { instants: 2, rejected: 0 }));
    for (counts, label, words) in [
        ([0, 2], (1, 6), "grid `contact` has 0 x 2 points"),
        ([7_071_068, 7_071_068], (1, 6), "grid `contact` has 7071068 x 7071068 points"),
        ([100_000, 100_000], (1, 6), "has 10000000000 points: no recording holds a field on it"),
        ([30, 20], (1, 6), "1 component(s) at 6 point(s); its grid `contact` has 600"),
        ([3, 2], (2, 6), "2 component(s) at 6 point(s)"),
    ] {
        let error = given(counts, label).unwrap_err();
        assert!(error.contains(words) && error.contains("r.mcap"), "{error}");
    }
}

fn given(
    set: &[(&str, serde_json::Value)],
    description: Option<&Description>,
) -> Result<serde_json::Value, String> {
    let content = Content::good();
    let recorded = &content.head().participants[0];
    let request = &request(Path::new("r.mcap"), set);
    let (key, attachment) = ("/here/file-0".to_owned(), "files/bodies.rail.profile".to_owned());
    let files = &[CaseFile { key, attachment }];
    let given =
        Reconfiguration { request, recorded, description, files }.configuration(&configuration());
    given.map(|(body, _)| serde_json::from_slice(&body).unwrap()).map_err(|error| error.to_string())
}

#[test]
fn a_configuration_is_given_with_files_and_changes() {
    let said = description();
    let (depth, pointer) = (serde_json::json!(2.0), "/case/thermal/depth");
    let changed = given(&[("thermal.depth", depth.clone())], Some(&said)).unwrap();
    assert_eq!(changed.pointer("/case/rail/profile").unwrap(), "/here/file-0");
    assert_eq!(changed.pointer(pointer), Some(&depth), "the program reads it");
    let unknown = given(&[("thermal.dept", depth)], Some(&said)).unwrap_err();
    assert_eq!(unknown, "the recorded configuration of thermal has no `thermal.dept`");
}

#[test]
fn a_program_without_the_recorded_model_is_refused_with_a_fix() {
    let mut other = description();
    "strips".clone_into(&mut other.models[0].name);
    assert!(given(&[], Some(&description())).is_ok());
    let error = given(&[], Some(&other)).unwrap_err();
    for words in [
        "`strips` has no model `columns`, which is in",
        "--set thermal.model=NAME (strips)",
        "replay with the program that was recorded, `thermal-solver`",
    ] {
        assert!(error.contains(words), "{error}");
    }
    let chosen = given(&[("thermal.model", "strips".into())], Some(&other)).unwrap();
    assert_eq!(chosen["model"], "strips");
    assert_eq!(chosen["observed"], serde_json::json!(["lower_temperature"]), "what it provides");
}

#[test]
fn one_text_is_a_command_line() {
    let split = |command: &[&str]| {
        words(&command.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>())
    };
    assert_eq!(split(&["a 'b c' d\\ e"]).unwrap(), ["a", "b c", "d e"]);
    assert_eq!(split(&["a b", "c"]).unwrap(), ["a b", "c"]);
    assert!(split(&["a 'b"]).unwrap_err().to_string().contains("quote"));
}
