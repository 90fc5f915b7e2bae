//! The coupling of one run: which participants solve when, what the coupling data are, and when a
//! window is done. Independent axes, each behind a trait:
//!
//! - a [`scheme::Scheme`] orders the participants within one iteration,
//! - an [`accelerate::Accelerator`] chooses the next iterate of the coupling data,
//! - a [`converge::Convergence`] decides whether the window is done,
//! - a [`predict::Predictor`] gives the first iterate of a window.
//!
//! The iteration of a window is x ↦ x̃ = H(x): x is what was sent into a pass through the
//! participants, x̃ what they returned, r = x̃ − x the residual. The schemes know only [`Exchange`],
//! not the session behind it; accelerators, measures and predictors see slices only.

pub mod accelerate;
pub mod converge;
mod part;
pub mod predict;
pub mod scheme;
pub mod state;

pub use part::{Part, parts};

use crate::case::Implicit;
use crate::error::{NotConverged, RunError};
use accelerate::{Accelerator, StepTaken};
use converge::{Convergence, Verdict};
use predict::Predictor;
use proto::model::Step;
use scheme::Scheme;
use state::{Reader, StateMismatch};

/// What a scheme can do with the participants.
pub trait Exchange {
    /// Number of participants, in the order in which data flows.
    fn participants(&self) -> usize;

    /// Lets some participants solve at the same time, with the newest samples of their inputs as
    /// they are when the call begins.
    fn solve(&mut self, participants: &[usize], step: &Step) -> Result<(), RunError>;

    /// The coupling data: fields, as parts of one vector; none for an explicit scheme.
    fn fed_back(&self) -> &[Part];

    /// Sends an iterate of the coupling data to the participants which consume it.
    fn send(&mut self, iterate: &[f64], step: &Step) -> Result<(), RunError>;

    /// Copies what the participants have returned last into `returned`.
    fn returned(&self, returned: &mut [f64]);
}

/// What came out of one window.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowOutcome {
    /// Iterations made.
    pub iterations: u32,
    /// Largest relative residual of the last one; `None` if there are no coupling data.
    pub residual: Option<f64>,
    /// Why the window is not converged, if it is not.
    pub not_converged: Option<NotConverged>,
}

/// Scheme, accelerator, convergence measure and predictor of a run, and the vectors between them.
pub struct Coupling {
    scheme: Box<dyn Scheme>,
    accelerator: Box<dyn Accelerator>,
    convergence: Box<dyn Convergence>,
    predictor: Predictor,
    parts: Vec<Part>,
    sent: Vec<f64>,
    returned: Vec<f64>,
    step: Step,
    taken: StepTaken,
}

impl Coupling {
    /// One pass a window, one participant after the other, nothing iterated within the window.
    #[must_use]
    pub fn explicit() -> Self {
        Self::one_pass(Box::new(scheme::Serial))
    }

    /// One pass a window, all participants at once, each with what was there before.
    #[must_use]
    pub fn explicit_parallel() -> Self {
        Self::one_pass(Box::new(scheme::Parallel::default()))
    }

    fn one_pass(scheme: Box<dyn Scheme>) -> Self {
        Self {
            scheme,
            accelerator: Box::new(accelerate::Unaccelerated),
            convergence: Box::new(converge::OnePass),
            predictor: Predictor::new(crate::case::Predictor::Last, &[]),
            parts: Vec::new(),
            sent: Vec::new(),
            returned: Vec::new(),
            step: Step::STEADY,
            taken: StepTaken::default(),
        }
    }

    /// Windows that are iterated until the coupling data of `exchange` have converged; the
    /// first iterate of the first window is what the participants gave before any solve.
    #[must_use]
    pub fn implicit(settings: &Implicit, parallel: bool, exchange: &dyn Exchange) -> Self {
        let parts = exchange.fed_back().to_vec();
        let length = parts.last().map_or(0, |part| part.range.end);
        let mut returned = vec![0.0; length];
        exchange.returned(&mut returned);
        let scheme: Box<dyn Scheme> = match parallel {
            true => Box::new(scheme::Parallel::default()),
            false => Box::new(scheme::Serial),
        };
        let accelerator = accelerate::build(settings, &parts);
        let patience = accelerator.patience();
        Self {
            scheme,
            accelerator,
            convergence: Box::new(converge::Within::new(settings, &parts, patience)),
            predictor: Predictor::new(settings.predictor, &returned),
            parts,
            sent: vec![0.0; length],
            returned,
            step: Step::STEADY,
            taken: StepTaken::default(),
        }
    }

    /// Begins a window, or begins it again with another length. What an attempt that was not
    /// accepted has taught is forgotten.
    pub fn begin_window(&mut self, window: &Step) {
        self.step = Step { iteration: 0, ..*window };
        self.taken = StepTaken::default();
        self.accelerator.begin_window();
        self.convergence.begin_window();
        self.predictor.predict(window.duration(), &mut self.sent);
    }

    /// One iteration: a pass through the participants, the verdict, and, unless the window is
    /// done, the next iterate.
    pub fn iterate(&mut self, exchange: &mut dyn Exchange) -> Result<Verdict, RunError> {
        self.step.iteration += 1;
        if !self.parts.is_empty() {
            exchange.send(&self.sent, &self.step)?;
        }
        self.scheme.pass(exchange, &self.step)?;
        exchange.returned(&mut self.returned);
        let verdict = self.convergence.judge(self.step.iteration, &self.sent, &self.returned);
        self.taken = StepTaken::default();
        if verdict == Verdict::Continue {
            self.taken = self.accelerator.next(&mut self.sent, &self.returned);
        }
        Ok(verdict)
    }

    /// The window is done: its last iteration holds.
    pub fn accept_window(&mut self) {
        self.accelerator.accept_window(&self.sent, &self.returned);
        self.predictor.accept_window(self.step.duration(), &self.returned);
    }

    /// Iterates one window until it is done, and accepts it.
    pub fn solve_window(
        &mut self,
        exchange: &mut dyn Exchange,
        window: &Step,
    ) -> Result<WindowOutcome, RunError> {
        self.begin_window(window);
        let verdict = loop {
            match self.iterate(exchange)? {
                Verdict::Continue => {}
                verdict => break verdict,
            }
        };
        self.accept_window();
        Ok(self.outcome(verdict))
    }

    /// What came out of the window with this verdict.
    #[must_use]
    pub fn outcome(&self, verdict: Verdict) -> WindowOutcome {
        let not_converged = match verdict {
            Verdict::NotConverged(why) => Some(NotConverged {
                why,
                window: self.step.window,
                iteration: self.step.iteration,
                field: self.parts[self.convergence.worst()].name.clone(),
                residual: self.residual().unwrap_or(f64::NAN),
                acceleration: self.accelerator.name(),
            }),
            Verdict::Continue | Verdict::Done => None,
        };
        let (iterations, residual) = (self.step.iteration, self.residual());
        WindowOutcome { iterations, residual, not_converged }
    }

    /// The step of the last iteration.
    #[must_use]
    pub fn step(&self) -> &Step {
        &self.step
    }

    /// What was sent into the last iteration, once the window is done.
    #[must_use]
    pub fn sent(&self) -> &[f64] {
        &self.sent
    }

    /// The fields of the coupling data.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// ‖r‖/‖x̃‖ of every field of the coupling data, in the last iteration.
    #[must_use]
    pub fn residuals(&self) -> &[f64] {
        self.convergence.residuals()
    }

    /// The largest of the residuals; `None` if there are no coupling data.
    #[must_use]
    pub fn residual(&self) -> Option<f64> {
        // `f64::max` would lose a NaN.
        self.residuals().iter().copied().reduce(|a, b| if a >= b || a.is_nan() { a } else { b })
    }

    /// How the next iterate was chosen, after the last iteration.
    #[must_use]
    pub fn taken(&self) -> &StepTaken {
        &self.taken
    }

    /// Writes everything that the next window depends on, to be read by [`Coupling::restore`] of a
    /// coupling of the same case.
    pub fn save(&self, into: &mut Vec<u8>) {
        self.predictor.save(into);
        self.accelerator.save(into);
    }

    /// Returns to a saved state, between two windows; the run continues from it bit-identically.
    ///
    /// # Errors
    /// The state is that of another case.
    pub fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), StateMismatch> {
        self.predictor.restore(from)?;
        self.accelerator.restore(from)
    }
}

#[cfg(test)]
mod tests;
