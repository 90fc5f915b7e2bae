//! Moments of the conduction kernel over an interval of the past.
//!
//! M_p = ∫_{τ₁}^{τ₂} (τ − τ₁)^p e^(−c²/τ) dτ/√τ for p = 0, 1, 2, where τ is the age [s] and
//! c = z/(2√κ) [√s] the depth (any consistent units).
//!
//! On the surface (c = 0) with u = √τ₁ and d = √τ₂ − √τ₁ = (τ₂ − τ₁)/(√τ₁ + √τ₂):
//!
//! M₀ = 2d,  M₁ = 2ud² + ⅔d³,  M₂ = (8/3)u²d³ + 2ud⁴ + ⅖d⁵,
//!
//! sums of positive terms, exact to rounding both near and far.
//!
//! In depth, from zero age, the closed forms are J₀ = 2√τ e^(−c²/τ) − 2c√π erfc(c/√τ) and
//! J_p = (τ^(p+½) e^(−c²/τ) − c² J_(p−1))/(p + ½). Intervals that begin at less than twice their
//! length take differences of these forms. Later intervals would lose digits, but there the kernel
//! is smooth, and Gauss quadrature is exact to rounding. The kernel is analytic except at age 0,
//! and at most 1/√|τ| where the real part of the age is positive. For an interval that begins at r
//! times its length the error of N points falls like ϱ^(−2N) with ϱ = 1 + 2r + 2√(r(r + 1)); later
//! intervals need fewer points.

use numerics::quadrature::points_of;
use std::f64::consts::PI;

/// Start of an interval, in multiples of its length, from which quadrature is used.
const SMOOTH_FROM: f64 = 2.0;

/// Returns M₀, M₁, M₂ over the ages from `from` ≥ 0 to `to` at the depth c ≥ 0.
#[must_use]
pub fn kernel_moments(from: f64, to: f64, depth: f64) -> [f64; 3] {
    if depth == 0.0 {
        surface(from, to)
    } else if from > SMOOTH_FROM * (to - from) {
        smooth(from, to, depth)
    } else {
        closed(from, to, depth)
    }
}

fn surface(from: f64, to: f64) -> [f64; 3] {
    let u = from.sqrt();
    let d = (to - from) / (u + to.sqrt());
    let square = d * d;
    [
        2.0 * d,
        2.0 * square * (u + d / 3.0),
        2.0 * square * d * (4.0 / 3.0 * u * u + u * d + square / 5.0),
    ]
}

/// Returns the number of points that integrate an interval to rounding, which begins at `start`
/// times its length: ϱ^(−2N) is below 1e-17.
fn enough(start: f64) -> usize {
    match start {
        _ if start > 25.0 => 5,
        _ if start > 10.0 => 6,
        _ if start > 5.0 => 7,
        _ => 9,
    }
}

fn smooth(from: f64, to: f64, depth: f64) -> [f64; 3] {
    let mut moments = [0.0; 3];
    for (age, weight) in points_of(enough(from / (to - from)), from, to) {
        let kernel = weight * (-depth * depth / age).exp() / age.sqrt();
        let since = age - from;
        moments[0] += kernel;
        moments[1] += kernel * since;
        moments[2] += kernel * since * since;
    }
    moments
}

fn closed(from: f64, to: f64, depth: f64) -> [f64; 3] {
    let (upper, lower) = (from_zero(to, depth), from_zero(from, depth));
    let [j0, j1, j2]: [f64; 3] = std::array::from_fn(|p| upper[p] - lower[p]);
    [j0, j1 - from * j0, j2 - from * (2.0 * j1 - from * j0)]
}

/// Returns J₀, J₁, J₂: the moments of the age itself, from zero age to `to`.
fn from_zero(to: f64, depth: f64) -> [f64; 3] {
    if to == 0.0 {
        return [0.0; 3];
    }
    let (root, square) = (to.sqrt(), depth * depth);
    let decay = (-square / to).exp();
    let j0 = 2.0 * root * decay - 2.0 * depth * PI.sqrt() * libm::erfc(depth / root);
    let j1 = (to * root * decay - square * j0) / 1.5;
    let j2 = (to * to * root * decay - square * j1) / 2.5;
    [j0, j1, j2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::integrate;

    /// Reference: quadrature in √τ on many panels, finer towards the lower end.
    fn slow(from: f64, to: f64, depth: f64, power: i32) -> f64 {
        let (low, high) = (from.sqrt(), to.sqrt());
        let edge = |panel: i32| low + (high - low) * 0.6_f64.powi(panel);
        (0..70)
            .map(|panel| {
                integrate(edge(panel + 1), edge(panel), |u| {
                    2.0 * (u * u - from).powi(power) * (-depth * depth / (u * u)).exp()
                })
            })
            .sum()
    }

    #[test]
    fn agree_with_quadrature_near_and_far_shallow_and_deep() {
        let late = [2.01, 5.01, 10.01, 25.01, 1000.5].map(|from| (from, from + 1.0));
        for (from, to) in [(0.0, 0.5), (0.1, 0.5), (0.5, 1.5)].into_iter().chain(late) {
            for depth in [0.0, 1e-3, 0.3, 1.0, 4.0] {
                let got = kernel_moments(from, to, depth);
                for (power, value) in got.iter().enumerate() {
                    let expected = slow(from, to, depth, power as i32);
                    // Rounding, relative to the moment at the surface: deep moments are small
                    // differences, and the quadrature in √τ loses the digits of u² − from.
                    let scale = slow(from, to, 0.0, power as i32);
                    let error = (value - expected).abs() / scale;
                    assert!(error < 3e-13, "{from} {to} {depth} {power}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn tiny_pieces_keep_their_digits() {
        // The interval is 1e-9 of the age: the mean value theorem gives the moments to that order.
        let [m0, m1, m2] = kernel_moments(1.0, 1.0 + 1e-9, 0.0);
        let width = (1.0 + 1e-9) - 1.0;
        assert!((m0 / width - 1.0).abs() < 1e-9);
        assert!((m1 / (width * width / 2.0) - 1.0).abs() < 1e-9);
        assert!((m2 / (width.powi(3) / 3.0) - 1.0).abs() < 1e-9);
    }
}
