//! How the coupling has converged.

use super::work::windows;
use crate::plot::Figure;
use crate::source::Results;
use run::format::words;

/// Residuals over all iterations, and iterations a window; nothing for an explicit scheme.
pub(super) fn figures(results: &Results) -> Vec<Figure> {
    match residuals(results) {
        Some(residuals) => [residuals].into_iter().chain(iterations(results)).collect(),
        None => Vec::new(),
    }
}

fn residuals(results: &Results) -> Option<Figure> {
    let table = &results.iterations;
    let fields: Vec<&str> = table.names().filter(|name| name.starts_with("residual_")).collect();
    if fields.is_empty() || table.is_empty() {
        return None;
    }
    let windows = windows(table).len();
    let mut figure = Figure::new("relative residuals", "iteration", "‖r‖ / ‖x̃‖");
    (figure.decades, figure.whole) = (true, true);
    for field in fields {
        let values = table.column(field)?;
        let points = gapped(&values, &table.column("iteration")?);
        let name = field.trim_start_matches("residual_");
        figure = figure.with(words(name), points);
    }
    figure.note = match windows {
        1 => "Of every field of the coupling data.".to_owned(),
        many => format!("Of every field of the coupling data; {many} windows one after the other."),
    };
    figure.has_points().then_some(figure)
}

/// Values over the number of their row from 1 on, with a gap before every window.
fn gapped(values: &[f64], iterations: &[f64]) -> Vec<[f64; 2]> {
    let mut points = Vec::with_capacity(values.len());
    for (n, (value, iteration)) in values.iter().zip(iterations).enumerate() {
        if n > 0 && *iteration == 1.0 {
            points.push([n as f64 + 0.5, f64::NAN]);
        }
        points.push([n as f64 + 1.0, *value]);
    }
    points
}

/// Iterations of each window, where there are several.
fn iterations(results: &Results) -> Option<Figure> {
    let windows = windows(&results.iterations);
    let points: Vec<[f64; 2]> =
        windows.iter().enumerate().map(|(n, rows)| [n as f64, rows.len() as f64]).collect();
    let mut figure = Figure::new("iterations of each window", "window", "iterations");
    figure.whole = true;
    (points.len() > 1).then(|| figure.with("iterations", points))
}
