//! Modified Bessel functions K₀ and K₁.
//!
//! For x ≤ 2: the series with ln x (Abramowitz and Stegun 9.6.11, 9.6.13). Beyond: Chebyshev series
//! in 4/x − 1 of √x eˣ K_ν(x). Their coefficients are computed once, by the trapezoidal rule on
//! K_ν(x) = ∫₀^∞ e^{−x cosh t} cosh νt dt (9.6.24), which converges faster than any power of its
//! step. Relative errors are below 1e-14.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// Argument above which the Chebyshev series is used.
const LARGE: f64 = 2.0;
/// Step of the trapezoidal rule at x = 2; the width of the integrand is proportional to 1/√x.
const STEP: f64 = 0.125;
/// e^{−NOTHING} is negligible beside one.
const NOTHING: f64 = 38.0;
/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;
/// Number of terms of the series with ln x: (x²/4)^m/m!² is negligible beyond.
const TERMS: usize = 12;
/// Number of terms of the Chebyshev series.
const CHEBYSHEV: usize = 26;

/// Coefficients of (x²/4)^m in I₀ and in 2I₁/x, and in the two sums beside the logarithm.
static SERIES: LazyLock<[[f64; 4]; TERMS]> = LazyLock::new(|| {
    let mut terms = [[0.0; 4]; TERMS];
    let (mut square, mut harmonic) = (1.0, 0.0);
    for (m, term) in terms.iter_mut().enumerate() {
        let m = m as f64;
        if m > 0.0 {
            square /= m * m;
            harmonic += 1.0 / m;
        }
        let inner = square / (m + 1.0);
        *term = [square, inner, square * harmonic, inner * (2.0 * harmonic + 1.0 / (m + 1.0))];
    }
    terms
});

/// Coefficients of the Chebyshev series of √x eˣ K₀ and √x eˣ K₁.
static LARGE_SERIES: LazyLock<[[f64; 2]; CHEBYSHEV]> = LazyLock::new(|| {
    let node = |k: usize| (PI * (k as f64 + 0.5) / CHEBYSHEV as f64).cos();
    let values: [[f64; 2]; CHEBYSHEV] = std::array::from_fn(|k| {
        let x = 2.0 * LARGE / (node(k) + 1.0);
        integral(x).map(|value| value * x.sqrt())
    });
    std::array::from_fn(|n| {
        [0, 1].map(|of| {
            let angle = |k: usize| PI * n as f64 * (k as f64 + 0.5) / CHEBYSHEV as f64;
            let sum: f64 = values.iter().enumerate().map(|(k, v)| v[of] * angle(k).cos()).sum();
            sum * if n == 0 { 1.0 } else { 2.0 } / CHEBYSHEV as f64
        })
    })
});

/// Returns K₀(x) and K₁(x) for x > 0.
#[must_use]
pub fn k0_k1(x: f64) -> [f64; 2] {
    if x > LARGE { large(x).map(|scaled| (-x).exp() * scaled) } else { small(x) }
}

/// Returns eˣ K₀(x) and eˣ K₁(x) for x > 0, which do not underflow for large x.
#[must_use]
pub fn scaled_k0_k1(x: f64) -> [f64; 2] {
    if x > LARGE { large(x) } else { small(x).map(|value| x.exp() * value) }
}

/// eˣ K₀(x) and eˣ K₁(x) by Clenshaw's recurrence.
fn large(x: f64) -> [f64; 2] {
    let u = 2.0 * (2.0 * LARGE / x - 1.0);
    let ([mut a0, mut a1], [mut b0, mut b1]) = ([0.0; 2], [0.0; 2]);
    for [c0, c1] in LARGE_SERIES[1..].iter().rev() {
        (a0, b0) = (u * a0 - b0 + c0, a0);
        (a1, b1) = (u * a1 - b1 + c1, a1);
    }
    let [c0, c1] = LARGE_SERIES[0];
    let factor = 1.0 / x.sqrt();
    [factor * (0.5 * u * a0 - b0 + c0), factor * (0.5 * u * a1 - b1 + c1)]
}

/// eˣ K₀(x) and eˣ K₁(x) by the trapezoidal rule.
fn integral(x: f64) -> [f64; 2] {
    let (mut k0, mut k1) = (0.5, 0.5);
    let length = STEP * (LARGE / x).sqrt();
    for step in 1.. {
        let cosh = (f64::from(step) * length).cosh();
        let exponent = x * (cosh - 1.0);
        if exponent > NOTHING {
            break;
        }
        let value = (-exponent).exp();
        k0 += value;
        k1 += value * cosh;
    }
    [length * k0, length * k1]
}

fn small(x: f64) -> [f64; 2] {
    let square = 0.25 * x * x;
    let logarithm = (0.5 * x).ln() + EULER;
    let [mut i0, mut i1, mut beside_i0, mut beside_i1] = [0.0; 4];
    for [a, b, c, d] in SERIES.iter().rev() {
        i0 = i0 * square + a;
        i1 = i1 * square + b;
        beside_i0 = beside_i0 * square + c;
        beside_i1 = beside_i1 * square + d;
    }
    let k1 = 1.0 / x + 0.5 * x * (logarithm * i1 - 0.5 * beside_i1);
    [beside_i0 - logarithm * i0, k1]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz and Stegun, table 9.8.
    #[test]
    fn tabulated_values() {
        for (x, k0, k1) in [
            (0.1, 2.427_069_024_702_017, 9.853_844_780_870_606),
            (1.0, 0.421_024_438_240_708_34, 0.601_907_230_197_234_6),
            (2.0, 0.113_893_872_749_533_43, 0.139_865_881_816_522_43),
            (2.000_001, 0.113_893_732_884, 0.139_865_698_0),
            (5.0, 3.691_098_334_042_594e-3, 4.044_613_445_452_164e-3),
        ] {
            let [a, b] = k0_k1(x);
            assert!((a / k0 - 1.0).abs() < 1e-8 && (b / k1 - 1.0).abs() < 1e-8, "{x}: {a} {b}");
        }
    }

    /// On both sides of the limit between the methods, and the Chebyshev series against its
    /// integral.
    #[test]
    fn both_methods_agree() {
        for x in [2.0, 2.000_1, 2.7, 4.4, 9.0, 33.0, 400.0] {
            let (one, other) = (scaled_k0_k1(x), integral(x));
            for k in 0..2 {
                assert!((one[k] / other[k] - 1.0).abs() < 3e-14, "{x}: {one:?} {other:?}");
            }
        }
    }

    #[test]
    fn scaled_values_stay_where_others_vanish() {
        for x in [0.1, 1.9, 2.1, 40.0] {
            let pairs = k0_k1(x).into_iter().zip(scaled_k0_k1(x));
            assert!(
                pairs.into_iter().all(|(k, scaled)| (k * x.exp() / scaled - 1.0).abs() < 1e-14)
            );
        }
        // √(π/2x) (1 − 1/8x), (1 + 3/8x) for large x.
        let x: f64 = 1e6;
        let leading = (0.5 * PI / x).sqrt();
        for (value, first) in scaled_k0_k1(x).into_iter().zip([-0.125, 0.375]) {
            assert!((value / leading / (1.0 + first / x) - 1.0).abs() < 1e-12);
        }
    }
}
