//! Rolling of a rigid cylinder on a viscoelastic half-space, or of two such cylinders, in plane
//! strain.
//!
//! Both bodies have the creep compliance J(t) = J [1 + f (1 − e^{−t/τ})] of a standard linear solid
//! and a common τ. c is the instantaneous compliance (1 − ν²)/E of the pair, R the relative radius,
//! N the load per length, V the speed, l = Vτ. The contact is |x − d| < a, with its middle ahead by
//! d. Outside, the pressure is zero; inside, the displacement is δ − x²/2R. With w the displacement
//! of elastic bodies under the same pressure, u = w + f ∫₀^∞ w(x + s) e^{−s/l} ds/l, so that
//! u − l u' = (1 + f) w − l w'. With λ = l/(1 + f), t = x − d and
//! κ = 1/(2cR(1 + f)) the pressure obeys
//!
//! p − λ p' = q,   ∫ q(s)/(t − s) ds = πκ (t + d − l),
//!
//! q = κ [a² − t² − (d − l) t + C]/√(a² − t²),   N = πκ (a²/2 + C).
//!
//! p vanishes at both ends, hence ∫ q e^{−t/λ} dt = 0. In addition the surface, which enters
//! relaxed, has to meet the cylinder at the leading edge with the cylinder's slope, C K₀(a/l) = a d
//! K₁(a/l). So
//!
//! d = (l − λ) ρ_I/(ρ_I + ρ_K),   C = a d ρ_K,   ρ_I = I₁/I₀ (a/λ),   ρ_K = K₁/K₀ (a/l),
//!
//! with modified Bessel functions. The centre of pressure is x̄ = d − λ − κπa²(d − l)/(2N), and the
//! rolling resistance N x̄/R.
//!
//! Source: S. C. Hunter, The rolling contact of a rigid cylinder with a viscoelastic half space, J.
//! Appl. Mech. 28 (1961) 611–617; the derivation above is this project's.

use numerics::bessel::scaled_k0_k1;
use numerics::search::root_between;
use std::f64::consts::PI;

/// Steps of the trapezoidal rule for Bessel functions, enough to leave only rounding.
const STEPS: usize = 400;

/// Rolling cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Instantaneous compliance c of the pair [1/Pa].
    pub compliance: f64,
    /// Delayed compliance f over the instantaneous one [-].
    pub delayed: f64,
    /// Distance l = Vτ rolled in the retardation time [m].
    pub length: f64,
    /// Relative radius R [m].
    pub radius: f64,
}

/// Contact of a rolling cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Half-width a [m].
    pub half_width: f64,
    /// Load per length N [N/m].
    pub load: f64,
    /// Position d of the middle of the contact [m].
    pub middle: f64,
    /// Centre of pressure x̄ [m].
    pub centre: f64,
    cylinder: Cylinder,
}

impl Cylinder {
    /// Contact of a given half-width [m].
    #[must_use]
    pub fn of_half_width(&self, half_width: f64) -> Contact {
        let (a, l) = (half_width, self.length);
        let late = self.late();
        let (inner, outer) = (ratio_i(a / late), ratio_k(a / l));
        let middle = (l - late) * inner / (inner + outer);
        let weight = 0.5 * a * a + a * middle * outer;
        let centre = middle - late - 0.5 * a * a * (middle - l) / weight;
        let load = PI * self.curvature() * weight;
        Contact { half_width, load, middle, centre, cylinder: *self }
    }

    /// Contact under a load per length [N/m].
    #[must_use]
    pub fn under(&self, load: f64) -> Contact {
        // The half-width lies between those of the instantaneous and of the relaxed elastic bodies.
        let hertz = (4.0 * load * self.radius * self.compliance / PI).sqrt();
        let ends = [hertz, hertz * (1.0 + self.delayed).sqrt()];
        let half_width = root_between(ends, |a| self.of_half_width(a).load - load);
        // Both ends are equal if the bodies do not relax.
        self.of_half_width(half_width.unwrap_or(hertz))
    }

    /// Length λ = l/(1 + f) [m].
    fn late(&self) -> f64 {
        self.length / (1.0 + self.delayed)
    }

    /// Factor κ [Pa/m].
    fn curvature(&self) -> f64 {
        1.0 / (2.0 * self.compliance * self.radius * (1.0 + self.delayed))
    }
}

impl Contact {
    /// Coefficient of rolling resistance x̄/R: resisting force over load [-].
    #[must_use]
    pub fn resistance_coefficient(&self) -> f64 {
        self.centre / self.cylinder.radius
    }

    /// Pressure at x [Pa], p(t) = ∫_t^a q(s) e^{(t − s)/λ} ds/λ.
    #[must_use]
    pub fn pressure(&self, x: f64) -> f64 {
        let (a, d) = (self.half_width, self.middle);
        let t = x - d;
        if t.abs() >= a {
            return 0.0;
        }
        let (l, late) = (self.cylinder.length, self.cylinder.late());
        let weight = self.load / (PI * self.cylinder.curvature()) - 0.5 * a * a;
        // Substitutes s = a cos θ and stops where the exponential has vanished.
        let nearest = (t / a).acos();
        let farthest = ((t + 40.0 * late) / a).min(1.0).acos();
        let step = (nearest - farthest) / STEPS as f64;
        let term = |k: usize| {
            let theta = farthest + k as f64 * step;
            let (sine, cosine) = theta.sin_cos();
            let shape = a * a * sine * sine - (d - l) * a * cosine + weight;
            let simpson = [1.0, if k % 2 == 1 { 4.0 } else { 2.0 }];
            simpson[usize::from(k > 0 && k < STEPS)] * shape * ((t - a * cosine) / late).exp()
        };
        self.cylinder.curvature() / late * step / 3.0 * (0..=STEPS).map(term).sum::<f64>()
    }
}

/// I₁/I₀ by π I_n(z) = ∫₀^π e^{z cos θ} cos nθ dθ, whose trapezoidal rule converges geometrically.
/// For large z, the asymptotic series, which is exact to rounding there.
fn ratio_i(z: f64) -> f64 {
    if z > 1e3 {
        let inverse = 1.0 / z;
        return 1.0 - inverse * (0.5 + inverse * (0.125 + 0.125 * inverse));
    }
    let mut sums = [0.0; 2];
    for k in 0..=STEPS {
        let end = if k == 0 || k == STEPS { 0.5 } else { 1.0 };
        let cosine = (PI * k as f64 / STEPS as f64).cos();
        let value = end * (z * (cosine - 1.0)).exp();
        sums[0] += value;
        sums[1] += value * cosine;
    }
    sums[1] / sums[0]
}

/// K₁/K₀.
fn ratio_k(z: f64) -> f64 {
    let [k0, k1] = scaled_k0_k1(z);
    k1 / k0
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::simpson;

    const CYLINDER: Cylinder = Cylinder { compliance: 0.5, delayed: 3.0, length: 0.7, radius: 2.0 };

    /// Values of Abramowitz and Stegun, tables 9.8 and 9.11.
    #[test]
    fn ratios_of_bessel_functions() {
        for (z, i, k) in [
            (0.1, 0.050_062_526_047_0 / 1.002_501_562_9, 9.853_844_780_9 / 2.427_069_024_7),
            (1.0, 0.565_159_104_0 / 1.266_065_877_8, 0.601_907_230_2 / 0.421_024_438_2),
            (10.0, 0.121_262_681_38 / 0.127_833_337_16, 0.410_766_57 / 0.391_631_93),
        ] {
            assert!((ratio_i(z) / i - 1.0).abs() < 1e-6, "I {z}: {} {i}", ratio_i(z));
            assert!((ratio_k(z) / k - 1.0).abs() < 1e-6, "K {z}: {} {k}", ratio_k(z));
        }
        assert!((ratio_i(1000.1) - ratio_i(999.9)).abs() < 2e-7);
    }

    /// The pressure carries the load, has the given centre, and causes the displacement: u' = −x/R
    /// in the contact, by quadrature over the pressure and over the memory.
    #[test]
    fn pressure_solves_the_problem() {
        for length in [0.05, 0.7, 5.0] {
            let contact = Cylinder { length, ..CYLINDER }.of_half_width(1.0);
            let [low, high] = [-1.0, 1.0].map(|side| contact.middle + side);
            let load = simpson(low, high, |x| contact.pressure(x));
            let moment = simpson(low, high, |x| x * contact.pressure(x));
            assert!((load / contact.load - 1.0).abs() < 1e-5, "{length}: {load} {}", contact.load);
            assert!(
                (moment / load / contact.centre - 1.0).abs() < 1e-4,
                "{length}: {}",
                moment / load
            );
        }
    }

    /// The limits of very fast and very slow rolling are Hertz contacts without resistance.
    #[test]
    fn fast_and_slow_limits() {
        for (length, factor) in [(1e-6, 1.0 + CYLINDER.delayed), (1e5, 1.0)] {
            let contact = Cylinder { length, ..CYLINDER }.under(3.0);
            let expected = (4.0 * 3.0 * CYLINDER.radius * factor * CYLINDER.compliance / PI).sqrt();
            assert!((contact.half_width / expected - 1.0).abs() < 1e-5, "{contact:?}");
            assert!(contact.centre.abs() < 1e-3, "{contact:?}");
        }
    }
}
