//! The trait of an accelerator, and the two accelerators without memory: none, and constant
//! relaxation.

use crate::vector::{StateMismatch, StateReader};

/// Iterations without a better residual that an accelerator without memory may take before it gives
/// up.
pub(super) const PATIENCE: u32 = 100;

/// Describes how an iterate was chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AccelerationStats {
    /// Relaxation factor ω, for an accelerator that relaxes.
    pub relaxation: Option<f64>,
    /// Number of secant columns that were used.
    pub columns: Option<usize>,
    /// Number of secant columns that were dropped as linearly dependent.
    pub dropped: usize,
}

/// Chooses the next iterate. The coupling data are one vector, passed as a slice.
pub trait Accelerator {
    /// Returns the number of iterations without a better residual after which the accelerator gives
    /// up.
    fn patience(&self) -> u32 {
        PATIENCE
    }

    /// Returns the change of the case to recommend for a window that does not converge.
    fn advice(&self) -> &'static str {
        "set coupling.acceleration to \"iqn-ils\""
    }

    /// Begins a window, or repeats it. Discards secant data learned in a rejected attempt.
    fn begin_window(&mut self);

    /// Computes the next iterate. `sent` went into the last iteration and `returned` came out; both
    /// have the same length. On return `sent` holds the next iterate.
    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> AccelerationStats;

    /// Ends the window with this iteration. Learned data may serve the next window.
    fn accept_window(&mut self, sent: &[f64], returned: &[f64]);

    /// Writes the data learned in the windows accepted so far.
    fn save(&mut self, into: &mut Vec<u8>);

    /// Restores data written by [`Accelerator::save`] of an accelerator with the same settings.
    ///
    /// # Errors
    /// The state comes from other settings.
    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateMismatch>;
}

/// No acceleration: the next iterate is the vector that the participants returned.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unaccelerated;

impl Accelerator for Unaccelerated {
    fn begin_window(&mut self) {}

    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> AccelerationStats {
        sent.copy_from_slice(returned);
        AccelerationStats::default()
    }

    fn accept_window(&mut self, _sent: &[f64], _returned: &[f64]) {}

    fn save(&mut self, _into: &mut Vec<u8>) {}

    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateMismatch> {
        Ok(())
    }
}

/// Relaxation x + ωr with a constant ω.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    relaxation: f64,
}

impl Constant {
    /// Creates an accelerator with the constant relaxation factor ω \[-\].
    #[must_use]
    pub fn new(relaxation: f64) -> Self {
        Self { relaxation }
    }
}

impl Accelerator for Constant {
    fn begin_window(&mut self) {}

    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> AccelerationStats {
        relax(self.relaxation, sent, returned);
        AccelerationStats { relaxation: Some(self.relaxation), ..AccelerationStats::default() }
    }

    fn accept_window(&mut self, _sent: &[f64], _returned: &[f64]) {}

    fn save(&mut self, _into: &mut Vec<u8>) {}

    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateMismatch> {
        Ok(())
    }
}

/// Replaces x by x + ω(x̃ − x).
pub(super) fn relax(relaxation: f64, sent: &mut [f64], returned: &[f64]) {
    for (sent, returned) in sent.iter_mut().zip(returned) {
        *sent += relaxation * (returned - *sent);
    }
}
