//! Fixed-point search for the creepages if friction depends on them.
//!
//! The friction at assumed creepages gives other creepages for a prescribed force. The fixed point
//! is found by Aitken's relaxation in the vector form of Irons and Tuck (Int. J. Numer. Meth. Engng
//! 1 (1969) 275–277), which is the secant method for one component.

use proto::model::StepError;
use proto::readable::number;

/// Relative change of the creepages at convergence.
const SETTLED: f64 = 1e-8;
/// Maximum number of iterations.
const MOST: usize = 60;
/// Largest relaxation factor.
const LARGEST: f64 = 1e3;

/// Search for creepages that reproduce themselves.
#[derive(Clone, Copy, Debug)]
pub(super) struct CreepageSearch {
    /// Length by which the spin is multiplied [m].
    length: f64,
    at: [f64; 3],
    residual: Option<[f64; 3]>,
    factor: f64,
    tried: usize,
}

impl CreepageSearch {
    /// Starts at these creepages, in a contact of this size [m].
    pub(super) fn new(at: [f64; 3], length: f64) -> Self {
        Self { length, at, residual: None, factor: 1.0, tried: 0 }
    }

    /// Current iterate of the creepages.
    pub(super) fn at(&self) -> [f64; 3] {
        self.at
    }

    /// Takes the creepages that follow from the current iterate. Returns whether they have
    /// converged.
    ///
    /// # Errors
    /// Creepages that do not converge.
    pub(super) fn take(&mut self, found: [f64; 3]) -> Result<bool, StepError> {
        let weights = [1.0, 1.0, self.length];
        let weighted = |of: &dyn Fn(usize) -> f64| std::array::from_fn(|k| weights[k] * of(k));
        let residual: [f64; 3] = weighted(&|k| found[k] - self.at[k]);
        let size: [f64; 3] = weighted(&|k| found[k]);
        let change = dot(residual, residual);
        if change.is_finite() && change <= SETTLED * SETTLED * dot(size, size) {
            return Ok(true);
        }
        self.tried += 1;
        if self.tried == MOST || !change.is_finite() {
            return Err(StepError::NoSolution(format!(
                "friction falls with slip, and no creepage was found for the force: {} were tried, the last along x {}, which led to \
                 {}; prescribe less force, or motion.creepage",
                self.tried,
                number(self.at[0], 5),
                number(found[0], 5)
            )));
        }
        if let Some(before) = self.residual.replace(residual) {
            let change: [f64; 3] = std::array::from_fn(|k| residual[k] - before[k]);
            let square = dot(change, change);
            let factor =
                if square > 0.0 { -self.factor * dot(before, change) / square } else { 1.0 };
            self.factor = if factor > 0.0 { factor.min(LARGEST) } else { 1.0 };
        }
        for (at, found) in self.at.iter_mut().zip(found) {
            *at += self.factor * (found - *at);
        }
        Ok(false)
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = a + g x with a gain near one, for which a plain iteration needs thousands of steps; and
    /// x = −1 − x², which has no solution.
    #[test]
    fn a_gain_near_one_and_no_solution() {
        let mut search = CreepageSearch::new([0.0; 3], 1e-3);
        while !search.take([1e-3 + 0.99 * search.at()[0], 0.0, 0.0]).unwrap() {}
        assert!((search.at()[0] / 0.1 - 1.0).abs() < 1e-6, "{search:?}");
        assert!(search.tried < 5);
        let mut search = CreepageSearch::new([0.0; 3], 1e-3);
        let ended = loop {
            match search.take([-1.0 - search.at()[0].powi(2), 0.0, 0.0]) {
                Ok(false) => {}
                ended => break ended,
            }
        };
        assert!(ended.unwrap_err().to_string().contains("no creepage"));
    }
}
