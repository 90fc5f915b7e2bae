//! The quantities of the summary: the few that matter first, all of them last.

use crate::page::{Block, Headline, Section};
use crate::source::Results;
use crate::table::Table;
use contract::figure::FigureSpec;
use run::format::{Scale, counted, number, sentence, stem_and_unit, words};
use run::results::figures::{Entry, Extreme, Group, Line, List, groups};
use serde_json::Value;

/// Significant digits of the figures at most.
const DIGITS: usize = 4;

/// The figures that matter, and the coordinator's own, at a glance; lists as tables.
pub(super) fn section(results: &Results) -> Option<Section> {
    let figures = results.figures();
    let groups = groups(&results.summary, figures);
    let mut all = Vec::new();
    let mut lists = Vec::new();
    for group in &groups {
        match group {
            Group::Line(line) => all.extend(of_line(line)),
            Group::List(list) => lists.push(card(list)),
        }
    }
    all.extend(coupling(results));
    if all.is_empty() {
        return None;
    }
    let over = over_all(results);
    let last = over.as_ref().map(|(word, _)| {
        Block::Text(format!(
            "These figures are of the last {word}; the table below has the extremes over all {word}s."
        ))
    });
    let over = over.map(|(_, card)| card);
    let head = last.into_iter().chain([Block::Headlines(all)]);
    Section::of("Results", head.chain(over).chain(lists).collect())
}

/// The extremes over the windows of a run of several, and the word for a window.
fn over_all(results: &Results) -> Option<(&'static str, Block)> {
    let all = Extreme::all(&results.summary, results.figures());
    let word = all.first()?.word;
    let mut table = Table::new(["figure", "smallest", "largest"], 1);
    for extreme in &all {
        let mut n = extreme.windows.iter();
        let mut cell = |said| format!("{said} ({word} {})", n.next().copied().unwrap_or_default());
        let [least, most] = extreme.said(DIGITS).map(&mut cell);
        table.row([sentence(&extreme.figure.words), least, most]);
    }
    Some((word, Block::Table(table)))
}

/// Those of a line that stand large, each with what follows it on the line.
fn of_line(line: &Line) -> Vec<Headline> {
    let mut all: Vec<Headline> = Vec::new();
    for entry in &line.entries {
        match all.last_mut() {
            _ if entry.figure.headline => {
                let name = sentence(&entry.figure.words);
                all.push(headline(&name, entry.number(DIGITS), String::new()));
            }
            Some(Headline { more, .. }) => {
                let comma = if more.is_empty() { "" } else { ", " };
                *more += &format!("{comma}{}", entry.text(DIGITS));
            }
            None => {}
        }
    }
    all
}

/// A row for each entry of a list.
fn card(list: &List) -> Block {
    let names = list.figures.iter().map(|figure| match figure.short.is_empty() {
        true => figure.words.clone(),
        false => figure.short.clone(),
    });
    let called = list.names.iter().any(|name| !name.is_empty());
    let row = |(place, row): (usize, &Vec<Entry>)| {
        let shown = |&figure: &&FigureSpec| {
            let entry = row.iter().find(|entry| entry.figure == figure);
            entry.map(|entry| entry.number(DIGITS)).unwrap_or_default()
        };
        let figures = list.figures.iter().map(shown);
        let name = called.then(|| list.names[place].clone());
        std::iter::once((place + 1).to_string()).chain(name).chain(figures).collect()
    };
    let name = called.then(String::new);
    let head = std::iter::once(list.name.to_owned()).chain(name).chain(names).collect();
    let rows = list.rows.iter().enumerate().map(row).collect();
    Block::Card(counted(list.count as u64, list.name), Table { head, rows, figures_from: 0 })
}

fn headline(name: &str, value: String, more: String) -> Headline {
    Headline { name: name.to_owned(), value, more }
}

/// A quantity of the summary with its unit.
fn shown(results: &Results, pointer: &str, si: &str, digits: usize) -> Option<String> {
    results.quantity(pointer).map(|value| Scale::of(si, value).show(value, digits))
}

fn coupling(results: &Results) -> Vec<Headline> {
    let balance = results.quantity("/coupling/energy_imbalance").map(|value| {
        let text = if value == 0.0 { "exact".to_owned() } else { number(value, 2) };
        headline("Heat imbalance", text, "received against sent, worst window".to_owned())
    });
    let iterations = results.quantity("/coupling/iterations").map(|value| {
        let windows = results.quantity("/coupling/windows").unwrap_or(0.0);
        let windows = counted(windows as u64, "window");
        let more = format!("in {windows}, {}", results.word("/coupling/scheme"));
        headline("Iterations", format!("{value}"), more)
    });
    let wall = shown(results, "/cost/wall_s", "s", 3).map(|value| {
        let bytes = shown(results, "/cost/bytes_exchanged", "byte", 3);
        let more = bytes.map(|b| format!("{b} exchanged")).unwrap_or_default();
        headline("Wall time", value, more)
    });
    [balance, iterations, wall].into_iter().flatten().collect()
}

/// Every quantity of the summary, as it stands there and with a unit.
pub(super) fn everything(results: &Results) -> Option<Section> {
    let mut table = Table::new(["quantity", "value", "in summary.json"], 1);
    list(&results.summary, "", &mut table);
    if table.rows.is_empty() {
        return None;
    }
    let title = format!("All {} quantities of summary.json", table.rows.len());
    Section::of("Every quantity", vec![Block::Folded(title, table)])
}

fn list(value: &Value, path: &str, table: &mut Table) {
    let inner = |key: &str| match path {
        "" => key.to_owned(),
        path => format!("{path}.{key}"),
    };
    match value {
        Value::Object(entries) => {
            entries.iter().for_each(|(key, value)| list(value, &inner(key), table));
        }
        Value::Number(raw) => {
            let value = raw.as_f64().unwrap_or(f64::NAN);
            let (stem, si) = stem_and_unit(path);
            let name = words(stem).replace('.', " · ");
            table.row([name, Scale::of(si, value).show(value, 6), raw.to_string()]);
        }
        _ => {}
    }
}
