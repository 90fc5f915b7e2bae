//! Carlson's symmetric elliptic integrals of the first and second kind.
//!
//! R_F(x, y, z) = ½ ∫₀^∞ dt / √((t+x)(t+y)(t+z))
//!
//! R_D(x, y, z) = 3/2 ∫₀^∞ dt / (√((t+x)(t+y)) · (t+z)^{3/2})
//!
//! Both are homogeneous, of degree −½ and −3/2, and normalised to R_F(1,1,1) = R_D(1,1,1) = 1. At
//! most one of the arguments x, y may be zero; z > 0 in R_D.
//!
//! Source: B. C. Carlson, Numerical computation of real or complex elliptic integrals, Numerical
//! Algorithms 10 (1995) 13–26 (also DLMF §19.36): duplication theorem, then a Taylor series of the
//! fifth degree. No terms cancel, from circular to very long ellipses. Deviation: none; the
//! tolerance is set for double precision.

/// Bound on the relative truncation error of the series [-].
const TRUNCATION: f64 = 1e-17;

/// R_F(x, y, z) of non-negative arguments, at most one of them zero.
#[must_use]
pub fn carlson_rf(x: f64, y: f64, z: f64) -> f64 {
    let (mut x, mut y, mut z) = (x, y, z);
    let start = (x + y + z) / 3.0;
    let (dx, dy) = (start - x, start - y);
    let spread = dx.abs().max(dy.abs()).max((start - z).abs());
    let mut bound = (3.0 * TRUNCATION).powf(-1.0 / 6.0) * spread;
    let (mut mean, mut scale) = (start, 1.0);
    while bound >= mean {
        let shift = duplication_shift(x, y, z);
        [x, y, z, mean] = [x, y, z, mean].map(|v| 0.25 * (v + shift));
        bound *= 0.25;
        scale *= 0.25;
    }
    let (u, v) = (scale * dx / mean, scale * dy / mean);
    let w = -(u + v);
    let (e2, e3) = (u * v - w * w, u * v * w);
    let series = 1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0;
    series / mean.sqrt()
}

/// R_D(x, y, z) of non-negative x and y, at most one of them zero, and positive z.
#[must_use]
pub fn carlson_rd(x: f64, y: f64, z: f64) -> f64 {
    let (mut x, mut y, mut z) = (x, y, z);
    let start = (x + y + 3.0 * z) / 5.0;
    let (dx, dy) = (start - x, start - y);
    let spread = dx.abs().max(dy.abs()).max((start - z).abs());
    let mut bound = (0.25 * TRUNCATION).powf(-1.0 / 6.0) * spread;
    let (mut mean, mut scale, mut sum) = (start, 1.0, 0.0);
    while bound >= mean {
        let shift = duplication_shift(x, y, z);
        sum += scale / (z.sqrt() * (z + shift));
        [x, y, z, mean] = [x, y, z, mean].map(|v| 0.25 * (v + shift));
        bound *= 0.25;
        scale *= 0.25;
    }
    let (u, v) = (scale * dx / mean, scale * dy / mean);
    let w = -(u + v) / 3.0;
    let (uv, ww) = (u * v, w * w);
    let (e2, e3) = (uv - 6.0 * ww, (3.0 * uv - 8.0 * ww) * w);
    let (e4, e5) = (3.0 * (uv - ww) * ww, uv * ww * w);
    let series = 1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0
        - 3.0 * e4 / 22.0
        - 9.0 * e2 * e3 / 52.0
        + 3.0 * e5 / 26.0;
    scale * series / (mean * mean.sqrt()) + 3.0 * sum
}

fn duplication_shift(x: f64, y: f64, z: f64) -> f64 {
    let [x, y, z] = [x, y, z].map(f64::sqrt);
    x * y + x * z + y * z
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Rounding of about ten additions and roots; the truncation is a tenth of it.
    const ROUNDING: f64 = 2e-15;

    #[track_caller]
    fn assert_close(value: f64, expected: f64) {
        assert!((value / expected - 1.0).abs() < ROUNDING, "{value} is not {expected}");
    }

    #[test]
    fn published_values() {
        // Carlson 1995, section 3.
        assert_close(carlson_rf(1.0, 2.0, 0.0), 1.311_028_777_146_059_9);
        assert_close(carlson_rf(2.0, 3.0, 4.0), 0.584_082_841_677_151_7);
        assert_close(carlson_rd(0.0, 2.0, 1.0), 1.797_210_352_103_388_3);
        assert_close(carlson_rd(2.0, 3.0, 4.0), 0.165_105_272_942_610_53);
    }

    #[test]
    fn circular_values() {
        assert_close(carlson_rf(0.0, 1.0, 1.0), PI / 2.0);
        assert_close(carlson_rd(0.0, 1.0, 1.0), 0.75 * PI);
    }

    #[test]
    fn homogeneous() {
        assert_close(carlson_rf(0.0, 3e-8, 2e-3), 1e3 * carlson_rf(0.0, 3e-2, 2e3));
        assert_close(carlson_rd(0.0, 3e-8, 2e-3), 1e9 * carlson_rd(0.0, 3e-2, 2e3));
    }

    /// Legendre's relation E K' + E' K − K K' = π/2 between the complete integrals of complementary
    /// moduli, at any aspect ratio; E from R_D by DLMF 19.25.1.
    #[test]
    fn legendre_relation() {
        let first = |z: f64| carlson_rf(0.0, z, 1.0);
        let second = |z: f64| z / 3.0 * (carlson_rd(0.0, z, 1.0) + carlson_rd(0.0, 1.0, z));
        for exponent in 0..12 {
            let z = 0.7 * 10f64.powi(-exponent);
            let (k, e, k_prime, e_prime) = (first(z), second(z), first(1.0 - z), second(1.0 - z));
            let relation = e * k_prime + e_prime * k - k * k_prime;
            // K grows like ln(4/√z): two terms of up to 25 cancel to π/2, hence ten roundings.
            assert!((relation / (PI / 2.0) - 1.0).abs() < 10.0 * ROUNDING, "{z}: {relation}");
        }
    }
}
