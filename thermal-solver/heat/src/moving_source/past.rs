//! Windows of a history as intervals of the past.

use super::ages::PastInterval;
use crate::columns::history::{History, Window};
use crate::window::Stage;

/// Iterates over the windows of a state, newest first; nothing precedes a window without end.
pub fn stretches(history: &History, stage: Stage) -> impl Iterator<Item = (PastInterval, &Window)> {
    let newest = PastInterval { from: 0.0, to: 0.0, way: 0.0, speed: 0.0 };
    history.windows(stage).scan(newest, move |before, window| {
        let (from, way) = (before.to, before.way_at(before.to));
        let (to, speed) = (from + window.duration, window.speed);
        *before = PastInterval { from, to, way, speed };
        (from < f64::INFINITY).then_some((*before, window))
    })
}
