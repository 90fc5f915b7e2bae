//! Accelerators, which choose the next iterate of the coupling data.
//!
//! | word | x ↦ |
//! |---|---|
//! | `none` | x̃ |
//! | `constant`, `aitken` | x + ωr |
//! | `anderson`, `iqn-ils`, `iqn-imvj` | x̃ + a combination of the changes in earlier iterations |

mod accelerator;
mod aitken;
mod columns;
mod kernels;
mod least_squares;
mod quasi_newton;
mod weights;

pub use accelerator::{AccelerationStats, Accelerator, Constant, Unaccelerated};
pub use aitken::Aitken;
pub use quasi_newton::{QuasiNewton, Rule};

use crate::settings::{Acceleration, Implicit};
use crate::vector::Part;

/// Creates the accelerator that the settings select.
#[must_use]
pub fn build(settings: &Implicit, parts: &[Part]) -> Box<dyn Accelerator> {
    match settings.acceleration {
        Acceleration::None => Box::new(Unaccelerated),
        Acceleration::Constant => Box::new(Constant::new(settings.relaxation)),
        Acceleration::Aitken => Box::new(Aitken::new(settings, parts)),
        Acceleration::Anderson => Box::new(QuasiNewton::new(Rule::Anderson, settings, parts)),
        Acceleration::IqnImvj => Box::new(QuasiNewton::new(Rule::MultiVector, settings, parts)),
        Acceleration::Auto | Acceleration::IqnIls => {
            Box::new(QuasiNewton::new(Rule::LeastSquares, settings, parts))
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
