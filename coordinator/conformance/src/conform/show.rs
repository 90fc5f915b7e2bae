//! The table on the terminal.

use super::check::{CheckOutcome, CheckResult};
use super::report::Report;
use contract::text::one_line;
use std::fmt::Write as _;

/// Column of the names of the checks.
pub(super) const NAME_WIDTH: usize = 18;
/// Where long lines are broken.
const LINE: usize = 96;

/// The participant that is checked, and in which settings.
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
    listed("left out", &report.left_out);
    text + "\n"
}

/// One check in one line.
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

/// The details of what failed, and the sum.
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

/// Lines of at most [`LINE`] columns, all but the first indented.
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
