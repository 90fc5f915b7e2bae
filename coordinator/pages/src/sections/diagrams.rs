//! The diagrams that participants describe: where the run lies among known lines, and lines that stand in its summary.

use crate::axis::extent;
use crate::page::{Block, Section};
use crate::places::label;
use crate::plot::Figure;
use crate::source::Results;
use contract::diagram::Diagram;
use contract::figure::{self, ENTRY, Style};
use run::format::{Scale, sentence, words};
use serde_json::Value;

/// Every diagram in which the run has a point.
pub(super) fn section(results: &Results) -> Option<Section> {
    let diagrams = results.plan.iter().flat_map(|plan| &plan.diagrams);
    let drawn = diagrams.filter_map(|diagram| plot(results, diagram)).map(Block::Figure);
    Section::of("Diagrams", drawn.collect())
}

/// The points of a line of the summary.
fn curve(summary: &Value, key: &str) -> Option<Vec<[f64; 2]>> {
    let list = summary.pointer(&format!("/{}", key.replace('.', "/")))?.as_array()?;
    list.iter().map(|point| Some([point.get(0)?.as_f64()?, point.get(1)?.as_f64()?])).collect()
}

/// A point for each entry of a list of the summary.
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

/// Beyond the rounding of a solver, the points differ in x: one point, however often, is no curve.
fn varies(points: &[[f64; 2]]) -> bool {
    let apart = |[from, to]: [f64; 2]| to - from > 1e-6 * from.abs().max(to.abs());
    extent(points.iter().map(|point| point[0])).is_some_and(apart)
}

fn plot(results: &Results, diagram: &Diagram) -> Option<Figure> {
    let curves = diagram.curves.iter();
    let curves: Vec<(&str, Vec<[f64; 2]>)> = curves
        .filter_map(|one| Some((one.name.as_str(), curve(&results.summary, &one.key)?)))
        .collect();
    if curves.is_empty() != diagram.curves.is_empty() {
        return None;
    }
    let column = |key: &str| results.history.column(key).unwrap_or_default();
    let windows = column(&diagram.x).into_iter().zip(column(&diagram.y));
    let mut points: Vec<[f64; 2]> = windows.map(|(x, y)| [x, y]).collect();
    let at_end = [&diagram.x, &diagram.y].map(|key| figure::value(&results.summary, key));
    if let [Some(x), Some(y)] = at_end {
        points.push([x, y]);
    }
    points.extend(entries(&results.summary, diagram).into_iter().flatten());
    points.retain(|point| point.iter().all(|value| value.is_finite()));
    // Each of two wheels has its own diagram.
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
        // A true shape has one unit.
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
        (None, true) => "this run, window by window",
        (None, false) => "this run",
    };
    drawn = drawn.with_marks(name, scaled(&points));
    drawn.note.clone_from(&diagram.note);
    Some(drawn)
}
