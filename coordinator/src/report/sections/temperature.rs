//! Temperature over the depth, and how it has built up.

use crate::report::places::{AXES, is_surface, places};
use crate::report::plot::Figure;
use crate::report::source::{Field, GridSeries, Image, Results};
use run::format::{Scale, words};

/// Most instants shown in one figure.
const INSTANTS: usize = 6;

/// Depth profiles below the hottest points; lines through them, through time.
pub(super) fn figures(results: &Results) -> Vec<Figure> {
    let surfaces = results.series.iter().filter(|series| is_surface(series));
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
    figure.note = "In each section, below its hottest point.".to_owned();
    for (name, points) in profiles {
        figure = figure.with(name, points.iter().map(|[z, t]| [z / scale.factor, *t]).collect());
    }
    figure.has_points().then_some(figure)
}

/// Distance from the surface \[m\] and temperature \[K\] of the column of cells with the hottest one.
fn profile(image: &Image, field: &Field) -> Option<(String, Vec<[f64; 2]>)> {
    let [along, _] = image.plane()?;
    let (x, points) = image.through_largest(field)?;
    let place = Scale::of("m", x).show(x, 3);
    Some((format!("{}, at {} {place}", words(&field.name), AXES[along]), points))
}

/// The line through the largest first temperature of a surface at several instants.
fn build_up(series: &GridSeries) -> Option<Figure> {
    let count = series.instants.len();
    let name = series.line.as_ref()?.names().find_map(|name| name.strip_suffix(" [K]"))?.to_owned();
    if count < 2 {
        return None;
    }
    let (x_label, _) = places(series.line.as_ref()?)?;
    let mut figure = Figure::new(format!("{} through time", words(&name)), x_label, "K");
    figure.note = "Along the row of the largest value of each instant.".to_owned();
    let mut chosen: Vec<usize> = (0..INSTANTS.min(count))
        .map(|k| (k * (count - 1)).div_ceil((INSTANTS.min(count) - 1).max(1)))
        .collect();
    chosen.dedup();
    for instant in chosen {
        let line = series.line_at(instant)?;
        let (_, places) = places(&line)?;
        let values = line.column(&format!("{name} [K]"))?;
        let time = series.instants[instant].0;
        let points = places.iter().zip(&values).map(|(x, v)| [*x, *v]).collect();
        figure = figure.with(Scale::of("s", time).show(time, 4), points);
        if let Some(line) = figure.lines.last_mut() {
            line.dots = false;
        }
    }
    figure.has_points().then_some(figure)
}
