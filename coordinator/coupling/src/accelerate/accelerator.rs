//! What every accelerator is.

use crate::state::{Reader, StateMismatch};

/// Iterations without a better residual that an accelerator may need which remembers nothing.
pub(super) const PATIENCE: u32 = 100;

/// How an iterate was chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTaken {
    /// Relaxation ω, if it is one.
    pub relaxation: Option<f64>,
    /// Secant columns that took part.
    pub columns: Option<usize>,
    /// Secant columns that were dropped because they held nothing new.
    pub dropped: usize,
}

/// Chooses the next iterate. Sees slices only: one vector of all coupling data.
pub trait Accelerator {
    /// Its word in the case file.
    fn name(&self) -> &'static str;

    /// Iterations without a better residual after which it will not find one.
    fn patience(&self) -> u32 {
        PATIENCE
    }

    /// Returns the change of the case that helps a window that does not converge.
    fn advice(&self) -> &'static str {
        "set coupling.acceleration to \"iqn-ils\""
    }

    /// A window begins, or begins again: what its last attempt has taught, if it was not accepted,
    /// is forgotten.
    fn begin_window(&mut self);

    /// `sent` went into this iteration, `returned` came out of it; both have the same length. On
    /// return `sent` holds what goes into the next iteration.
    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> StepTaken;

    /// The window is done with this iteration; what was learned may serve the next one.
    fn accept_window(&mut self, sent: &[f64], returned: &[f64]);

    /// Writes what was learned in the windows accepted so far.
    fn save(&mut self, into: &mut Vec<u8>);

    /// Reads what [`Accelerator::save`] of one with the same settings has written.
    ///
    /// # Errors
    /// The state is that of other settings.
    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), StateMismatch>;
}
