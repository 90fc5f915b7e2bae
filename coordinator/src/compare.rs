//! `coordinator compare A B`: differences of two results in case, figures, fields and time, or of
//! two sweeps point by point.

mod difference;
mod fields;

use clap::Args;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::figure::Measure;
use contract::text::json;
use difference::{Comparison, FigureDifference};
use fields::FieldDifference;
use pages::axis::largest_magnitude;
use pages::source::Results;
use run::error::RunError;
use run::format::{Scale, counted, number, of_key, seconds, words};
use run::{signals, wrap};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use studies::study::quantity::show_change;
use studies::sweep::compare;

/// Options of `coordinator compare`.
#[derive(Debug, Args)]
pub(crate) struct CompareCommand {
    /// First result directory, of a run or of a sweep.
    #[arg(value_name = "A")]
    a: PathBuf,
    /// Second result directory, of the same kind.
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for CompareCommand {
    const NAME: &'static str = "compare";
    const GROUP: Group = Group::Look;
    const ABOUT: &'static str = "List the differences of two results";
    const EXAMPLES: &'static [&'static str] = &["coordinator compare results/first results/second"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _reading = signals::end_at_once();
        if compare::is_sweep(&self.a) && compare::is_sweep(&self.b) {
            let found = compare::compare(&self.a, &self.b)?;
            if self.json {
                return print(&json(&found));
            }
            let head = format!("A {}\nB {}\n", self.a.display(), self.b.display());
            return context.print(&(head + &found.text()));
        }
        let [a, b] = [Results::read(&self.a)?, Results::read(&self.b)?];
        let comparison = Comparison::of(&a, &b);
        if self.json {
            return print(&json(&comparison));
        }
        context.print(&text(&comparison, [&self.a, &self.b]))
    }
}

/// Word for differences that are rounding errors.
const ROUNDING: &str = "the same to six digits";
/// Largest number of figures that are listed.
const MOST: usize = 24;

fn text(of: &Comparison, [a, b]: [&Path; 2]) -> String {
    let mut out = format!("A {}\nB {}\n", a.display(), b.display());
    if of.is_same() {
        let (figures, fields) = (of.same_figures as u64, of.same_fields as u64);
        let (figures, fields) = (counted(figures, "figure"), counted(fields, "field"));
        let _ = writeln!(out, "  the same case; {figures} and {fields} the same to the bit");
    }
    let mut head = "case";
    for one in &of.case {
        let [a, b] = [&one.a, &one.b].map(|value| value.as_deref().unwrap_or("–"));
        let line = format!("  {head:9} {}  {a} → {b}", one.key);
        let _ = writeln!(out, "{}", wrap::columns(&line));
        head = "";
    }
    figures(&mut out, of);
    fields(&mut out, of);
    let times: Vec<String> = of
        .times
        .iter()
        .map(|(name, [a, b])| format!("{name} {} → {}", seconds(*a), seconds(*b)))
        .collect();
    let times: Vec<&str> = times.iter().map(String::as_str).collect();
    if !times.is_empty() {
        let _ = writeln!(out, "{}", wrap::entries("  time      ", &times));
    }
    out
}

fn figures(out: &mut String, of: &Comparison) {
    let mut head = "figures";
    let (rounding, different): (Vec<&FigureDifference>, Vec<_>) =
        of.figures.iter().partition(|one| one.is_negligible());
    for FigureDifference { key, name, a, b, measure, change } in different.iter().take(MOST) {
        let largest = [a, b].into_iter().flatten().fold(0.0, |l: f64, v| l.max(v.abs()));
        let scale = of_key(key, largest);
        let [a, b] = [a, b].map(|v| v.map_or("–".to_owned(), |v| scale.show(v, 6)));
        // The change of a place is a length.
        let change = change.map_or_else(String::new, |change| match measure {
            Measure::Absolute if !scale.unit.is_empty() => {
                let sign = if change > 0.0 { "+" } else { "" };
                format!("{sign}{}", scale.show(change, 2))
            }
            _ => show_change(*measure, change),
        });
        // Text after a comma explains the name.
        let name = name.split(',').next().unwrap_or(name);
        let _ = writeln!(out, "  {head:9} {name:27} {a:>13} → {b:13} {change:>9}");
        head = "";
    }
    let rest = [
        (different.len().saturating_sub(MOST), "that differ less (--json)"),
        (rounding.len(), ROUNDING),
        (if of.is_same() { 0 } else { of.same_figures }, "the same"),
    ];
    remainder(out, head, "figure", &rest);
}

/// Returns the number of further entries of a kind, and the way in which they differ.
fn remainder(out: &mut String, head: &str, thing: &str, counts: &[(usize, &str)]) {
    let some = counts.iter().filter(|(count, _)| *count > 0);
    let said = some.map(|(count, how)| format!("{} {how}", counted(*count as u64, thing)));
    let said: Vec<String> = said.collect();
    if !said.is_empty() {
        let line = format!("  {head:9} {}", said.join(", "));
        let _ = writeln!(out, "{}", wrap::columns(&line));
    }
}

fn fields(out: &mut String, of: &Comparison) {
    let mut head = "fields";
    let (rounding, different): (Vec<&FieldDifference>, Vec<_>) =
        of.fields.iter().partition(|one| one.is_negligible());
    for one in &different {
        let line = format!("  {head:9} {:27} {}", words(&one.field), said(one));
        let _ = writeln!(out, "{}", wrap::columns(&line));
        head = "";
    }
    let interpolated =
        |one: &FieldDifference| one.difference.as_ref().is_some_and(|d| d.interpolated);
    if of.fields.iter().any(interpolated) {
        let _ = writeln!(out, "  {head:9} B is interpolated to the grids of A");
    }
    let same = if of.is_same() { 0 } else { of.same_fields };
    remainder(out, head, "field", &[(rounding.len(), ROUNDING), (same, "the same to the bit")]);
}

/// Returns the root mean square of the difference, the largest one, and its place.
fn said(one: &FieldDifference) -> String {
    let largest = [one.largest_a, one.largest_b].into_iter().flatten().fold(0.0, f64::max);
    let scale = Scale::of(&one.unit, largest);
    let Some(difference) = &one.difference else {
        return match (one.largest_a, one.largest_b) {
            (Some(_), None) => format!("in A alone, up to {}", scale.show(largest, 4)),
            (None, _) => format!("in B alone, up to {}", scale.show(largest, 4)),
            _ => "on grids without a common plane".to_owned(),
        };
    };
    let length = Scale::of("m", largest_magnitude(&difference.at));
    // Treat coordinates within rounding of zero as zero.
    let nought = 1e-9 * length.factor;
    let at = difference.at.map(|place| if place.abs() < nought { 0.0 } else { place });
    let at = at.map(|place| number(place / length.factor, 3));
    let place = if difference.at[2] == 0.0 { at[..2].join(", ") } else { at.join(", ") };
    let mean = match difference.l2 {
        Some(l2) => format!("{} %,", number(100.0 * l2, 2)),
        None => "zero in A,".to_owned(),
    };
    let most = scale.show(difference.max, 3);
    format!("{mean} at most {most} at ({place}) {}", length.unit)
}
