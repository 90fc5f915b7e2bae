//! The edges as a document: what was found, without times or any number that another machine may
//! round otherwise.

use super::report::{CaseReport, Report, SweepReport};
use pages::table::Table;
use std::fmt::Write as _;

const OPENING: &str = "\
# Limits

Where the answers of this program end, and what happens there. Every line is the outcome of a run of
`coordinator stability`, which wrote this file (`--write-limits docs/limits.md`); the nightly tests run
it again and compare. The cases and the reasons of their bounds stand in
[cases/hard/suite.toml](../cases/hard/suite.toml); a case or a sweep joins by an entry there. Numbers in
headings are those of the list of hard cases.

*Edge* is between the last value that went as before and the first that did not; values beyond it were
run, too. A refusal ends the command with the exit code given and a message that holds the words
quoted, with the place and the fix. In every case the fields are finite, the heat that is sent is the
heat that is received, and temperatures and friction power are not below zero, to the tolerances of the
suite; the recording reads up to the end of the run, however it ends.
";

/// The document.
pub(super) fn text(report: &Report) -> String {
    let mut text = OPENING.to_owned();
    for case in &report.cases {
        section(&mut text, case);
    }
    text
}

fn section(text: &mut String, case: &CaseReport) {
    let _ = writeln!(text, "\n## {}. {}: {}\n", case.number, case.name, case.title);
    let _ = writeln!(text, "Ends with {}.", case.expected.replace('\n', " "));
    *text += &table(["holds", "bound", "because"], case.bounds.iter().cloned());
    let head = ["parameter", "before", "edge", "beyond", "why"];
    *text += &table(head, case.sweeps.iter().map(edge));
}

/// A table; nothing without rows.
fn table<const N: usize>(head: [&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let mut table = Table::new(head, N);
    rows.for_each(|row| table.row(row));
    match table.rows.is_empty() {
        true => String::new(),
        false => format!("\n{}\n", table.markdown()),
    }
}

fn edge(sweep: &SweepReport) -> [String; 5] {
    let SweepReport { parameter, before, beyond, why, rows } = sweep;
    let first = rows.first().map_or("", |(value, _)| value);
    let last = rows.last().map_or("", |(value, _)| value);
    let (place, beyond) = match (sweep.edge(), beyond) {
        (Some(at), Some(beyond)) => {
            (format!("{} | {}, from {first}", rows[at - 1].0, rows[at].0), beyond.as_str())
        }
        _ => (format!("none from {first} to {last}"), "–"),
    };
    [parameter.clone(), before.clone(), place, beyond.to_owned(), why.clone()]
}
