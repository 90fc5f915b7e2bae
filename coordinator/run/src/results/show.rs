//! Text of the summary for the terminal.

use super::figures::{Entry, Extreme, Group, List, groups};
use crate::format::{bytes, counted, number, seconds};
use crate::warnings;
use crate::wrap;
use contract::figure::FigureSpec;
use serde_json::Value;
use std::fmt::Write as _;

/// Largest number of entries of a list that have a line each.
const MOST_LISTED: usize = 8;

/// Returns the lines printed at the end of a run, with the described figures. Figures that the
/// summary does not hold are omitted.
#[must_use]
pub fn text(summary: &Value, title: Option<&str>, figures: &[FigureSpec]) -> String {
    let of = |pointer: &str| summary.pointer(pointer).and_then(Value::as_f64);
    let word = |pointer: &str| summary.pointer(pointer).and_then(Value::as_str).unwrap_or("");
    let mut out = word("/case").to_owned();
    if let Some(title) = title {
        let _ = write!(out, " · {title}");
    }
    let status = format!("  {}: {}", word("/status"), word("/reason"));
    let _ = writeln!(out, "\n{}", wrap::columns(&status));
    for warning in warnings::of_summary(summary) {
        let _ = writeln!(out, "{}", wrap::columns(&format!("  warning   {warning}")));
    }
    extremes(&mut out, summary, figures);
    for group in groups(summary, figures) {
        match group {
            Group::Line(one) => line(&mut out, one.name, &texts(&one.entries)),
            Group::List(list) => entries(&mut out, &list),
        }
    }
    line(
        &mut out,
        "coupling",
        &[
            Some(word("/coupling/scheme").to_owned()).filter(|scheme| !scheme.is_empty()),
            Some(word("/coupling/acceleration").to_owned())
                .filter(|word| !word.is_empty() && word != "none"),
            of("/coupling/windows").map(|v| counted(v as u64, "window")),
            of("/coupling/iterations").map(|v| counted(v as u64, "iteration")),
            of("/coupling/final_residual").map(|v| format!("residual {v}", v = number(v, 2))),
            of("/coupling/energy_imbalance").map(imbalance),
        ],
    );
    line(&mut out, "accuracy", &accuracy(summary, figures));
    line(&mut out, "cost", &cost(summary));
    out
}

/// Writes the smallest and largest values over several windows, with their windows. All lines below
/// describe the last window.
fn extremes(out: &mut String, summary: &Value, figures: &[FigureSpec]) {
    let all = Extreme::all(summary, figures);
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
fn accuracy(summary: &Value, figures: &[FigureSpec]) -> Vec<Option<String>> {
    let Some(section) = summary.get("accuracy") else { return Vec::new() };
    let of = |key: &str| section.get(key).and_then(Value::as_f64);
    let percent = |key: &str| of(key).map(|error| format!("{} %", number(100.0 * error, 2)));
    let word = |key: &str| section.get(key).and_then(Value::as_str).map(str::to_owned);
    let quoted = || {
        let (key, value) = (word("quantity")?, of("value")?);
        let figure = figures.iter().find(|figure| figure.key == key);
        Some(match figure {
            Some(figure) => {
                let text = Entry { figure, value }.number(usize::MAX);
                format!("{} {}", figure.words, text.replace('\u{a0}', " ").replace('−', "-"))
            }
            None => format!("{key} {}", number(value, 5)),
        })
    };
    let taken = section.get("taken").and_then(Value::as_str) == Some("extrapolated");
    let limit = of("extrapolated").filter(|_| !taken);
    vec![
        quoted(),
        percent("estimated_error").map(|error| format!("± {error}")),
        percent("target").map(|error| format!("of {error} asked for")),
        percent("grid_error").map(|error| format!("grid {error}")),
        percent("model_error").map(|error| format!("models {error}")),
        limit.map(|value| format!("extrapolated {}", number(value, 5))),
        of("narrow_slip_zone").map(|width| {
            let width = number(width, 2);
            format!("not extrapolated: slip zone {width} elements wide on the coarsest grid")
        }),
        taken.then(|| "extrapolated from three grids: quote this".to_owned()),
        taken.then(|| "the lines above describe the finest grid".to_owned()),
        word("models"),
    ]
}

fn cost(summary: &Value) -> Vec<Option<String>> {
    let section = summary.get("cost").and_then(Value::as_object);
    let entries = section.into_iter().flatten().filter_map(|(key, value)| {
        let value = value.as_f64()?;
        let name = key.strip_suffix("_s")?;
        Some(Some(format!("{name} {}", seconds(value))))
    });
    let exchanged = summary.pointer("/cost/bytes_exchanged").and_then(Value::as_u64);
    entries.chain([exchanged.map(|v| format!("{} exchanged", bytes(v)))]).collect()
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
    use contract::figure::Style;

    #[test]
    fn what_is_absent_leaves_no_trace() {
        let summary = serde_json::json!({
            "case": "c", "status": "completed", "reason": "done",
            "heat": {"disc": {"rise_k": 298.2, "x_over_a": -0.829}},
            "cost": {"wall_s": 0.12, "bytes_exchanged": 64},
        });
        let figure = |key: &str, short: &str| FigureSpec::new(key, "K", "rise").on("disc", short);
        let figures = [
            figure("heat.disc.rise_k", "").style(Style::Signed),
            FigureSpec { unit: "1".to_owned(), ..figure("heat.disc.x_over_a", "at x/a").digits(4) },
            figure("heat.disc.depth_m", "depth"),
            figure("heat.pin.rise_k", "").on("pin", ""),
        ];
        let text = text(&summary, None, &figures);
        let expected = "c\n  completed: done\n  disc      +298.20 K   at x/a -0.8290\n  \
                        cost      wall 120 ms   64 B exchanged\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn of_many_entries_those_that_matter_most_have_a_line() {
        let each: Vec<Value> =
            (0..9).map(|place| serde_json::json!({"load_n": 25.0 - f64::from(place)})).collect();
        let summary = serde_json::json!({"contact": {"patches": 12, "each": each}});
        let figures = [
            FigureSpec::new("contact.patches", "1", "number")
                .on("contact", "patch")
                .style(Style::Count),
            FigureSpec::new("contact.each.#.load_n", "N", "load").on("patch", "N").headline(),
        ];
        let text = text(&summary, None, &figures);
        let lines: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(lines.len(), 10);
        assert_eq!(lines[0], "  contact   12 patches");
        assert_eq!(lines[2], "  patch 2   N 24.000 N");
        assert_eq!(lines[9], "            4 smaller patches: see summary.json");
    }
}
