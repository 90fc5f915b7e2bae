//! Hertz contact of two elastic bodies over an ellipse.
//!
//! Undeformed gap: h(x, y) = A x² + B y², A and B > 0 [1/m]. Pressure
//! p = p_0 √(1 − x²/a² − y²/b²) with p_0 = 3N/(2π a b). With the compliance sum
//! E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa] the displacement of that pressure,
//! u = p_0 a b E* · [R_F(0, a², b²) − ⅓ R_D(0, b², a²) x² − ⅓ R_D(0, a², b²) y²],
//! closes the gap, u = δ − h, when
//!
//! - A = ⅓ p_0 a b E* R_D(0, b², a²),
//! - B = ⅓ p_0 a b E* R_D(0, a², b²),
//! - δ = p_0 a b E* R_F(0, a², b²), the approach of the bodies.
//!
//! The quotient B/A determines the aspect ratio, A then the size. R_F and R_D are the integrals of
//! [`super::elliptic_integrals`]. In Legendre's form they are K, and (K − E)/k² up to factors,
//! whose cancellation near the circle is thus avoided.
//!
//! **Line.** Bodies with the gap A x² touch along a line of width w under N: a² = 2N E*/(π A w),
//! p_0 = 2N/(π a w). The displacement of a half-plane has no natural zero. In the middle of the
//! width, w ≫ a, the bodies approach by δ = (2 E* N/(π w)) (ln(2w/a) + ½), the displacement by the
//! semi-elliptic pressure over that width.
//!
//! Source: K. L. Johnson, Contact Mechanics (1985), §3.5 and §4.2. Deviation: symmetric integrals;
//! E* is the sum of compliances (Naeimi et al., eq. 19), the inverse of Johnson's E*. The longer
//! axis may lie along x or y.

use super::elliptic_integrals::{carlson_rd, carlson_rf};
use std::f64::consts::PI;

/// Solution of a Hertz contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipticContact {
    /// Semi-axis a along x [m].
    pub semi_axis_a: f64,
    /// Semi-axis b along y [m].
    pub semi_axis_b: f64,
    /// Pressure p_0 at the centre [Pa].
    pub max_pressure: f64,
    /// Approach δ of the bodies [m].
    pub approach: f64,
}

/// Solves the contact of bodies with the gap A x² + B y².
///
/// `gap_x` is A and `gap_y` is B [1/m], `normal_force` N [N], `contact_compliance` the sum
/// (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa]; all must be positive and finite, A and B within a factor of
/// 1e100. Relative error of the result below 1e-12 for aspect ratios up to 1000.
#[must_use]
pub fn elliptic_contact(
    gap_x: f64,
    gap_y: f64,
    normal_force: f64,
    contact_compliance: f64,
) -> EllipticContact {
    let along_x = gap_x <= gap_y;
    let (flat, steep) = if along_x { (gap_x, gap_y) } else { (gap_y, gap_x) };
    let aspect = aspect_ratio(steep / flat);
    let square = aspect * aspect;
    let load = normal_force * contact_compliance / (2.0 * PI);
    let major = (load * carlson_rd(0.0, square, 1.0) / flat).cbrt();
    let minor = aspect * major;
    let (semi_axis_a, semi_axis_b) = if along_x { (major, minor) } else { (minor, major) };
    EllipticContact {
        semi_axis_a,
        semi_axis_b,
        max_pressure: 1.5 * normal_force / (PI * major * minor),
        approach: 3.0 * load * carlson_rf(0.0, 1.0, square) / major,
    }
}

/// Solves the contact of bodies with the gap A x² along a line. `gap_x` is A [1/m], `width` w [m],
/// `normal_force` N [N], `contact_compliance` the sum (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa]. The
/// semi-axis b of the result is half the width.
#[must_use]
pub fn line_contact(
    gap_x: f64,
    width: f64,
    normal_force: f64,
    contact_compliance: f64,
) -> EllipticContact {
    let load = contact_compliance * normal_force / (PI * width);
    let semi_axis_a = (2.0 * load / gap_x).sqrt();
    EllipticContact {
        semi_axis_a,
        semi_axis_b: 0.5 * width,
        max_pressure: 2.0 * normal_force / (PI * semi_axis_a * width),
        approach: 2.0 * load * ((2.0 * width / semi_axis_a).ln() + 0.5),
    }
}

/// Normal force on a line contact at an approach δ [N], by Newton's method for a: δ = A a²
/// (ln(2w/a) + ½).
#[must_use]
pub fn line_force_at_approach(
    gap_x: f64,
    width: f64,
    approach: f64,
    contact_compliance: f64,
) -> f64 {
    const STEPS: usize = 40;
    let mut a = (approach / gap_x).sqrt();
    for _ in 0..STEPS {
        let logarithm = (2.0 * width / a).ln();
        let step = (gap_x * a * a * (logarithm + 0.5) - approach) / (2.0 * gap_x * a * logarithm);
        a -= step.min(0.5 * a);
        if step.abs() <= f64::EPSILON * a {
            break;
        }
    }
    0.5 * gap_x * a * a * PI * width / contact_compliance
}

/// Normal force at an approach δ [N], from δ ∝ N^(2/3).
#[must_use]
pub fn force_at_approach(gap_x: f64, gap_y: f64, approach: f64, contact_compliance: f64) -> f64 {
    let unit = elliptic_contact(gap_x, gap_y, 1.0, contact_compliance).approach;
    (approach / unit).powf(1.5)
}

/// Shorter over longer semi-axis g, for a ratio ≥ 1 of the gap's coefficients.
///
/// Solves ln(R_D(0, 1, g²)/R_D(0, g², 1)) = ln(ratio) for ln g by secants. The left side falls with
/// a slope between −3/2 (circle) and −2 (line), which bounds the secants. A step leaves at most a
/// quarter of the error from any start, and convergence is soon quadratic.
fn aspect_ratio(ratio: f64) -> f64 {
    const STEPS: usize = 30;
    let target = ratio.ln();
    let excess = |logarithm: f64| {
        let square = (2.0 * logarithm).exp();
        (carlson_rd(0.0, 1.0, square) / carlson_rd(0.0, square, 1.0)).ln() - target
    };
    let mut logarithm = -target / 1.75;
    let mut above = excess(logarithm);
    let mut step = above / 1.75;
    for _ in 0..STEPS {
        logarithm += step;
        if step.abs() <= f64::EPSILON * logarithm.abs().max(1.0) {
            break;
        }
        let next = excess(logarithm);
        let slope = (above - next) / step;
        (above, step) = (next, next / slope.clamp(1.5, 2.0));
    }
    logarithm.exp().min(1.0)
}

/// Largest pressure, semi-axis and approach of a circular contact (Johnson §3.4), as a check and
/// for reports: a³ = ¾ N R E*, p_0 = 3N/(2π a²), δ = a²/R with the relative radius R [m].
#[must_use]
pub fn circular_contact(
    relative_radius: f64,
    normal_force: f64,
    contact_compliance: f64,
) -> EllipticContact {
    let radius = (0.75 * normal_force * relative_radius * contact_compliance).cbrt();
    EllipticContact {
        semi_axis_a: radius,
        semi_axis_b: radius,
        max_pressure: 1.5 * normal_force / (PI * radius * radius),
        approach: radius * radius / relative_radius,
    }
}

/// Normal force 2/3 π a b p_0 of an ellipsoidal pressure [N].
#[must_use]
pub fn normal_force(semi_axis_a: f64, semi_axis_b: f64, max_pressure: f64) -> f64 {
    2.0 / 3.0 * PI * semi_axis_a * semi_axis_b * max_pressure
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STEEL: f64 = 2.0 * 0.91 / 210e9;

    #[track_caller]
    fn assert_close(value: f64, expected: f64, tolerance: f64) {
        let error = (value / expected - 1.0).abs();
        assert!(error < tolerance, "{value} is not {expected}, relative error {error}");
    }

    /// The displacement of the pressure closes the gap at the edge and in the middle, by Gauss's
    /// rule on the logarithm. The force at an approach inverts the approach under a force.
    /// Tolerance: the rule, and rounding.
    #[test]
    fn a_line_closes_its_gap() {
        let (gap, width, force) = (1.1, 0.02, 4e4);
        let line = line_contact(gap, width, force, STEEL);
        let a = line.semi_axis_a;
        let count = 20_000;
        let displacement = |x: f64| -> f64 {
            let at = |k: usize| (PI * (k as f64 + 0.5) / f64::from(count)).cos();
            // Pressure times dx, with x = a cos t.
            let part = |s: f64| (1.0 - s * s) * 2.0 * (width / (a * s - x).abs()).ln();
            let sum: f64 = (0..count as usize).map(|k| part(at(k))).sum();
            STEEL / PI * line.max_pressure * a * PI / f64::from(count) * sum
        };
        for share in [0.0, 0.3, 0.9] {
            let gap_there = gap * (share * a).powi(2);
            let closed = displacement(share * a) + gap_there;
            assert_close(closed, line.approach, 1e-4);
        }
        assert_close(line_force_at_approach(gap, width, line.approach, STEEL), force, 1e-12);
    }

    /// Table 1 of Naeimi et al. with the inferred crown radius of 0.300 m. Tolerance: the printed
    /// digits.
    #[test]
    fn the_papers_contact() {
        let contact = elliptic_contact(0.5 / 0.46, 0.5 / 0.3, 134e3, STEEL);
        assert_close(contact.semi_axis_a, 7.8956e-3, 1e-4);
        assert_close(contact.semi_axis_b, 5.9392e-3, 1e-4);
        assert_close(contact.max_pressure, 1364.38e6, 1e-4);
        assert_close(contact.approach, 126.551e-6, 1e-4);
    }

    /// Tolerance: rounding of the cube root and of some ten operations.
    #[test]
    fn circle() {
        let contact = elliptic_contact(0.5 / 0.46, 0.5 / 0.46, 134e3, STEEL);
        let exact = circular_contact(0.46, 134e3, STEEL);
        assert_close(contact.semi_axis_a, exact.semi_axis_a, 1e-14);
        assert_close(contact.semi_axis_b, exact.semi_axis_b, 1e-14);
        assert_close(contact.max_pressure, exact.max_pressure, 1e-14);
        assert_close(contact.approach, exact.approach, 1e-14);
    }

    /// Line contact (Johnson §4.2c, b → ∞): a / R = 2 p_0 E*. The next term is of the order of
    /// (a/b)² ln(b/a), which the tolerance covers.
    #[test]
    fn long_ellipse_tends_to_a_line_contact() {
        for flatness in [1e-4, 1e-5, 1e-6] {
            let contact = elliptic_contact(0.5, 0.5 * flatness, 1e3, STEEL);
            let slenderness = contact.semi_axis_a / contact.semi_axis_b;
            let tolerance = 2.0 * slenderness.powi(2) * slenderness.recip().ln();
            assert!(slenderness < 0.02);
            assert_close(2.0 * contact.max_pressure * STEEL, contact.semi_axis_a, tolerance);
        }
    }

    /// ∫₀^{π/2} of an even, π-periodic function by the trapezoidal rule, whose error falls like
    /// exp(−4 n g) for integrands with the aspect ratio g.
    fn quarter_period_integral(function: impl Fn(f64) -> f64, aspect: f64) -> f64 {
        let intervals = 16 + (12.0 / aspect) as usize;
        let step = PI / 2.0 / intervals as f64;
        let inner: f64 = (1..intervals).map(|i| function(step * i as f64)).sum();
        step * (inner + 0.5 * (function(0.0) + function(PI / 2.0)))
    }

    /// Substitutes a solution into the equations, with integrals by another route: u's curvature
    /// along x is p_0 a b E* ∫₀^{π/2} cos²θ dθ / (a² √(a² sin²θ + b² cos²θ)).
    fn assert_satisfies_the_equations(gap_x: f64, gap_y: f64, force: f64, compliance: f64) {
        let contact = elliptic_contact(gap_x, gap_y, force, compliance);
        let (a, b) = (contact.semi_axis_a, contact.semi_axis_b);
        let curvature = |along: f64, across: f64| {
            let root = |t: f64| (along * t.sin()).hypot(across * t.cos());
            let integrand = |t: f64| t.cos().powi(2) / root(t);
            quarter_period_integral(integrand, a.min(b) / a.max(b)) / along.powi(2)
        };
        let factor = contact.max_pressure * a * b * compliance;
        let inverse = |t: f64| 1.0 / (a * t.sin()).hypot(b * t.cos());
        let approach = factor * quarter_period_integral(inverse, a.min(b) / a.max(b));
        // Rounding of the quadrature's sum and of the aspect ratio.
        let tolerance = 1e-12;
        assert_close(factor * curvature(a, b), gap_x, tolerance);
        assert_close(factor * curvature(b, a), gap_y, tolerance);
        assert_close(contact.approach, approach, tolerance);
        assert_close(contact.max_pressure, 1.5 * force / (PI * a * b), tolerance);
        assert_close(normal_force(a, b, contact.max_pressure), force, tolerance);
    }

    #[test]
    fn satisfies_both_equations_up_to_aspect_ratios_of_a_thousand() {
        for ratio in [1.0, 1.0 + 1e-9, 1.5333, 10.0, 1e3, 2e5] {
            assert_satisfies_the_equations(1.0, ratio, 134e3, STEEL);
            assert_satisfies_the_equations(ratio, 1.0, 134e3, STEEL);
        }
        let long = elliptic_contact(1.0, 2e5, 134e3, STEEL);
        assert!(long.semi_axis_a / long.semi_axis_b > 1000.0);
    }

    proptest! {
        #[test]
        fn satisfies_both_equations(
            gap_x in 1e-2..1e2, gap_y in 1e-2..1e2, force in 1e-3..1e6, modulus in 1e6..1e12,
        ) {
            assert_satisfies_the_equations(gap_x, gap_y, force, 1.0 / modulus);
        }

        /// Exchanging the axes only exchanges the semi-axes, bit for bit.
        #[test]
        fn independent_of_the_direction(gap_x in 1e-3..1e3, gap_y in 1e-3..1e3) {
            let one = elliptic_contact(gap_x, gap_y, 1.0, 1.0);
            let other = elliptic_contact(gap_y, gap_x, 1.0, 1.0);
            prop_assert_eq!(one.semi_axis_a, other.semi_axis_b);
            prop_assert_eq!(one.approach, other.approach);
        }
    }
}
