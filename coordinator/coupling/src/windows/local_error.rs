//! Local error of a window, estimated from a straight line.
//!
//! Exchanged values are constant, or linear, within a window, so that the coupling is of first
//! order: with windows of length Δt the values y at their ends have the local error ½Δt²y″. The
//! line through the ends of the two windows before, y^P = yₙ + (Δt/Δt′)(yₙ − yₙ₋₁), has the error
//! −½Δt(Δt + Δt′)y″. Milne's device takes the error from the difference of the two:
//!
//! e = Δt/(2Δt + Δt′) · ‖y − y^P‖ / Y,
//!
//! in two-norms, with Y the largest norm of the field so far in the run. The largest e of all
//! fields counts. The estimate needs no extra solve. Source: E. Hairer, S. P. Nørsett & G. Wanner,
//! *Solving Ordinary Differential Equations I*, 2nd ed. (1993), section III.7, for Milne's device.
//! Deviation: the device is applied to the windows of a coupling, whose participants may be more
//! exact than first order within.
//!
//! A field that jumps lies on no line. There is no estimate before two ends on the same branch are
//! known, at the beginning of a run and after [`LocalError::forget`]. A field whose number of
//! values changes, as on a grid that grows, begins a branch of its own. Until it has two ends, only
//! the other fields are judged.

use serde::{Deserialize, Serialize};

/// Estimator of the local error, from the ends of the last windows and the rates of change.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LocalError {
    fields: Vec<Line>,
    /// Length of the last window \[s\].
    duration: f64,
}

/// Straight line through the values of one field.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Line {
    last: Vec<f64>,
    /// Change per second over the last window \[unit/s\].
    slope: Vec<f64>,
    /// Largest two-norm so far.
    largest: f64,
    /// Number of ends known on the present branch; more than two count as two.
    ends: u32,
}

impl LocalError {
    /// Returns the relative local error of a window of this duration \[s\] that ends with these
    /// values, field by field in a fixed order. `None` if no field has a line with as many values.
    /// NaN if a value is NaN.
    #[must_use]
    pub fn estimate<'a>(
        &self,
        duration: f64,
        fields: impl IntoIterator<Item = &'a [f64]>,
    ) -> Option<f64> {
        let milne = duration / (2.0 * duration + self.duration);
        let known = self.fields.iter().zip(fields);
        let known =
            known.filter(|(line, values)| line.ends == 2 && line.last.len() == values.len());
        let errors = known.map(|(line, values)| {
            let scale = line.largest.max(norm(values.iter().copied()));
            let ends = line.last.iter().zip(&line.slope);
            let apart = ends.zip(values).map(|((last, slope), y)| y - (last + duration * slope));
            let apart = norm(apart);
            if apart == 0.0 { 0.0 } else { milne * apart / scale }
        });
        // `f64::max` would drop a NaN.
        errors.reduce(|a, b| if a >= b || a.is_nan() { a } else { b })
    }

    /// Takes in the values at the end of an accepted window of this duration \[s\].
    pub fn accept<'a>(&mut self, duration: f64, fields: impl IntoIterator<Item = &'a [f64]>) {
        for (index, values) in fields.into_iter().enumerate() {
            if self.fields.len() == index {
                self.fields.push(Line {
                    last: values.to_vec(),
                    slope: vec![0.0; values.len()],
                    largest: 0.0,
                    ends: 0,
                });
            }
            let line = &mut self.fields[index];
            if line.last.len() != values.len() {
                // The number of values has changed: begin a new branch.
                (line.last, line.slope) = (values.to_vec(), vec![0.0; values.len()]);
                line.ends = 0;
            }
            line.ends = (line.ends + 1).min(2);
            line.largest = line.largest.max(norm(values.iter().copied()));
            let ends = line.last.iter_mut().zip(values);
            for (slope, (last, value)) in line.slope.iter_mut().zip(ends) {
                *slope = (value - *last) / duration;
                *last = *value;
            }
        }
        self.duration = duration;
    }

    /// Begins a new branch for every field, after a jump.
    pub fn forget(&mut self) {
        self.fields.iter_mut().for_each(|line| line.ends = 0);
    }
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid that grows begins a new line; a grid that moves does not.
    #[test]
    fn another_number_of_values_is_another_branch() {
        let mut local = LocalError::default();
        let mut ends = Vec::new();
        for (window, length) in [2, 2, 2, 3, 3, 3].into_iter().enumerate() {
            let values = vec![window as f64; length];
            ends.push(local.estimate(1.0, [values.as_slice()]));
            local.accept(1.0, [values.as_slice()]);
        }
        assert_eq!(ends, [None, None, Some(0.0), None, None, Some(0.0)]);
    }

    /// A field on a grid that grows in every window never has a line. The field with a constant
    /// grid is judged nevertheless; otherwise the windows would never change.
    #[test]
    fn a_field_that_grows_does_not_hide_the_others() {
        let mut local = LocalError::default();
        let mut of = |window: usize, value: f64| {
            let grown = vec![1.0; window + 1];
            let fields = [grown.as_slice(), &[value]];
            let error = local.estimate(1.0, fields);
            local.accept(1.0, fields);
            error
        };
        assert_eq!([of(0, 1.0), of(1, 1.0), of(2, 1.0)], [None, None, Some(0.0)]);
        // A third of the deviation from the line, over the largest value.
        assert_eq!(of(3, 4.0), Some(3.0 / 4.0 / 3.0));
    }

    /// Returns the estimate for the window [t, t + h] of y, after windows of these lengths before
    /// t.
    fn estimated(y: impl Fn(f64) -> f64, t: f64, before: [f64; 2], h: f64) -> f64 {
        let mut local = LocalError::default();
        let mut at = t - before[0] - before[1];
        for length in before {
            at += length;
            local.accept(length, [[y(at)].as_slice()]);
        }
        local.estimate(h, [[y(t + h)].as_slice()]).unwrap()
    }

    /// One window of backward Euler for y′ = −y from an exact start. The estimate from its result
    /// and exact earlier ends tends to the true local error ½h². The rest is of higher order in h:
    /// the ratio tends to 1 at first order.
    #[test]
    fn the_estimate_is_the_local_error_of_a_first_order_window() {
        let exact = |t: f64| (-t).exp();
        let off = |h: f64| {
            let before = [1.7 * h, 0.6 * h];
            let euler = |t: f64| if t > 1.0 + 0.5 * h { exact(1.0) / (1.0 + h) } else { exact(t) };
            let estimate = estimated(euler, 1.0, before, h) * exact(1.0 - before[1]);
            let truth = exact(1.0) / (1.0 + h) - exact(1.0 + h);
            // The history is exact here, and its slope lies half a window back.
            estimate / truth - 1.0
        };
        let errors: Vec<f64> = [0.1, 0.05, 0.025, 0.0125].iter().map(|h| off(*h).abs()).collect();
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.8..1.3).contains(&order), "{errors:?}");
        }
        assert!(errors[3] < 0.03, "{errors:?}");
    }

    #[test]
    fn a_line_has_no_error_and_a_jump_has_no_line() {
        let line = |t: f64| 2.0 + 3.0 * t;
        // Rounding of a value of size 10.
        assert!(estimated(line, 1.0, [0.5, 0.25], 0.75) < 1e-15);
        let mut local = LocalError::default();
        assert_eq!(local.estimate(1.0, [[1.0].as_slice()]), None);
        local.accept(1.0, [[1.0].as_slice()]);
        assert_eq!(local.estimate(1.0, [[1.0].as_slice()]), None, "the start is not on a branch");
        local.accept(1.0, [[1.0].as_slice()]);
        assert_eq!(local.estimate(1.0, [[4.0].as_slice()]), Some(3.0 / 4.0 / 3.0));
        local.forget();
        local.accept(1.0, [[4.0].as_slice()]);
        assert_eq!(local.estimate(1.0, [[4.0].as_slice()]), None);
    }

    #[test]
    fn the_worst_field_counts_and_nothing_hides_what_is_no_number() {
        let mut local = LocalError::default();
        let fields = |a: f64, b: f64| [vec![a], vec![b, 0.0]];
        for _ in 0..2 {
            let values = fields(1.0, 1e6);
            local.accept(1.0, values.iter().map(Vec::as_slice));
        }
        let of = |a, b| {
            let values = fields(a, b);
            local.estimate(1.0, values.iter().map(Vec::as_slice)).unwrap()
        };
        assert_eq!(of(1.0, 1e6), 0.0);
        assert!((of(0.7, 1e6 - 3.0) - 0.1).abs() < 1e-15, "rounding");
        assert!(of(f64::NAN, 1e6).is_nan() && of(1.0, f64::NAN).is_nan());
    }
}
