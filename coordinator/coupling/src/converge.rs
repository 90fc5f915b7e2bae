//! When a window is done.
//!
//! Measured are, for every field of the coupling data, the two-norm of the residual ‖r‖ = ‖x̃ − x‖
//! against an absolute bound, against ‖x̃‖, and against the first residual of the window. Every
//! measure that a field is given has to hold, for every field, in the same iteration. A norm that
//! is no finite number never counts as converged.
//!
//! That a window will not converge is recognised by [`Progress`].

mod norms;
mod progress;

pub use norms::Norms;
pub use progress::{Progress, Why};

use crate::part::Part;
use crate::settings::{Implicit, Tolerances};

/// What a convergence measure decides after an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The window is done.
    Done,
    /// Another iteration.
    Continue,
    /// Another iteration would not help.
    NotConverged(Why),
}

/// Measures the distance between what went into an iteration and what came out.
pub trait Convergence {
    /// Forgets the last window.
    fn begin_window(&mut self);

    /// Judges iteration `iteration` (from 1) of the current window; `sent` and `returned` have the
    /// same length.
    fn judge(&mut self, iteration: u32, sent: &[f64], returned: &[f64]) -> Verdict;

    /// ‖r‖/‖x̃‖ of every field in the last iteration.
    fn residuals(&self) -> &[f64];

    /// The index of the field with the largest residual.
    fn worst(&self) -> usize;
}

/// An explicit scheme is done after one pass, whatever came out.
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

/// Iterates until every field is within its tolerances.
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
    /// The measures that the case asks for; `patience` is the number of iterations without a
    /// better residual after which there is no hope.
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
            return Verdict::NotConverged(Why::Diverged);
        }
        let hopeless = self.progress.hopeless(iteration, &self.norms);
        let fields = self.norms.iter().zip(&self.tolerances).zip(&self.first);
        let met = fields.into_iter().all(|((norms, bounds), first)| norms.meet(bounds, *first));
        match hopeless {
            _ if met && iteration >= self.min_iterations => Verdict::Done,
            _ if met => Verdict::Continue,
            Some(why) => Verdict::NotConverged(why),
            None if iteration >= self.max_iterations => Verdict::NotConverged(Why::OutOfIterations),
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

#[cfg(test)]
mod tests;
