//! Closed forms for the contact of bodies of different elastic constants.
//!
//! With the constants of [`Elasticity`]: compliance C = (1 − ν)/G, coupling k = K/G, β = k/C
//! (Dundurs).
//!
//! **Rolling along a line without slip** (Bufler, Ingenieur-Archiv 27 (1959)). In plane strain
//! pressure and traction obey −(2C/π) ∫ p_n/(x − s) ds + 2k q = −x/R and
//! −(2C/π) ∫ q/(x − s) ds − 2k p_n = ξ. For φ = p_n + iq this is one equation, whose solution
//! Φ(z) = (i/4CR)[z − 2iεa − (z − a)^(½+iε) (z + a)^(½−iε)] is bounded at both ends if
//! |ξ| = 2εa/R with ε = ln[(1 + β)/(1 − β)]/2π. The tangential force is zero; the
//! load is (1 + 4ε²) times the Hertz load for the same a.
//!
//! **Rolling along a line under vanishing friction.** The slip is the sum of 2k p_n, caused by the
//! pressure, and the creepage. It changes sign where half the load lies inside, so that the
//! tangential force is zero.
//!
//! **Growing load with friction** (Spence, J. Elasticity 5 (1975); Johnson, *Contact Mechanics*
//! (1985) §5.4). The contact sticks in the same share c/a of its radius for any profile. The effect
//! of the tractions on the pressure, of the order of β², is neglected:
//!
//! - for a line K(√(1 − c²/a²))/K(c/a) = β/f,
//! - for a circle (a/2c) ln[(a + c)/(a − c)] = (f/β) K(√(1 − c²/a²)),
//!
//! with the complete elliptic integral K as a function of the modulus.

use super::elliptic_integrals::carlson_rf;
use crate::Elasticity;
use numerics::search::root_in_bracket;
use std::f64::consts::{FRAC_PI_4, PI};

/// Dundurs' β = k/C [-].
#[must_use]
pub fn coupling(bodies: &Elasticity) -> f64 {
    bodies.coupling_compliance / bodies.contact_compliance()
}

/// Exponent ε of the oscillating ends [-].
#[must_use]
pub fn oscillation(bodies: &Elasticity) -> f64 {
    let beta = coupling(bodies);
    ((1.0 + beta) / (1.0 - beta)).ln() / (2.0 * PI)
}

/// Half length a [m] of a line contact that rolls without slip, for the Hertz half length `hertz`
/// under the same load.
#[must_use]
pub fn half_length_without_slip(bodies: &Elasticity, hertz: f64) -> f64 {
    hertz / (1.0 + 4.0 * oscillation(bodies).powi(2)).sqrt()
}

/// Creepage of a line contact in free rolling without slip, of half length a [m] and relative
/// radius R [m] [-].
#[must_use]
pub fn creepage_without_slip(bodies: &Elasticity, half_length: f64, radius: f64) -> f64 {
    -2.0 * oscillation(bodies) * half_length / radius
}

/// Creepage of a line contact in free rolling under vanishing friction, of peak pressure p_0 [Pa]
/// [-].
#[must_use]
pub fn creepage_without_friction(bodies: &Elasticity, max_pressure: f64) -> f64 {
    // Half the load lies within the share sin t of the half length, where 2t + sin 2t = π/2.
    let mut angle = 0.4;
    for _ in 0..20 {
        let excess = 0.5 * (2.0 * angle + f64::sin(2.0 * angle)) - FRAC_PI_4;
        angle -= excess / (1.0 + f64::cos(2.0 * angle));
    }
    -2.0 * bodies.coupling_compliance * max_pressure * angle.cos()
}

/// Sticking share c/a of a line contact under a growing load, as a function of β/f.
#[must_use]
pub fn stick_share_of_a_line(beta_over_friction: f64) -> f64 {
    share(|share| elliptic(share * share) / elliptic(1.0 - share * share) - beta_over_friction)
}

/// Sticking share c/a of the radius of a circular contact under a growing load, as a function of
/// β/f.
#[must_use]
pub fn stick_share_of_a_circle(beta_over_friction: f64) -> f64 {
    share(|share| {
        let logarithm = ((1.0 + share) / (1.0 - share)).ln() / (2.0 * share);
        elliptic(share * share) / beta_over_friction - logarithm
    })
}

/// K of a modulus whose square is 1 − `complement`.
fn elliptic(complement: f64) -> f64 {
    carlson_rf(0.0, complement, 1.0)
}

/// Zero of a falling function between 0 and 1.
fn share(function: impl Fn(f64) -> f64) -> f64 {
    let ends = [(0.0, f64::INFINITY), (1.0, f64::NEG_INFINITY)];
    root_in_bracket(ends, function).expect("a bracket")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Limits of zero and of large friction; both shares from the definition of K.
    #[test]
    fn limits_of_the_stick_shares() {
        for share in [stick_share_of_a_line, stick_share_of_a_circle] {
            assert!(share(30.0) < 0.05 && share(1e-2) > 0.98);
            assert!(share(1.0) > share(2.0));
        }
        // Both sides are K(√½).
        assert!((stick_share_of_a_line(1.0) - 0.5_f64.sqrt()).abs() < 1e-12);
    }
}
