//! Errors of a finite-element solve.

use tables::readable::number;

/// Reason why finite elements give no result.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// Newton's method did not reach its tolerance.
    ///
    /// The method converges from any start, with two exceptions. Conjugate gradients may end too
    /// early; elimination does not. Rounding may exceed the tolerance, between layers so thin that
    /// their conduction cancels.
    #[error(
        "the equations of the elements are not solved: the residual is {residual} after {newton} steps of Newton's \
         method", residual = number(*.residual, 2))]
    NotSolved {
        /// Residual over the largest term of the equations [-].
        residual: f64,
        /// Steps of Newton's method.
        newton: usize,
        /// Whether conjugate gradients ended before their tolerance.
        gradients_stopped: bool,
    },
    /// A temperature is outside the table of properties.
    #[error(
        "{temperature:.1} K is beyond the table of properties, which covers {} to {} K", known[0], known[1]
    )]
    BeyondProperties {
        /// The temperature [K].
        temperature: f64,
        /// First and last temperature of the table [K].
        known: [f64; 2],
    },
    /// Heat spreads over an element faster than the material passes it.
    #[error(
        "the march downstream needs a speed at which material passes an element before heat spreads over it: \
         its Fourier number is {fourier:.2} at {speed} m/s, and must not be above {most}"
    )]
    TooSlow {
        /// Fourier number of an element [-].
        fourier: f64,
        /// Speed [m/s].
        speed: f64,
        /// Largest Fourier number that is allowed [-].
        most: f64,
    },
    /// The march downstream changes from sweep to sweep.
    #[error("the march downstream does not settle: it changes by {change} W/m", change = number(*.change, 4))]
    Unsettled {
        /// Change of the last sweep [W/m].
        change: f64,
    },
}
