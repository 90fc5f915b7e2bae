//! Steps in time: backward Euler, BDF2 and Crank–Nicolson by name.
//!
//! All of them are a₀ T − θ Δt L T = Σ aᵢ Tᵢ + (1 − θ) Δt L T₁ + Δt q for the conduction L, the state T₁ one step
//! ago and T₂ two steps ago:
//!
//! | | a₀ | a₁ | a₂ | θ |
//! |---|---|---|---|---|
//! | backward Euler | 1 | 1 | 0 | 1 |
//! | Crank–Nicolson | 1 | 1 | 0 | ½ |
//! | BDF2 | (1 + 2ω)/(1 + ω) | 1 + ω | −ω²/(1 + ω) | 1 |
//!
//! with the step ω over the step before it. BDF2 begins with a step of backward Euler, Crank–Nicolson with two of them,
//! which damp what it does not (R. Rannacher, Numer. Math. 43 (1984) 309–327).

/// A scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// First order, damps most.
    BackwardEuler,
    /// Second order, damps.
    Bdf2,
    /// Second order, four times as exact as BDF2, damps the finest least.
    CrankNicolson,
}

/// Steps of backward Euler with which Crank–Nicolson begins.
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
    /// Coefficients of a step after so many others, over the step before it.
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
