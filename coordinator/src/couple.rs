//! The coupling of one run: which participants solve when, what is fed back, and when a window
//! is done. Three independent axes, each behind a trait:
//!
//! - a [`scheme::Scheme`] orders the participants within one iteration,
//! - an [`accelerate::Accelerator`] chooses the next iterate of the fields that close a loop,
//! - a [`converge::Convergence`] decides whether the window is done.
//!
//! The schemes know only [`Exchange`], not the session behind it; accelerators and measures see
//! slices only.

pub mod accelerate;
pub mod converge;
pub mod scheme;

use crate::error::RunError;
use accelerate::Accelerator;
use converge::{Convergence, Verdict};
use proto::model::Step;
use scheme::Scheme;

/// What a scheme can do with the participants.
pub trait Exchange {
    /// Number of participants, in the order in which data flows.
    fn participants(&self) -> usize;

    /// Lets some participants solve at the same time, with the newest samples of their inputs as
    /// they are when the call begins.
    fn solve(&mut self, participants: &[usize], step: &Step) -> Result<(), RunError>;
}

/// What came out of one window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowOutcome {
    /// Iterations made.
    pub iterations: u32,
    /// Residual of the last one; `None` if nothing closes a loop.
    pub residual: Option<f64>,
}

/// Scheme, accelerator and convergence measure of a run.
pub struct Coupling {
    /// Order of the participants.
    pub scheme: Box<dyn Scheme>,
    /// Next iterate.
    pub accelerator: Box<dyn Accelerator>,
    /// When is it enough.
    pub convergence: Box<dyn Convergence>,
}

impl Coupling {
    /// One pass, nothing fed back within the window.
    #[must_use]
    pub fn explicit() -> Self {
        Self {
            scheme: Box::new(scheme::Serial),
            accelerator: Box::new(accelerate::Unaccelerated),
            convergence: Box::new(converge::OnePass),
        }
    }

    /// Iterates one window until it is done.
    pub fn solve_window(
        &mut self,
        exchange: &mut dyn Exchange,
        window: &Step,
    ) -> Result<WindowOutcome, RunError> {
        let mut step = Step { iteration: 1, ..*window };
        loop {
            self.scheme.pass(exchange, &step)?;
            // An explicit pass feeds nothing back: the coupling vector is empty.
            let (mut sent, returned): ([f64; 0], [f64; 0]) = ([], []);
            match self.convergence.judge(step.iteration, &sent, &returned) {
                Verdict::Done { residual } => {
                    self.accelerator.accept_window();
                    return Ok(WindowOutcome { iterations: step.iteration, residual });
                }
                Verdict::Continue => self.accelerator.next(&mut sent, &returned),
            }
            step.iteration += 1;
        }
    }
}
