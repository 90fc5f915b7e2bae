//! The iteration of a window: x ↦ x̃ = H(x). The vector x is sent into a pass through the
//! participants, x̃ is returned, and r = x̃ − x is the residual.
//!
//! A serial scheme iterates the fields that go back to an earlier participant. Fields that go
//! forward depend on them; they are tested if the case gives them tolerances of their own. Their
//! residual is the change since the last iteration, or since the last window in the first one.

use crate::accelerate::{self, AccelerationStats, Accelerator};
use crate::converge::{Convergence, NonConvergence, OnePass, Verdict, Within};
use crate::exchange::{Exchange, Order, ParticipantIndex};
use crate::gain::LoopGain;
use crate::predict::Predictor;
use crate::settings::{self, Implicit};
use crate::vector::{Part, StateMismatch, StateReader, parts, put_f64s};
use contract::readable::number;
use contract::step::Step;
use std::convert::Infallible;

/// A window that did not converge.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{} in window {window}, iteration {iteration}: the relative residual of `{field}` is \
     {residual}",
    why.words()
, residual = number(*.residual, 4))]
pub struct NotConverged {
    /// Divergence, stagnation, or too few iterations.
    pub why: NonConvergence,
    /// Number of the window, from 0.
    pub window: u64,
    /// The last iteration.
    pub iteration: u32,
    /// Field with the largest residual.
    pub field: String,
    /// Residual of this field over its values, in two-norms \[-\].
    pub residual: f64,
    /// Change of the case that the accelerator recommends.
    pub advice: &'static str,
}

/// Outcome of a window.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowOutcome {
    /// Number of iterations.
    pub iterations: u32,
    /// Largest relative residual of the last iteration; `None` without coupling data.
    pub residual: Option<f64>,
    /// Details of a window that did not converge.
    pub not_converged: Option<NotConverged>,
}

/// Scheme, accelerator, convergence measure and predictor of a run, with the vectors that they
/// share.
pub struct Coupling {
    order: Order,
    accelerator: Box<dyn Accelerator>,
    convergence: Box<dyn Convergence>,
    predictor: Predictor,
    /// Coupling data, then measured data.
    parts: Vec<Part>,
    /// Number of values of the coupling data.
    iterated: usize,
    /// Iterate of the coupling data, then the last values of the measured data.
    sent: Vec<f64>,
    returned: Vec<f64>,
    /// Measured data at the end of the last accepted window.
    accepted: Vec<f64>,
    step: Step,
    taken: AccelerationStats,
    gain: Option<LoopGain>,
}

impl Coupling {
    /// Creates a serial explicit coupling: one pass a window, one participant after another.
    #[must_use]
    pub fn explicit() -> Self {
        Self::one_pass(Order::Serial)
    }

    /// Creates a parallel explicit coupling: one pass a window, all participants at once, each with
    /// the values of the last window.
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
            iterated: 0,
            sent: Vec::new(),
            returned: Vec::new(),
            accepted: Vec::new(),
            step: Step::STEADY,
            taken: AccelerationStats::default(),
            gain: None,
        }
    }

    /// Creates an implicit coupling, which iterates each window until the coupling data of
    /// `exchange` have converged. The first iterate of the first window is the vector that the
    /// participants return before any solve.
    #[must_use]
    pub fn implicit<E: Exchange>(settings: &Implicit, parallel: bool, exchange: &E) -> Self {
        let length = |parts: &[Part]| parts.last().map_or(0, |part| part.range.end);
        let coupling_data = exchange.coupling_data();
        let iterated = length(coupling_data);
        let accelerator = accelerate::build(settings, coupling_data);
        let patience = accelerator.patience();
        let parts = [coupling_data, exchange.measured_data()].concat();
        let mut returned = vec![0.0; length(&parts)];
        exchange.returned(&mut returned);
        Self {
            order: Order::of(parallel),
            accelerator,
            convergence: Box::new(Within::new(settings, &parts, patience)),
            predictor: Predictor::new(settings.predictor, &returned[..iterated]),
            parts,
            iterated,
            sent: vec![0.0; returned.len()],
            accepted: returned[iterated..].to_vec(),
            returned,
            step: Step::STEADY,
            taken: AccelerationStats::default(),
            gain: None,
        }
    }

    /// Enables the estimate of the loop gain, which keeps the changes of the iterations of a
    /// window.
    #[must_use]
    pub fn with_gain(self) -> Self {
        Self { gain: Some(LoopGain::default()), ..self }
    }

    /// Returns the loop gain in the last window \[-\]: the eigenvalue with the largest real part of
    /// the pass, as a linear map of changes of the coupling data. `None` if the estimate is
    /// disabled or no two iterations differ.
    #[must_use]
    pub fn gain(&self) -> Option<f64> {
        self.gain.as_ref().and_then(LoopGain::value)
    }

    /// Begins a window, or repeats it with another length. Discards secant data learned in a
    /// rejected attempt.
    pub fn begin_window(&mut self, window: &Step) {
        self.step = Step { iteration: 0, ..*window };
        self.taken = AccelerationStats::default();
        self.gain.iter_mut().for_each(LoopGain::begin_window);
        self.accelerator.begin_window();
        self.convergence.begin_window();
        let (iterate, last) = self.sent.split_at_mut(self.iterated);
        self.predictor.predict(window.duration(), iterate);
        last.copy_from_slice(&self.accepted);
    }

    /// Makes one iteration: a pass through the participants, the verdict and, unless the window is
    /// done, the next iterate.
    ///
    /// # Errors
    /// [`Exchange::solve`] or [`Exchange::send`] fails.
    pub fn iterate<E: Exchange>(&mut self, exchange: &mut E) -> Result<Verdict, E::Error> {
        self.step.iteration += 1;
        if !self.parts.is_empty() {
            exchange.send(&self.sent[..self.iterated], &self.step)?;
        }
        self.order.pass(exchange, &self.step)?;
        exchange.returned(&mut self.returned);
        let n = self.iterated;
        if let Some(gain) = &mut self.gain {
            gain.learn(&self.sent[..n], &self.returned[..n]);
        }
        let verdict = self.convergence.judge(self.step.iteration, &self.sent, &self.returned);
        self.taken = AccelerationStats::default();
        if verdict == Verdict::Continue {
            self.taken = self.accelerator.next(&mut self.sent[..n], &self.returned[..n]);
            self.sent[n..].copy_from_slice(&self.returned[n..]);
        }
        Ok(verdict)
    }

    /// Accepts the window with its last iteration.
    pub fn accept_window(&mut self) {
        let (iterate, (returned, measured)) =
            (&self.sent[..self.iterated], self.returned.split_at(self.iterated));
        self.accelerator.accept_window(iterate, returned);
        self.predictor.accept_window(self.step.duration(), returned);
        self.accepted.copy_from_slice(measured);
    }

    /// Iterates one window until it is done, and accepts it.
    ///
    /// # Errors
    /// [`Exchange::solve`] or [`Exchange::send`] fails.
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

    /// Returns the outcome of the window with this verdict.
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

    /// Returns the coupling data sent into the last iteration, once the window is done.
    #[must_use]
    pub fn sent(&self) -> &[f64] {
        &self.sent[..self.iterated]
    }

    /// The fields with residuals: coupling data, then measured data.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns ‖r‖/‖x̃‖ of every field of [`Coupling::parts`] in the last iteration.
    #[must_use]
    pub fn residuals(&self) -> &[f64] {
        self.convergence.residuals()
    }

    /// Returns the largest of the residuals; `None` without coupling data.
    #[must_use]
    pub fn residual(&self) -> Option<f64> {
        // `f64::max` would lose a NaN.
        self.residuals().iter().copied().reduce(|a, b| if a >= b || a.is_nan() { a } else { b })
    }

    /// Describes how the next iterate was chosen after the last iteration.
    #[must_use]
    pub fn taken(&self) -> &AccelerationStats {
        &self.taken
    }

    /// Writes the state that the next window depends on, for [`Coupling::restore`] in a coupling of
    /// the same case.
    pub fn save(&mut self, into: &mut Vec<u8>) {
        self.predictor.save(into);
        self.accelerator.save(into);
        put_f64s(into, &self.accepted);
    }

    /// Restores a saved state between two windows. The run then continues bit-identically.
    ///
    /// # Errors
    /// The state comes from another case.
    pub fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateMismatch> {
        self.predictor.restore(from)?;
        self.accelerator.restore(from)?;
        from.f64s(&mut self.accepted)
    }
}

/// A single participant that evaluates a function of a vector.
struct Function<F> {
    pass: F,
    sent: Vec<f64>,
    returned: Vec<f64>,
    data: Vec<Part>,
}

impl<F: FnMut(&[f64], &mut [f64])> Exchange for Function<F> {
    type Error = Infallible;

    fn participants(&self) -> usize {
        1
    }

    fn solve(&mut self, _: &[ParticipantIndex], _: &Step) -> Result<(), Infallible> {
        (self.pass)(&self.sent, &mut self.returned);
        Ok(())
    }

    fn coupling_data(&self) -> &[Part] {
        &self.data
    }

    fn send(&mut self, iterate: &[f64], _: &Step) -> Result<(), Infallible> {
        self.sent.copy_from_slice(iterate);
        Ok(())
    }

    fn returned(&self, returned: &mut [f64]) {
        returned.copy_from_slice(&self.returned);
    }
}

/// Iterates x ↦ H(x) from `x` until the settings' tolerances hold. `pass(x, y)` writes H(x) into
/// `y`, which is as long as `x`. On return `x` holds the result of the last pass.
pub fn fixed_point(
    settings: &Implicit,
    x: &mut [f64],
    pass: impl FnMut(&[f64], &mut [f64]),
) -> WindowOutcome {
    let data = parts([("x", x.len())]);
    let mut function = Function { pass, sent: x.to_vec(), returned: x.to_vec(), data };
    let mut coupling = Coupling::implicit(settings, false, &function);
    let Ok(outcome) = coupling.solve_window(&mut function, &Step::STEADY);
    x.copy_from_slice(&function.returned);
    outcome
}

#[cfg(test)]
mod tests;
