//! The suite on the terminal, case by case.

use super::report::{CaseReport, Report};
use super::rows::{NAME_WIDTH, OTHERWISE, cases, course};
use std::fmt::Write as _;
use std::path::Path;

/// The head of the table.
pub(super) fn head() -> String {
    cases().head()
}

/// A case in one line, one more for each sweep, and the details of what went otherwise.
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

/// The sum, and where more is to be read.
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
