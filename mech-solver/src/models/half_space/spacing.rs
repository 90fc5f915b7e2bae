//! Length of the elements along x, which follows the length of the slip zone.
//!
//! Errors of friction power and temperatures depend on the number of elements across the slip zone.
//! In steady rolling with a difference of second order,
//!
//! ```text
//! dx = a/⌈n max(1, a/2L)⌉,
//! ```
//!
//! so that n elements per semi-axis a put n/2 or more across a slip zone of the mean length L. The
//! whole number puts both edges of the middle row between elements, on every grid. The zone is
//! estimated by strips along x before the contact is solved. A force F has Carter's zone on
//! an ellipse, L = 2a (1 − ∛(1 − F/fN)); creepages have
//!
//! ```text
//! L(y) = E* a/(f p₀) |(1 + a/5b)(ξ − φ y), (1 + 2a/5b)(1 − ν)(η + φ L/2)|,
//! ```
//!
//! at most the length of the row, with 1/E* = (1 − ν²)/E summed over both bodies. The mean over y
//! is weighted with the friction power of a row, L² times its length. The terms with a/b, which
//! strips in plane strain lack, are fitted to solutions with b/a from 0.15 to 2.8.

use super::drive::Driven;
use half_space::viscoelastic::Bodies;

/// Minimum number of elements across the slip zone, as a share of those of a semi-axis.
const SHARE: f64 = 0.5;
/// Lower limit of dx over a/n. At a twenty-fourth Newton's method fails for some of the smallest
/// creepages.
const SHORTEST: f64 = 1.0 / 8.0;
/// Length of a slip zone over a, below which a contact counts as stuck. Its force is that of the
/// linear theory within a thousandth, and its friction power below a millionth of that of sliding.
const STUCK: f64 = 1e-3;
/// Number of strips.
const STRIPS: usize = 32;
/// Number of substitutions for the lateral slip by spin at the border of adhesion.
const SUBSTITUTIONS: usize = 12;

/// Contact whose slip zone is estimated. Profiles have an equivalent ellipse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch<'a> {
    pub(super) semi_axes: [f64; 2],
    /// True for a line contact.
    pub(super) line: bool,
    pub(super) normal_force: f64,
    pub(super) max_pressure: f64,
    pub(super) friction_coefficient: f64,
    pub(super) bodies: &'a Bodies,
}

/// Length of the elements along x over a/n, for a slip zone of this mean length over a.
pub(super) fn share(zone: f64) -> f64 {
    (zone / SHARE).clamp(SHORTEST, 1.0)
}

impl Patch<'_> {
    /// Length of the slip zone over a where the whole contact slides.
    pub(super) const WHOLE: f64 = 2.0;

    /// Half lengths of a slip zone along x and y [m]. Those of a contact that sticks are not known.
    pub(super) fn slips(&self, zone: Option<f64>) -> Option<[f64; 2]> {
        let [a, b] = self.semi_axes;
        zone.map(|zone| [0.5 * zone * a, b])
    }

    /// Mean length of the slip zone over the semi-axis a, up to [`Self::WHOLE`]. Returns `None` for
    /// a contact that counts as stuck.
    pub(super) fn slip_zone(&self, driven: &Driven) -> Option<f64> {
        Some(self.mean_zone(driven)).filter(|zone| *zone > STUCK)
    }

    fn mean_zone(&self, driven: &Driven) -> f64 {
        let [a, b] = self.semi_axes;
        let motion = driven.at(self.normal_force);
        let per_creepage = self.lengths_per_creepage();
        let [along, across] = [0, 1].map(|k| match motion.force[k] {
            Some(force) => -force.signum() * self.length_under(force),
            None => per_creepage[k] * motion.creepage[k],
        });
        let [turn_along, turn_across] = per_creepage.map(|length| length * motion.creepage[2]);
        let (mut powers, mut weighted) = (0.0, 0.0);
        for strip in 0..STRIPS {
            let place = (2 * strip + 1) as f64 / STRIPS as f64 - 1.0;
            let half = if self.line { 1.0 } else { (1.0 - place * place).sqrt() };
            let mut length = 0.0;
            for _ in 0..SUBSTITUTIONS {
                let slip_y = across + turn_across * 0.5 * a * length;
                length = (along - turn_along * b * place).hypot(slip_y).min(2.0 * half);
            }
            let power = length * length * half;
            powers += power;
            weighted += power * length;
        }
        if powers > 0.0 { weighted / powers } else { 0.0 }
    }

    /// Lengths of the slip zone per longitudinal and lateral creepage, over a.
    fn lengths_per_creepage(&self) -> [f64; 2] {
        let [a, b] = self.semi_axes;
        let elasticity = &self.bodies.instantaneous;
        let poisson = elasticity.poisson_compliance / elasticity.shear_compliance;
        let narrow = if self.line { 0.0 } else { a / b };
        let bound = self.friction_coefficient * self.max_pressure;
        let longitudinal = 1.0 / (elasticity.contact_compliance() * bound);
        let lateral = (1.0 - poisson) * longitudinal;
        [longitudinal * (1.0 + 0.2 * narrow), lateral * (1.0 + 0.4 * narrow)]
    }

    /// Length of the slip zone under a force [N], over a.
    fn length_under(&self, force: f64) -> f64 {
        let sticks = 1.0 - force.abs() / (self.friction_coefficient * self.normal_force);
        let sticks = sticks.max(0.0);
        2.0 * (1.0 - if self.line { sticks.sqrt() } else { sticks.cbrt() })
    }
}
