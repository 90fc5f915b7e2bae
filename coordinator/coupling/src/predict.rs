//! The first iterate of a window.
//!
//! `last` takes the values returned last. `linear` extrapolates through the ends of the last two
//! windows, x₀ = x̃ₙ + (Δtₙ₊₁/Δtₙ)(x̃ₙ − x̃ₙ₋₁), also for windows of different lengths. The first
//! two windows lack a slope and begin with the last values, and so does a steady window.

use crate::settings;
use crate::vector::{StateMismatch, StateReader, put_f64s};

/// Predictor of the first iterate, from the ends of the last windows.
#[derive(Clone, Debug)]
pub struct Predictor {
    kind: settings::Predictor,
    last: Vec<f64>,
    /// Change per second up to `last` [unit/s]; empty unless needed.
    slope: Vec<f64>,
    windows: u64,
}

impl Predictor {
    /// Creates a predictor that begins with `first`, the values known before any solve.
    #[must_use]
    pub fn new(kind: settings::Predictor, first: &[f64]) -> Self {
        let slope = match kind {
            settings::Predictor::Last => Vec::new(),
            settings::Predictor::Linear => vec![0.0; first.len()],
        };
        Self { kind, last: first.to_vec(), slope, windows: 0 }
    }

    /// Fills in the first iterate of a window of this duration [s].
    pub fn predict(&self, duration: f64, iterate: &mut [f64]) {
        iterate.copy_from_slice(&self.last);
        if self.kind == settings::Predictor::Linear {
            for (value, slope) in iterate.iter_mut().zip(&self.slope) {
                *value += duration * slope;
            }
        }
    }

    /// Takes in the values at the end of an accepted window of this duration [s].
    pub fn accept_window(&mut self, duration: f64, returned: &[f64]) {
        // Values before the first solve do not belong to a time.
        if self.windows > 0 && duration > 0.0 {
            let ends = self.last.iter().zip(returned);
            for (slope, (last, returned)) in self.slope.iter_mut().zip(ends) {
                *slope = (returned - last) / duration;
            }
        }
        self.windows += 1;
        self.last.copy_from_slice(returned);
    }

    pub(super) fn save(&self, into: &mut Vec<u8>) {
        into.extend(self.windows.to_le_bytes());
        put_f64s(into, &self.last);
        put_f64s(into, &self.slope);
    }

    pub(super) fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateMismatch> {
        self.windows = from.u64()?;
        from.f64s(&mut self.last)?;
        from.f64s(&mut self.slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn predicted(predictor: &Predictor, duration: f64) -> f64 {
        let mut iterate = [f64::NAN];
        predictor.predict(duration, &mut iterate);
        iterate[0]
    }

    #[test]
    fn a_straight_line_is_predicted_over_windows_of_any_length() {
        let line = |t: f64| 3.0 - 0.5 * t;
        let mut linear = Predictor::new(settings::Predictor::Linear, &[17.0]);
        assert_eq!(predicted(&linear, 1.0), 17.0);
        linear.accept_window(1.0, &[line(1.0)]);
        assert_eq!(predicted(&linear, 1.0), line(1.0), "the start is not a point of the line");
        linear.accept_window(2.0, &[line(3.0)]);
        assert_eq!(predicted(&linear, 4.0), line(7.0));
        linear.accept_window(0.5, &[line(3.5)]);
        assert_eq!(predicted(&linear, 0.25), line(3.75));
    }

    #[test]
    fn the_last_value_stays() {
        let mut last = Predictor::new(settings::Predictor::Last, &[1.0]);
        last.accept_window(1.0, &[2.0]);
        last.accept_window(1.0, &[5.0]);
        assert_eq!(predicted(&last, 1.0), 5.0);
    }
}
