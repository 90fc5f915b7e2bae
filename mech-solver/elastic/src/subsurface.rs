//! Stresses below Hertz contacts, frictionless and sliding.
//!
//! Frame and signs follow `half_space::subsurface`: z into the body, tractions on that body,
//! tension positive. Sliding means a traction q = q_0/p_0 · p along x everywhere.
//!
//! Line contact, p = p_0 √(1 − x²/a²), with (n + im)² = (x + iz)² − a², m ≥ 0, n of the sign of x,
//! and the shapes
//!
//! - S_xx = m (1 + (z² + n²)/(m² + n²)) − 2z,
//! - S_zz = m (1 − (z² + n²)/(m² + n²)),
//! - S_xz = n (m² − z²)/(m² + n²),
//!
//! the stresses are
//!
//! - σ_xx = −(p_0/a) S_xx + (q_0/a) [2(n − x) + S_xz],
//! - σ_zz = −(p_0/a) S_zz − (q_0/a) S_xz,
//! - σ_xz = −(p_0/a) S_xz − (q_0/a) S_xx,
//! - σ_yy = ν (σ_xx + σ_zz), plane strain.
//!
//! Circular contact, p = p_0 √(1 − r²/a²), on the axis with t = 1 − (z/a) arctan(a/z) and
//! w = 1/(1 + z²/a²):
//!
//! - σ_zz = −p_0 w,
//! - σ_xx = σ_yy = −p_0 [(1 + ν) t − w/2],
//! - σ_xz = −q_0 [3t/2 − w/2], the other components zero.
//!
//! Source: K. L. Johnson, Contact Mechanics (1985), eq. 3.45 (circle), 4.49 and §7.1 (line, after
//! McEwen 1949). σ_xz on the axis is not printed there. It follows from the kernel −3x²z/(2πR⁵),
//! which for ν = ½ gives the same integral as σ_xx under pressure.

use crate::Stress;

/// Stress below a line contact of half-width `semi_axis_a` [m], at (x, depth) from its centre [m],
/// under `max_pressure` p_0 and `max_traction` q_0 [Pa].
///
/// Returns NaN at the edges x = ±a on the surface, which belong to neither side.
#[must_use]
pub fn line_contact(
    semi_axis_a: f64,
    max_pressure: f64,
    max_traction: f64,
    poisson_ratio: f64,
    [x, depth]: [f64; 2],
) -> Stress {
    let (x, z) = (x / semi_axis_a, depth / semi_axis_a);
    let real = x * x - z * z - 1.0;
    let modulus = real.hypot(2.0 * x * z);
    // The smaller of m² and n² follows from their product x²z², free of cancellation.
    let larger = 0.5 * (modulus + real.abs());
    let smaller = if x * z == 0.0 { 0.0 } else { (x * z).powi(2) / larger };
    let (m_square, n_square) = if real > 0.0 { (smaller, larger) } else { (larger, smaller) };
    let (m, n) = (m_square.sqrt(), n_square.sqrt().copysign(x));
    let quotient = (z * z + n_square) / modulus;
    let shape_xx = m * (1.0 + quotient) - 2.0 * z;
    let shape_zz = m * (1.0 - quotient);
    let shape_xz = n * (m_square - z * z) / modulus;
    let xx = -max_pressure * shape_xx + max_traction * (2.0 * (n - x) + shape_xz);
    let zz = -max_pressure * shape_zz - max_traction * shape_xz;
    let xz = -max_pressure * shape_xz - max_traction * shape_xx;
    Stress { xx, yy: poisson_ratio * (xx + zz), zz, xz, ..Stress::default() }
}

/// Stress on the axis of a circular contact of radius `semi_axis_a` at a depth [m], under
/// `max_pressure` p_0 and `max_traction` q_0 along x [Pa].
#[must_use]
pub fn circular_contact_axis(
    semi_axis_a: f64,
    max_pressure: f64,
    max_traction: f64,
    poisson_ratio: f64,
    depth: f64,
) -> Stress {
    let z = depth / semi_axis_a;
    let t = 1.0 - z * 1.0_f64.atan2(z);
    let w = 1.0 / (1.0 + z * z);
    let across = -max_pressure * ((1.0 + poisson_ratio) * t - 0.5 * w);
    Stress {
        xx: across,
        yy: across,
        zz: -max_pressure * w,
        xz: -max_traction * (1.5 * t - 0.5 * w),
        ..Stress::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::simpson;
    use std::f64::consts::PI;

    /// Argument in (0, 2) at which a function is largest, and the value, by golden section.
    fn largest(function: impl Fn(f64) -> f64) -> (f64, f64) {
        let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (0.05, 2.0);
        for _ in 0..60 {
            let (one, other) = (high - ratio * (high - low), low + ratio * (high - low));
            if function(one) > function(other) { high = other } else { low = one }
        }
        (low, function(low))
    }

    /// Textbook values of Johnson, §3.4 and Table 4.1. Tolerance: their digits.
    #[test]
    fn textbook_maxima() {
        let circle = |z: f64| circular_contact_axis(1.0, 1.0, 0.0, 0.3, z);
        let (depth, shear) = largest(|z| circle(z).max_shear());
        assert!((depth - 0.48).abs() < 5e-3 && (shear - 0.31).abs() < 5e-3, "{depth} {shear}");
        let (_, mises) = largest(|z| circle(z).von_mises());
        assert!((mises - 0.62).abs() < 5e-3, "{mises}");
        let line = |z: f64| line_contact(1.0, 1.0, 0.0, 0.3, [0.0, z]);
        let (depth, shear) = largest(|z| line(z).max_shear());
        assert!((depth - 0.786).abs() < 5e-4 && (shear - 0.300).abs() < 5e-4, "{depth} {shear}");
        let (depth, mises) = largest(|z| line(z).von_mises());
        assert!((depth - 0.70).abs() < 1e-2 && (mises - 0.558).abs() < 5e-3, "{depth} {mises}");
    }

    /// On the axis of a line contact (Johnson, eq. 4.46): σ_zz = −p_0 (1 + z²)^-½ and
    /// σ_xx = −p_0 [(1 + 2z²)(1 + z²)^-½ − 2z]. Tolerance: rounding.
    #[test]
    fn axis_of_a_line_contact() {
        for z in [0.0, 1e-3, 0.3, 1.0, 5.0_f64] {
            let root = (1.0 + z * z).sqrt();
            let stress = line_contact(2.0, 3.0, 0.0, 0.25, [0.0, 2.0 * z]);
            let xx = -3.0 * ((1.0 + 2.0 * z * z) / root - 2.0 * z);
            assert!((stress.xx - xx).abs() < 1e-14 && (stress.zz + 3.0 / root).abs() < 1e-14);
            assert!(stress.xz.abs() < 1e-14);
        }
    }

    /// Agrees with sums of line loads: 2D kernels −(2/π) x_i x_j (x·f)/R⁴. Tolerance: the
    /// quadrature.
    #[test]
    fn line_contact_equals_quadrature() {
        let kernel = |x: f64, z: f64, i: i32| {
            simpson(-1.0, 1.0, |s| {
                let square = (x - s).powi(2) + z * z;
                let root = (1.0 - s * s).sqrt();
                -2.0 / PI * root * (x - s).powi(i) * z.powi(3 - i) / (square * square)
            })
        };
        for (x, z) in [(0.0, 0.4), (0.6, 0.3), (-0.9, 0.2), (1.7, 0.5), (-3.0, 2.0)] {
            let stress = line_contact(1.0, 1.0, 0.7, 0.3, [x, z]);
            let [zzz, xzz, xxz, xxx] = [0, 1, 2, 3].map(|i| kernel(x, z, i));
            let expected = [xxz + 0.7 * xxx, zzz + 0.7 * xzz, xzz + 0.7 * xxz];
            for (value, expected) in [stress.xx, stress.zz, stress.xz].iter().zip(expected) {
                assert!((value - expected).abs() < 1e-9, "{x} {z}: {value} {expected}");
            }
        }
    }

    /// Agrees with rings of point loads. Tolerance: the quadrature.
    #[test]
    fn axis_of_a_circular_contact_equals_quadrature() {
        let nu = 0.3;
        for z in [0.2, 0.48, 1.0, 3.0_f64] {
            let over_rings = |kernel: &dyn Fn(f64, f64) -> f64| {
                simpson(0.0, 1.0, |r| r * (1.0 - r * r).sqrt() * kernel(r, r.hypot(z)))
            };
            let zz = over_rings(&|_, rho| -3.0 * z.powi(3) / rho.powi(5));
            // Half the sum of the radial and the hoop stress (Johnson, eq. 3.20).
            let xx = over_rings(&|r, rho| {
                -1.5 * z * r * r / rho.powi(5) + 0.5 * (1.0 - 2.0 * nu) * z / rho.powi(3)
            });
            let xz = over_rings(&|r, rho| -1.5 * z * r * r / rho.powi(5));
            let stress = circular_contact_axis(1.0, 1.0, 0.5, nu, z);
            for (value, expected) in [(stress.zz, zz), (stress.xx, xx), (stress.xz, 0.5 * xz)] {
                assert!((value - expected).abs() < 1e-9, "{z}: {value} {expected}");
            }
        }
    }

    /// On the surface the stresses equal the tractions, and σ_xx changes from −2f p_0 at the
    /// leading edge of the traction to +2f p_0 behind it (Johnson, eq. 7.5). Tolerance: rounding.
    #[test]
    fn surface_of_a_sliding_line_contact() {
        let at = |x: f64| line_contact(1.0, 1.0, 0.3, 0.3, [x, 0.0]);
        for x in [-0.9, -0.2, 0.0, 0.5_f64] {
            let pressure = (1.0 - x * x).sqrt();
            let stress = at(x);
            assert!((stress.zz + pressure).abs() < 1e-15);
            assert!((stress.xz + 0.3 * pressure).abs() < 1e-15);
            assert!((stress.xx + pressure + 0.6 * x).abs() < 1e-15);
        }
        assert_eq!((at(1.5).zz, at(-1.5).xz), (0.0, 0.0));
        let next_to = 1.0 + 1e-12;
        assert!((at(-next_to).xx - 0.6).abs() < 1e-5 && (at(next_to).xx + 0.6).abs() < 1e-5);
    }
}
