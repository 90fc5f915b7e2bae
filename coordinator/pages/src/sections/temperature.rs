//! Temperature over the depth, and how it has built up.

use crate::places::{AXES, is_surface, places};
use crate::plot::{Figure, Line};
use crate::source::{Field, GridSeries, Image, Results};
use run::format::{Scale, words};

/// Most instants shown in one figure at once.
const INSTANTS: usize = 6;
/// Most instants among which a reader may choose.
const FRAMES: usize = 60;

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
    let line = |instant: usize| {
        let line = series.line_at(instant)?;
        let (_, places) = places(&line)?;
        let values = line.column(&format!("{name} [K]"))?;
        let points = places.iter().zip(&values).map(|(x, v)| [*x, *v]).collect();
        let time = series.instants[instant].0;
        let name = Scale::of("s", time).show(time, 4);
        Some(Line { name, points, dots: false, marks: false })
    };
    figure.lines = evenly(INSTANTS, count).map(line).collect::<Option<_>>()?;
    if count > INSTANTS {
        figure.frames = evenly(FRAMES, count).map(line).collect::<Option<_>>()?;
    }
    figure.has_points().then_some(figure)
}

/// At most `most` of `count` instants, the first and the last among them.
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
