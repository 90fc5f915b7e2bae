//! Formulas of radial basis functions.
//!
//! With p = r/a, the functions are those of preCICE 3, divided by their value at r = 0 or by a
//! power of a. Such a factor does not change an interpolant.
//!
//! | [`Basis`] | φ | positive definite in space |
//! |---|---|---|
//! | `wendland-c0` | (1 − p)²₊ | yes |
//! | `wendland-c2` | (1 − p)⁴₊ (4p + 1) | yes |
//! | `wendland-c4` | (1 − p)⁶₊ (35p² + 18p + 3)/3 | yes |
//! | `wendland-c6` | (1 − p)⁸₊ (32p³ + 25p² + 8p + 1) | yes |
//! | `wendland-c8` | (1 − p)¹⁰₊ (429p⁴ + 450p³ + 210p² + 50p + 5)/5 | yes |
//! | `compact-thin-plate-splines-c2` | 1 − 30p² − 10p³ + 45p⁴ − 6p⁵ − 60p³ log p, 0 beyond p = 1 | yes |
//! | `gaussian` | 10^(−9p²) | yes |
//! | `multiquadrics` | √(1 + p²) | with a constant polynomial |
//! | `inverse-multiquadrics` | 1/√(1 + p²) | yes |
//! | `thin-plate-splines` | p² log p | with a linear polynomial |
//! | `volume-splines` | p | with a constant polynomial |
//!
//! For the two splines a is the extent of the points. The length then scales the linear system and
//! has no influence on the interpolant: a² p² log p differs from r² log r by a multiple of r². The
//! constraints on the coefficients turn this multiple into a linear function, as long as the
//! polynomial has every direction that the points span.
//!
//! Sources: H. Wendland, *Adv. Comput. Math.* 4 (1995) 389–396; M. D. Buhmann, *Proc. AMS* 129
//! (2001) 2147–2154 (compact function with a logarithm); R. L. Hardy, *J. Geophys. Res.* 76 (1971)
//! 1905–1915 (multiquadrics); J. Duchon, *Lect. Notes Math.* 571 (1977) 85–100 (splines).

use crate::settings::{Basis, Kernel};

impl Basis {
    /// Returns φ at p = r/a.
    pub(super) fn value(self, p: f64) -> f64 {
        let beyond = (1.0 - p).max(0.0);
        match self {
            Self::WendlandC0 => beyond.powi(2),
            Self::WendlandC2 => beyond.powi(4) * (4.0 * p + 1.0),
            Self::WendlandC4 => beyond.powi(6) * ((35.0 / 3.0 * p + 6.0) * p + 1.0),
            Self::WendlandC6 => beyond.powi(8) * (((32.0 * p + 25.0) * p + 8.0) * p + 1.0),
            Self::WendlandC8 => {
                beyond.powi(10) * ((((85.8 * p + 90.0) * p + 42.0) * p + 10.0) * p + 1.0)
            }
            Self::CompactThinPlateSplinesC2 if p >= 1.0 => 0.0,
            Self::CompactThinPlateSplinesC2 => {
                let smooth = ((-6.0 * p + 45.0) * p - 10.0) * p - 30.0;
                1.0 + (smooth - 60.0 * p_log_p(p)) * p * p
            }
            Self::Gaussian => (-9.0 * std::f64::consts::LN_10 * p * p).exp(),
            Self::Multiquadrics => (1.0 + p * p).sqrt(),
            Self::InverseMultiquadrics => 1.0 / (1.0 + p * p).sqrt(),
            Self::ThinPlateSplines => p * p_log_p(p),
            Self::VolumeSplines => p,
        }
    }

    /// Returns the sign of the quadratic form of the function on coefficients that annihilate
    /// linear polynomials.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Multiquadrics | Self::VolumeSplines => -1.0,
            _ => 1.0,
        }
    }
}

/// Returns p log p, continued to p = 0.
fn p_log_p(p: f64) -> f64 {
    if p > 0.0 { p * p.ln() } else { 0.0 }
}

impl Kernel {
    /// Returns whether the function has fallen below a hundredth of its peak at a distance [m].
    pub(super) fn is_small_at(&self, distance: f64) -> bool {
        let radius = self.radius.filter(|_| self.basis.decays());
        radius.is_some_and(|radius| self.basis.value(distance / radius) < 0.01)
    }
}
