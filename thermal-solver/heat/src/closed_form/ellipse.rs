//! Exact elliptic heat flux √(1 − ξ²) in steady motion.
//!
//! The surface temperature is T(ξ) = q₀/β · √(a/(πV)) · E(ξ) with
//!
//! E(ξ) = ∫₋₁^min(ξ,1) √(1 − ξ'²) dξ'/√(ξ − ξ').
//!
//! Inside the contact the substitution ξ − ξ' = (1 + ξ) sin²φ gives E = (1 + ξ) ∫₀^π cos²φ
//! √(1 − ξ + (1 + ξ) sin²φ) dφ; behind it ξ' = −cos φ gives E = ∫₀^π sin²φ/√(ξ + cos φ) dφ. Both
//! integrands are smooth and periodic, so that the trapezoidal rule converges faster than any power
//! of the step, except at the trailing edge itself. The step is halved until the result no longer
//! changes. The maximum is 2.18830667 at ξ = 0.652229532.

use numerics::search::maximum;
use std::f64::consts::PI;

const LARGEST_RULE: usize = 1 << 20;

/// Returns E(ξ) [-], with a relative error below 1e-14 except within 1e-3 of ξ = 1, where the error
/// is below 1e-9.
#[must_use]
pub fn surface(xi: f64) -> f64 {
    if xi <= -1.0 {
        0.0
    } else if xi < 1.0 {
        periodic(|phi| {
            let (sin, cos) = phi.sin_cos();
            (1.0 + xi) * cos * cos * (1.0 - xi + (1.0 + xi) * sin * sin).sqrt()
        })
    } else {
        periodic(|phi| {
            let (sin, cos) = phi.sin_cos();
            // At the trailing edge the quotient tends to 0 with the sine.
            if sin == 0.0 { 0.0 } else { sin * sin / (xi + cos).sqrt() }
        })
    }
}

/// Returns the position ξ and the value of the maximum of E.
#[must_use]
pub fn peak() -> (f64, f64) {
    maximum(0.5, 0.8, surface)
}

/// Integrates over one period [0, π] by the trapezoidal rule, doubling the intervals until the
/// result settles.
fn periodic(f: impl Fn(f64) -> f64) -> f64 {
    let mut intervals = 16_usize;
    let at = |i: usize, n: usize| f(PI * i as f64 / n as f64);
    let mut sum: f64 = (0..intervals).map(|i| at(i, intervals)).sum();
    let mut value = sum * PI / intervals as f64;
    while intervals < LARGEST_RULE {
        let n = 2 * intervals;
        sum += (1..n).step_by(2).map(|i| at(i, n)).sum::<f64>();
        let finer = sum * PI / n as f64;
        let settled = (finer - value).abs() <= 4.0 * f64::EPSILON * finer.abs();
        (intervals, value) = (n, finer);
        if settled {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maximum_is_the_known_one() {
        let (xi, value) = peak();
        // References have nine figures; a maximum is located to the root of the rounding error.
        assert!((value - 2.188_306_67).abs() < 5e-9, "{value}");
        assert!((xi - 0.652_229_532).abs() < 2e-8, "{xi}");
    }

    #[test]
    fn zero_ahead_and_a_line_source_far_behind() {
        assert_eq!(surface(-1.5), 0.0);
        // Heat π/2 at the centre; the next term is (1/4)(3/8)/ξ² of the first.
        let far = surface(1e4) / (PI / 2.0 / 1e2);
        assert!((far - 1.0).abs() < 2e-9, "{far}");
    }

    #[test]
    fn continuous_at_the_trailing_edge() {
        // The slope is finite there up to a logarithm: a step of 1e-9 changes E by less than 1e-7.
        assert!((surface(1.0 - 1e-9) - surface(1.0)).abs() < 1e-7);
        assert!((surface(1.0 + 1e-9) - surface(1.0)).abs() < 1e-7);
    }
}
