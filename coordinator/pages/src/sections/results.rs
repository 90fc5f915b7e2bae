//! Figures of the summary: headline figures, plots over time, the diagrams that participants
//! describe, and a table of all figures.

use crate::axis::{extent, is_varying, label};
use crate::page::{Block, Headline, Section};
use crate::plot::Figure;
use crate::source::Results;
use crate::table::Table;
use contract::diagram::Diagram;
use contract::figure::{self, ENTRY, FigureSpec, Style};
use run::format::{Scale, counted, number, sentence, stem_and_unit, words};
use run::results::figures::{Entry, Extreme, Group, Line, List, groups};
use run::results::summary::Summary;
use serde_json::Value;

/// Maximum number of significant digits of figures.
const DIGITS: usize = 4;

/// Headline figures of the participants and of the coordinator; lists as tables.
pub(super) fn headlines(results: &Results) -> Option<Section> {
    let figures = results.figures();
    let groups = groups(results.sections(), figures);
    let mut all = Vec::new();
    let mut lists = Vec::new();
    for group in &groups {
        match group {
            Group::Line(line) => all.extend(of_line(line)),
            Group::List(list) => lists.push(card(list)),
        }
    }
    all.extend(of_coupling(results));
    if all.is_empty() {
        return None;
    }
    let over = over_all(results);
    let last = over.as_ref().map(|(word, _)| {
        Block::Text(format!(
            "These figures belong to the last {word}; the table below lists the extremes over all \
             {word}s."
        ))
    });
    let over = over.map(|(_, card)| card);
    let head = last.into_iter().chain([Block::Headlines(all)]);
    Section::of("Results", head.chain(over).chain(lists).collect())
}

/// Extremes over the windows of a transient run, and the word for a window.
fn over_all(results: &Results) -> Option<(&'static str, Block)> {
    let extremes = results.summary.as_ref()?.extremes.as_ref();
    let all = Extreme::all(extremes, results.figures());
    let word = all.first()?.word;
    let mut table = Table::new(["figure", "smallest", "largest"], 1);
    for extreme in &all {
        let [least, most] = extreme.said(DIGITS);
        table.row([sentence(&extreme.figure.words), least, most]);
    }
    Some((word, Block::Table(table)))
}

/// Headlines of a line, each followed by the rest of the line.
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

/// Table with one row for each entry of a list.
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

fn of_coupling(results: &Results) -> Vec<Headline> {
    let Some(Summary { coupling, cost, .. }) = &results.summary else { return Vec::new() };
    let balance = coupling.energy_imbalance.map(|value| {
        let text = if value == 0.0 { "exact".to_owned() } else { number(value, 2) };
        headline("Heat imbalance", text, "received minus sent, worst window".to_owned())
    });
    let more = format!("in {}, {}", counted(coupling.windows, "window"), coupling.scheme);
    let iterations = headline("Iterations", coupling.iterations.to_string(), more);
    let shown = |value: f64, si: &str| Scale::of(si, value).show(value, 3);
    let bytes = format!("{} exchanged", shown(cost.bytes_exchanged as f64, "byte"));
    let wall = headline("Wall time", shown(cost.wall_s, "s"), bytes);
    balance.into_iter().chain([iterations, wall]).collect()
}

/// All quantities of the summary, as stored and with their units.
pub(super) fn everything(results: &Results) -> Option<Section> {
    let summary = results.summary.as_ref()?.to_value();
    let mut table = Table::new(["quantity", "value", "in summary.json"], 1);
    list(&summary, "", &mut table);
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

/// Plots of the headline figures that change over time.
pub(super) fn over_time(results: &Results) -> Option<Section> {
    let large = results.figures().iter().filter(|one| one.headline && !one.is_of_a_list());
    let plots = large.filter_map(|one| history(results, one)).map(Block::Figure);
    Section::of("Over time", plots.collect())
}

fn history(results: &Results, of: &FigureSpec) -> Option<Figure> {
    let (times, values) = (results.history.column("end_s")?, results.history.column(&of.key)?);
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let [least, most] =
        [finite().fold(f64::INFINITY, f64::min), finite().fold(-f64::INFINITY, f64::max)];
    if least >= most {
        return None;
    }
    let latest = times.iter().copied().fold(0.0, f64::max);
    let (time, scale) = (Scale::of("s", latest), scale(of, least.abs().max(most.abs())));
    let points = times.iter().zip(&values);
    let points = points.map(|(t, v)| [t / time.factor, v / scale.factor]).collect();
    let figure = Figure::new(of.words.clone(), format!("time [{}]", time.unit), scale.unit);
    Some(figure.with(sentence(&of.words), points))
}

fn scale(of: &FigureSpec, largest: f64) -> Scale {
    match of.style {
        Style::Percent => Scale { factor: 0.01, unit: "%".to_owned() },
        Style::Place => Scale { factor: 1e-3, unit: "mm".to_owned() },
        Style::Number | Style::Signed | Style::Count => Scale::of(&of.unit, largest),
    }
}

/// Diagrams in which the run has a point.
pub(super) fn diagrams(results: &Results) -> Option<Section> {
    let described = results.plan.iter().flat_map(|plan| &plan.diagrams);
    let drawn = described.filter_map(|one| diagram(results, one)).map(Block::Figure);
    Section::of("Diagrams", drawn.collect())
}

/// Points of a curve in the summary.
fn curve(summary: &Value, key: &str) -> Option<Vec<[f64; 2]>> {
    let list = summary.pointer(&format!("/{}", key.replace('.', "/")))?.as_array()?;
    list.iter().map(|point| Some([point.get(0)?.as_f64()?, point.get(1)?.as_f64()?])).collect()
}

/// One point for each entry of a list in the summary.
fn entries(summary: &Value, diagram: &Diagram) -> Option<Vec<[f64; 2]>> {
    let parts = |key: &'_ str| {
        let (list, name) = key.split_once(&format!(".{ENTRY}."))?;
        Some((format!("/{}", list.replace('.', "/")), name.to_owned()))
    };
    let ((list, x), (other, y)) = (parts(&diagram.x)?, parts(&diagram.y)?);
    let entries = summary.pointer(&list).filter(|_| list == other)?.as_array()?;
    let point = |entry: &Value| Some([entry.get(&x)?.as_f64()?, entry.get(&y)?.as_f64()?]);
    Some(entries.iter().filter_map(point).collect())
}

/// Returns whether the points differ in x beyond solver rounding; otherwise they form no curve.
fn varies(points: &[[f64; 2]]) -> bool {
    is_varying(points.iter().map(|point| point[0]))
}

fn diagram(results: &Results, diagram: &Diagram) -> Option<Figure> {
    let curves = diagram.curves.iter();
    let curves: Vec<(&str, Vec<[f64; 2]>)> = curves
        .filter_map(|one| Some((one.name.as_str(), curve(results.sections(), &one.key)?)))
        .collect();
    if curves.is_empty() != diagram.curves.is_empty() {
        return None;
    }
    let column = |key: &str| results.history.column(key).unwrap_or_default();
    let windows = column(&diagram.x).into_iter().zip(column(&diagram.y));
    let mut points: Vec<[f64; 2]> = windows.map(|(x, y)| [x, y]).collect();
    if diagram.constant.iter().any(|key| is_varying(column(key).into_iter())) {
        points.clear();
    }
    let at_end = [&diagram.x, &diagram.y].map(|key| figure::value(results.sections(), key));
    if let [Some(x), Some(y)] = at_end {
        points.push([x, y]);
    }
    points.extend(entries(results.sections(), diagram).into_iter().flatten());
    points.retain(|point| point.iter().all(|value| value.is_finite()));
    // Each of two wheels has its own diagram, so only points within the curves' range belong to it.
    if let Some([from, to]) = extent(curves.iter().flat_map(|(_, line)| line).map(|p| p[0])) {
        points.retain(|point| (from..=to).contains(&point[0]));
    }
    let fewest = match (diagram.lines.is_empty(), curves.is_empty()) {
        (true, true) => 3,
        (true, false) => 0,
        _ => 1,
    };
    let alone = diagram.lines.is_empty() && curves.is_empty();
    if points.len() < fewest || alone && !varies(&points) {
        return None;
    }
    let all = || curves.iter().flat_map(|(_, line)| line).chain(&points);
    let spec = |key: &str| results.figures().iter().find(|spec| spec.key == key);
    let largest = |n: usize| all().fold(0.0, |largest: f64, point| largest.max(point[n].abs()));
    let [x_scale, y_scale] = [(0, &diagram.x), (1, &diagram.y)].map(|(n, key)| {
        let unit = spec(key).map_or("1", |spec| spec.unit.as_str());
        if spec(key).is_some_and(|spec| spec.style == Style::Percent) {
            return Scale { factor: 0.01, unit: "%".to_owned() };
        }
        // Equal scales need a common unit.
        Scale::of(unit, if diagram.true_shape { largest(0).max(largest(1)) } else { largest(n) })
    });
    let axis = |key: &str, scale: &Scale| {
        spec(key).map_or_else(String::new, |spec| {
            let name =
                if spec.short.is_empty() { sentence(&spec.words) } else { spec.short.clone() };
            label(&name, &scale.unit)
        })
    };
    let scaled = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().map(|p| [p[0] / x_scale.factor, p[1] / y_scale.factor]).collect()
    };
    let [x_label, y_label] = [axis(&diagram.x, &x_scale), axis(&diagram.y, &y_scale)];
    let mut drawn = Figure::new(diagram.title.as_str(), x_label, y_label);
    (drawn.true_shape, drawn.from_zero) = (diagram.true_shape, !diagram.true_shape);
    let lines = diagram.lines.iter().map(|line| (line.name.as_str(), &line.points));
    for (name, points) in lines.chain(curves.iter().map(|(name, line)| (*name, line))) {
        drawn = drawn.with(name, scaled(points));
        if let Some(line) = drawn.lines.last_mut() {
            line.dots = false;
        }
    }
    let list = diagram.x.split_once(&format!(".{ENTRY}.")).map(|(list, _)| list);
    let entry = list.and_then(|list| list.rsplit('.').next()).map(words);
    let name = match (&entry, points.len() > 2) {
        (Some(entry), _) => entry.as_str(),
        (None, true) => "this run, one point per window",
        (None, false) => "this run",
    };
    drawn = drawn.with_marks(name, scaled(&points));
    drawn.note.clone_from(&diagram.note);
    Some(drawn)
}
