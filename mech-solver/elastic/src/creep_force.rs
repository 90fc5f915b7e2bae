//! Kalker's simplified theory for a contact without spin, in closed form.
//!
//! The surfaces are beds of springs, u = L p, with the traction bound
//! g = g_0 (1 − x²/a² − y²/b²), g_0 = 2 f N/(π a b). With the creepage w along one direction and
//! the reduced creepage τ = a w/(L g_0) ≥ 0, a strip of half length a η, η = √(1 − y²/b²), sticks
//! from its leading edge (X = 1) to 1 + X = c, c = τ/η, with the traction g_0 η² c (1 − X), and
//! slips behind, with the traction g_0 η² (1 − X²) and the slip w − L ∂p/∂x = w (1 + 2X/c).
//! Its force is g_0 a η³ S(c), S = 2c − c² + c³/6 for c < 2, and 4/3 beyond. With y = b sin θ and
//! cos θ_m = τ/2 the sum over the strips is
//!
//! F/(f N) = 2/π · [4τ(s − s³/3) − τ²(θ_m + s cos θ_m) + τ³ s/3
//!           + 8/3 (3π/16 − 3θ_m/8 − sin 2θ_m/4 − sin 4θ_m/32)], s = sin θ_m, for τ < 2; else 1.
//!
//! For small τ it is 16 τ/(3π) = 8 a² b w/(3 L), which with L = 8a/(3 G C) is G a b C w, as in
//! Kalker's linear theory. The whole contact slips for τ ≥ 2.
//!
//! **Elliptic bound**, g = g_0 √(1 − x²/a² − y²/b²), g_0 = 3 f N/(2π a b). With τ = a w/(L g_0)
//! every strip sticks down to the same X, where τ (1 − X) = √(1 − X²); τ = tan α gives X = −cos 2α.
//! Then F/(f N) = (2/π)(α + ½ sin 2α), that is (2/π)(arctan τ + τ/(1 + τ²)): Polach's formula, with
//! the same slope. No finite creepage makes the whole contact slip.
//!
//! **Strip theory** in the stick zone, under the same bound; every strip slips over the length 2d
//! at its trailing edge, d/a = 16 τ/(3π²): F/(f N) = 1 − (3/2)(s − s³/3 − δ θ),
//! δ = d/a = cos θ < 1, s = sin θ, with the same slope again; 1 beyond.
//!
//! Sources: J. J. Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle
//! System Dynamics 11 (1982) 1–13; O. Polach, Wear 258 (2005) 992–1000; D. J. Haines and E.
//! Ollerton, Proc. Inst. Mech. Engrs 177 (1963) 95–114. The sums over the strips are derived here.

use std::f64::consts::PI;

/// Reduced creepage at which the whole contact slips [-].
pub const FULL_SLIP: f64 = 2.0;

/// Force over f N [-] at a reduced creepage τ ≥ 0.
#[must_use]
pub fn force_ratio(reduced_creepage: f64) -> f64 {
    let tau = reduced_creepage;
    if tau >= FULL_SLIP {
        return 1.0;
    }
    let cosine = 0.5 * tau;
    let (angle, sine) = (cosine.acos(), (1.0 - cosine * cosine).sqrt());
    let stick = 4.0 * tau * (sine - sine.powi(3) / 3.0) - tau * tau * (angle + sine * cosine)
        + tau.powi(3) * sine / 3.0;
    let slip =
        3.0 * PI / 16.0 - 0.375 * angle - 0.25 * (2.0 * angle).sin() - (4.0 * angle).sin() / 32.0;
    2.0 / PI * (stick + 8.0 / 3.0 * slip)
}

/// Force over f N under the elliptic bound [-] at a reduced creepage τ ≥ 0, with g_0 of that bound.
#[must_use]
pub fn elliptic_force_ratio(reduced_creepage: f64) -> f64 {
    let tau = reduced_creepage;
    2.0 / PI * (tau.atan() + tau / (1.0 + tau * tau))
}

/// Force over f N under the elliptic bound, with strip theory in the stick zone [-].
#[must_use]
pub fn strip_force_ratio(reduced_creepage: f64) -> f64 {
    let slipping = 16.0 * reduced_creepage / (3.0 * PI * PI);
    if slipping >= 1.0 {
        return 1.0;
    }
    let (angle, sine) = (slipping.acos(), (1.0 - slipping * slipping).sqrt());
    1.0 - 1.5 * (sine - sine.powi(3) / 3.0 - slipping * angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::simpson;

    /// Strips under both theories, by quadrature of the traction with X = sin t. Tolerance:
    /// Simpson's rule.
    #[test]
    fn strips_under_the_elliptic_bound() {
        for tau in [1e-3, 0.1, 0.7, 1.3, 4.0] {
            let bound = |t: f64| t.cos() * t.cos();
            let border = (-(2.0 * f64::atan(tau)).cos()).asin();
            let stick = |t: f64| tau * (1.0 - t.sin()) * t.cos();
            let strip = simpson(-0.5 * PI, border, bound) + simpson(border, 0.5 * PI, stick);
            assert!((elliptic_force_ratio(tau) - 2.0 / PI * strip).abs() < 1e-9, "{tau}");
        }
        for tau in [1e-3, 0.1, 0.7, 1.3, 1.9] {
            let d = 16.0 * tau / (3.0 * PI * PI);
            let outer = |angle: f64| angle.cos().powi(3);
            let middle = d.min(1.0).acos();
            let inner = |angle: f64| (angle.cos() - d).powi(2) * angle.cos();
            let sum = simpson(0.0, 0.5 * PI, outer) - simpson(0.0, middle, inner);
            assert!((strip_force_ratio(tau) - 1.5 * sum).abs() < 1e-9, "{tau}");
        }
        let small = 1e-6;
        for ratio in [elliptic_force_ratio(small), strip_force_ratio(small)] {
            assert!((ratio / (4.0 * small / PI) - 1.0).abs() < 1e-5);
        }
    }

    /// Force of the strips by quadrature of the traction, then over the strips. Tolerance:
    /// Simpson's rule at the kink where strips begin to slip entirely.
    #[test]
    fn sum_over_the_strips() {
        for tau in [1e-3, 0.1, 0.7, 1.3, 1.9, 1.999, 2.0, 5.0] {
            let strip = |eta: f64| {
                let c: f64 = (tau / eta).min(2.0);
                let slip = simpson(-1.0, c - 1.0, |x| 1.0 - x * x);
                slip + if c < 2.0 { 0.5 * c * (2.0 - c).powi(2) } else { 0.0 }
            };
            let middle = (0.5f64 * tau).min(1.0).acos();
            let row = |angle: f64| angle.cos().powi(4) * strip(angle.cos());
            let sum = simpson(0.0, middle, row) + simpson(middle, 0.5 * PI, row);
            assert!((force_ratio(tau) - 4.0 / PI * sum).abs() < 1e-9, "{tau}");
        }
    }

    #[test]
    fn limits() {
        assert!(force_ratio(0.0).abs() < 1e-15);
        assert!((force_ratio(1e-6) / (16e-6 / (3.0 * PI)) - 1.0).abs() < 1e-5);
        assert_eq!(force_ratio(2.0), 1.0);
        // The strips that still stick lack a share of the order of (2 − τ)^{9/2}; tolerance: the
        // digits that θ_m loses close to zero.
        assert!((force_ratio(2.0 - 1e-9) - 1.0).abs() < 1e-10);
    }
}
