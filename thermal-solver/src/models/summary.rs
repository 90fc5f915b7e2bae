//! The thermal part of `summary.json`.

use super::setup::Frame;
use super::shell::{Conduction, Peak};
use crate::search::root_of_decreasing;
use crate::{RAIL, WHEEL};
use serde_json::{Map, Value, json};

/// The hottest place of a body and how deep its heat goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hottest {
    /// The place.
    pub peak: Peak,
    /// Depth [m] where the rise below it is 1/e of the surface's.
    pub penetration: Option<f64>,
}

/// `{"temperature": {"rail": {...}, "wheel": {...}}}`. Where nothing is warm there is no hottest
/// place: the rise is 0, and places and depth are absent.
pub fn temperature(frame: &Frame, hottest: impl Fn(usize) -> Option<Hottest>) -> Value {
    let section = |body| match hottest(body) {
        None => json!({"max_rise_k": 0.0}),
        Some(Hottest { peak, penetration }) => {
            let mut section = Map::new();
            section.insert("max_rise_k".to_owned(), json!(peak.rise));
            section.insert("x_m".to_owned(), json!(peak.x));
            section.insert("y_m".to_owned(), json!(frame.grid.y(peak.row)));
            if let Some(depth) = penetration {
                section.insert("penetration_depth_m".to_owned(), json!(depth));
            }
            Value::Object(section)
        }
    };
    json!({"temperature": {"rail": section(RAIL), "wheel": section(WHEEL)}})
}

/// Depth [m] below the hottest place where the rise has fallen to 1/e, by bisection with the exact
/// depth dependence of the model.
pub fn penetration<C: Conduction>(
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
