//! No acceleration, and a constant relaxation.

use super::accelerator::{Accelerator, StepTaken};
use crate::state::{Reader, StateMismatch};

/// What came out goes in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unaccelerated;

impl Accelerator for Unaccelerated {
    fn name(&self) -> &'static str {
        "none"
    }

    fn begin_window(&mut self) {}

    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> StepTaken {
        sent.copy_from_slice(returned);
        StepTaken::default()
    }

    fn accept_window(&mut self, _sent: &[f64], _returned: &[f64]) {}

    fn save(&mut self, _into: &mut Vec<u8>) {}

    fn restore(&mut self, _from: &mut Reader<'_>) -> Result<(), StateMismatch> {
        Ok(())
    }
}

/// x + ωr with a constant ω.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    relaxation: f64,
}

impl Constant {
    /// With this ω \[-\].
    #[must_use]
    pub fn new(relaxation: f64) -> Self {
        Self { relaxation }
    }
}

impl Accelerator for Constant {
    fn name(&self) -> &'static str {
        "constant"
    }

    fn begin_window(&mut self) {}

    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> StepTaken {
        relax(self.relaxation, sent, returned);
        StepTaken { relaxation: Some(self.relaxation), ..StepTaken::default() }
    }

    fn accept_window(&mut self, _sent: &[f64], _returned: &[f64]) {}

    fn save(&mut self, _into: &mut Vec<u8>) {}

    fn restore(&mut self, _from: &mut Reader<'_>) -> Result<(), StateMismatch> {
        Ok(())
    }
}

/// x becomes x + ω(x̃ − x).
pub(super) fn relax(relaxation: f64, sent: &mut [f64], returned: &[f64]) {
    for (sent, returned) in sent.iter_mut().zip(returned) {
        *sent += relaxation * (returned - *sent);
    }
}
