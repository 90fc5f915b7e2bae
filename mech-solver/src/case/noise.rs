//! Noise of a measured profile: scatter of its points about a smooth curve, and the resulting
//! change of the pressure.
//!
//! *Scatter.* A point deviates by r from the cubic through its two neighbours on either side, with
//! the Lagrange weights w over the chord length. Noise of standard deviation σ gives r the standard
//! deviation σ √(1 + Σw²), so that σ is estimated as the median of |r|/√(1 + Σw²), divided by
//! 0.6745. Corners are too few to move the median. A smooth shape contributes its fourth
//! difference, h⁴ z''''/6, which is far below the noise that matters.
//!
//! *Pressure.* Pressing waves of amplitude σ and length λ flat takes the pressure π E* σ/λ
//! (Johnson, *Contact Mechanics*, 13.2). Noise of points with the spacing h has its shortest
//! visible waves at 2 h and most of its power near 4 h, which is used for λ. The result is an order
//! of magnitude, not an error bar.
//!
//! Source: Rousseeuw & Croux, J. Am. Stat. Assoc. 88 (1993) 1273, for the median of absolute
//! deviations.

use proto::configuration::Refusal;
use std::f64::consts::PI;

/// Smallest number of points for an estimate of the scatter.
const FEWEST: usize = 9;
/// Median of the absolute value of a normal variable, relative to its standard deviation.
const MEDIAN: f64 = 0.6745;
/// Wavelength that represents the noise, relative to the spacing of the points.
const WAVE: f64 = 4.0;
/// Smallest pressure of noise that causes a warning, relative to E*: 50 MPa between steel bodies, a
/// twentieth of the pressure under a wheel.
const LEAST: f64 = 4.3e-4;
/// Suggested tolerance of smoothing, relative to the scatter; nearly every point lies within it.
const TOLERANCE: f64 = 3.0;

/// Returns a warning if the scatter of the points of a profile [m] visibly changes the pressure
/// between bodies with the contact modulus E* [Pa]. `key` is the key of the profile, `tolerance`
/// that of its smoothing.
pub(crate) fn warning(
    key: &str,
    tolerance: &str,
    points: &[[f64; 2]],
    contact_modulus: f64,
) -> Option<Refusal> {
    let (scatter, spacing) = scatter(points)?;
    let share = PI * scatter / (WAVE * spacing);
    (share > LEAST).then(|| {
        let reason = format!(
            "the points scatter by about {:.1} µm at a spacing of {:.2} mm, which changes the contact pressure by \
             some {:.0} MPa from place to place",
            1e6 * scatter,
            1e3 * spacing,
            1e-6 * share * contact_modulus
        );
        let smooth = 1e6 * TOLERANCE * scatter;
        Refusal::new(key, reason, format!("smooth the profile by {tolerance} = \"{smooth:.1} um\""))
    })
}

/// Returns the standard deviation of points from a smooth curve, and the median of their spacing
/// [m].
fn scatter(points: &[[f64; 2]]) -> Option<(f64, f64)> {
    if points.len() < FEWEST {
        return None;
    }
    let step = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
    let mut steps: Vec<f64> = points.windows(2).map(step).collect();
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
        y.hypot(z) / (1.0 + size).sqrt()
    });
    let mut deviations: Vec<f64> = deviations.filter(|value| value.is_finite()).collect();
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    Some((median(&mut deviations)? / MEDIAN, median(&mut steps)?))
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn noise_that_the_pressure_shows_is_told_with_what_smooths_it() {
        let warning = |noise| warning("p", "p_tolerance", &crown(noise, 0.5e-3), 1.15e11);
        let told = warning(2e-6).unwrap();
        assert!(
            told.reason.contains("spacing of 0.50 mm") && told.fix.contains("p_tolerance = \""),
            "{told}"
        );
        assert_eq!(warning(0.1e-6), None);
        assert_eq!(warning(0.0), None);
    }
}
