//! Convergence, divergence and stagnation of a window.
//!
//! For every field of the coupling data, the two-norm of the residual ‖r‖ = ‖x̃ − x‖ is compared
//! with an absolute bound, with ‖x̃‖, and with the first residual of the window. All bounds that
//! are set must hold, for every field, in the same iteration. A norm that is not finite never
//! counts as converged.
//!
//! [`Progress`] detects divergence and stagnation early. The distance from the fixed point is
//! d_k = max over the fields of ‖r_k‖/s. The scale s is the larger of ‖x̃‖ and ‖r‖ in the window's
//! first iteration where either is not zero, so it does not grow with the iterates. The patience of
//! an accelerator is the number of iterations that it needs to learn the problem. A window
//!
//! - *diverges* when d_k exceeds 10⁶ times its first value (10⁶ · 10⁻⁶ if the first value was below
//!   10⁻⁶);
//! - *diverges* when d has not improved for as many iterations as the patience, and either is no
//!   nearer than at the start, d_k > d₁/2, or leaves a residual ‖r‖ above ‖x̃‖/100 in a field;
//! - *stagnates* when d has not improved for that long but is nearer than at the start: the
//!   precision of the participants limits the residual.
//!
//! Residuals of quasi-Newton methods may rise until the method knows the problem. Such a rise is
//! neither divergence nor stagnation: an accelerator with m secant columns has a patience of 2m.

use crate::settings::{Implicit, Tolerances};
use crate::vector::{BLOCK, Part, dot};

/// Growth of the distance from which no iteration recovers.
const GROWTH: f64 = 1e6;
/// Lower bound of the first distance used to judge growth.
const LEAST_FIRST: f64 = 1e-6;
/// Relative residual above which limited precision cannot be the cause.
const SWING: f64 = 0.01;
/// A residual counts as better below this fraction of the best one. Without the margin, iterations
/// that approach a cycle would improve a little for ever.
const BETTER: f64 = 0.999;
/// Fraction of the first distance below which a window has made progress.
const NEARER: f64 = 0.5;

/// Reason why a window does not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NonConvergence {
    /// The residual grows, or is not finite.
    Diverged,
    /// The residual has decreased and then stopped decreasing.
    Stagnated,
    /// The largest number of iterations is reached.
    OutOfIterations,
}

impl NonConvergence {
    /// Returns the subject and verb of a message.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Diverged => "the coupling diverged",
            Self::Stagnated => "the coupling stagnated",
            Self::OutOfIterations => "the coupling has not converged",
        }
    }
}

/// Decision of a convergence measure after an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The window is done.
    Done,
    /// Another iteration is needed.
    Continue,
    /// Further iterations would not help.
    NotConverged(NonConvergence),
}

/// Measures the distance between the vectors sent into an iteration and returned by it.
pub trait Convergence {
    /// Resets the state of the last window.
    fn begin_window(&mut self);

    /// Judges iteration `iteration` (from 1) of the current window. `sent` and `returned` have the
    /// same length.
    fn judge(&mut self, iteration: u32, sent: &[f64], returned: &[f64]) -> Verdict;

    /// Returns ‖r‖/‖x̃‖ of every field in the last iteration.
    fn residuals(&self) -> &[f64];

    /// Returns the index of the field with the largest residual.
    fn worst(&self) -> usize;
}

/// Measure of an explicit scheme: a window is done after one pass.
#[derive(Clone, Copy, Debug, Default)]
pub struct OnePass;

impl Convergence for OnePass {
    fn begin_window(&mut self) {}

    fn judge(&mut self, _iteration: u32, _sent: &[f64], _returned: &[f64]) -> Verdict {
        Verdict::Done
    }

    fn residuals(&self) -> &[f64] {
        &[]
    }

    fn worst(&self) -> usize {
        0
    }
}

/// Measure of an implicit scheme: a window is done when every field is within its tolerances.
#[derive(Clone, Debug)]
pub struct Within {
    parts: Vec<Part>,
    tolerances: Vec<Tolerances>,
    min_iterations: u32,
    max_iterations: u32,
    first: Vec<f64>,
    norms: Vec<Norms>,
    relative: Vec<f64>,
    progress: Progress,
}

impl Within {
    /// Creates the measure from the settings of a case. `patience` is the number of iterations
    /// without a better residual after which the window is given up.
    #[must_use]
    pub fn new(settings: &Implicit, parts: &[Part], patience: u32) -> Self {
        Self {
            parts: parts.to_vec(),
            tolerances: parts.iter().map(|part| settings.tolerances_of(&part.name)).collect(),
            min_iterations: settings.min_iterations,
            max_iterations: settings.max_iterations,
            first: vec![0.0; parts.len()],
            norms: vec![Norms::default(); parts.len()],
            relative: vec![0.0; parts.len()],
            progress: Progress::new(parts.len(), patience),
        }
    }

    fn measure(&mut self, iteration: u32, sent: &[f64], returned: &[f64]) {
        for (index, part) in self.parts.iter().enumerate() {
            let norms = Norms::of(&sent[part.range.clone()], &returned[part.range.clone()]);
            if iteration == 1 {
                self.first[index] = norms.residual;
            }
            self.norms[index] = norms;
            self.relative[index] = norms.relative();
        }
    }
}

impl Convergence for Within {
    fn begin_window(&mut self) {
        self.progress.begin_window();
    }

    fn judge(&mut self, iteration: u32, sent: &[f64], returned: &[f64]) -> Verdict {
        self.measure(iteration, sent, returned);
        if !self.norms.iter().all(Norms::are_finite) {
            return Verdict::NotConverged(NonConvergence::Diverged);
        }
        let diagnose = self.progress.diagnose(iteration, &self.norms);
        let fields = self.norms.iter().zip(&self.tolerances).zip(&self.first);
        let met = fields.into_iter().all(|((norms, bounds), first)| norms.meet(bounds, *first));
        match diagnose {
            _ if met && iteration >= self.min_iterations => Verdict::Done,
            _ if met => Verdict::Continue,
            Some(why) => Verdict::NotConverged(why),
            None if iteration >= self.max_iterations => {
                Verdict::NotConverged(NonConvergence::OutOfIterations)
            }
            None => Verdict::Continue,
        }
    }

    fn residuals(&self) -> &[f64] {
        &self.relative
    }

    fn worst(&self) -> usize {
        let not_finite = self.norms.iter().position(|norms| !norms.are_finite());
        let largest = || {
            let of = |index: &usize| self.relative[*index];
            (0..self.relative.len()).max_by(|a, b| of(a).total_cmp(&of(b)))
        };
        not_finite.or_else(largest).unwrap_or(0)
    }
}

/// Two-norms of one field in one iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Norms {
    /// ‖r‖.
    pub residual: f64,
    /// ‖x̃‖.
    pub returned: f64,
}

impl Norms {
    pub(super) fn of(sent: &[f64], returned: &[f64]) -> Self {
        let (mut residual, mut value) = (0.0, 0.0);
        let mut difference = [0.0; BLOCK];
        for (sent, returned) in sent.chunks(BLOCK).zip(returned.chunks(BLOCK)) {
            let difference = &mut difference[..sent.len()];
            for (difference, (sent, returned)) in
                difference.iter_mut().zip(sent.iter().zip(returned))
            {
                *difference = returned - sent;
            }
            residual += dot(difference, difference);
            value += dot(returned, returned);
        }
        Self { residual: residual.sqrt(), returned: value.sqrt() }
    }

    pub(super) fn are_finite(&self) -> bool {
        self.residual.is_finite() && self.returned.is_finite()
    }

    /// Returns ‖r‖/‖x̃‖, or 0 if the residual is 0.
    #[must_use]
    pub fn relative(&self) -> f64 {
        if self.residual == 0.0 { 0.0 } else { self.residual / self.returned }
    }

    pub(super) fn meet(&self, tolerances: &Tolerances, first: f64) -> bool {
        let within = |bound: Option<f64>, scale: f64| {
            bound.is_none_or(|bound| self.residual <= bound * scale)
        };
        self.are_finite()
            && within(tolerances.absolute, 1.0)
            && within(tolerances.relative, self.returned)
            && within(tolerances.residual_relative, first)
    }
}

/// Watches the residuals of a window for divergence and stagnation.
#[derive(Clone, Debug)]
pub struct Progress {
    patience: u32,
    scales: Vec<f64>,
    first: f64,
    best: f64,
    best_at: u32,
}

impl Progress {
    /// Creates a watch of `fields` fields with this patience.
    #[must_use]
    pub fn new(fields: usize, patience: u32) -> Self {
        Self { patience, scales: vec![0.0; fields], first: 0.0, best: 0.0, best_at: 0 }
    }

    /// Resets the state of the last window.
    pub fn begin_window(&mut self) {
        self.scales.fill(0.0);
        (self.first, self.best, self.best_at) = (0.0, f64::INFINITY, 0);
    }

    /// Returns why the window will not converge, if the iterations so far show it.
    pub fn diagnose(&mut self, iteration: u32, norms: &[Norms]) -> Option<NonConvergence> {
        let distance = self.distance(norms);
        if iteration == 1 {
            self.first = distance;
        }
        if distance < BETTER * self.best {
            (self.best, self.best_at) = (distance, iteration);
        }
        if distance > GROWTH * self.first.max(LEAST_FIRST) {
            return Some(NonConvergence::Diverged);
        }
        if iteration - self.best_at < self.patience {
            return None;
        }
        let swings = norms.iter().any(|norms| norms.residual > SWING * norms.returned);
        let diverged = swings || distance > NEARER * self.first;
        Some(if diverged { NonConvergence::Diverged } else { NonConvergence::Stagnated })
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
    use crate::accelerate::tests::settings;
    use crate::settings::Acceleration;
    use crate::vector::parts;

    /// Returns the verdict on the second iteration of a window with two fields of two values and
    /// ‖x̃‖ = 10. The norm of both first residuals is 1; the second ones are `residuals`.
    fn second(change: impl Fn(&mut Implicit), residuals: [f64; 2]) -> Verdict {
        let mut settings = settings(Acceleration::None);
        settings.tolerances = Tolerances::default();
        change(&mut settings);
        let mut within = Within::new(&settings, &parts([("u", 2), ("v", 2)]), 100);
        let returned = [6.0, 8.0, 6.0, 8.0];
        within.begin_window();
        within.judge(1, &[7.0, 8.0, 6.0, 9.0], &returned);
        let [u, v] = residuals;
        within.judge(2, &[6.0 - u, 8.0, 6.0 - 0.6 * v, 8.0 - 0.8 * v], &returned)
    }

    #[test]
    fn each_measure_bounds_what_it_says() {
        let absolute = |bound| move |s: &mut Implicit| s.tolerances.absolute = Some(bound);
        assert_eq!(second(absolute(1e-3), [0.9e-3, 0.9e-3]), Verdict::Done);
        assert_eq!(second(absolute(1e-3), [0.9e-3, 1.1e-3]), Verdict::Continue);
        let relative = |bound| move |s: &mut Implicit| s.tolerances.relative = Some(bound);
        assert_eq!(second(relative(1e-3), [9e-3, 9e-3]), Verdict::Done);
        assert_eq!(second(relative(1e-3), [11e-3, 0.0]), Verdict::Continue);
        let to_first = |bound| move |s: &mut Implicit| s.tolerances.residual_relative = Some(bound);
        assert_eq!(second(to_first(0.1), [0.09, 0.09]), Verdict::Done);
        assert_eq!(second(to_first(0.1), [0.0, 0.11]), Verdict::Continue);
    }

    #[test]
    fn all_measures_have_to_hold_and_a_field_can_have_its_own() {
        let both = |s: &mut Implicit| {
            (s.tolerances.relative, s.tolerances.absolute) = (Some(1e-2), Some(1e-3));
        };
        assert_eq!(second(both, [0.9e-3, 0.9e-3]), Verdict::Done);
        assert_eq!(second(both, [0.9e-2, 0.0]), Verdict::Continue);
        let own = |s: &mut Implicit| {
            s.tolerances.absolute = Some(1e-9);
            s.fields
                .insert("v".to_owned(), Tolerances { relative: Some(0.1), ..Default::default() });
        };
        assert_eq!(second(own, [0.0, 0.9]), Verdict::Done);
        assert_eq!(second(own, [1e-8, 0.9]), Verdict::Continue);
    }

    #[test]
    fn iterations_have_a_least_and_a_most() {
        let least = |s: &mut Implicit| s.min_iterations = 3;
        assert_eq!(second(least, [0.0, 0.0]), Verdict::Continue);
        let most = |s: &mut Implicit| {
            (s.max_iterations, s.tolerances.absolute) = (2, Some(1e-9));
        };
        assert_eq!(
            second(most, [1e-3, 0.0]),
            Verdict::NotConverged(NonConvergence::OutOfIterations)
        );
        assert_eq!(second(most, [0.0, 0.0]), Verdict::Done, "the last iteration counts");
    }

    /// Iterations required by `min_iterations` do not count as stagnation.
    #[test]
    fn a_window_within_its_tolerances_is_not_given_up() {
        let settings = Implicit { min_iterations: 300, ..settings(Acceleration::None) };
        let mut within = Within::new(&settings, &parts([("u", 1)]), 100);
        within.begin_window();
        let ends = (1..).find(|&k| within.judge(k, &[1.0], &[1.0 + 1e-9]) != Verdict::Continue);
        assert_eq!(ends, Some(300));
        assert_eq!(within.judge(301, &[1.0], &[1.0 + 1e-9]), Verdict::Done);
    }

    #[test]
    fn norms_that_are_no_numbers_are_divergence_whatever_the_bounds() {
        let loose = |s: &mut Implicit| s.tolerances.absolute = Some(f64::INFINITY);
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(
                second(loose, [0.0, bad]),
                Verdict::NotConverged(NonConvergence::Diverged),
                "{bad}"
            );
        }
    }

    #[test]
    fn a_field_that_stays_zero_has_converged() {
        let settings = settings(Acceleration::None);
        let mut within = Within::new(&settings, &parts([("u", 2)]), 100);
        within.begin_window();
        assert_eq!(within.judge(1, &[0.0; 2], &[0.0; 2]), Verdict::Done);
        assert_eq!(within.residuals(), [0.0]);
    }

    /// Norms over several blocks equal a plain sum up to rounding.
    #[test]
    fn norms_of_long_vectors() {
        let returned: Vec<f64> = (0..5000).map(|i| f64::from(i % 17) - 3.0).collect();
        let sent: Vec<f64> = (0..5000).map(|i| f64::from(i % 5)).collect();
        let plain =
            |of: &dyn Fn(usize) -> f64| (0..5000).map(of).map(|v| v * v).sum::<f64>().sqrt();
        let norms = Norms::of(&sent, &returned);
        assert_eq!(norms.returned, plain(&|i| returned[i]), "sums of whole numbers are exact");
        assert_eq!(norms.residual, plain(&|i| returned[i] - sent[i]));
    }

    /// Returns the verdict and its iteration, for these residuals of one field of norm 1.
    fn ends(patience: u32, residual: impl Fn(u32) -> f64) -> Option<(u32, NonConvergence)> {
        let mut progress = Progress::new(1, patience);
        progress.begin_window();
        (1..=1000).find_map(|k| {
            let norms = Norms { residual: residual(k), returned: 1.0 };
            progress.diagnose(k, &[norms]).map(|why| (k, why))
        })
    }

    #[test]
    fn growth_is_divergence_long_before_numbers_overflow() {
        let doubling = |k: u32| 0.25 * 2.0_f64.powi(k as i32 - 1);
        assert_eq!(ends(100, doubling), Some((21, NonConvergence::Diverged)), "2^20 > 1e6");
        let tiny = |k: u32| 1e-12 * 10.0_f64.powi(k as i32 - 1);
        assert_eq!(ends(100, tiny), Some((14, NonConvergence::Diverged)), "10 > 1e6 · 1e-6");
    }

    #[test]
    fn slow_growth_and_standing_still_where_it_began_are_divergence() {
        let slow = |k: u32| 1.001_f64.powi(k as i32);
        assert_eq!(ends(100, slow), Some((101, NonConvergence::Diverged)));
        assert_eq!(ends(100, |_| 0.3), Some((101, NonConvergence::Diverged)));
    }

    #[test]
    fn a_cycle_is_divergence() {
        let cycle =
            |k: u32| if k.is_multiple_of(2) { 1.0 } else { 0.7 + 0.1 * 0.99_f64.powi(k as i32) };
        let (iteration, why) = ends(100, cycle).unwrap();
        assert!(why == NonConvergence::Diverged && iteration < 800, "{iteration}");
    }

    #[test]
    fn standing_still_nearer_is_stagnation() {
        let floor = |k: u32| 0.5_f64.powi(k as i32).max(1e-3);
        assert_eq!(ends(50, floor), Some((60, NonConvergence::Stagnated)), "the tenth is the best");
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
                assert_eq!(progress.diagnose(k, &[norms, Norms::default()]), None);
            }
        }
    }
}
