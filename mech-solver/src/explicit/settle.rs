//! Rolling until that is steady, with the force that is prescribed.
//!
//! A creepage for a prescribed force is corrected between measurements along a creep curve ξ(F) that comes near that of the
//! elements: first by the factor between both that a measurement gives, then along the straight line that ξ of the curve
//! has over ξ of the elements through the last two.

use super::rolling::{Asked, Means, RISE, Rolling};

/// Ways in half lengths of the contact: after which what is prescribed has settled, and over which is measured.
const SETTLE: f64 = 4.5;
const SETTLE_AGAIN: f64 = 2.5;
const MEASURE: f64 = 0.5;
/// Creepages that are apart, over themselves.
const APART: f64 = 0.02;
/// Deviation of a force from the prescribed one, over f N, that is accepted, and measurements at most.
const FORCE: f64 = 1e-3;
const MEASUREMENTS: usize = 8;

/// Steps that it will take, about, of a length [s].
#[must_use]
pub fn expected_steps(asked: &Asked, step: f64) -> f64 {
    let measurements = if asked.force.is_some() && asked.law.sticks { 2.0 } else { 1.0 };
    let way = RISE + SETTLE + (measurements - 1.0) * (SETTLE_AGAIN + MEASURE) + MEASURE;
    way * asked.half_length / (asked.speed * step)
}

/// Rolls bodies until they do so steadily with what is prescribed, and measures; `report` hears how many steps of about how
/// many are taken, and `curve` knows creepages that come near those of forces over f N. The last measurement, and whether the
/// prescribed force was met.
///
/// # Errors
/// Those of the curve.
pub fn settle<E>(
    rolling: &mut Rolling,
    curve: impl Fn(f64) -> Result<f64, E>,
    report: &mut dyn FnMut(u64, u64),
) -> Result<(Means, bool), E> {
    let expected = expected_steps(&rolling.asked, rolling.step) as u64;
    let mut told = |steps: u64| report(steps, expected.max(steps));
    rolling.roll(RISE + SETTLE, &mut told);
    let mut means = rolling.roll(MEASURE, &mut told);
    let Asked { force: Some(target), law, .. } = rolling.asked else { return Ok((means, true)) };
    let of = |means: &Means| means.force[0] / (law.coefficient * means.force[2]);
    let (aim, mut search) = (curve(target)?, Search::default());
    for before in 1..MEASUREMENTS {
        if (of(&means) - target).abs() <= FORCE {
            return Ok((means, true));
        }
        let now = [rolling.motion.creepage, curve(of(&means))?];
        rolling.motion.creepage = search.next(now, aim);
        rolling.roll(SETTLE_AGAIN, &mut told);
        // Where a force wavers by more than is accepted, a longer mean wavers less.
        let longer = before.div_ceil(2).min(4) as f64;
        means = rolling.roll(longer * MEASURE, &mut told);
    }
    Ok((means, (of(&means) - target).abs() <= FORCE))
}

/// A search for the creepage of a force.
#[derive(Default)]
struct Search {
    /// Creepage of a measurement before, of the elements and of the curve.
    last: [f64; 2],
    slope: f64,
}

impl Search {
    /// The creepage for a place on the curve, after a measurement of both. A slope is taken from measurements that are apart, and not
    /// trusted where it is far from that of the line through the origin: forces waver a little.
    fn next(&mut self, now: [f64; 2], target: f64) -> f64 {
        let [creepage, place] = now;
        let apart = creepage - self.last[0];
        if apart.abs() > APART * creepage.abs() {
            let whole = place / creepage;
            self.slope = whole * ((place - self.last[1]) / (apart * whole)).clamp(0.3, 3.0);
            self.last = now;
        }
        creepage + (target - place) / self.slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along a curve that is proportional one correction is enough, along one with an offset two. Rounding.
    #[test]
    fn a_creepage_is_found() {
        for (offset, corrections) in [(0.0, 1), (5e-4, 2)] {
            let curve = |creepage: f64| 0.9 * creepage + offset;
            let (mut creepage, mut search) = (-2e-3, Search::default());
            for _ in 0..corrections {
                creepage = search.next([creepage, curve(creepage)], curve(-3e-3));
            }
            assert!((creepage + 3e-3).abs() < 1e-15, "{offset} {creepage}");
        }
    }
}
