//! Corrections of an iteration that learn from earlier ones, by a multisecant method.
//!
//! An iteration x ← x + P e(x) with an approximate inverse P of the operator behind the error e
//! diverges where P is wrong by more than a factor of two. Every past iterate gives a pair of a
//! step s = Δx and a change y = Δe. An error within the span of the changes is removed by the steps
//! that caused them, and P corrects only the rest of it. For a linear error e this is the
//! generalised conjugate residual method. It converges if P A is positive.
//!
//! Source: Fang & Saad, Numer. Linear Algebra Appl. 16 (2009) 197–221, Broyden's second method with
//! many secants; Eisenstat, Elman & Schultz, SIAM J. Numer. Anal. 20 (1983) 345–357.

use crate::vector::{add_scaled, dot, norm};

/// Share of a change that must be new, relative to its size; the rest is rounding.
const NEW: f64 = 1e-6;

/// Steps and changes of past iterates of one problem.
#[derive(Clone, Debug, Default)]
pub struct Secants {
    /// Steps, combined as the changes are.
    steps: Vec<Vec<f64>>,
    /// Orthonormal changes of the error.
    changes: Vec<Vec<f64>>,
    /// Last step, and the error before it.
    last: Option<(Vec<f64>, Vec<f64>)>,
}

impl Secants {
    /// Forgets all iterates.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Writes the step for an error, which becomes the part of it that no earlier step removes.
    /// The caller adds P times the remaining error to the step and passes the sum to
    /// [`Secants::took`].
    pub fn step(&mut self, error: &mut [f64], step: &mut [f64]) {
        if let Some((step, before)) = self.last.take() {
            self.learn(step, before, error);
        }
        step.fill(0.0);
        let before = error.to_vec();
        for (change, of_change) in self.changes.iter().zip(&self.steps) {
            let overlap = dot(change, error);
            add_scaled(error, change, -overlap);
            add_scaled(step, of_change, -overlap);
        }
        self.last = Some((Vec::new(), before));
    }

    /// Records the step that was taken.
    pub fn took(&mut self, step: &[f64]) {
        if let Some((last, _)) = &mut self.last {
            *last = step.to_vec();
        }
    }

    /// Adds the pair of the last step.
    fn learn(&mut self, mut step: Vec<f64>, before: Vec<f64>, error: &[f64]) {
        let mut change: Vec<f64> = error.iter().zip(before).map(|(now, old)| now - old).collect();
        let size = norm(&change);
        for (earlier, of_earlier) in self.changes.iter().zip(&self.steps) {
            let overlap = dot(earlier, &change);
            add_scaled(&mut change, earlier, -overlap);
            add_scaled(&mut step, of_earlier, -overlap);
        }
        let new = norm(&change);
        if new <= NEW * size {
            return;
        }
        change.iter_mut().chain(&mut step).for_each(|value| *value /= new);
        self.changes.push(change);
        self.steps.push(step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A diagonal operator whose approximate inverse is wrong by factors of 0.4 to 2.5. The plain
    /// iteration diverges; the corrections converge to rounding, whether the error is linear or
    /// has a small quadratic part. The bound is that rounding: 40 components of one, orthogonal to
    /// known changes of which the last keep a part of [`NEW`] only, have ε √40/`NEW` = 1.4e-9.
    #[test]
    fn a_wrong_inverse_converges() {
        let count = 40;
        let factor = |at: usize| 0.4 + 2.1 * at as f64 / (count - 1) as f64;
        for bent in [0.0, 0.02] {
            let (mut x, mut secants) = (vec![0.0; count], Secants::default());
            let (mut errors, mut step) = (Vec::new(), vec![0.0; count]);
            for _ in 0..30 {
                errors =
                    (0..count).map(|at| 1.0 - factor(at) * x[at] - bent * x[at] * x[at]).collect();
                let mut rest: Vec<f64> = errors.clone();
                secants.step(&mut rest, &mut step);
                add_scaled(&mut step, &rest, 1.0);
                secants.took(&step);
                add_scaled(&mut x, &step, 1.0);
            }
            println!("{bent}: {:e}", norm(&errors));
            let rounding = f64::EPSILON * (count as f64).sqrt() / NEW;
            assert!(norm(&errors) < rounding, "{bent}: {}", norm(&errors));
        }
    }
}
