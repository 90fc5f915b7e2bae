//! Carter's rolling contact with a stick zone, applied to the strips of an elliptic patch.
//!
//! Per strip y = const of half length a_y = a √(1 − y²/b²), with X = x/a_y ∈ [−1, 1] (leading edge
//! at +1), force ratio r = |F|/(f N) and k = √(1 − r), m = 1 − k:
//!
//! - traction over f p_0 √(1 − y²/b²): √(1 − X²) − k √(1 − ((X − m)/k)²), the second term only in
//!   the stick zone 2m − 1 < X ≤ 1, of half length k around X = m;
//! - slip velocity over V A: √((ξ − ξ_c)² − k²) = √((1 − X)(2m − 1 − X)) in the slip zone
//!   X < 2m − 1, with ξ = −X of the strip's own half length, ξ_c = k − 1;
//! - creep s = A m, a fraction m of every strip slips, and a strip's friction power is V s times
//!   its force: ∫(2 − u)√(u(2m − u)) du = π/2 · m²(2 − m) over u = 1 + X ∈ [0, 2m].
//!
//! The prefactor A follows one of two laws, which agree for a line contact only:
//! A = f a/R_wheel, or A = 2 f p_0 E* with E* the compliance sum of [`super::hertz`].
//!
//! Source: F. W. Carter, On the action of a locomotive driving wheel, Proc. R. Soc. Lond. A 112
//! (1926) 151–157; J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990); the
//! two prefactors: Naeimi et al., eq. 18. Deviations: the minus sign of eq. 18 is left out, as
//! creep here is a magnitude. The two forms, printed there as equal, are two laws. The variable is
//! m instead of k, so that nothing cancels when the slip zone is small.

/// Fraction m = 1 − √(1 − r) of every strip that slips [-], for a force ratio r in [0, 1].
#[must_use]
pub fn slip_fraction(force_ratio: f64) -> f64 {
    force_ratio / (1.0 + (1.0 - force_ratio).sqrt())
}

/// Force ratio r = |F|/(f N) = m(2 − m) of a slip fraction m in [0, 1] [-].
#[must_use]
pub fn force_ratio(slip_fraction: f64) -> f64 {
    slip_fraction * (2.0 - slip_fraction)
}

/// Prefactor A = f a/R_wheel of the law `carter-radius` [-]; lengths in m.
#[must_use]
pub fn prefactor_by_radius(friction_coefficient: f64, semi_axis_a: f64, wheel_radius: f64) -> f64 {
    friction_coefficient * semi_axis_a / wheel_radius
}

/// Prefactor A = 2 f p_0 E* of the law `carter-pressure` [-]; pressure in Pa, compliance sum in
/// 1/Pa.
#[must_use]
pub fn prefactor_by_pressure(
    friction_coefficient: f64,
    max_pressure: f64,
    contact_compliance: f64,
) -> f64 {
    2.0 * friction_coefficient * max_pressure * contact_compliance
}

/// Creep magnitude s = A·(1 − √(1 − r)) [-] at a force ratio r in [0, 1].
#[must_use]
pub fn creep(prefactor: f64, force_ratio: f64) -> f64 {
    prefactor * slip_fraction(force_ratio)
}

/// Traction at X = `position` ∈ [−1, 1] over the strip's largest bound f p_0 √(1 − y²/b²) [-].
#[must_use]
pub fn traction_shape(position: f64, slip_fraction: f64) -> f64 {
    let (ahead, behind) = ((1.0 - position).max(0.0).sqrt(), (1.0 + position).max(0.0).sqrt());
    let from_border = 1.0 + position - 2.0 * slip_fraction;
    if from_border <= 0.0 {
        return ahead * behind;
    }
    // Difference of the two half ellipses, from the difference of their squares.
    ahead * 2.0 * slip_fraction / (behind + from_border.sqrt())
}

/// Slip velocity at X = `position` ∈ [−1, 1] over V A [-].
#[must_use]
pub fn slip_shape(position: f64, slip_fraction: f64) -> f64 {
    let to_border = (2.0 * slip_fraction - 1.0 - position).max(0.0);
    ((1.0 - position) * to_border).sqrt()
}

/// Largest value of [`traction_shape`]: at the centre of the strip if the centre slips, otherwise
/// at the border of the stick zone.
#[must_use]
pub fn largest_traction_shape(slip_fraction: f64) -> f64 {
    if slip_fraction >= 0.5 { 1.0 } else { 2.0 * (slip_fraction * (1.0 - slip_fraction)).sqrt() }
}

/// Largest value of [`slip_shape`], at the trailing edge.
#[must_use]
pub fn largest_slip_shape(slip_fraction: f64) -> f64 {
    2.0 * slip_fraction.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hertz::elliptic_contact;
    use numerics::quadrature::simpson;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    const STEEL: f64 = 2.0 * 0.91 / 210e9;
    /// Table 2 of Naeimi et al., with f = 0.6.
    const FRICTION: f64 = 0.6;
    const SEMI_AXIS_A: f64 = 7.98e-3;
    const MAX_PRESSURE: f64 = 1352e6;

    /// Creepages of the table in question, to the printed digits.
    #[test]
    fn creepages_of_the_pressure_law() {
        let prefactor = prefactor_by_pressure(FRICTION, MAX_PRESSURE, STEEL);
        for (mu, expected) in
            [(0.58, 1.149e-2), (0.5, 0.832e-2), (0.4, 0.594e-2), (0.3, 0.412e-2), (0.2, 0.258e-2)]
        {
            let creep = creep(prefactor, mu / FRICTION);
            assert!((creep - expected).abs() < 0.5001e-5, "{mu}: {creep}");
        }
    }

    /// This test fails with the printed eq. 18, in which both forms are equal.
    #[test]
    fn the_two_laws_differ_for_an_elliptic_patch() {
        let by_radius = prefactor_by_radius(FRICTION, SEMI_AXIS_A, 0.46);
        let by_pressure = prefactor_by_pressure(FRICTION, MAX_PRESSURE, STEEL);
        assert!((creep(by_radius, 0.58 / FRICTION) - 0.85e-2).abs() < 5e-5);
        assert!((creep(by_pressure, 0.58 / FRICTION) - 1.15e-2).abs() < 5e-5);
        assert!((by_pressure / by_radius - 1.35).abs() < 5e-3);
    }

    /// Tolerance: the distance of an ellipse of aspect ratio 1000 from a line contact.
    #[test]
    fn the_two_laws_agree_for_a_line_contact() {
        let line = elliptic_contact(0.5 / 0.46, 1e-7, 134e3, STEEL);
        let by_radius = prefactor_by_radius(FRICTION, line.semi_axis_a, 0.46);
        let by_pressure = prefactor_by_pressure(FRICTION, line.max_pressure, STEEL);
        assert!((by_pressure / by_radius - 1.0).abs() < 1e-4, "{}", by_pressure / by_radius);
    }

    /// The friction power of a strip is exactly V s F. Tolerance: the quadrature, and the digits
    /// that X = −1 + u loses in a small slip zone.
    #[test]
    fn force_and_power_of_a_strip() {
        for fraction in [0.01, 0.1, 0.3, 0.5, 0.8, 0.999, 1.0] {
            let border = 2.0 * fraction - 1.0;
            let traction = |x: f64| traction_shape(x, fraction);
            let force = simpson(-1.0, border, traction) + simpson(border, 1.0, traction);
            let expected = 0.5 * PI * force_ratio(fraction);
            assert!((force / expected - 1.0).abs() < 1e-9, "{fraction}: {force} {expected}");
            let power = simpson(-1.0, border, |x| traction(x) * slip_shape(x, fraction));
            assert!((power / (fraction * expected) - 1.0).abs() < 1e-9, "{fraction}: {power}");
        }
    }

    /// The shapes in their usual form, with k. Tolerance: the cancellation in that form.
    #[test]
    fn shapes_in_the_usual_form() {
        for (x, k) in [(-0.9, 0.3f64), (0.2, 0.3), (0.9, 0.3), (-0.9, 0.8), (-0.5, 0.8), (0.7, 0.8)]
        {
            let m = 1.0 - k;
            let stick = 1.0 - ((x - (1.0 - k)) / k).powi(2);
            let traction = (1.0 - x * x).sqrt() - k * stick.max(0.0).sqrt();
            assert!((traction_shape(x, m) - traction).abs() < 1e-14, "{x} {k}");
            let (xi, centre) = (-x, k - 1.0);
            let slip = if stick > 0.0 { 0.0 } else { ((xi - centre).powi(2) - k * k).sqrt() };
            assert!((slip_shape(x, m) - slip).abs() < 1e-14, "{x} {k}");
        }
    }

    #[test]
    fn full_slip_is_twice_the_mean_at_the_trailing_edge() {
        assert_eq!(slip_shape(-1.0, 1.0), 2.0);
        assert_eq!(slip_shape(0.0, 1.0), 1.0);
        assert_eq!(slip_shape(1.0, 1.0), 0.0);
        assert_eq!(largest_slip_shape(1.0), 2.0);
    }

    proptest! {
        /// Tolerance: rounding.
        #[test]
        fn force_and_slip_fraction_are_inverse(ratio in 0.0..=1.0) {
            let fraction = slip_fraction(ratio);
            prop_assert!((force_ratio(fraction) - ratio).abs() < 4e-16);
            prop_assert!((0.0..=1.0).contains(&fraction));
        }

        /// Coulomb's law: the traction is never above the bound, is at the bound in the slip zone,
        /// and slip is zero in the stick zone; the largest values are not exceeded. Tolerance:
        /// rounding.
        #[test]
        fn bounds(x in -1.0..1.0f64, fraction in 0.0..=1.0) {
            let bound = (1.0 - x * x).sqrt();
            let (traction, slip) = (traction_shape(x, fraction), slip_shape(x, fraction));
            prop_assert!(traction <= bound * (1.0 + 1e-12));
            prop_assert!(slip == 0.0 || (traction / bound - 1.0).abs() < 1e-12);
            prop_assert!(traction <= largest_traction_shape(fraction) * (1.0 + 1e-12));
            prop_assert!(slip <= largest_slip_shape(fraction) * (1.0 + 1e-12));
        }
    }

    /// The largest values are attained. Tolerance: rounding at the border.
    #[test]
    fn largest_values_are_attained() {
        for fraction in [0.01f64, 0.3, 0.5, 0.7, 1.0] {
            let place = (2.0 * fraction - 1.0).min(0.0);
            let traction = traction_shape(place, fraction);
            assert!((traction / largest_traction_shape(fraction) - 1.0).abs() < 1e-7);
            let slip = slip_shape(-1.0, fraction);
            assert!((slip / largest_slip_shape(fraction) - 1.0).abs() < 1e-15);
        }
    }
}
