//! Largest pressure at which a surface under repeated rolling shakes down to elastic behaviour:
//! plastic flow in the first passages leaves residual stresses that keep the later ones elastic.
//!
//! Residual stresses do not change along the motion. Equilibrium with a free surface then allows
//! only normal stresses in the plane of the surface. They can cancel every cause of yielding except
//! the shear stress τ_xz. The limit (Melan) is therefore p₀/k = 1/max |τ_xz/p₀|, with the yield
//! stress k in shear. Under a pressure p₀√(1 − x²) in full sliding with a traction coefficient μ,
//! in half widths a of a line contact,
//!
//! τ_xz/p₀ = −n (m² − z²)/(m² + n²) − μ [m (1 + (z² + n²)/(m² + n²)) − 2z],
//!
//! m² = ½ [√((1 − x² + z²)² + 4x²z²) + (1 − x² + z²)], n² = m² − (1 − x² + z²),
//! n with the sign of x.
//!
//! Without friction the limit is 4.0 (half a width below the surface); from μ = 0.367 it is 1/μ, at
//! the surface. Other contacts have higher limits: 4.7 for a circular contact without friction.
//!
//! In the first passage, without residual stresses, the body flows from a lower pressure, at which
//! the von Mises stress reaches √3 k. Stresses under the pressure are
//! σ_x/p₀ = −[m (1 + (z² + n²)/(m² + n²)) − 2z], σ_z/p₀ = −m [1 − (z² + n²)/(m² + n²)]. Stresses
//! under the traction are σ_x/p₀ = μ [n (2 − (z² − m²)/(m² + n²)) − 2x],
//! σ_z/p₀ = −μ n (m² − z²)/(m² + n²), in plane strain.
//!
//! Source: Johnson, *Contact Mechanics* (1985), 4.2(c), 7.1 and 9.2.

/// Steps per half-width in the search for the largest shear stress.
const STEPS: i32 = 32;
/// Extent of the search in steps: to either side of the middle, and below the surface.
const REACH: [i32; 2] = [STEPS * 3 / 2, STEPS];

/// Poisson's ratio of metals.
const POISSON: f64 = 0.3;

/// Shakedown limit p₀/k at a traction coefficient [-].
#[must_use]
pub fn limit(traction: f64) -> f64 {
    largest(|x, z| stresses(x, z, traction.abs())[2].abs()).recip()
}

/// Elastic limit p₀/k of first yield at a traction coefficient [-].
#[must_use]
pub fn elastic_limit(traction: f64) -> f64 {
    largest(|x, z| von_mises(stresses(x, z, traction.abs()))).recip() * 3.0_f64.sqrt()
}

/// Largest value at and below the surface, without the ends of the contact on the surface, where
/// stresses jump.
fn largest(value: impl Fn(f64, f64) -> f64) -> f64 {
    let place = |step: i32| f64::from(step) / f64::from(STEPS);
    let places = (-REACH[0]..=REACH[0]).flat_map(|i| (0..=REACH[1]).map(move |k| (i, k)));
    places.map(|(i, k)| value(place(i), place(k))).fold(0.0, f64::max)
}

/// Von Mises stress from σ_x, σ_z and τ_xz in plane strain.
fn von_mises([along, deep, shear]: [f64; 3]) -> f64 {
    let across = POISSON * (along + deep);
    let differences = [along - deep, deep - across, across - along];
    let sum: f64 = differences.iter().map(|difference| difference * difference).sum();
    (0.5 * sum + 3.0 * shear * shear).sqrt()
}

/// Stresses σ_x, σ_z and τ_xz over p₀ at a point below the surface, coordinates in half-widths.
fn stresses(x: f64, z: f64, traction: f64) -> [f64; 3] {
    let part = 1.0 - x * x + z * z;
    let m2 = 0.5 * ((part * part + 4.0 * x * x * z * z).sqrt() + part);
    let (m, n2) = (m2.sqrt(), m2 - part);
    let n = n2.max(0.0).sqrt() * x.signum();
    let sum = m2 + n2;
    let shared = (z * z + n2) / sum;
    let [along, deep] = [2.0 * z - m * (1.0 + shared), -m * (1.0 - shared)];
    let shear = -n * (m2 - z * z) / sum;
    let pulled = n * (2.0 - (z * z - m2) / sum) - 2.0 * x;
    [along + traction * pulled, deep + traction * shear, shear + traction * along]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Johnson's values: 4.0 without friction, 0.25 p₀ at 0.87 and 0.5 half-widths; from 0.367 at
    /// the surface. Tolerance: the steps, of second order, and the printed digits.
    #[test]
    fn johnsons_figures() {
        assert!((limit(0.0) - 4.0).abs() < 2e-3, "{}", limit(0.0));
        assert!((stresses(0.75_f64.sqrt(), 0.5, 0.0)[2].abs() - 0.25).abs() < 1e-12);
        assert!((limit(0.58) - 1.0 / 0.58).abs() < 1e-12);
        let at_surface = |traction: f64| (limit(traction) * traction - 1.0).abs() < 1e-12;
        assert!(at_surface(0.372) && !at_surface(0.362), "{} {}", limit(0.362), limit(0.372));
        assert!(limit(-0.1) < limit(0.05));
    }

    /// Without friction p₀ is 1.79 times the yield stress, 3.10 k (Johnson, table 4.1). With high
    /// friction the surface flows behind the contact under σ_x = 2μp₀ alone, in plane strain. The
    /// elastic limit is below the shakedown limit. Tolerance: the printed digits, and the first
    /// point beside the jump at the end of the contact.
    #[test]
    fn first_yield() {
        let frictionless = elastic_limit(0.0);
        assert!((frictionless / (1.79 * 3.0_f64.sqrt()) - 1.0).abs() < 5e-3, "{frictionless}");
        let traction = 0.8;
        let pulled = 2.0 * traction * (1.0 - POISSON + POISSON * POISSON).sqrt() / 3.0_f64.sqrt();
        let much = elastic_limit(traction);
        assert!(much < 1.04 / pulled && much > 0.9 / pulled, "{much} {pulled}");
        for traction in [0.0, 0.1, 0.2, 0.3, 0.6, 1.0] {
            assert!(elastic_limit(traction) < limit(traction) * 1.001, "{traction}");
        }
    }

    /// Equilibrium along the motion: the shear stress summed over a plane far below is zero under
    /// the pressure and carries the whole traction. Tolerance: a tenth of the part beyond the ends
    /// X of the sum, where stresses fall like those of a line load, 4z/πX of the total.
    #[test]
    fn shear_stresses_carry_the_traction() {
        let traction = 0.4;
        for z in [0.3, 1.0] {
            let (step, count) = (1e-3, 200_000);
            let sum: f64 = (-count..=count)
                .map(|i| stresses(f64::from(i) * step, z, traction)[2] * step)
                .sum();
            let beyond = 4.0 * z / (PI * f64::from(count) * step);
            let expected = -traction * 0.5 * PI * (1.0 - beyond);
            assert!((sum / expected - 1.0).abs() < 0.1 * beyond, "{z}: {sum} {expected}");
        }
    }
}
