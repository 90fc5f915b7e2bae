//! Time-stepping schemes: backward Euler, BDF2 and Crank–Nicolson.
//!
//! All schemes have the form a₀ T − θ Δt L T = Σ aᵢ Tᵢ + (1 − θ) Δt L T₁ + Δt q for the conduction
//! L, the state T₁ one step ago and T₂ two steps ago:
//!
//! | | a₀ | a₁ | a₂ | θ |
//! |---|---|---|---|---|
//! | backward Euler | 1 | 1 | 0 | 1 |
//! | Crank–Nicolson | 1 | 1 | 0 | ½ |
//! | BDF2 | (1 + 2ω)/(1 + ω) | 1 + ω | −ω²/(1 + ω) | 1 |
//!
//! with ω the step over the step before. BDF2 begins with one step of backward Euler.
//! Crank–Nicolson begins with two such steps, which damp the components that it does not damp
//! itself (R. Rannacher, Numer. Math. 43 (1984) 309–327).

/// A time-stepping scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// First order, strongest damping.
    BackwardEuler,
    /// Second order, with damping.
    Bdf2,
    /// Second order, four times as accurate as BDF2, least damping of the finest components.
    CrankNicolson,
}

/// Number of backward Euler steps with which Crank–Nicolson begins.
const DAMPED: u64 = 2;

/// The coefficients of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// a₀, a₁ and a₂.
    pub a: [f64; 3],
    /// θ.
    pub theta: f64,
}

impl Scheme {
    /// Returns the coefficients of a step after `steps` others, for the ratio `over` of this step
    /// to the previous one.
    #[must_use]
    pub fn coefficients(self, steps: u64, over: f64) -> Coefficients {
        let euler = Coefficients { a: [1.0, 1.0, 0.0], theta: 1.0 };
        match self {
            Self::Bdf2 if steps > 0 => {
                let one = 1.0 + over;
                Coefficients { a: [(one + over) / one, one, -over * over / one], theta: 1.0 }
            }
            Self::CrankNicolson if steps >= DAMPED => Coefficients { theta: 0.5, ..euler },
            _ => euler,
        }
    }
}
