//! The surface fields of the newest instant: maps, and lines through their largest values.

use super::temperature;
use crate::maps::{self, Drawn};
use crate::page::{Block, Section};
use crate::places::{AXES, is_surface, label, places};
use crate::plot::Figure;
use crate::source::{Results, Table};
use run::format::{Scale, words};

/// A component of less than this share of the largest is what an iteration leaves of zero, and not drawn.
const NOTHING: f64 = 1e-5;

/// Every field of every grid, the mechanical ones first as the files are named.
pub(super) fn maps(results: &Results) -> Option<Section> {
    let block = |drawn| match drawn {
        Drawn::Map(map) => Block::Heatmap(map),
        Drawn::Line(line) => Block::Figure(line),
    };
    let mut blocks: Vec<Block> = maps::all(results).into_iter().map(block).collect();
    if !blocks.is_empty() {
        let when = when(results);
        let axes = match results.summary.get("contact") {
            Some(_) => {
                " x points forward, in the direction of rolling, and y to the left. Slip and friction power \
                 belong to the way of a particle from one element to the next: the row of elements at the \
                 leading edge holds the way into the contact, where surfaces slip before they stick."
            }
            None => "",
        };
        let zero = match maps::zero(results).as_slice() {
            [] => String::new(),
            names => {
                let names: Vec<String> = names.iter().map(|name| words(name)).collect();
                format!(" Zero everywhere, and not drawn: {}.", names.join(", "))
            }
        };
        blocks.insert(
            0,
            Block::Text(format!(
                "{when}{axes} Blank is zero, or rounding beside the largest value. A cross marks the element \
                 with the largest value, thin lines join equal values. A map has means or values of elements; \
                 the results at the head interpolate between elements, and are the ones to quote.{zero}"
            )),
        );
    }
    Section::of("Fields", blocks)
}

fn when(results: &Results) -> String {
    let newest = results.series.iter().filter_map(|series| series.instants.last());
    match newest.map(|(time, _)| *time).fold(0.0, f64::max) {
        0.0 => "The fields of the last window.".to_owned(),
        time => format!("The fields at {}.", Scale::of("s", time).show(time, 4)),
    }
}

/// Lines in the rolling direction, one figure for each grid and unit; then depth and time.
pub(super) fn lines(results: &Results) -> Option<Section> {
    let surfaces = results.series.iter().filter(|series| is_surface(series));
    let figures = surfaces.flat_map(|series| {
        // Of a single row each line alone is among the fields.
        let alone = maps::is_row(series);
        let all = series.line.iter().flat_map(figures);
        all.filter(move |figure| !alone || figure.lines.len() > 1)
    });
    let mut blocks: Vec<Block> = figures.map(Block::Figure).collect();
    blocks.extend(temperature::figures(results).into_iter().map(Block::Figure));
    Section::of("Through the largest value, over depth, through time", blocks)
}

fn figures(line: &Table) -> Vec<Figure> {
    let Some((x_label, places)) = places(line) else { return Vec::new() };
    let columns: Vec<(&str, &str)> =
        line.names().filter_map(quantity).filter(|(name, _)| !AXES.contains(name)).collect();
    let mut units: Vec<&str> = columns.iter().map(|(_, unit)| *unit).collect();
    units.dedup();
    let figure = |unit: &&str| {
        let names = columns.iter().filter(|(_, other)| other == unit).map(|(name, _)| *name);
        lines_of(line, unit, names, &x_label, &places)
    };
    units.iter().filter_map(figure).collect()
}

/// The quantities of one unit in one figure; those that are zero to rounding are left out.
fn lines_of<'a>(
    line: &Table,
    unit: &str,
    names: impl Iterator<Item = &'a str>,
    x_label: &str,
    places: &[f64],
) -> Option<Figure> {
    let column = |name: &'a str| Some((name, line.column(&format!("{name} [{unit}]"))?));
    let columns: Vec<(&str, Vec<f64>)> = names.filter_map(column).collect();
    let size = |values: &[f64]| values.iter().fold(0.0, |l: f64, v| l.max(v.abs()));
    let largest = columns.iter().map(|(_, values)| size(values)).fold(0.0, f64::max);
    let shown = columns.iter().filter(|(_, values)| size(values) > NOTHING * largest);
    let scale = Scale::of(unit, largest);
    let names: Vec<String> = shown.clone().map(|(name, _)| words(name)).collect();
    let mut figure = Figure::new(names.join(", "), x_label, label("", &scale.unit));
    for (name, values) in shown {
        let points = places.iter().zip(values).map(|(x, v)| [*x, v / scale.factor]).collect();
        figure = figure.with(words(name), points);
        if let Some(line) = figure.lines.last_mut() {
            line.dots = false;
        }
    }
    (!figure.lines.is_empty()).then_some(figure)
}

/// Name and unit of a column.
fn quantity(column: &str) -> Option<(&str, &str)> {
    column.strip_suffix(']')?.rsplit_once(" [")
}
