//! The comparison as a person reads it.

use super::difference::{Comparison, FigureDifference};
use super::fields::FieldDifference;
use run::format::{Scale, counted, number, of_key, seconds, words};
use run::wrap;
use std::fmt::Write as _;
use std::path::Path;

/// Figures with a line of their own at most.
const MOST: usize = 24;
/// Differences below this are written with a power of ten [%].
const LEAST: f64 = 1e-3;

pub(super) fn text(of: &Comparison, [a, b]: [&Path; 2]) -> String {
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
    for FigureDifference { key, name, a, b, relative } in of.figures.iter().take(MOST) {
        let largest = [a, b].into_iter().flatten().fold(0.0, |l: f64, v| l.max(v.abs()));
        let scale = of_key(key, largest);
        let [a, b] = [a, b].map(|v| v.map_or("–".to_owned(), |v| scale.show(v, 6)));
        let change = relative.map_or_else(String::new, change);
        let _ = writeln!(out, "  {head:9} {name:27} {a:>13} → {b:13} {change:>9}");
        head = "";
    }
    let more = of.figures.len().saturating_sub(MOST);
    let rest = match (more, of.same_figures) {
        (_, 0) if more == 0 => return,
        (0, same) => format!("{} the same", counted(same as u64, "figure")),
        (more, same) => {
            format!("{} that differ less (--json), {same} the same", counted(more as u64, "figure"))
        }
    };
    if !of.is_same() {
        let _ = writeln!(out, "  {head:9} {rest}");
    }
}

/// A relative difference in per cent, short even where it is next to nothing.
fn change(relative: f64) -> String {
    let percent = 100.0 * relative;
    let sign = if percent > 0.0 { "+" } else { "" };
    match percent.abs() < LEAST {
        true => format!("{sign}{percent:.0e} %").replace('-', "−"),
        false => format!("{sign}{} %", number(percent, 2)),
    }
}

fn fields(out: &mut String, of: &Comparison) {
    let mut head = "fields";
    for one in &of.fields {
        let line = format!("  {head:9} {:27} {}", words(&one.field), said(one));
        let _ = writeln!(out, "{}", wrap::columns(&line));
        head = "";
    }
    let interpolated =
        |one: &FieldDifference| one.difference.as_ref().is_some_and(|d| d.interpolated);
    if of.fields.iter().any(interpolated) {
        let _ = writeln!(out, "  {head:9} B is interpolated to the grids of A");
    }
    if of.same_fields > 0 && !of.is_same() {
        let same = counted(of.same_fields as u64, "field");
        let _ = writeln!(out, "  {head:9} {same} the same to the bit");
    }
}

/// The difference in the mean of squares, the largest, and where.
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
    let length = Scale::of("m", difference.at.iter().fold(0.0, |l: f64, v| l.max(v.abs())));
    let at = difference.at.map(|place| number(place / length.factor, 3));
    let place = if difference.at[2] == 0.0 { at[..2].join(", ") } else { at.join(", ") };
    format!(
        "{} %, at most {} at ({place}) {}",
        number(100.0 * difference.l2, 2),
        scale.show(difference.max, 3),
        length.unit
    )
}
