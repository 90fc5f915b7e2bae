//! Renders a report as text, one row per run.

use super::report::{CaseReport, Finding, Report, RunResult, SweepReport};
use crate::study::table::{Cell, Column, Table};
use run::format::number;
use std::fmt::Write as _;
use std::path::Path;

/// Mark of an unexpected outcome.
pub(super) const OTHERWISE: &str = "✗";

/// Width of the column for names of cases and parameters.
pub(super) const NAME_WIDTH: usize = 31;

/// Table of the cases of a suite.
pub(super) fn cases<'a>() -> Table<'a, CaseReport> {
    let mut columns = vec![
        Column::quantity("no.", |case: &CaseReport| Cell::text(case.number)).width(3),
        Column::text("case", |case: &CaseReport| case.name.clone()).width(NAME_WIDTH),
        Column::text("difficulty", |case: &CaseReport| case.title.clone()).not_on_terminal(),
    ];
    columns.extend(course_of(|case: &CaseReport| &case.row));
    let least = Column::text("margin: smallest ratio of bound to quantity", |case: &CaseReport| {
        margin(&case.row)
    });
    columns.push(least.not_on_page());
    Table::new(columns).mark(OTHERWISE, |case| !case.row.as_expected)
}

/// Table of the runs of a sweep.
pub(super) fn values(sweep: &SweepReport) -> Table<'_, (String, RunResult)> {
    type Run = (String, RunResult);
    let mut columns = vec![Column::text(&sweep.parameter, |(value, _): &Run| value.clone())];
    columns.extend(course_of(|(_, row): &Run| row));
    columns.push(Column::text("message", |(_, row): &Run| {
        let message = row.error.as_ref().and_then(|(_, message)| message.lines().next());
        message.unwrap_or_default().to_owned()
    }));
    Table::new(columns).mark(OTHERWISE, |(_, row)| !row.as_expected)
}

/// Columns for the result of a run.
fn course_of<'a, R: 'a>(row: fn(&R) -> &RunResult) -> [Column<'a, R>; 6] {
    [
        Column::text("end", move |of| end(row(of))).width(13),
        Column::text("bounded", move |of| bounded(row(of)).to_owned()).width(7),
        Column::text("energy", move |of| energy(row(of))).width(6),
        Column::text("margin", move |of| margin(row(of))).not_on_terminal(),
        Column::quantity("iter.", move |of| Cell::text(row(of).iterations))
            .on_page("iterations")
            .width(5),
        Column::quantity("time", move |of| {
            Cell::number(row(of).seconds, format!("{:.2} s", row(of).seconds))
        })
        .width(7),
    ]
}

/// Outcome of a run, in a word or two.
fn end(row: &RunResult) -> String {
    match &row.error {
        None => "result".to_owned(),
        Some((2, _)) => "refused".to_owned(),
        Some((3, _)) => "not converged".to_owned(),
        Some((code, _)) => format!("ended, code {code}"),
    }
}

/// Returns whether every value is finite, in a word.
fn bounded(row: &RunResult) -> &'static str {
    match row.bounded {
        Some(true) => "yes",
        Some(false) => "NO",
        None => "–",
    }
}

/// Formats the heat imbalance.
fn energy(row: &RunResult) -> String {
    match row.energy_imbalance {
        None => "–".to_owned(),
        Some(0.0) => "exact".to_owned(),
        Some(imbalance) => number(imbalance, 1),
    }
}

/// Smallest margin and the name of its quantity.
fn margin(row: &RunResult) -> String {
    match row.worst() {
        Some(finding) => format!("{} {}", factor(finding), finding.name),
        None => "–".to_owned(),
    }
}

/// Ratio of the bound to the quantity.
pub(super) fn factor(finding: &Finding) -> String {
    match finding.share {
        Some(0.0) => "∞".to_owned(),
        Some(share) => format!("{}×", number(1.0 / share, 2)),
        None => "none".to_owned(),
    }
}

/// Summary of a sweep: first value, edge and last value.
pub(super) fn course(sweep: &SweepReport) -> String {
    let values: Vec<&str> = sweep.rows.iter().map(|(value, _)| value.as_str()).collect();
    let (Some(first), Some(last)) = (values.first(), values.last()) else {
        return String::new();
    };
    let shares = sweep.rows.iter().filter(|(_, row)| row.answers());
    let worst = shares.filter_map(|(_, row)| row.worst());
    let least = worst.max_by(|a, b| a.share.unwrap_or(0.0).total_cmp(&b.share.unwrap_or(0.0)));
    let least = least.map_or_else(String::new, |one| format!("; {} {}", factor(one), one.name));
    match sweep.edge() {
        None => format!("{first} … {last}: no edge{least}"),
        Some(edge) => {
            let (value, row) = &sweep.rows[edge];
            let how = if row.error.is_none() { "out of bounds".to_owned() } else { end(row) };
            format!("{first} … {} | {value}: {how}{least}", values[edge - 1])
        }
    }
}

/// Heading of the table.
pub(super) fn head() -> String {
    cases().head()
}

/// Renders a case: one line, one more for each sweep, and details of unexpected outcomes.
pub(super) fn case(case: &CaseReport) -> String {
    let mut text = cases().row(case);
    for sweep in &case.sweeps {
        let mark = if sweep.as_expected() { " " } else { OTHERWISE };
        let (parameter, course) = (&sweep.parameter, course(sweep));
        let _ = writeln!(text, " {mark}       {parameter:NAME_WIDTH$}  {course}");
    }
    for (at, row) in case.runs() {
        let place = at.map_or_else(String::new, |(what, value)| format!("{what} {value}: "));
        for what in &row.otherwise {
            let _ = writeln!(text, "         {place}{}", what.trim_end());
        }
    }
    text
}

/// Renders totals and the path of the results.
pub(super) fn tail(report: &Report, out: &Path) -> String {
    let good = report.cases.iter().filter(|case| case.as_expected()).count();
    format!(
        "\n{good} of {} cases as expected; {} runs in {:.1} s\nresults {}\n",
        report.cases.len(),
        report.runs(),
        report.wall_s,
        out.display()
    )
}
