//! Length of the elements along x, which follows the length of the slip zone.
//!
//! Errors of friction power and temperatures depend on the number of elements across the slip zone.
//! In steady rolling with a difference of second order,
//!
//! ```text
//! dx = a/⌈n max(1, a (1 − c/2)/L)⌉,
//! ```
//!
//! so that n elements per semi-axis a put n (1 − c/2) or more across a slip zone of the mean length
//! L: n/2 where the longitudinal creepage drives (c = 1), n where lateral creepage and spin do
//! (c = 0). With v and w the parts of both in a strip, c = max(0, (v² − w²)/(v² + w²)). More
//! elements do not pay: the error of the rows, which are a/n wide, is then larger. The whole number
//! puts both edges of the middle row between elements, on every grid. The zone is estimated by
//! strips along x before the contact is solved. A force F has Carter's zone on
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

/// Lower limit of dx over a/n. Shorter elements leave the error of the rows.
const SHORTEST: f64 = 1.0 / 16.0;
/// The same for the smallest creepages, for some of which Newton's method fails with elements half
/// as long.
const SHORTEST_OF_NARROW: f64 = 1.0 / 8.0;
/// Length of a slip zone over a, below which the lower limit grows in inverse proportion to it.
const NARROW: f64 = 1.0 / 64.0;
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

/// Slip zone that is estimated by strips.
#[derive(Clone, Copy, Debug)]
pub(super) struct Zone {
    /// Mean length over the semi-axis a, up to [`Zone::WHOLE`].
    pub(super) length: f64,
    /// Share c of the longitudinal creepage in the slip, from 0 to 1.
    longitudinal: f64,
}

impl Zone {
    /// Zone of a contact that slides everywhere.
    pub(super) const WHOLE: Self = Self { length: 2.0, longitudinal: 1.0 };

    /// Length of the elements along x over a/n.
    pub(super) fn share(&self) -> f64 {
        let shortest = (SHORTEST * NARROW / self.length).clamp(SHORTEST, SHORTEST_OF_NARROW);
        (self.length / (1.0 - 0.5 * self.longitudinal)).clamp(shortest, 1.0)
    }
}

impl Patch<'_> {
    /// Half lengths of a slip zone along x and y [m]. Those of a contact that sticks are not known.
    pub(super) fn slips(&self, zone: Option<Zone>) -> Option<[f64; 2]> {
        let [a, b] = self.semi_axes;
        zone.map(|zone| [0.5 * zone.length * a, b])
    }

    /// Slip zone under this motion. Returns `None` for a contact that counts as stuck.
    pub(super) fn slip_zone(&self, driven: &Driven) -> Option<Zone> {
        self.zone(driven).filter(|zone| zone.length > STUCK)
    }

    fn zone(&self, driven: &Driven) -> Option<Zone> {
        let [a, b] = self.semi_axes;
        let motion = driven.at(self.normal_force);
        let per_creepage = self.lengths_per_creepage();
        let [along, across] = [0, 1].map(|k| match motion.force[k] {
            Some(force) => -force.signum() * self.length_under(force),
            None => per_creepage[k] * motion.creepage[k],
        });
        let [turn_along, turn_across] = per_creepage.map(|length| length * motion.creepage[2]);
        let (mut powers, mut weighted, mut longitudinal) = (0.0, 0.0, 0.0);
        for strip in 0..STRIPS {
            let place = (2 * strip + 1) as f64 / STRIPS as f64 - 1.0;
            let half = if self.line { 1.0 } else { (1.0 - place * place).sqrt() };
            let turn_x = turn_along * b * place;
            let (mut length, mut slip_y) = (0.0, 0.0);
            for _ in 0..SUBSTITUTIONS {
                slip_y = across + turn_across * 0.5 * a * length;
                length = (along - turn_x).hypot(slip_y).min(2.0 * half);
            }
            let power = length * length * half;
            powers += power;
            weighted += power * length;
            let [own, other] = [along.powi(2), turn_x.powi(2) + slip_y.powi(2)];
            if own > other {
                longitudinal += power * (own - other) / (own + other);
            }
        }
        let mean = |sum: f64| sum / powers;
        (powers > 0.0).then(|| Zone { length: mean(weighted), longitudinal: mean(longitudinal) })
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
