//! Fields at the newest instant: maps of surfaces, lines through the largest values, and the
//! temperature over depth and time.

use crate::axis::{AXES, extent, label, largest_magnitude};
use crate::maps::{self, FieldDrawing};
use crate::page::{Block, Section};
use crate::plot::{Figure, Line};
use crate::source::{Columns, Field, GridSeries, Image, Results};
use contract::figure::Style;
use run::format::{Scale, words};
use run::results::figures::{Entry, Group, groups};

/// Components below this share of the largest are residuals of an iteration and not drawn.
const NOTHING: f64 = 1e-5;

/// All fields of all grids, in the order of the files: mechanical fields first.
pub(super) fn maps(results: &Results) -> Option<Section> {
    let mut blocks: Vec<Block> = maps::all(results).into_iter().map(FieldDrawing::block).collect();
    if !blocks.is_empty() {
        let when = when(results);
        let axes = match results.sections().get("contact") {
            Some(_) => {
                " x points forward, in the direction of rolling, and y to the left. Slip and \
                 friction power are assigned to the path of a particle from one element to the \
                 next. The row of elements at the leading edge holds the path into the contact, \
                 where surfaces slip before they stick."
            }
            None => "",
        };
        let named = named(results);
        let zero = match maps::zero(results).as_slice() {
            [] => String::new(),
            names => {
                let names: Vec<String> = names.iter().map(|name| words(name)).collect();
                format!(" Fields that are zero everywhere are not drawn: {}.", names.join(", "))
            }
        };
        blocks.insert(
            0,
            Block::Text(format!(
                "{when}{axes}{named} Blank elements are outside the contact. A cross marks the element \
                 with the largest value, and thin lines are contours. A map shows means or point \
                 values of elements. The results at the top of the page interpolate between \
                 elements and are the values to quote.{zero}"
            )),
        );
    }
    Section::of("Fields", blocks)
}

/// Tells which of several named patches lies where across the maps.
fn named(results: &Results) -> String {
    let groups = groups(results.sections(), results.figures());
    let patches = groups.iter().filter_map(|group| match group {
        Group::List(list) if list.rows.len() > 1 => Some(list),
        _ => None,
    });
    let told = patches.filter_map(|list| {
        let place = |row: &Vec<Entry>| {
            let across = |entry: &&Entry| {
                entry.figure.style == Style::Place && entry.figure.short == AXES[1]
            };
            row.iter().find(across).map(|entry| Scale::of("m", entry.value).show(entry.value, 3))
        };
        let one = |(name, row): (&String, &Vec<Entry>)| {
            let place = place(row).filter(|_| !name.is_empty())?;
            Some(format!("{name} at {} {place}", AXES[1]))
        };
        let all: Option<Vec<String>> = list.names.iter().zip(&list.rows).map(one).collect();
        all.map(|all| format!(" Each {} on the maps: {}.", list.name, all.join(", ")))
    });
    told.collect()
}

fn when(results: &Results) -> String {
    let newest = results.series.iter().filter_map(|series| series.instants.last());
    match newest.map(|(time, _)| *time).fold(0.0, f64::max) {
        0.0 => "The fields of the last window.".to_owned(),
        time => format!("The fields at {}.", Scale::of("s", time).show(time, 4)),
    }
}

/// Lines in the rolling direction, one figure per grid and unit, followed by depth and time.
pub(super) fn lines(results: &Results) -> Option<Section> {
    let surfaces = results.series.iter().filter(|series| series.is_surface());
    let figures = surfaces.flat_map(|series| {
        // Single lines of a single row of elements already appear among the fields.
        let alone = maps::is_row(series);
        let all = series.line.iter().flat_map(figures);
        all.filter(move |figure| !alone || figure.lines.len() > 1)
    });
    let mut blocks: Vec<Block> = figures.map(Block::Figure).collect();
    blocks.extend(temperature(results).into_iter().map(Block::Figure));
    Section::of("Lines through the largest value, over depth and over time", blocks)
}

fn figures(line: &Columns) -> Vec<Figure> {
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

/// Plots the quantities of one unit in one figure; quantities within rounding of zero are omitted.
fn lines_of<'a>(
    line: &Columns,
    unit: &str,
    names: impl Iterator<Item = &'a str>,
    x_label: &str,
    places: &[f64],
) -> Option<Figure> {
    let column = |name: &'a str| Some((name, line.column(&format!("{name} [{unit}]"))?));
    let columns: Vec<(&str, Vec<f64>)> = names.filter_map(column).collect();
    let largest = columns.iter().map(|(_, values)| largest_magnitude(values)).fold(0.0, f64::max);
    let shown = columns.iter().filter(|(_, values)| largest_magnitude(values) > NOTHING * largest);
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

/// Coordinate along a line, with its label.
fn places(line: &Columns) -> Option<(String, Vec<f64>)> {
    let columns = AXES.iter().filter_map(|axis| Some((axis, line.column(&format!("{axis} [m]"))?)));
    let length =
        |values: &[f64]| extent(values.iter().copied()).map_or(0.0, |[low, high]| high - low);
    let (axis, values) = columns.max_by(|a, b| length(&a.1).total_cmp(&length(&b.1)))?;
    let scale = Scale::of("m", largest_magnitude(&values));
    let places = values.iter().map(|v| v / scale.factor).collect();
    Some((label(axis, &scale.unit), places))
}

/// Name and unit in the heading of a column.
fn quantity(column: &str) -> Option<(&str, &str)> {
    column.strip_suffix(']')?.rsplit_once(" [")
}

/// Maximum number of instants shown in one figure.
const INSTANTS: usize = 6;
/// Maximum number of instants offered for selection.
const FRAMES: usize = 60;

/// Depth profiles below the hottest points, and lines through the hottest points over time.
fn temperature(results: &Results) -> Vec<Figure> {
    let surfaces = results.series.iter().filter(|series| series.is_surface());
    depth(results).into_iter().chain(surfaces.filter_map(build_up)).collect()
}

fn is_temperature(field: &Field) -> bool {
    field.unit == "K" && field.components == 1
}

/// Temperature over the distance from the surface, below the hottest point of each section.
fn depth(results: &Results) -> Option<Figure> {
    let mut profiles = Vec::new();
    for image in results.series.iter().filter_map(|series| series.image.as_ref()) {
        if image.plane().is_some_and(|[_, upright]| upright == 2) {
            let hot = image.fields.iter().filter(|field| is_temperature(field));
            profiles.extend(hot.filter_map(|field| profile(image, field)));
        }
    }
    let deepest = profiles.iter().flat_map(|(_, points)| points).fold(0.0, |l: f64, p| l.max(p[0]));
    let scale = Scale::of("m", deepest);
    let x_label = format!("distance from the surface [{}]", scale.unit);
    let mut figure = Figure::new("temperature rise over depth", x_label, "K");
    figure.note = "Below the hottest point of each section.".to_owned();
    for (name, points) in profiles {
        figure = figure.with(name, points.iter().map(|[z, t]| [z / scale.factor, *t]).collect());
    }
    figure.has_points().then_some(figure)
}

/// Distance from the surface \[m\] and temperature \[K\] in the column of cells with the hottest
/// point.
fn profile(image: &Image, field: &Field) -> Option<(String, Vec<[f64; 2]>)> {
    let [along, _] = image.plane()?;
    let (x, points) = image.through_largest(field)?;
    let place = Scale::of("m", x).show(x, 3);
    Some((format!("{}, at {} {place}", words(&field.name), AXES[along]), points))
}

/// Lines of a surface's first temperature at several instants, through the largest value of each.
fn build_up(series: &GridSeries) -> Option<Figure> {
    let count = series.instants.len();
    let name = series.line.as_ref()?.names().find_map(|name| name.strip_suffix(" [K]"))?.to_owned();
    if count < 2 {
        return None;
    }
    let (x_label, _) = places(series.line.as_ref()?)?;
    let mut figure = Figure::new(format!("{} over time", words(&name)), x_label, "K");
    figure.note = "Along the row of elements with the largest value at each instant.".to_owned();
    let line = |instant: usize| {
        let line = series.line_at(instant)?;
        let (_, places) = places(&line)?;
        let values = line.column(&format!("{name} [K]"))?;
        let points = places.iter().zip(&values).map(|(x, v)| [*x, *v]).collect();
        let time = series.instants[instant].0;
        let name = Scale::of("s", time).show(time, 4);
        Some(Line { name, points, dots: false, marks: false, spreads: Vec::new() })
    };
    figure.lines = evenly(INSTANTS, count).map(line).collect::<Option<_>>()?;
    if count > INSTANTS {
        figure.frames = evenly(FRAMES, count).map(line).collect::<Option<_>>()?;
    }
    figure.has_points().then_some(figure)
}

/// Selects at most `most` of `count` instants, evenly, including the first and the last.
fn evenly(most: usize, count: usize) -> impl Iterator<Item = usize> {
    let parts = most.min(count).max(2);
    (0..parts.min(count)).map(move |k| (k * (count - 1)).div_ceil(parts - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_are_chosen_evenly_with_both_ends() {
        let of = |most, count| evenly(most, count).collect::<Vec<_>>();
        assert_eq!(of(6, 3), [0, 1, 2]);
        assert_eq!(of(6, 2), [0, 1]);
        assert_eq!(of(3, 101), [0, 50, 100]);
        assert_eq!(of(6, 1000).len(), 6);
    }
}
