//! The two-norms that convergence is measured by.

use crate::part::{BLOCK, dot};
use crate::settings::Tolerances;

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

    /// ‖r‖/‖x̃‖; 0 if nothing has changed.
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
