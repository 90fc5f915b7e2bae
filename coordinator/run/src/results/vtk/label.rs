//! What a file says of its arrays, where programs look for it: the unit of an array in its
//! information, and for people a table in the field data with unit, body and meaning of every array.

use super::shown::{Fields, ShownKind};
use std::fmt::Write as _;

/// What a column of the table tells of a field.
type Column = fn(&ShownKind) -> String;

/// Name of the array of a field, with its unit.
pub(super) fn array_name(kind: &ShownKind) -> String {
    format!("{} [{}]", kind.name, kind.unit)
}

/// VTK's information key for the unit of an array.
pub(super) fn unit(kind: &ShownKind) -> String {
    let unit = escape(&kind.unit);
    format!(
        "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{unit}</InformationKey>"
    )
}

/// The table of the arrays: one column for each thing that is stated, one row for each array.
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

/// Text as it may stand in an element or an attribute.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// A string as VTK writes it: the numbers of its bytes, and a zero at its end.
fn codes(text: &str) -> String {
    text.bytes().chain([0]).map(|byte| byte.to_string()).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field::{LOWER_TEMPERATURE, TRACTION};

    #[test]
    fn a_table_has_a_row_for_each_array() {
        let [traction, rail] =
            [&TRACTION, &LOWER_TEMPERATURE].map(|spec| ShownKind::of(&spec.kind(), None));
        let text = table(&[(&traction, &[]), (&rail, &[])]);
        let rows = text.lines().filter(|line| line.contains("NumberOfTuples=\"2\""));
        assert_eq!(rows.count(), 4, "{text}");
        // "Pa" and "K".
        assert!(text.contains("Name=\"unit\" NumberOfTuples=\"2\" format=\"ascii\">80 97 0 75 0<"));
    }

    #[test]
    fn a_unit_does_not_break_the_file() {
        let kind = ShownKind { unit: "<\"&".to_owned(), ..ShownKind::of(&TRACTION.kind(), None) };
        assert!(unit(&kind).contains(">&lt;&quot;&amp;</InformationKey>"), "{}", unit(&kind));
    }
}
