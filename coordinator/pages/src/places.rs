//! Axes, and places along them.

use super::axis::extent;
use super::source::{GridSeries, Image, Table};
use run::format::Scale;

/// Names of the axes.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// The grid is a surface, and no section below one.
pub(crate) fn is_surface(series: &GridSeries) -> bool {
    series.image.as_ref().and_then(Image::plane) == Some([0, 1])
}

/// The coordinate along a line, with its label.
pub(crate) fn places(line: &Table) -> Option<(String, Vec<f64>)> {
    let columns = AXES.iter().filter_map(|axis| Some((axis, line.column(&format!("{axis} [m]"))?)));
    let length =
        |values: &[f64]| extent(values.iter().copied()).map_or(0.0, |[low, high]| high - low);
    let (axis, values) = columns.max_by(|a, b| length(&a.1).total_cmp(&length(&b.1)))?;
    let scale = Scale::of("m", values.iter().fold(0.0, |l: f64, v| l.max(v.abs())));
    let places = values.iter().map(|v| v / scale.factor).collect();
    Some((label(axis, &scale.unit), places))
}

/// What an axis is labelled with.
pub(crate) fn label(name: &str, unit: &str) -> String {
    match (name, unit) {
        (name, "") => name.to_owned(),
        ("", unit) => unit.to_owned(),
        (name, unit) => format!("{name} [{unit}]"),
    }
}
