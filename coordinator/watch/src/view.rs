//! The view of one field at one step: maps, profiles, history, statistics, and the work of the
//! participants around the step.

use crate::index::{Index, Place, Sample, Series, Step};
use crate::steps::{Move, arrive};
use contract::bodies::Bodies;
use contract::grid::Grid;
use pages::axis::{AXES, label};
use pages::lanes::Lanes;
use pages::map::Heatmap;
use pages::maps::{self, FieldDrawing};
use pages::page::{self, Block};
use pages::plot::Figure;
use pages::source::{Columns, Field, Image};
use pages::table::Table;
use run::error::RunError;
use run::format::{Scale, number, words};
use run::results::last::LastField;
use run::results::vtk::FieldLabel;
use serde::Serialize;
use std::borrow::Cow;

/// Number of steps before and after the shown one whose work is drawn.
const AROUND: usize = 6;

contract::words! {
    /// State with which the shown one is compared.
    #[derive(Default)]
    pub(crate) enum Against {
        /// None.
        #[default]
        Nothing = "nothing",
        /// The iteration before.
        Iteration = "iteration",
        /// The accepted values of the window before.
        Window = "window",
        /// The same iteration of the other recording.
        Other = "other",
    }
}

/// Field, step and comparison to show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Request {
    /// Number of the series.
    pub(crate) series: usize,
    /// Number of the step.
    pub(crate) step: usize,
    /// Step to go to from there.
    pub(crate) go: Move,
    /// Comparison.
    pub(crate) against: Against,
}

/// A view, as the script of the page receives it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct View {
    /// Number of the shown step.
    pub(crate) step: usize,
    /// Window, iteration, time and residual.
    pub(crate) caption: String,
    /// HTML of the drawings.
    pub(crate) html: String,
    /// Number of the recording that is drawn, as in the state.
    pub(crate) run: u64,
}

/// Returns the name of a series for the page.
pub(crate) fn name(series: &Series, bodies: Option<&Bodies>) -> String {
    let kind = FieldLabel::of(&series.kind, bodies);
    let parts: Vec<&str> = series.service.split('/').collect();
    let from = match parts.as_slice() {
        ["field", "coordinator", _] => "iterate of the coupling".to_owned(),
        ["field", "coordinator", _, role] => format!("mapped for {role}"),
        ["field", role, _] => (*role).to_owned(),
        _ => series.service.clone(),
    };
    format!("{} ({from})", words(&kind.name))
}

/// Draws a view.
///
/// # Errors
/// A recording is damaged.
pub(crate) fn view(
    now: &mut Index,
    other: Option<&mut Index>,
    request: Request,
) -> Result<View, RunError> {
    let Some(step) = arrive(now.steps(), request.step, request.go) else {
        let caption = "no iteration is complete yet".to_owned();
        return Ok(View { caption, ..View::default() });
    };
    let caption = caption(now.steps(), step);
    let blocks = blocks(now, other, Request { step, ..request })?;
    Ok(View { step, caption, html: page::html(&blocks), run: 0 })
}

fn caption(steps: &[Step], at: usize) -> String {
    let Step { window, iteration, interval: [start, end], residual, .. } = steps[at];
    let mut text = format!("window {window}, iteration {iteration}");
    if end > start {
        let scale = Scale::of("s", end);
        text += &format!(" · {} to {}", number(start / scale.factor, 4), scale.show(end, 4));
    }
    if let Some(residual) = residual {
        text += &format!(" · residual {}", number(residual, 2));
    }
    text + &format!(" · step {} of {}", at + 1, steps.len())
}

fn blocks(
    now: &mut Index,
    other: Option<&mut Index>,
    request: Request,
) -> Result<Vec<Block>, RunError> {
    let Request { series, step, .. } = request;
    let Some(of) = now.series().get(series).cloned() else { return Ok(Vec::new()) };
    let time = now.steps()[step].nanoseconds;
    let Some((place, sample)) = now.sample(series, time)? else {
        let text = "The field has not been sent by the end of this step.";
        return Ok(vec![Block::Text(text.to_owned())]);
    };
    let compared = compared(now, other, request, &of, &place)?;
    let kind = FieldLabel::of(&of.kind, now.bodies());
    let mut blocks = Vec::new();
    if (place.window, place.iteration) != (now.steps()[step].window, now.steps()[step].iteration) {
        blocks.push(Block::Text(format!(
            "This sample was sent in window {}, iteration {}.",
            place.window, place.iteration
        )));
    }
    if let Compared::Missing(why) = &compared {
        blocks.push(Block::Text((*why).to_owned()));
    }
    let before = match &compared {
        Compared::Sample(words, before) => Some((words.as_str(), &**before)),
        _ => None,
    };
    blocks.extend(drawings(&kind, &sample, before));
    blocks.push(Block::Card("values".to_owned(), statistics(&kind, &sample, before)));
    blocks.extend(history(&kind, now, &of, step).map(Block::Figure));
    blocks.extend(lanes(now, step).map(Block::Lanes));
    Ok(blocks)
}

/// State with which the shown one is compared.
enum Compared {
    Nothing,
    /// It does not exist, for this reason.
    Missing(&'static str),
    /// Name and values of the other state.
    Sample(String, Box<Sample>),
}

fn compared(
    now: &mut Index,
    other: Option<&mut Index>,
    request: Request,
    of: &Series,
    place: &Place,
) -> Result<Compared, RunError> {
    let before = |now: &mut Index, step: Option<usize>, words: &str, none: &'static str| {
        let Some(step) = step else { return Ok(Compared::Missing(none)) };
        let time = now.steps()[step].nanoseconds;
        Ok(match now.sample(request.series, time)? {
            Some((_, sample)) => Compared::Sample(words.to_owned(), Box::new(sample)),
            None => Compared::Missing(none),
        })
    };
    match request.against {
        Against::Nothing => Ok(Compared::Nothing),
        Against::Iteration => {
            let step = request.step.checked_sub(1);
            before(now, step, "the iteration before", "There is no iteration before this one.")
        }
        Against::Window => {
            let window = now.steps()[request.step].window;
            let step = now.steps()[..request.step].iter().rposition(|one| one.window != window);
            before(now, step, "the window before", "There is no window before this one.")
        }
        Against::Other => {
            let missing = Compared::Missing("The other recording does not have this sample.");
            let Some(other) = other else { return Ok(missing) };
            let Some(series) = other.find(&of.service) else { return Ok(missing) };
            let sample = other.sample_like(series, place)?;
            let words = "the other recording".to_owned();
            Ok(sample.map_or(missing, |sample| Compared::Sample(words, Box::new(sample))))
        }
    }
}

/// Draws the field and, if it is compared, its difference.
fn drawings(kind: &FieldLabel, sample: &Sample, before: Option<(&str, &Sample)>) -> Vec<Block> {
    let Some(grid) = &sample.grid else {
        return vec![Block::Text("The grid of this field is not in the recording.".to_owned())];
    };
    let name = words(&kind.name);
    let mut blocks = vec![drawn(kind, grid, &sample.values, name.clone(), Drawn::Field)];
    if let Some((of, before)) = before {
        match difference(sample, before) {
            Some(values) => {
                let title = format!("{name} minus that of {of}");
                blocks.push(drawn(kind, grid, &values, title, Drawn::Difference));
            }
            None => blocks.push(Block::Text(format!("The grid differs from that of {of}."))),
        }
    }
    if let Some(image) = image(kind, grid, &sample.values) {
        blocks.extend(profile(kind, &image, before));
    }
    blocks
}

/// Kind of drawn values.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drawn {
    Field,
    Difference,
}

/// Draws values as a map or as lines or, on a grid without rows, as scattered points.
fn drawn(kind: &FieldLabel, grid: &Grid, values: &[f64], title: String, drawn: Drawn) -> Block {
    let Some(mut image) = image(kind, grid, values) else {
        return Block::Figure(scattered(kind, grid, values, title));
    };
    let drawing = match drawn {
        Drawn::Field => maps::draw(&image, &image.fields[0], &[]),
        Drawn::Difference => {
            let field = &mut image.fields[0];
            field.meaning = match field.components {
                1 => "positive where the shown values are larger".to_owned(),
                _ => "difference of the vectors".to_owned(),
            };
            maps::draw_difference(&image, &image.fields[0])
        }
    };
    match drawing {
        Some(FieldDrawing::Map(map)) => Block::Heatmap(Heatmap { title, ..map }),
        Some(FieldDrawing::Line(line)) => Block::Figure(Figure { title, ..line }),
        None => Block::Text(format!("The {title} is zero everywhere.")),
    }
}

/// Returns the field on the cells of a structured grid that is aligned with the axes.
fn image(kind: &FieldLabel, grid: &Grid, values: &[f64]) -> Option<Image> {
    let field = LastField {
        series: String::new(),
        grid: *grid.as_structured()?,
        kind: Cow::Borrowed(kind),
        values: Cow::Borrowed(values),
    };
    Image::of(std::iter::once(&field))
}

fn difference(now: &Sample, before: &Sample) -> Option<Vec<f64>> {
    let same = now.values.len() == before.values.len();
    same.then(|| now.values.iter().zip(&before.values).map(|(a, b)| a - b).collect())
}

/// Line through the largest value of a map, with the compared values along the same line.
fn profile(kind: &FieldLabel, image: &Image, before: Option<(&str, &Sample)>) -> Option<Block> {
    let [along, upright] = image.plane()?;
    let columns = image.cells[along];
    if columns < 2 || image.cells[upright] < 2 {
        return None;
    }
    let field = &image.fields[0];
    let values = field.magnitudes();
    let largest = (0..values.len()).max_by(|a, b| values[*a].abs().total_cmp(&values[*b].abs()))?;
    let row = largest / columns;
    let borders = image.borders(along);
    let length = Scale::of("m", borders[0].abs().max(borders[1].abs()));
    let scale = Scale::of(&kind.unit, values[largest].abs());
    let line = |field: &Field| -> Vec<[f64; 2]> {
        let values = field.magnitudes();
        let point = |column: usize| {
            let value = values[row * columns + column];
            [image.middle(along, column) / length.factor, value / scale.factor]
        };
        (0..columns).map(point).collect()
    };
    let title = "along the line through the largest value";
    let mut figure = Figure::new(title, label(AXES[along], &length.unit), label("", &scale.unit));
    if let Some((words, before)) = before {
        let then = before.grid.as_ref().and_then(|grid| self::image(kind, grid, &before.values));
        if let Some(then) = then.filter(|then| then.cells == image.cells) {
            figure = figure.with("shown", line(field)).with(words, line(&then.fields[0]));
        }
    }
    if figure.lines.is_empty() {
        figure = figure.with(words(&kind.name), line(field));
    }
    let place = image.middle(upright, row);
    // Treat a place within rounding of zero as zero.
    let place = if place.abs() < 1e-9 * image.spacing[upright] { 0.0 } else { place };
    let across = image.borders(upright);
    let across = Scale::of("m", across[0].abs().max(across[1].abs()));
    figure.note = format!("At {} {}.", AXES[upright], across.show(place, 3));
    Some(Block::Figure(figure))
}

/// Draws values at scattered points over the coordinate with the largest extent.
fn scattered(kind: &FieldLabel, grid: &Grid, values: &[f64], title: String) -> Figure {
    let points = grid.points();
    let places: Vec<[f64; 3]> = (0..points).map(|point| grid.centre(point)).collect();
    let extent = |axis: usize| {
        let along = || places.iter().map(|place| place[axis]);
        along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
    };
    let along = (0..3).max_by(|a, b| extent(*a).total_cmp(&extent(*b))).unwrap_or(0);
    let far = places.iter().map(|place| place[along].abs()).fold(0.0, f64::max);
    let magnitudes: Vec<f64> = (0..points)
        .map(|point| {
            let component = |k: usize| values[k * points + point];
            match kind.components {
                1 => component(0),
                many => (0..many as usize).map(|k| component(k).powi(2)).sum::<f64>().sqrt(),
            }
        })
        .collect();
    let largest = magnitudes.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let (length, scale) = (Scale::of("m", far), Scale::of(&kind.unit, largest));
    let mut line: Vec<[f64; 2]> = places
        .iter()
        .zip(&magnitudes)
        .map(|(place, value)| [place[along] / length.factor, value / scale.factor])
        .collect();
    line.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let x = label(AXES[along], &length.unit);
    let mut figure = Figure::new(title, x, label("", &scale.unit));
    figure = figure.with_marks(words(&kind.name), line);
    figure.note = "All points of the grid, over one coordinate.".to_owned();
    figure
}

/// Numbers about the values, and about their change.
fn statistics(kind: &FieldLabel, sample: &Sample, before: Option<(&str, &Sample)>) -> Table {
    let values = &sample.values;
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
    let largest = finite().fold(0.0, |most: f64, value| most.max(value.abs()));
    let scale = Scale::of(&kind.unit, largest);
    let mut table = Table::new(["of the sample", "value"], 1);
    table.row(["smallest".to_owned(), scale.show(finite().fold(f64::INFINITY, f64::min), 6)]);
    table.row(["largest".to_owned(), scale.show(finite().fold(f64::NEG_INFINITY, f64::max), 6)]);
    table.row(["mean".to_owned(), scale.show(finite().sum::<f64>() / values.len() as f64, 6)]);
    table.row(["number of values".to_owned(), values.len().to_string()]);
    let wrong = values.len() - finite().count();
    if wrong > 0 {
        table.row(["not finite".to_owned(), wrong.to_string()]);
    }
    let Some((of, before)) = before else { return table };
    let Some(change) = difference(sample, before) else { return table };
    let relative = norm(&change) / norm(values);
    let most = change.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let unequal = change.iter().filter(|value| **value != 0.0).count();
    table.row([format!("largest change from {of}"), Scale::of(&kind.unit, most).show(most, 4)]);
    table.row(["two-norm of the change, relative".to_owned(), number(relative, 3)]);
    table.row(["values that differ".to_owned(), unequal.to_string()]);
    table
}

/// Smallest and largest value over all steps.
fn history(kind: &FieldLabel, now: &Index, of: &Series, step: usize) -> Option<Figure> {
    let steps = now.steps();
    if steps.len() < 2 {
        return None;
    }
    let largest =
        of.places.iter().flat_map(|place| place.range).fold(0.0, |m: f64, v| m.max(v.abs()));
    let scale = Scale::of(&kind.unit, largest);
    let places: Vec<(usize, Place)> = steps
        .iter()
        .enumerate()
        .filter_map(|(n, step)| Some((n, of.at(step.nanoseconds)?)))
        .collect();
    let line = |end: usize| -> Vec<[f64; 2]> {
        let point = |(n, place): &(usize, Place)| [(n + 1) as f64, place.range[end] / scale.factor];
        places.iter().map(point).collect()
    };
    let here = places.iter().find(|(n, _)| *n == step).map(|(_, place)| place.range)?;
    let marks = here.map(|value| [(step + 1) as f64, value / scale.factor]).to_vec();
    let mut figure = Figure::new("smallest and largest value", "step", label("", &scale.unit));
    figure.whole = true;
    let figure = figure.with("largest", line(1)).with("smallest", line(0));
    let mut figure = figure.with_marks("this step", marks);
    if kind.components > 1 {
        figure.note = "Over all components.".to_owned();
    }
    Some(figure)
}

/// Work of the participants around the step.
fn lanes(now: &Index, step: usize) -> Option<Lanes> {
    let first = step.saturating_sub(AROUND);
    let last = (step + AROUND).min(now.steps().len() - 1);
    let rows = Columns::parse(&now.table(first..last + 1));
    let mut lanes = pages::work(&rows, now.scheme())?;
    lanes.title = format!("work in steps {} to {}", first + 1, last + 1);
    Some(lanes)
}
