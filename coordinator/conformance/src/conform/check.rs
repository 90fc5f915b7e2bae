//! A check, its result, and the report of all checks, as data and as text.

use super::bench::TestBench;
use super::fault::{CheckFailure, Finding};
use contract::text::one_line;
use serde::Serialize;
use std::fmt::Write as _;
use std::time::Duration;

/// A demand of the contract, with its check.
#[derive(Debug)]
pub(super) struct Check {
    /// Name of the check, for `--only`.
    pub(super) name: &'static str,
    /// Demand of the contract.
    pub(super) demand: &'static str,
    /// Place to look at if the check fails.
    pub(super) fix: &'static str,
    /// Function that checks the participant.
    pub(super) run: fn(&TestBench) -> Result<Finding, CheckFailure>,
}

/// Outcome of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum CheckOutcome {
    /// The participant meets the demand.
    Passed,
    /// The participant does not meet the demand.
    Failed,
    /// The demand does not concern this participant, or this case.
    Inapplicable,
    /// Not made: the participant does not describe itself, or never joins a run.
    NotMade,
}

/// A check that was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct CheckResult {
    /// Name of the check.
    pub name: &'static str,
    /// Outcome.
    pub verdict: CheckOutcome,
    /// Finding, or reason why there is none.
    pub seen: String,
    /// Demand of the contract.
    pub demand: &'static str,
    /// Place to look at if the check failed.
    pub fix: &'static str,
    /// Earlier check that failed with the same finding.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub same_as: Option<&'static str>,
    /// Duration of the check [s].
    pub seconds: f64,
}

impl CheckResult {
    pub(super) fn new(
        check: &Check,
        outcome: Result<Finding, CheckFailure>,
        took: Duration,
    ) -> Self {
        let (verdict, seen) = match outcome {
            Ok(Finding::Kept(seen)) => (CheckOutcome::Passed, seen),
            Ok(Finding::Inapplicable(why)) => (CheckOutcome::Inapplicable, why),
            Err(CheckFailure::Broken(what) | CheckFailure::Late(what)) => {
                (CheckOutcome::Failed, what)
            }
            Err(CheckFailure::Interrupted(signal)) => {
                (CheckOutcome::Failed, format!("stopped by {signal}"))
            }
        };
        let Check { name, demand, fix, .. } = *check;
        let seen = one_line(&seen).into_owned();
        let seconds = took.as_secs_f64();
        Self { name, verdict, seen, demand, fix, same_as: None, seconds }
    }

    /// Returns the result of a check that cannot be made.
    pub(super) fn not_made(check: &Check, because: &str) -> Self {
        let Check { name, demand, fix, .. } = *check;
        let (verdict, seen) = (CheckOutcome::NotMade, because.to_owned());
        Self { name, verdict, seen, demand, fix, same_as: None, seconds: 0.0 }
    }
}

/// Results of all checks of a participant.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Report {
    /// Requested role.
    pub role: String,
    /// Name and version according to the description of the program; empty without one.
    pub program: String,
    /// Model and mode of every setting in which the participant was checked.
    pub settings: Vec<String>,
    /// Settings that the case does not give, with the reason.
    pub left_out: Vec<String>,
    /// Result of each check.
    pub checks: Vec<CheckResult>,
    /// Duration of all checks [s].
    pub wall_s: f64,
}

impl Report {
    /// Returns the failed checks.
    pub(crate) fn failed(&self) -> impl Iterator<Item = &CheckResult> {
        self.checks.iter().filter(|row| row.verdict == CheckOutcome::Failed)
    }
}

/// Width of the names of the checks.
pub(super) const NAME_WIDTH: usize = 18;
/// Width of a line.
const LINE: usize = 96;

/// Describes the checked participant and its settings.
pub(super) fn head(report: &Report) -> String {
    let program = if report.program.is_empty() { "?" } else { &one_line(&report.program) };
    let mut text =
        format!("{} as `{}`, protocol {}\n", program, report.role, contract::PROTOCOL_VERSION);
    let mut listed = |word: &str, list: &[String]| {
        for (index, one) in list.iter().enumerate() {
            let word = if index == 0 { word } else { "" };
            let _ = writeln!(text, "  {word:9} {}", one_line(one));
        }
    };
    listed("settings", &report.settings);
    listed("omitted", &report.left_out);
    text + "\n"
}

/// Describes a check in one line.
pub(super) fn line(row: &CheckResult) -> String {
    let word = match row.verdict {
        CheckOutcome::Passed => "ok",
        CheckOutcome::Failed => "FAIL",
        CheckOutcome::Inapplicable | CheckOutcome::NotMade => "-",
    };
    let same = row.same_as.map(|earlier| format!("as `{earlier}`"));
    let seen = same.as_deref().unwrap_or(&row.seen).lines().next().unwrap_or_default();
    let width = LINE - NAME_WIDTH - 9;
    let short: String = match seen.chars().count() > width {
        true => seen.chars().take(width - 1).chain(['…']).collect(),
        false => seen.to_owned(),
    };
    format!("  {:NAME_WIDTH$} {word:4}  {short}\n", row.name)
}

/// Describes the failed checks in detail, and counts the results.
pub(super) fn tail(report: &Report) -> String {
    let mut text = String::new();
    for row in report.failed().filter(|row| row.same_as.is_none()) {
        let _ = writeln!(text, "\n{}", row.name);
        for (word, words) in [("demand", row.demand), ("seen", &row.seen), ("look at", row.fix)] {
            let _ = writeln!(text, "  {word:8} {}", wrapped(words, 11));
        }
    }
    let count = |verdict| report.checks.iter().filter(|row| row.verdict == verdict).count();
    let not_made = match report.checks.iter().find(|row| row.verdict == CheckOutcome::NotMade) {
        Some(row) => format!(", {} not made ({})", count(CheckOutcome::NotMade), row.seen),
        None => String::new(),
    };
    let _ = writeln!(
        text,
        "\n{} passed, {} failed, {} do not apply{not_made}; {:.1} s",
        count(CheckOutcome::Passed),
        count(CheckOutcome::Failed),
        count(CheckOutcome::Inapplicable),
        report.wall_s
    );
    text
}

/// Wraps a text into lines of at most [`LINE`] columns, with all but the first indented.
fn wrapped(text: &str, indent: usize) -> String {
    let (mut out, mut column) = (String::new(), indent);
    for word in text.split_whitespace() {
        let width = word.chars().count();
        if column > indent && column + 1 + width > LINE {
            let _ = write!(out, "\n{:indent$}", "");
            column = indent;
        } else if column > indent {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += width;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(verdict: CheckOutcome, seen: &str) -> CheckResult {
        let (name, demand, fix) = ("solve", "the requirement", "where to look");
        CheckResult {
            name,
            verdict,
            seen: seen.to_owned(),
            demand,
            fix,
            same_as: None,
            seconds: 0.0,
        }
    }

    #[test]
    fn a_check_is_one_line_and_only_a_failure_has_details() {
        let long = "word ".repeat(60);
        let rows = vec![
            row(CheckOutcome::Passed, "2 outputs"),
            row(CheckOutcome::Failed, &long),
            row(CheckOutcome::Inapplicable, "no input"),
            CheckResult { same_as: Some("solve"), ..row(CheckOutcome::Failed, &long) },
            row(CheckOutcome::NotMade, "it is gone"),
        ];
        for row in &rows {
            let text = line(row);
            assert_eq!(text.lines().count(), 1);
            assert!(text.trim_end().chars().count() <= LINE, "{text}");
        }
        let text = tail(&Report { checks: rows.clone(), ..Report::default() });
        assert!(text.lines().all(|line| line.chars().count() <= LINE), "{text}");
        assert_eq!(text.matches("the requirement").count(), 1);
        assert_eq!(text.matches("word").count(), 60);
        assert!(line(&rows[3]).contains(" FAIL  as `solve`"), "{}", line(&rows[3]));
        let sum = "1 passed, 2 failed, 1 do not apply, 1 not made (it is gone)";
        assert!(text.contains(sum), "{text}");
    }
}
