//! Divergence and stagnation, recognised while there is still something to save.
//!
//! The distance from the fixed point is watched as d_k = max over the fields of ‖r_k‖/s, where s is
//! the larger of ‖x̃‖ and ‖r‖ in the window's first iteration that has either: a scale that does
//! not grow with the iterates. A window
//!
//! - *diverges* when d_k exceeds 10⁶ times its first value (or times the part 10⁻⁶ of the field,
//!   where the first was below that), or when it has found no better d for as many iterations as
//!   its accelerator needs to learn the problem (its patience) and is where it began, d_k > d₁/2, or
//!   swings by more than a hundredth of the field;
//! - *stagnates* when it has found no better d for that long, but is nearer than at its beginning: the
//!   precision of the participants is what is left.
//!
//! Residuals that rise for a while, as those of quasi-Newton methods do until they know the
//! problem, are neither: an accelerator with m secant columns has a patience of 2m.

use super::norms::Norms;

/// Growth of the distance that is never made good.
const GROWTH: f64 = 1e6;
/// A first distance below this says nothing about growth.
const LEAST_FIRST: f64 = 1e-6;
/// A residual above this part of what comes back is no question of precision.
const SWING: f64 = 0.01;
/// A residual is better than another when it is below this part of it: iterations that run into a
/// cycle come a little nearer to its least residual for ever.
const BETTER: f64 = 0.999;
/// Nearer than this part of the first distance is progress.
const NEARER: f64 = 0.5;

/// Why a window does not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// The residual grows, or is no finite number.
    Diverged,
    /// The residual has become smaller, and then no more.
    Stagnated,
    /// It goes on, but the iterations are used up.
    OutOfIterations,
}

impl Why {
    /// As the subject and verb of a message.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Diverged => "the coupling diverged",
            Self::Stagnated => "the coupling stagnated",
            Self::OutOfIterations => "the coupling has not converged",
        }
    }
}

/// Watches the residuals of a window.
#[derive(Clone, Debug)]
pub struct Progress {
    patience: u32,
    scales: Vec<f64>,
    first: f64,
    best: f64,
    best_at: u32,
}

impl Progress {
    /// Watches `fields` fields, with patience for this many iterations without a better residual.
    #[must_use]
    pub fn new(fields: usize, patience: u32) -> Self {
        Self { patience, scales: vec![0.0; fields], first: 0.0, best: 0.0, best_at: 0 }
    }

    /// Forgets the last window.
    pub fn begin_window(&mut self) {
        self.scales.fill(0.0);
        (self.first, self.best, self.best_at) = (0.0, f64::INFINITY, 0);
    }

    /// Why the window will not converge, if its iterations so far show it.
    pub fn hopeless(&mut self, iteration: u32, norms: &[Norms]) -> Option<Why> {
        let distance = self.distance(norms);
        if iteration == 1 {
            self.first = distance;
        }
        if distance < BETTER * self.best {
            (self.best, self.best_at) = (distance, iteration);
        }
        if distance > GROWTH * self.first.max(LEAST_FIRST) {
            return Some(Why::Diverged);
        }
        if iteration - self.best_at < self.patience {
            return None;
        }
        let swings = norms.iter().any(|norms| norms.residual > SWING * norms.returned);
        let diverged = swings || distance > NEARER * self.first;
        Some(if diverged { Why::Diverged } else { Why::Stagnated })
    }

    fn distance(&mut self, norms: &[Norms]) -> f64 {
        let mut distance = 0.0_f64;
        for (scale, norms) in self.scales.iter_mut().zip(norms) {
            if *scale == 0.0 {
                *scale = norms.returned.max(norms.residual);
            }
            if norms.residual > 0.0 {
                distance = distance.max(norms.residual / *scale);
            }
        }
        distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The verdict, and when it falls, on residuals of one field of norm 1.
    fn ends(patience: u32, residual: impl Fn(u32) -> f64) -> Option<(u32, Why)> {
        let mut progress = Progress::new(1, patience);
        progress.begin_window();
        (1..=1000).find_map(|k| {
            let norms = Norms { residual: residual(k), returned: 1.0 };
            progress.hopeless(k, &[norms]).map(|why| (k, why))
        })
    }

    #[test]
    fn growth_is_divergence_long_before_numbers_overflow() {
        let doubling = |k: u32| 0.25 * 2.0_f64.powi(k as i32 - 1);
        assert_eq!(ends(100, doubling), Some((21, Why::Diverged)), "2^20 > 1e6");
        let tiny = |k: u32| 1e-12 * 10.0_f64.powi(k as i32 - 1);
        assert_eq!(ends(100, tiny), Some((14, Why::Diverged)), "10 > 1e6 · 1e-6");
    }

    #[test]
    fn slow_growth_and_standing_still_where_it_began_are_divergence() {
        let slow = |k: u32| 1.001_f64.powi(k as i32);
        assert_eq!(ends(100, slow), Some((101, Why::Diverged)));
        assert_eq!(ends(100, |_| 0.3), Some((101, Why::Diverged)));
    }

    #[test]
    fn a_cycle_is_divergence() {
        let cycle =
            |k: u32| if k.is_multiple_of(2) { 1.0 } else { 0.7 + 0.1 * 0.99_f64.powi(k as i32) };
        let (iteration, why) = ends(100, cycle).unwrap();
        assert!(why == Why::Diverged && iteration < 800, "{iteration}");
    }

    #[test]
    fn standing_still_nearer_is_stagnation() {
        let floor = |k: u32| 0.5_f64.powi(k as i32).max(1e-3);
        assert_eq!(ends(50, floor), Some((60, Why::Stagnated)), "the tenth is the best");
    }

    #[test]
    fn rising_for_a_while_or_falling_slowly_is_neither() {
        let hump = |k: u32| if k < 90 { 1e3 } else { 0.9_f64.powi(k as i32) };
        assert_eq!(ends(100, |k| if k == 1 { 1.0 } else { hump(k) }), None);
        assert_eq!(ends(100, |k| 0.9999_f64.powi(k as i32)), None);
    }

    #[test]
    fn each_window_is_watched_by_itself() {
        let mut progress = Progress::new(2, 3);
        for _ in 0..5 {
            progress.begin_window();
            for k in 1..=3 {
                let norms = Norms { residual: 0.1, returned: 1.0 };
                assert_eq!(progress.hopeless(k, &[norms, Norms::default()]), None);
            }
        }
    }
}
