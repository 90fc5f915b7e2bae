//! Force of a fully sliding elliptic contact whose friction is cut off at a largest traction.
//!
//! The traction is |p_t| = min(g, τ), with a bound g of height g₀ at the centre. For friction that
//! varies across the contact, g₀(y) = f(y) p₀. With η = √(1 − y²/b²) and X = x/(a η), over strips
//! of half length a η:
//!
//! - half ellipse, g = g₀ η √(1 − X²): with t = τ/(g₀ η) < 1 and c = √(1 − t²) a strip carries 2 a
//!   η [τ c + g₀ η (arccos c − c t)/2];
//! - parabola, g = (4/3) g₀ η² (1 − X²), of the same sum: with G = (4/3) g₀ η², t = τ/G < 1 and
//!   c = √(1 − t) a strip carries 2 a η [τ c + G (2/3 − c + c³/3)].
//!
//! Where τ is not reached, strips carry (π/2) a g₀ η² and (16/9) a g₀ η³. For uniform f the sums
//! over the strips, as shares of f N with t = τ/(f p₀), are (3t − t³)/2 for t < 1 under the half
//! ellipse, and (3/2) t (1 − 3t/8) for t < 4/3 under the parabola; otherwise 1. Derived here.

use std::f64::consts::{FRAC_PI_2, PI};

/// Shape of the traction bound of friction over the ellipse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// The friction coefficient times Hertz's pressure.
    HalfEllipse,
    /// Kalker's parabola of the same sum.
    Parabola,
}

/// Share of f N that a contact carries under uniform friction, for a largest traction over f p₀
/// [-].
#[must_use]
pub fn force_share(shape: Shape, largest: f64) -> f64 {
    match shape {
        Shape::HalfEllipse => {
            let t = largest.min(1.0);
            0.5 * (3.0 * t - t.powi(3))
        }
        Shape::Parabola => {
            let t = largest.min(4.0 / 3.0);
            1.5 * t * (1.0 - 0.375 * t)
        }
    }
}

/// Force [N] on an ellipse of semi-axes a, b [m] and peak pressure p₀ [Pa], with friction
/// coefficients over y and a largest traction τ [Pa]. The sum over y is the midpoint rule in the
/// angle of the strips: exact to rounding for a smooth f, of first order for an f with steps.
#[must_use]
pub fn force(
    shape: Shape,
    [semi_axis_a, semi_axis_b]: [f64; 2],
    max_pressure: f64,
    friction: impl Fn(f64) -> f64,
    largest: f64,
) -> f64 {
    const STRIPS: usize = 4000;
    let strip = |index: usize| {
        let angle = PI * ((index as f64 + 0.5) / STRIPS as f64 - 0.5);
        let (y, eta) = (semi_axis_b * angle.sin(), angle.cos());
        let height = friction(y) * max_pressure;
        let width = semi_axis_b * eta * PI / STRIPS as f64;
        width * 2.0 * semi_axis_a * eta * half_strip(shape, height * eta, eta, largest)
    };
    (0..STRIPS).map(strip).sum()
}

/// ∫ min(g, τ) dX over half a strip, whose half ellipse has this height [Pa].
fn half_strip(shape: Shape, height: f64, eta: f64, largest: f64) -> f64 {
    match shape {
        Shape::HalfEllipse => {
            let t = largest / height;
            if t >= 1.0 {
                return 0.5 * FRAC_PI_2 * height;
            }
            let c = (1.0 - t * t).sqrt();
            largest * c + 0.5 * height * (c.acos() - c * t)
        }
        Shape::Parabola => {
            let height = 4.0 / 3.0 * height * eta;
            let t = largest / height;
            if t >= 1.0 {
                return 2.0 / 3.0 * height;
            }
            let c = (1.0 - t).sqrt();
            largest * c + height * (2.0 / 3.0 - c + c.powi(3) / 3.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums over strips equal the shares under uniform friction. For friction that varies over y
    /// without cut-off they equal the share of its mean. Tolerance: the midpoint rule at the border
    /// of the cut-off.
    #[test]
    fn strips_and_whole() {
        let [a, b, pressure, friction] = [3e-3, 5e-3, 1e9, 0.4];
        let load = 2.0 / 3.0 * PI * a * b * pressure;
        for shape in [Shape::HalfEllipse, Shape::Parabola] {
            for share in [1e-3, 0.2, 0.7, 0.99, 1.2, 1.4, f64::INFINITY] {
                let largest = share * friction * pressure;
                let found = force(shape, [a, b], pressure, |_| friction, largest);
                let expected = friction * load * force_share(shape, share);
                assert!((found / expected - 1.0).abs() < 1e-6, "{shape:?} {share}: {found}");
            }
            let tilted = |y: f64| friction * (1.0 + 0.5 * y / b);
            let found = force(shape, [a, b], pressure, tilted, f64::INFINITY);
            assert!((found / (friction * load) - 1.0).abs() < 1e-6, "{shape:?}: {found}");
        }
    }
}
