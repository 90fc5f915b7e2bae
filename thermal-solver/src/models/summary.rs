//! The thermal part of `summary.json`.

use super::conduction::{Conduction, Peak};
use super::frame::Frame;
use crate::search::root_of_decreasing;
use crate::{LOWER, UPPER};
use serde_json::{Map, Value, json};

/// Strips listed at most: the first of them all.
const MOST_STRIPS: usize = 32;

/// `{"temperature": {NAME: {...}, NAME: {...}}}`, with the names of the case. Where nothing is warm there
/// is no hottest place: the rise is 0, and places and depth are absent. Several heated strips, between which the
/// surface is cold, have their own hottest places besides.
pub fn temperature<C: Conduction>(frame: &Frame, conduction: &C, rise: &[Vec<f64>; 2]) -> Value {
    let section = |body: usize| {
        let Some(peak) = conduction.peak(body, &rise[body]) else {
            return json!({"max_rise_k": 0.0});
        };
        let mut section = place(frame, peak);
        if let Some(depth) = penetration(frame, conduction, body, peak) {
            section.insert("penetration_depth_m".to_owned(), json!(depth));
        }
        let strips = strips(frame.grid.ni, &rise[body]);
        if strips.len() > 1 {
            let strips = strips.iter().take(MOST_STRIPS);
            let each = strips.filter_map(|rows| strip(frame, conduction, body, &rise[body], *rows));
            section.insert("each_strip".to_owned(), Value::Array(each.collect()));
        }
        Value::Object(section)
    };
    let [upper, lower] = &frame.scene.names.0;
    json!({"temperature": {lower: section(LOWER), upper: section(UPPER)}})
}

fn place(frame: &Frame, peak: Peak) -> Map<String, Value> {
    let figures = [("max_rise_k", peak.rise), ("x_m", peak.x), ("y_m", frame.grid.y(peak.row))];
    figures.into_iter().map(|(key, value)| (key.to_owned(), json!(value))).collect()
}

/// First and last rows of the heated strips: rows next to each other that are warm somewhere.
fn strips(columns: usize, rise: &[f64]) -> Vec<[usize; 2]> {
    let mut strips: Vec<[usize; 2]> = Vec::new();
    for (row, values) in rise.chunks_exact(columns).enumerate() {
        if values.iter().any(|rise| *rise > 0.0) {
            match strips.last_mut() {
                Some([_, last]) if *last + 1 == row => *last = row,
                _ => strips.push([row, row]),
            }
        }
    }
    strips
}

/// The sides and the hottest place of a strip.
fn strip<C: Conduction>(
    frame: &Frame,
    conduction: &C,
    body: usize,
    rise: &[f64],
    [first, last]: [usize; 2],
) -> Option<Value> {
    let columns = frame.grid.ni;
    let mut own = vec![0.0; rise.len()];
    let range = first * columns..(last + 1) * columns;
    own[range.clone()].copy_from_slice(&rise[range]);
    let mut figures = place(frame, conduction.peak(body, &own)?);
    let half = 0.5 * frame.grid.dy();
    figures.insert("y_from_m".to_owned(), json!(frame.grid.y(first) - half));
    figures.insert("y_to_m".to_owned(), json!(frame.grid.y(last) + half));
    Some(Value::Object(figures))
}

/// Depth [m] below the hottest place where the rise has fallen to 1/e, by bisection with the exact
/// depth dependence of the model.
fn penetration<C: Conduction>(
    frame: &Frame,
    conduction: &C,
    body: usize,
    peak: Peak,
) -> Option<f64> {
    let target = peak.rise / std::f64::consts::E;
    let excess = |distance: f64| {
        conduction.rise_at(body, peak.row, peak.x, frame.depth(body, distance)) - target
    };
    root_of_decreasing(frame.level_spacing(body), excess)
}
