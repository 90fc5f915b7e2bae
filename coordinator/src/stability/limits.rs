//! The edges as a document: what was found, without times or any number that another machine may
//! round otherwise.

use super::report::{CaseReport, Report, SweepReport};
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
    if !report.waiting.is_empty() {
        text += "\n## Not yet met\n\n| | hard case | waits for |\n|---|---|---|\n";
        for one in &report.waiting {
            let _ = writeln!(text, "| {} | {} | {} |", one.number, one.title, one.waits_for);
        }
    }
    text
}

fn section(text: &mut String, case: &CaseReport) {
    let _ = writeln!(text, "\n## {}. {}: {}\n", case.number, case.name, case.title);
    let _ = writeln!(text, "Ends with {}.", cell(&case.expected));
    if !case.bounds.is_empty() {
        *text += "\n| holds | bound | because |\n|---|---|---|\n";
        for [name, bound, because] in &case.bounds {
            let _ = writeln!(text, "| {} | {} | {} |", cell(name), cell(bound), cell(because));
        }
    }
    if !case.sweeps.is_empty() {
        *text += "\n| parameter | before | edge | beyond | why |\n|---|---|---|---|---|\n";
        for sweep in &case.sweeps {
            edge(text, sweep);
        }
    }
}

fn edge(text: &mut String, sweep: &SweepReport) {
    let SweepReport { parameter, before, beyond, why, rows } = sweep;
    let first = rows.first().map_or("", |(value, _)| value);
    let last = rows.last().map_or("", |(value, _)| value);
    let (place, beyond) = match (sweep.edge(), beyond) {
        (Some(at), Some(beyond)) => {
            (format!("{} \\| {}, from {first}", rows[at - 1].0, rows[at].0), beyond.as_str())
        }
        _ => (format!("none from {first} to {last}"), "–"),
    };
    let (parameter, before, why) = (cell(parameter), cell(before), cell(why));
    let _ = writeln!(text, "| {parameter} | {before} | {place} | {} | {why} |", cell(beyond));
}

/// Text as it may stand in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
