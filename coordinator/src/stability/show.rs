//! The table on the terminal.

use super::report::{CaseReport, Finding, Report, Row, SweepReport};
use run::format::number;
use std::fmt::Write as _;
use std::path::Path;

/// Width of the names of cases and parameters.
const NAME_WIDTH: usize = 31;
/// Width of what is said of an end.
const END_WIDTH: usize = 13;

/// The head of the table.
pub(super) fn head() -> String {
    format!(
        "  no {:NAME_WIDTH$} {:END_WIDTH$} {:7} {:7} {:>5} {:>7}  {}\n",
        "case",
        "end",
        "bounded",
        "energy",
        "iter.",
        "time",
        "margin: least ratio of bound to quantity"
    )
}

/// A case in one line, one more for each sweep, and the details of what went otherwise.
pub(super) fn case(case: &CaseReport) -> String {
    let row = &case.row;
    let mut text = format!(
        "{} {:2} {:NAME_WIDTH$} {:END_WIDTH$} {:7} {:7} {:5} {:>6.2}s  {}\n",
        mark(row.as_expected),
        case.number,
        case.name,
        end(row),
        bounded(row),
        energy(row),
        row.iterations,
        row.seconds,
        margin(row),
    );
    for sweep in &case.sweeps {
        let _ = writeln!(
            text,
            "{}      {:NAME_WIDTH$} {}",
            mark(sweep.as_expected()),
            sweep.parameter,
            course(sweep)
        );
    }
    for (at, row) in case.runs() {
        let place = at.map_or_else(String::new, |(what, value)| format!("{what} {value}: "));
        for what in &row.otherwise {
            let _ = writeln!(text, "       {place}{}", what.trim_end());
        }
    }
    text
}

/// What waits, the sum, and where more is to be read.
pub(super) fn tail(report: &Report, out: &Path) -> String {
    let mut text = String::new();
    for waiting in &report.waiting {
        let _ = writeln!(
            text,
            "  {:2} {}: waits for {}",
            waiting.number, waiting.title, waiting.waits_for
        );
    }
    let good = report.cases.iter().filter(|case| case.as_expected()).count();
    let _ = writeln!(
        text,
        "\n{good} of {} cases as expected, {} wait; {} runs in {:.1} s\nresults {}",
        report.cases.len(),
        report.waiting.len(),
        report.runs(),
        report.wall_s,
        out.display()
    );
    text
}

fn mark(as_expected: bool) -> char {
    if as_expected { ' ' } else { '!' }
}

/// How a run ended, in a word or two.
pub(super) fn end(row: &Row) -> String {
    match &row.error {
        None => "answer".to_owned(),
        Some((2, _)) => "refused".to_owned(),
        Some((3, _)) => "not converged".to_owned(),
        Some((code, _)) => format!("ended, code {code}"),
    }
}

/// Whether every value is finite, in a word.
pub(super) fn bounded(row: &Row) -> &'static str {
    match row.bounded {
        Some(true) => "yes",
        Some(false) => "NO",
        None => "–",
    }
}

/// The energy imbalance.
pub(super) fn energy(row: &Row) -> String {
    match row.energy_imbalance {
        None => "–".to_owned(),
        Some(0.0) => "exact".to_owned(),
        Some(imbalance) => format!("{imbalance:.0e}"),
    }
}

/// The least margin, and whose it is.
pub(super) fn margin(row: &Row) -> String {
    match row.worst() {
        Some(finding) => format!("{} {}", factor(finding), finding.name),
        None => "–".to_owned(),
    }
}

/// How many times the bound is as far as the quantity.
pub(super) fn factor(finding: &Finding) -> String {
    match finding.share {
        Some(0.0) => "∞".to_owned(),
        Some(share) => format!("{}×", number(1.0 / share, 2)),
        None => "none".to_owned(),
    }
}

/// From the first value over the edge to the last.
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
            let how = if row.error.is_none() { "beyond a bound".to_owned() } else { end(row) };
            format!("{first} … {} | {value}: {how}{least}", values[edge - 1])
        }
    }
}
