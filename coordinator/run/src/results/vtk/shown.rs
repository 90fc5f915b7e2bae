//! Fields as they are written: under the names of the bodies in the case, labelled for other
//! programs, with the series of their files over time.
//!
//! A file states the unit of each array in its information keys. Its field data hold a table with
//! unit, body and meaning of every array.

use contract::bodies::{Bodies, LOWER, POSITIONS, UPPER};
use contract::field::{Body, FieldKind};
use contract::grid::Grid;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// Fields with their values.
pub(super) type Fields<'a> = [(&'a FieldLabel, &'a [f64])];

/// Word in place of the name of a body, for a field of the interface.
pub const INTERFACE: &str = "interface";

/// A kind of field, named for display.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FieldLabel {
    /// Name, including the name of the body for a field of a body.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Number of components.
    pub components: u32,
    /// Name of the body, or `interface`.
    pub body: String,
    /// Meaning of the field, in one line.
    pub meaning: String,
}

impl FieldLabel {
    /// Returns the kind of a field in a case with these bodies.
    #[must_use]
    pub fn of(kind: &FieldKind, bodies: Option<&Bodies>) -> Self {
        let names = bodies.map_or(POSITIONS, |Bodies(names)| names.each_ref().map(String::as_str));
        let body = match kind.body {
            Body::Upper => names[UPPER],
            Body::Lower => names[LOWER],
            Body::Interface => INTERFACE,
        };
        Self {
            name: shown(&kind.name, bodies),
            unit: kind.unit.clone(),
            components: kind.components,
            body: body.to_owned(),
            meaning: kind.meaning.clone(),
        }
    }
}

/// Returns the name of a field or grid for display.
fn shown(name: &str, bodies: Option<&Bodies>) -> String {
    bodies.map_or_else(|| name.to_owned(), |bodies| bodies.shown(name))
}

/// Current values of a field.
#[derive(Clone, Debug)]
pub struct FieldOutput<'a> {
    /// Name of the series of files. Fields of the same producer and grid share a series.
    pub series: String,
    /// Grid of the field.
    pub grid: &'a Grid,
    /// Kind of the field.
    pub kind: FieldLabel,
    /// Values, component-major.
    pub values: &'a [f64],
}

impl<'a> FieldOutput<'a> {
    /// Returns a field that the participant of the role `producer` sends, in a case with these
    /// bodies.
    #[must_use]
    pub fn new(
        producer: &str,
        grid: &'a Grid,
        kind: &FieldKind,
        values: &'a [f64],
        bodies: Option<&Bodies>,
    ) -> Self {
        let series = format!("{producer}_{}", shown(&grid.name, bodies));
        Self { series, grid, kind: FieldLabel::of(kind, bodies), values }
    }
}

/// Function that returns the content of a table column for a field.
type Column = fn(&FieldLabel) -> String;

/// Returns the name of the array of a field, with its unit.
pub(super) fn array_name(kind: &FieldLabel) -> String {
    format!("{} [{}]", kind.name, kind.unit)
}

/// Returns VTK's information key for the unit of an array.
pub(super) fn unit(kind: &FieldLabel) -> String {
    let unit = escape(&kind.unit);
    format!(
        "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{unit}</InformationKey>"
    )
}

/// Returns the table of the arrays: one column for each property, one row for each array.
pub(super) fn table(fields: &Fields) -> String {
    let columns: [(&str, Column); 4] = [
        ("array", array_name),
        ("unit", |kind| kind.unit.clone()),
        ("body", |kind| kind.body.clone()),
        ("meaning", |kind| kind.meaning.clone()),
    ];
    let mut text = String::new();
    for (name, describe) in columns {
        let rows =
            fields.iter().map(|(kind, _)| codes(&describe(kind))).collect::<Vec<_>>().join(" ");
        let _ = writeln!(
            text,
            "      <Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{}\" format=\"ascii\">\
             {rows}</Array>",
            fields.len()
        );
    }
    text
}

/// Escapes a text for an XML element or attribute.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// Returns a string in VTK's form: the numbers of its bytes, and a final zero.
fn codes(text: &str) -> String {
    text.bytes().chain([0]).map(|byte| byte.to_string()).collect::<Vec<_>>().join(" ")
}

/// Files of a grid of a participant over time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FileSeries {
    /// Participant and grid.
    pub name: String,
    /// Time [s] and name of each file, the newest last.
    pub files: Vec<(f64, String)>,
}

/// First lines of a collection.
const COLLECTION: &str = "<?xml version=\"1.0\"?>\n\
                          <VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n";
/// Last lines of a collection.
pub(super) const COLLECTION_END: &str = "  </Collection>\n</VTKFile>\n";
/// Parts of an entry before its time, before its file and at its end.
const ENTRY: [&str; 3] = ["    <DataSet timestep=\"", "\" file=\"", "\"/>\n"];

/// Returns a collection of files, each with its time [s].
pub(super) fn collection(files: &[(f64, String)]) -> String {
    let entries: String = files.iter().map(|(time, file)| entry(*time, file)).collect();
    format!("{COLLECTION}{entries}{COLLECTION_END}")
}

/// Returns the entry of a file in a collection.
pub(super) fn entry(time: f64, file: &str) -> String {
    let [before, between, after] = ENTRY;
    format!("{before}{time:e}{between}{file}{after}")
}

/// Reads the files of a collection that the coordinator has written. A cut entry is left out.
///
/// # Errors
/// It names a file outside of its folder.
pub fn read_collection(text: &str) -> Result<Vec<(f64, String)>, String> {
    let [before, between, after] = ENTRY;
    let parts = |line: &str| {
        let (time, file) = line.strip_prefix(before)?.strip_suffix(after)?.split_once(between)?;
        Some((time.parse().ok()?, file.to_owned()))
    };
    let files: Vec<(f64, String)> = text.split_inclusive('\n').filter_map(parts).collect();
    match files.iter().find(|(_, file)| file.contains('/')) {
        Some((_, file)) => Err(format!("it names {file:?}, which is not a file of the folder")),
        None => Ok(files),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field::{LOWER_TEMPERATURE, TRACTION};

    #[test]
    fn a_table_has_a_row_for_each_array() {
        let [traction, rail] =
            [&TRACTION, &LOWER_TEMPERATURE].map(|spec| FieldLabel::of(&spec.kind(), None));
        let text = table(&[(&traction, &[]), (&rail, &[])]);
        let rows = text.lines().filter(|line| line.contains("NumberOfTuples=\"2\""));
        assert_eq!(rows.count(), 4, "{text}");
        // "Pa" and "K".
        assert!(text.contains("Name=\"unit\" NumberOfTuples=\"2\" format=\"ascii\">80 97 0 75 0<"));
    }

    #[test]
    fn a_collection_is_read_as_far_as_it_is_whole() {
        let files = [(0.5, "a_000000.vti".to_owned()), (1e-7, "a_000001.vti".to_owned())];
        let text = collection(&files);
        assert_eq!(read_collection(&text).unwrap(), files);
        let cut = text.find("a_000001").unwrap();
        assert_eq!(read_collection(&text[..cut]).unwrap(), files[..1]);
        let outside = collection(&[(0.0, "../b".to_owned())]);
        assert!(read_collection(&outside).unwrap_err().contains("not a file of the folder"));
    }

    #[test]
    fn a_unit_does_not_break_the_file() {
        let kind = FieldLabel { unit: "<\"&".to_owned(), ..FieldLabel::of(&TRACTION.kind(), None) };
        assert!(unit(&kind).contains(">&lt;&quot;&amp;</InformationKey>"), "{}", unit(&kind));
    }
}
