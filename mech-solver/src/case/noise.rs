//! Noise of a measured profile: scatter of its points about a smooth curve, and the resulting
//! change of the pressure.
//!
//! *Scatter.* A point deviates by r from the cubic through its two neighbours on either side, with
//! the Lagrange weights w over the chord length. Noise of standard deviation σ gives r the standard
//! deviation σ √(1 + Σw²), so that σ is estimated as the median of |r|/√(1 + Σw²), divided by
//! 0.6745. The median is over y: instruments scatter in height, which shows on the running surface
//! and not on a flank. Corners are too few to move the median. A smooth shape contributes its
//! fourth difference, h⁴ z''''/6, which is far below the noise that matters.
//!
//! *Pressure.* Pressing a wave of amplitude A and wave number k flat takes the pressure ½ E* A k
//! (Johnson, *Contact Mechanics*, 13.2). White noise of points with the spacing h has the
//! mean square σ² h/π for each wave number up to π/h. A smoothing that halves waves of the number q
//! leaves the part 1/(1 + (k/q)⁴) of each. The root mean square of the pressure is therefore
//!
//! ½ E* σ √(π²/3)/h without smoothing, and ½ E* σ √(I q³ h/π) with it,
//!
//! where I = ∫ u²/(1 + u⁴)² du = 0.278.
//!
//! *Tolerance.* The largest of some hundred normal deviations is 3 to 4 σ. A smaller tolerance
//! follows the noise in places; a larger one smooths until it cuts the corners of the shape.
//!
//! Source: Rousseeuw & Croux, J. Am. Stat. Assoc. 88 (1993) 1273, for the median of absolute
//! deviations.

use proto::configuration::Refusal;
use std::f64::consts::{PI, TAU};
use wheel_rail::outline::Smoothing;

/// Smallest number of points for an estimate of the scatter.
const FEWEST: usize = 9;
/// Median of the absolute value of a normal variable, relative to its standard deviation.
const MEDIAN: f64 = 0.6745;
/// ∫ u²/(1 + u⁴)² du from 0 to infinity: share of the noise that smoothing leaves.
const LEFT: f64 = 0.2777;
/// Smallest pressure of noise that causes a warning, relative to E*: 50 MPa between steel bodies, a
/// twentieth of the pressure under a wheel.
const LEAST: f64 = 4.3e-4;
/// Smallest tolerance of smoothing that does not follow the noise, relative to the scatter.
const FOLLOWS: f64 = 4.0;
/// Suggested tolerance of smoothing, relative to the scatter.
const TOLERANCE: f64 = 5.0;

/// A profile in the case, as measured and as smoothed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured<'a> {
    /// Key of the profile.
    pub(crate) key: &'a str,
    /// Key of the tolerance of its smoothing.
    pub(crate) tolerance: &'a str,
    /// Key of the wavelength of its smoothing.
    pub(crate) wavelength: &'a str,
    /// Points before smoothing [m].
    pub(crate) points: &'a [[f64; 2]],
    /// Smoothing of the points.
    pub(crate) smoothing: Smoothing,
}

impl Measured<'_> {
    /// Returns a warning if the scatter of the points visibly changes the pressure between bodies
    /// with the contact modulus E* [Pa].
    pub(crate) fn warning(&self, contact_modulus: f64) -> Option<Refusal> {
        let (scatter, spacing) = scatter(self.points)?;
        let rough = 0.5 * scatter * PI / (3.0_f64.sqrt() * spacing);
        let smoothed = |wavelength: f64| {
            0.5 * scatter * (LEFT * (TAU / wavelength).powi(3) * spacing / PI).sqrt()
        };
        let share = match self.smoothing {
            Smoothing::Within(tolerance) if tolerance < FOLLOWS * scatter => rough,
            Smoothing::Within(_) => 0.0,
            Smoothing::Halving(wavelength) => rough.min(smoothed(wavelength)),
        };
        if share <= LEAST {
            return None;
        }
        let reason = format!(
            "the points scatter by about {:.1} µm at a spacing of {:.2} mm, which changes the contact pressure by \
             some {:.0} MPa from place to place",
            1e6 * scatter,
            1e3 * spacing,
            1e-6 * share * contact_modulus
        );
        let fix = match self.smoothing {
            Smoothing::Within(_) => {
                let tolerance = 1e6 * TOLERANCE * scatter;
                format!("smooth the profile by {} = \"{tolerance:.1} um\"", self.tolerance)
            }
            Smoothing::Halving(_) => {
                let wavelength = 1e3 * (smoothed(1.0) / LEAST).powf(2.0 / 3.0);
                let wavelength = (10.0 * wavelength).ceil() / 10.0;
                format!("smooth the profile by {} = \"{wavelength:.1} mm\"", self.wavelength)
            }
        };
        Some(Refusal::new(self.key, reason, fix))
    }
}

/// Returns the standard deviation of points from a smooth curve, and the median of their spacing
/// [m].
fn scatter(points: &[[f64; 2]]) -> Option<(f64, f64)> {
    if points.len() < FEWEST {
        return None;
    }
    let step = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
    let steps: Vec<f64> = points.windows(2).map(step).collect();
    let deviations = points.windows(5).zip(steps.windows(4)).map(|(five, steps)| {
        let at = [-(steps[0] + steps[1]), -steps[1], steps[2], steps[2] + steps[3]];
        let around = [five[0], five[1], five[3], five[4]];
        let weight = |k: usize| {
            let others = at.iter().enumerate().filter(|(other, _)| *other != k);
            others.map(|(_, other)| other / (other - at[k])).product::<f64>()
        };
        let weights = [0, 1, 2, 3].map(weight);
        let through =
            |axis: usize| weights.iter().zip(around).map(|(w, point)| w * point[axis]).sum::<f64>();
        let [y, z] = [0, 1].map(|axis| five[2][axis] - through(axis));
        let size: f64 = weights.iter().map(|w| w * w).sum();
        (y.hypot(z) / (1.0 + size).sqrt(), (five[3][0] - five[1][0]).abs())
    });
    let deviations = deviations.filter(|(value, _)| value.is_finite()).collect();
    let spacing = weighted_median(steps.iter().map(|step| (*step, 1.0)).collect())?;
    Some((weighted_median(deviations)? / MEDIAN, spacing))
}

/// Returns the value up to which half of the weight lies; values come with their weights.
fn weighted_median(mut values: Vec<(f64, f64)>) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * values.iter().map(|value| value.1).sum::<f64>();
    let mut below = 0.0;
    values.into_iter().find_map(|(value, weight)| {
        below += weight;
        (below >= half).then_some(value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A profile with these points and this smoothing.
    fn measured(points: &[[f64; 2]], smoothing: Smoothing) -> Measured<'_> {
        Measured {
            key: "p",
            tolerance: "p_tolerance",
            wavelength: "p_wavelength",
            points,
            smoothing,
        }
    }

    fn crown(noise: f64, step: f64) -> Vec<[f64; 2]> {
        let mut random = 1_u64;
        let mut normal = || {
            // The sum of twelve uniform numbers minus its mean has the standard deviation 1.
            let uniform = |state: &mut u64| {
                *state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (*state >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform(&mut random)).sum::<f64>() - 6.0
        };
        let count = (60e-3 / step) as usize;
        let point = |k: usize| {
            let y = -30e-3 + step * k as f64;
            [y, -y * y / 0.6 + noise * normal()]
        };
        (0..=count).map(point).collect()
    }

    /// The estimate matches the noise within the scatter of a median of 120 values.
    #[test]
    fn scatter_is_that_of_the_noise() {
        for noise in [0.5e-6, 2e-6, 10e-6] {
            let (found, spacing) = scatter(&crown(noise, 0.5e-3)).unwrap();
            assert!((found / noise - 1.0).abs() < 0.3, "{noise} {found}");
            assert!((spacing - 0.5e-3).abs() < 1e-5);
        }
        let (none, _) = scatter(&crown(0.0, 0.5e-3)).unwrap();
        // A cubic in the chord leaves a remainder of the order chord⁴/R³ of a circle.
        assert!(none < 1e-11, "{none}");
    }

    /// Noise in height shows on the crown, not on flanks that are more than half of the curve.
    #[test]
    fn steep_flanks_do_not_hide_the_noise() {
        let crown = crown(2e-6, 0.5e-3);
        let noise = |k: usize| crown[k % crown.len()][1] + crown[k % crown.len()][0].powi(2) / 0.6;
        let end = crown[0];
        let flank = (1..160).map(|k| {
            let down = 0.5e-3 * k as f64;
            [end[0] - 0.05 * down, end[1] - down + noise(k)]
        });
        let points: Vec<[f64; 2]> = flank.rev().chain(crown.iter().copied()).collect();
        let (found, _) = scatter(&points).unwrap();
        assert!((found / 2e-6 - 1.0).abs() < 0.3, "{found}");
    }

    /// The advice removes the warning, and asks for more than what is set.
    #[test]
    fn noise_that_the_pressure_shows_is_told_with_what_smooths_it() {
        let noisy = crown(2e-6, 0.5e-3);
        let warning = |smoothing| measured(&noisy, smoothing).warning(1.15e11);
        let number = |told: &Refusal| -> f64 {
            told.fix.split('"').nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
        };
        let told = warning(Smoothing::Within(0.0)).unwrap();
        assert!(
            told.reason.contains("spacing of 0.50 mm") && told.fix.contains("p_tolerance = \""),
            "{told}"
        );
        let tolerance = number(&told);
        assert!((8.0..12.5).contains(&tolerance), "{tolerance} um for a noise of 2 um");
        assert_eq!(warning(Smoothing::Within(1e-6 * tolerance)), None);
        let short = warning(Smoothing::Halving(1e-3)).unwrap();
        let wavelength = number(&short);
        assert!(short.fix.contains("p_wavelength") && wavelength > 1.0, "{short}");
        assert_eq!(warning(Smoothing::Halving(1e-3 * wavelength)), None);
        for noise in [0.1e-6, 0.0] {
            let points = crown(noise, 0.5e-3);
            assert_eq!(measured(&points, Smoothing::Within(0.0)).warning(1.15e11), None);
        }
    }
}
