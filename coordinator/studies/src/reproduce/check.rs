//! Checks the references within a study, and compares an earlier text with the new one.

use super::study::{FigureSpec, Study, TableSpec};
use run::error::RunError;
use std::collections::BTreeSet;
use std::path::Path;

/// Checks all references of the study in `file`.
///
/// # Errors
/// [`RunError::Usage`] lists every broken reference with its place.
pub(super) fn check(study: &Study, file: &Path) -> Result<(), RunError> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut wrong = Vec::new();
    if !folder.join(&study.text).is_file() {
        wrong.push(format!("text: there is no file {}", folder.join(&study.text).display()));
    }
    wrong.extend(repeated("run", study.titles(None).map(|(name, _)| name)));
    wrong.extend(repeated("table", study.tables.iter().map(|table| &*table.id)));
    wrong.extend(repeated("figure", study.figures.iter().map(|figure| &*figure.id)));
    let measured = study.measurements.iter();
    wrong.extend(repeated("measurement", measured.map(|measurement| &*measurement.name)));
    wrong.extend(families(study, folder));
    wrong.extend(measurements(study, folder));
    wrong.extend(limits(study));
    study.tables.iter().for_each(|table| wrong.extend(rows(study, table)));
    study.figures.iter().for_each(|figure| wrong.extend(lines(study, figure)));
    if wrong.is_empty() {
        return Ok(());
    }
    let lines: Vec<String> =
        wrong.iter().map(|what| format!("{}: {what}", file.display())).collect();
    Err(RunError::Usage(lines.join("\n")))
}

fn repeated<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let twice = names.filter(|name| !seen.insert(*name));
    twice.map(|name| format!("{what} `{name}` is defined twice; rename one of the two")).collect()
}

fn families(study: &Study, folder: &Path) -> Vec<String> {
    let mut wrong = Vec::new();
    for family in &study.families {
        let name = &family.name;
        let case = folder.join(&family.case);
        if !case.is_file() {
            wrong.push(format!("run `{name}`: there is no case file {}", case.display()));
        }
        match (&family.over, &family.at) {
            (Some(axis), _) => wrong.extend(no_axis(study, &format!("run `{name}`"), axis)),
            (None, Some(_)) => {
                wrong.push(format!("run `{name}`: `at` needs an axis; name the axis with `over`"));
            }
            (None, None) => {}
        }
    }
    wrong
}

fn measurements(study: &Study, folder: &Path) -> Vec<String> {
    let mut wrong = Vec::new();
    for measurement in &study.measurements {
        let place = format!("measurement `{}`", measurement.name);
        let case = folder.join(&measurement.case);
        if !case.is_file() {
            wrong.push(format!("{place}: there is no case file {}", case.display()));
        }
        if let Err(reason) = measurement.read(&folder.join(&measurement.table)) {
            wrong.push(format!("{place}: {reason}"));
        }
    }
    wrong
}

fn no_axis(study: &Study, place: &str, axis: &str) -> Option<String> {
    let known: Vec<&str> = study.axes.keys().map(String::as_str).collect();
    (!study.axes.contains_key(axis))
        .then(|| format!("{place}: there is no axis `{axis}`; known: {}", listed(&known)))
}

fn limits(study: &Study) -> Vec<String> {
    let mut wrong = Vec::new();
    for limit in &study.limits {
        for name in &limit.of {
            let place = format!("limit `{}`", limit.name);
            match study.families.iter().find(|family| family.name == *name) {
                None => wrong.push(no_run(study, &place, name)),
                Some(family) if family.fineness.is_none() => {
                    wrong.push(format!("{place}: run `{name}` has no `fineness`; add it"));
                }
                Some(_) => {}
            }
        }
    }
    wrong
}

fn rows(study: &Study, table: &TableSpec) -> Vec<String> {
    let place = format!("table `{}`", table.id);
    let mut wrong = Vec::new();
    for column in &table.columns {
        wrong.extend(column.over.as_ref().and_then(|axis| no_axis(study, &place, axis)));
    }
    for row in &table.rows {
        if let Some(run) = &row.run
            && study.members(run).is_none()
            && !study.limits.iter().any(|limit| limit.name == *run)
        {
            wrong.push(no_run(study, &place, run));
        }
        if let Some(group) = &row.group
            && study.titles(Some(group)).next().is_none()
        {
            wrong.push(format!("{place}: no run belongs to the group `{group}`"));
        }
    }
    wrong
}

fn lines(study: &Study, figure: &FigureSpec) -> Vec<String> {
    let lines = figure.plots.iter().flat_map(|plot| &plot.lines).filter_map(|line| line.run());
    let named = lines.chain(figure.maps.iter().map(|map| map.run.as_str()));
    let unknown = named.filter(|name| study.members(name).is_none());
    unknown.map(|name| no_run(study, &format!("figure `{}`", figure.id), name)).collect()
}

fn no_run(study: &Study, place: &str, name: &str) -> String {
    let known: Vec<&str> = study.families.iter().map(|family| family.name.as_str()).collect();
    format!("{place}: there is no run `{name}`; known: {}", listed(&known))
}

fn listed(names: &[&str]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// Start of a block that is excluded from the comparison.
pub(crate) const MEASURED: &str = "<!-- measured -->";
/// End of a block that is excluded from the comparison.
pub(crate) const MEASURED_END: &str = "<!-- /measured -->";

/// The first line that differs, in both texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Difference {
    /// Line number in the earlier text, counted from 1.
    pub line: usize,
    /// Line of the earlier text.
    pub kept: String,
    /// Line of the new text.
    pub new: String,
}

/// Finds the first difference between an earlier text and the new one.
#[must_use]
pub(crate) fn difference(kept: &str, new: &str) -> Option<Difference> {
    let (mut ours, mut theirs) = (compared(kept), compared(new));
    loop {
        let (line, kept, new) = match (ours.next(), theirs.next()) {
            (None, None) => return None,
            (Some((_, kept)), Some((_, new))) if same(kept, new) => continue,
            (Some((line, kept)), new) => (line, kept, new.map_or("", |(_, new)| new)),
            (None, Some((_, new))) => (kept.lines().count() + 1, "", new),
        };
        return Some(Difference { line, kept: kept.to_owned(), new: new.to_owned() });
    }
}

/// Lines to compare, with their numbers.
fn compared(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut measured = false;
    let counts = move |(_, line): &(usize, &str)| {
        measured = (measured || line.contains(MEASURED)) && !line.contains(MEASURED_END);
        !measured
    };
    text.lines().enumerate().map(|(n, line)| (n + 1, line)).filter(counts)
}

fn same(kept: &str, new: &str) -> bool {
    let embedded = |line: &str| line.contains("href=\"data:");
    if embedded(kept) && embedded(new) {
        return true;
    }
    let (kept, new) = (pieces(kept), pieces(new));
    kept.len() == new.len() && kept.iter().zip(&new).all(|(kept, new)| kept.is_as(new))
}

/// A number as written, or the text between numbers.
#[derive(Clone, Debug, PartialEq)]
enum Piece<'a> {
    Words(&'a str),
    Number { value: f64, unit: f64 },
}

impl Piece<'_> {
    fn is_as(&self, new: &Self) -> bool {
        match (self, new) {
            (Self::Number { value, unit }, Self::Number { value: other, unit: others }) => {
                // A number with more or fewer decimals makes a different statement.
                unit == others && (value - other).abs() <= unit * (1.0 + 1e-6)
            }
            (one, other) => one == other,
        }
    }
}

fn pieces(line: &str) -> Vec<Piece<'_>> {
    let part = |c: char| c.is_ascii_digit() || c == '.';
    let mut pieces = Vec::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let digits = part(first);
        let end = rest.find(|c| part(c) != digits).unwrap_or(rest.len());
        let (piece, after) = rest.split_at(end);
        pieces.push(number(piece).unwrap_or(Piece::Words(piece)));
        rest = after;
    }
    pieces
}

/// Parses a number, with the unit of its last digit. A sign belongs to the text before.
fn number(text: &str) -> Option<Piece<'_>> {
    let value: f64 = text.parse().ok()?;
    let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    Some(Piece::Number { value, unit: 10f64.powi(-i32::try_from(decimals).ok()?) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_may_differ_by_one() {
        assert_eq!(difference("at 226.9 K", "at 227.0 K"), None);
        let difference = difference("a\nat 226.9 K", "a\nat 227.1 K").unwrap();
        assert_eq!((difference.line, difference.new.as_str()), (2, "at 227.1 K"));
    }

    #[test]
    fn words_signs_and_lengths_count() {
        for (kept, new) in [
            ("rail 1.0", "wheel 1.0"),
            ("−0.84", "0.84"),
            ("0.84", "0.841"),
            ("one line", "one line\nand one more"),
            ("one line\nand one more", "one line"),
        ] {
            assert!(difference(kept, new).is_some(), "{kept} against {new}");
        }
    }

    #[test]
    fn times_are_not_compared() {
        let text = |time: &str| format!("a\n{MEASURED}\n{time}\n{MEASURED_END}\nb 2.0");
        assert_eq!(difference(&text("0.31 s"), &text("12 s\nand more")), None);
        assert!(difference(&text("0.31 s"), &text("0.31 s").replace("2.0", "3.0")).is_some());
    }
}
