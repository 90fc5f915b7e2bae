//! How the figures that matter most have changed from window to window.

use crate::page::{Block, Section};
use crate::plot::Figure;
use crate::source::Results;
use contract::figure::{FigureSpec, Style};
use run::format::{Scale, sentence};

/// A plot of each figure that stands large and has changed.
pub(super) fn section(results: &Results) -> Option<Section> {
    let large = results.figures().iter().filter(|one| one.headline && !one.is_of_a_list());
    let plots = large.filter_map(|one| plot(results, one)).map(Block::Figure);
    Section::of("Over time", plots.collect())
}

fn plot(results: &Results, of: &FigureSpec) -> Option<Figure> {
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
