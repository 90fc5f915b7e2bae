//! The iteration of a window: x ↦ x̃ = H(x), where x is what was sent into a pass through the
//! participants, x̃ what they returned, and r = x̃ − x the residual.

use crate::accelerate::{self, Accelerator, StepTaken};
use crate::converge::{Convergence, OnePass, Verdict, Why, Within};
use crate::exchange::Exchange;
use crate::gain::LoopGain;
use crate::order::Order;
use crate::part::Part;
use crate::predict::Predictor;
use crate::settings::{self, Implicit};
use crate::state::{Reader, StateMismatch};
use contract::step::Step;

/// Which window did not converge, and how.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{} in window {window}, iteration {iteration}: the relative residual of `{field}` is \
     {residual:.3e}",
    why.words()
)]
pub struct NotConverged {
    /// Divergence, stagnation, or too few iterations.
    pub why: Why,
    /// Number of the window, from 0.
    pub window: u64,
    /// The last iteration.
    pub iteration: u32,
    /// The field that is farthest from its end.
    pub field: String,
    /// Its residual over its values, in two-norms \[-\].
    pub residual: f64,
    /// Change of the case that the accelerator advises.
    pub advice: &'static str,
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
    order: Order,
    accelerator: Box<dyn Accelerator>,
    convergence: Box<dyn Convergence>,
    predictor: Predictor,
    parts: Vec<Part>,
    sent: Vec<f64>,
    returned: Vec<f64>,
    step: Step,
    taken: StepTaken,
    gain: Option<LoopGain>,
}

impl Coupling {
    /// One pass a window, one participant after the other, nothing iterated within the window.
    #[must_use]
    pub fn explicit() -> Self {
        Self::one_pass(Order::Serial)
    }

    /// One pass a window, all participants at once, each with what was there before.
    #[must_use]
    pub fn explicit_parallel() -> Self {
        Self::one_pass(Order::Parallel(Vec::new()))
    }

    fn one_pass(order: Order) -> Self {
        Self {
            order,
            accelerator: Box::new(accelerate::Unaccelerated),
            convergence: Box::new(OnePass),
            predictor: Predictor::new(settings::Predictor::Last, &[]),
            parts: Vec::new(),
            sent: Vec::new(),
            returned: Vec::new(),
            step: Step::STEADY,
            taken: StepTaken::default(),
            gain: None,
        }
    }

    /// Windows that are iterated until the coupling data of `exchange` have converged; the
    /// first iterate of the first window is what the participants gave before any solve.
    #[must_use]
    pub fn implicit<E: Exchange>(settings: &Implicit, parallel: bool, exchange: &E) -> Self {
        let parts = exchange.coupling_data().to_vec();
        let length = parts.last().map_or(0, |part| part.range.end);
        let mut returned = vec![0.0; length];
        exchange.returned(&mut returned);
        let accelerator = accelerate::build(settings, &parts);
        let patience = accelerator.patience();
        Self {
            order: Order::of(parallel),
            accelerator,
            convergence: Box::new(Within::new(settings, &parts, patience)),
            predictor: Predictor::new(settings.predictor, &returned),
            parts,
            sent: vec![0.0; length],
            returned,
            step: Step::STEADY,
            taken: StepTaken::default(),
            gain: None,
        }
    }

    /// Finds the gain of the loop from now on, for which it keeps what the iterations of a window have changed.
    #[must_use]
    pub fn with_gain(self) -> Self {
        Self { gain: Some(LoopGain::default()), ..self }
    }

    /// The gain of the loop in the last window: the eigenvalue with the largest real part of what a pass makes of a change of the
    /// coupling data \[-\]. `None` if it is not looked for, or no two iterations differ.
    #[must_use]
    pub fn gain(&self) -> Option<f64> {
        self.gain.as_ref().and_then(LoopGain::value)
    }

    /// Begins a window, or begins it again with another length. What an attempt that was not
    /// accepted has taught is forgotten.
    pub fn begin_window(&mut self, window: &Step) {
        self.step = Step { iteration: 0, ..*window };
        self.taken = StepTaken::default();
        self.gain.iter_mut().for_each(LoopGain::begin_window);
        self.accelerator.begin_window();
        self.convergence.begin_window();
        self.predictor.predict(window.duration(), &mut self.sent);
    }

    /// One iteration: a pass through the participants, the verdict, and, unless the window is
    /// done, the next iterate.
    ///
    /// # Errors
    /// What [`Exchange::solve`] and [`Exchange::send`] report.
    pub fn iterate<E: Exchange>(&mut self, exchange: &mut E) -> Result<Verdict, E::Error> {
        self.step.iteration += 1;
        if !self.parts.is_empty() {
            exchange.send(&self.sent, &self.step)?;
        }
        self.order.pass(exchange, &self.step)?;
        exchange.returned(&mut self.returned);
        if let Some(gain) = &mut self.gain {
            gain.learn(&self.sent, &self.returned);
        }
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
    ///
    /// # Errors
    /// As [`Coupling::iterate`].
    pub fn solve_window<E: Exchange>(
        &mut self,
        exchange: &mut E,
        window: &Step,
    ) -> Result<WindowOutcome, E::Error> {
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
                advice: self.accelerator.advice(),
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
    pub fn save(&mut self, into: &mut Vec<u8>) {
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
