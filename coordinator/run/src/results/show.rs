//! Text of the summary for the terminal.

use super::cost::Cost;
use super::figures::{Entry, Extreme, Group, List, groups};
use super::stated::{ResultSource, Stated};
use super::summary::{CouplingSummary, Summary};
use crate::format::{bytes, counted, number, seconds};
use crate::wrap;
use contract::figure::FigureSpec;
use std::fmt::Write as _;

/// Largest number of entries of a list that have a line each.
const MOST_LISTED: usize = 8;

/// Returns the lines printed at the end of a run, with the described figures. Figures that the
/// summary does not hold are omitted.
#[must_use]
pub fn text(summary: &Summary, title: Option<&str>, figures: &[FigureSpec]) -> String {
    let mut out = summary.case.clone();
    if let Some(title) = title {
        let _ = write!(out, " · {title}");
    }
    let status = format!("  {}: {}", summary.status.word(), summary.reason);
    let _ = writeln!(out, "\n{}", wrap::columns(&status));
    for warning in &summary.warnings {
        let _ = writeln!(out, "{}", wrap::columns(&format!("  warning   {warning}")));
    }
    extremes(&mut out, summary, figures);
    for group in groups(&summary.sections, figures) {
        match group {
            Group::Line(one) => line(&mut out, one.name, &texts(&one.entries)),
            Group::List(list) => entries(&mut out, &list),
        }
    }
    line(&mut out, "coupling", &coupling(&summary.coupling));
    let accuracy = summary.accuracy.as_ref().map(|stated| accuracy(stated, figures));
    line(&mut out, "accuracy", &accuracy.unwrap_or_default());
    line(&mut out, "cost", &cost(&summary.cost));
    out
}

fn coupling(of: &CouplingSummary) -> Vec<Option<String>> {
    let word = |word: &String| Some(word.clone()).filter(|word| !word.is_empty() && word != "none");
    vec![
        word(&of.scheme),
        word(&of.acceleration),
        Some(counted(of.windows, "window")),
        Some(counted(of.iterations, "iteration")),
        of.final_residual.map(|v| format!("residual {v}", v = number(v, 2))),
        of.energy_imbalance.map(imbalance),
    ]
}

/// Writes the smallest and largest values over several windows, with their windows. All lines below
/// describe the last window.
fn extremes(out: &mut String, summary: &Summary, figures: &[FigureSpec]) {
    let all = Extreme::all(summary.extremes.as_ref(), figures);
    if all.is_empty() {
        return;
    }
    let texts: Vec<String> = all.iter().map(plain).collect();
    for (n, text) in texts.iter().enumerate() {
        let head = if n == 0 { "over all" } else { "" };
        let _ = writeln!(out, "{}", wrap::columns(&format!("  {head:9} {text}")));
    }
    let _ = writeln!(out, "  {:9} the lines below describe the last {}", "", all[0].word);
}

fn plain(of: &Extreme) -> String {
    let [least, most] = of.said(usize::MAX);
    let FigureSpec { short, line, .. } = of.figure;
    let name = if short.is_empty() { line.as_deref().unwrap_or_default() } else { short };
    format!("{name:10}  {least} to {most}").replace('\u{a0}', " ").replace('−', "-")
}

/// Returns the figures of a line, with plain signs and spaces for programs that read them.
fn texts(entries: &[Entry]) -> Vec<Option<String>> {
    let plain = |entry: &Entry| entry.text(usize::MAX).replace('\u{a0}', " ").replace('−', "-");
    entries.iter().map(|entry| Some(plain(entry))).collect()
}

/// Writes a line for each entry of a list, or for the most important entries of a long list.
fn entries(out: &mut String, list: &List) {
    let shown = list.foremost(MOST_LISTED);
    for &place in &shown {
        let on_line = |entry: &&Entry| entry.figure.line.is_some();
        let entries: Vec<Entry> = list.rows[place].iter().filter(on_line).copied().collect();
        let name = Some(list.names[place].clone()).filter(|name| !name.is_empty());
        let all: Vec<Option<String>> = std::iter::once(name).chain(texts(&entries)).collect();
        line(out, &format!("{} {}", list.name, place + 1), &all);
    }
    let more = list.count.saturating_sub(shown.len());
    if more > 0 {
        let more = counted(more as u64, &format!("smaller {}", list.name));
        line(out, "", &[Some(format!("{more}: see summary.json"))]);
    }
}

fn imbalance(value: f64) -> String {
    if value == 0.0 {
        "heat balance exact".to_owned()
    } else {
        format!("heat imbalance {value}", value = number(value, 2))
    }
}

/// Returns the error of a run with a target accuracy, and the value to quote.
fn accuracy(of: &Stated, figures: &[FigureSpec]) -> Vec<Option<String>> {
    let percent = |error: f64| format!("{} %", number(100.0 * error, 2));
    let quoted = match figures.iter().find(|figure| figure.key == of.quantity) {
        Some(figure) => {
            let text = Entry { figure, value: of.value }.number(usize::MAX);
            format!("{} {}", figure.words, text.replace('\u{a0}', " ").replace('−', "-"))
        }
        None => format!("{} {}", of.quantity, number(of.value, 5)),
    };
    let taken = of.taken == ResultSource::Extrapolated;
    vec![
        Some(quoted),
        Some(format!("± {}", percent(of.estimated_error))),
        of.target.map(|error| format!("of {} asked for", percent(error))),
        Some(format!("grid {}", percent(of.grid_error))),
        Some(format!("models {}", percent(of.model_error))),
        of.extrapolated
            .filter(|_| !taken)
            .map(|value| format!("extrapolated {}", number(value, 5))),
        of.narrow_slip_zone.map(|width| {
            let width = number(width, 2);
            format!("not extrapolated: slip zone {width} elements wide on the coarsest grid")
        }),
        taken.then(|| "extrapolated from three grids: quote this".to_owned()),
        taken.then(|| "the lines above describe the finest grid".to_owned()),
        Some(of.models.clone()),
    ]
}

fn cost(of: &Cost) -> Vec<Option<String>> {
    let times = of.times().into_iter();
    let times = times.map(|(name, time)| Some(format!("{name} {}", seconds(time))));
    times.chain([Some(format!("{} exchanged", bytes(of.bytes_exchanged)))]).collect()
}

fn line(out: &mut String, head: &str, entries: &[Option<String>]) {
    let there: Vec<&str> = entries.iter().flatten().map(String::as_str).collect();
    if !there.is_empty() {
        let _ = writeln!(out, "{}", wrap::entries(&format!("  {head:9} "), &there));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::summary::Status;
    use contract::figure::Style;
    use serde_json::{Value, json};

    #[test]
    fn what_is_absent_leaves_no_trace() {
        let sections = json!({"heat": {"disc": {"rise_k": 298.2, "x_over_a": -0.829}}});
        let summary = Summary {
            case: "c".to_owned(),
            status: Status::Completed,
            reason: "done".to_owned(),
            cost: Cost { wall_s: 0.12, bytes_exchanged: 64, ..Cost::default() },
            ..Summary::of_sections(sections)
        };
        let figure = |key: &str, short: &str| FigureSpec::new(key, "K", "rise").on("disc", short);
        let figures = [
            figure("heat.disc.rise_k", "").style(Style::Signed),
            FigureSpec { unit: "1".to_owned(), ..figure("heat.disc.x_over_a", "at x/a").digits(4) },
            figure("heat.disc.depth_m", "depth"),
            figure("heat.pin.rise_k", "").on("pin", ""),
        ];
        let text = text(&summary, None, &figures);
        let expected = "c\n  completed: done\n  disc      +298.20 K   at x/a -0.8290\n";
        let (physics, run) = text.split_once("  coupling  ").unwrap();
        assert_eq!(physics, expected);
        assert!(run.starts_with("0 windows   0 iterations\n  cost      wall 120 ms"), "{run}");
        assert!(run.ends_with("64 B exchanged\n"), "{run}");
    }

    #[test]
    fn of_many_entries_those_that_matter_most_have_a_line() {
        let each: Vec<Value> =
            (0..9).map(|place| json!({"load_n": 25.0 - f64::from(place)})).collect();
        let summary = Summary::of_sections(json!({"contact": {"patches": 12, "each": each}}));
        let figures = [
            FigureSpec::new("contact.patches", "1", "number")
                .on("contact", "patch")
                .style(Style::Count),
            FigureSpec::new("contact.each.#.load_n", "N", "load").on("patch", "N").headline(),
        ];
        let text = text(&summary, None, &figures);
        let (physics, _) = text.split_once("  coupling").unwrap();
        let lines: Vec<&str> = physics.lines().skip(2).collect();
        assert_eq!(lines.len(), 10);
        assert_eq!(lines[0], "  contact   12 patches");
        assert_eq!(lines[2], "  patch 2   N 24.000 N");
        assert_eq!(lines[9], "            4 smaller patches: see summary.json");
    }
}
