//! JSON examples and tables in `docs/write-a-solver.md` agree with the code.

use crate::conform::check_names;
use crate::harness::root;
use proto::configuration::{Configuration, Layout, Refusal};
use proto::description::Description;
use proto::grid::Grid;
use proto::message::{
    Command, CommandKind, Failure, FieldHeader, Finished, GeometryTopic, Label, ProgressReport,
    Reply, StateFile, Topics,
};
use proto::run_dir::RunInfo;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::mem::{offset_of, size_of};

fn text() -> String {
    std::fs::read_to_string(root().join("docs/write-a-solver.md")).unwrap()
}

/// JSON block after `<!-- NAME -->`.
fn example(name: &str) -> Value {
    let text = text();
    let (_, rest) = text.split_once(&format!("<!-- {name} -->\n```json\n")).expect(name);
    serde_json::from_str(rest.split_once("\n```").unwrap().0).expect(name)
}

/// Parses an example and asserts that no key of it is ignored.
fn read<T: DeserializeOwned + Serialize>(name: &str) -> T {
    let example = example(name);
    let read: T = serde_json::from_value(example.clone()).expect(name);
    assert_within(&example, &serde_json::to_value(&read).unwrap(), name);
    read
}

/// Asserts that every key of the example was read, with the same value.
fn assert_within(example: &Value, read: &Value, place: &str) {
    match (example, read) {
        (Value::Object(a), Value::Object(b)) => {
            for (key, value) in a {
                let place = format!("{place}.{key}");
                // An empty list may be omitted when written.
                let empty = value.as_array().is_some_and(Vec::is_empty);
                match b.get(key) {
                    Some(read) => assert_within(value, read, &place),
                    None => assert!(empty, "{place} is not read"),
                }
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{place}");
            a.iter().zip(b).for_each(|(a, b)| assert_within(a, b, place));
        }
        (Value::Number(a), Value::Number(b)) => assert_eq!(a.as_f64(), b.as_f64(), "{place}"),
        (a, b) => assert_eq!(a, b, "{place}"),
    }
}

#[test]
fn the_examples_are_what_the_code_reads() {
    let description: Description = read("Description");
    assert_eq!(description.check(), Ok(()));
    assert_eq!(description.protocol, proto::PROTOCOL_VERSION);
    let configuration: Configuration = read("Configuration");
    assert_eq!(description.admit(&configuration), Ok(()));
    let layout: Layout = read("Layout");
    assert_eq!(layout.check(), Ok(()));
    assert_eq!(layout.grid_of("lower_temperature"), configuration.input_grid("friction_power"));
    assert_eq!(read::<Grid>("Grid").check(), Ok(()));
    let points = read::<Grid>("Points");
    assert_eq!((points.check(), points.points()), (Ok(()), 8));
    let vertices = read::<Grid>("Vertices");
    assert_eq!((vertices.check(), vertices.integrate(&[3.0; 4])), (Ok(()), 3.0));
    let volume = read::<Grid>("Volume");
    assert_eq!((volume.check(), volume.points()), (Ok(()), 1_000_000));
    assert!(volume.is_announced());
    assert_eq!(read::<GeometryTopic>("GeometryTopic").grid, volume.name);
    assert_eq!(read::<RunInfo>("RunInfo").protocol, proto::PROTOCOL_VERSION);
    assert_eq!(read::<Topics>("Topics").outputs[0].grid, layout.grids[0]);
    assert_eq!(read::<StateFile>("StateFile").outputs.len(), 1);
    assert!(read::<Finished>("Finished").summary.is_object());
    assert_eq!(read::<Refusal>("Refusal").key, "motion.speed");
    assert!(read::<Failure>("Failure").error.contains("friction_power"));
}

/// Rows of a layout table: offset, type and name.
fn table(name: &str) -> (usize, Vec<(usize, String, String)>) {
    let text = text();
    let (_, rest) = text.split_once(&format!("#### {name}, ")).expect(name);
    let size = rest.split_once(" bytes").unwrap().0.parse().unwrap();
    let rows = rest.lines().skip(2).skip_while(|line| !line.starts_with("|---")).skip(1);
    let rows = rows.take_while(|line| line.starts_with('|')).map(|line| {
        let mut cells = line.split('|').skip(1).map(str::trim);
        let offset = cells.next().unwrap().parse().unwrap();
        let kind = cells.next().unwrap().to_owned();
        (offset, kind, cells.next().unwrap().trim_matches('`').to_owned())
    });
    (size, rows.collect())
}

/// Name of a type in the tables.
trait Word {
    const WORD: &str;
}
impl Word for u32 {
    const WORD: &str = "u32";
}
impl Word for u64 {
    const WORD: &str = "u64";
}
impl Word for f64 {
    const WORD: &str = "f64";
}
impl Word for [u64; 16] {
    const WORD: &str = "u64[16]";
}
impl Word for Label<16> {
    const WORD: &str = "char[16]";
}
impl Word for Label<32> {
    const WORD: &str = "char[32]";
}

fn word<T: Word>(_: &T) -> String {
    T::WORD.to_owned()
}

macro_rules! layout {
    ($kind:ident: $($entry:ident),*) => {{
        let one = $kind::default();
        let rows = vec![$((offset_of!($kind, $entry), word(&one.$entry), stringify!($entry).to_owned())),*];
        (size_of::<$kind>(), rows)
    }};
}

#[test]
fn the_tables_are_the_layouts() {
    let command =
        layout!(Command: protocol, kind, sequence, window, iteration, flags, start, end, expected);
    assert_eq!(table("Command"), command);
    let reply = layout!(Reply: protocol, status, sequence, work, substeps, inner_iterations,
        received_power, model_seconds, wanted_window, present, reserved);
    assert_eq!(table("Reply"), reply);
    let header = layout!(FieldHeader: protocol, components, points, grid_revision, window, iteration,
        reserved, start, end, sequence, name, unit, producer, grid);
    assert_eq!(table("FieldHeader"), header);
    let progress = layout!(ProgressReport: sequence, done, of, what);
    assert_eq!(table("ProgressReport"), progress);
}

#[test]
fn every_command_and_every_check_is_told() {
    let text = text();
    for kind in CommandKind::ALL {
        let (number, name) = (kind as u32, format!("{kind:?}"));
        assert!(text.contains(&format!("{number} {name}")), "{name}");
        assert!(text.contains(&format!("\n| {name} |")), "{name}");
    }
    for name in check_names() {
        assert!(text.contains(&format!("`{name}`")), "{name}");
    }
}
