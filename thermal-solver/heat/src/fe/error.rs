//! Why finite elements have no answer.

/// Why finite elements have no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// Newton's method did not reach its tolerance.
    ///
    /// It converges from any start, unless conjugate gradients end too early, which elimination does
    /// not, or rounding exceeds the tolerance: between layers so thin that what they conduct cancels.
    #[error(
        "the equations of the elements are not solved: the residual is {residual:.1e} after {newton} steps of Newton's \
         method"
    )]
    NotSolved {
        /// Residual over the largest term of the equations [-].
        residual: f64,
        /// Steps of Newton's method.
        newton: usize,
        /// Conjugate gradients have ended before their tolerance.
        gradients_stopped: bool,
    },
    /// A temperature for which the table of properties has none.
    #[error(
        "{temperature:.1} K is beyond the table of properties, which is from {} to {} K", known[0], known[1]
    )]
    BeyondProperties {
        /// The temperature [K].
        temperature: f64,
        /// First and last temperature of the table [K].
        known: [f64; 2],
    },
    /// Heat spreads over elements before they are passed.
    #[error(
        "the march downstream is for speeds at which an element is passed before heat spreads over it: \
         its Fourier number is {fourier:.2} at {speed} m/s, and must not be above {most}"
    )]
    TooSlow {
        /// Fourier number of an element [-].
        fourier: f64,
        /// Speed [m/s].
        speed: f64,
        /// Largest Fourier number that has an answer [-].
        most: f64,
    },
    /// The march downstream changes from pass to pass.
    #[error("the march downstream does not settle: it changes by {change:.3e} W/m")]
    Unsettled {
        /// Change of the last pass [W/m].
        change: f64,
    },
}
