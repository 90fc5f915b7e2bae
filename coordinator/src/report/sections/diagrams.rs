//! Where the run lies among the known lines of the diagrams that its participants describe.

use crate::report::page::{Block, Section};
use crate::report::places::label;
use crate::report::plot::Figure;
use crate::report::source::Results;
use contract::diagram::Diagram;
use contract::figure;
use run::format::sentence;

/// Every diagram in which the run has a point.
pub(super) fn section(results: &Results) -> Option<Section> {
    let diagrams = results.plan.iter().flat_map(|plan| &plan.diagrams);
    let drawn = diagrams.filter_map(|diagram| plot(results, diagram)).map(Block::Figure);
    Section::of("Limits", drawn.collect())
}

fn plot(results: &Results, diagram: &Diagram) -> Option<Figure> {
    let column = |key: &str| results.history.column(key).unwrap_or_default();
    let windows = column(&diagram.x).into_iter().zip(column(&diagram.y));
    let mut points: Vec<[f64; 2]> = windows.map(|(x, y)| [x, y]).collect();
    let at_end = [&diagram.x, &diagram.y].map(|key| figure::value(&results.summary, key));
    if let [Some(x), Some(y)] = at_end {
        points.push([x, y]);
    }
    points.retain(|point| point.iter().all(|value| value.is_finite()));
    if points.is_empty() {
        return None;
    }
    let axis = |key: &str| {
        let spec = results.figures().iter().find(|spec| spec.key == key);
        spec.map_or_else(String::new, |spec| {
            let name =
                if spec.short.is_empty() { sentence(&spec.words) } else { spec.short.clone() };
            label(&name, if spec.unit == "1" { "" } else { &spec.unit })
        })
    };
    let mut drawn = Figure::new(diagram.title.as_str(), axis(&diagram.x), axis(&diagram.y));
    for line in &diagram.lines {
        drawn = drawn.with(line.name.as_str(), line.points.clone());
        if let Some(line) = drawn.lines.last_mut() {
            line.dots = false;
        }
    }
    let many = points.len() > 2;
    drawn = drawn.with_marks(if many { "this run, window by window" } else { "this run" }, points);
    drawn.note.clone_from(&diagram.note);
    Some(drawn)
}
