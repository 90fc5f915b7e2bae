//! Rolling until that is steady, with the force that is prescribed.
//!
//! A creepage for a prescribed force is corrected between measurements along a creep curve ξ(F) that comes near that of the
//! elements: first by the factor between both that a measurement gives, then along the straight line that ξ of the curve
//! has over ξ of the elements through the last two.

use super::rolling::{Means, Options, RISE, Rolling};

/// Ways in half lengths of the contact: after which what is prescribed has settled, and over which is measured.
const SETTLE: f64 = 4.5;
const SETTLE_AGAIN: f64 = 3.0;
const MEASURE: f64 = 1.0;
/// Creepages that are apart, over themselves.
const APART: f64 = 0.02;
/// Deviations that are accepted: of the creepage along the curve, over that of the prescribed force, or of the force, over
/// f N; measurements at most.
const CREEPAGE: f64 = 4e-3;
const FORCE: f64 = 3e-4;
const MEASUREMENTS: usize = 8;

/// Steps that it will take, about, of a length [s].
#[must_use]
pub fn expected_steps(asked: &Options, step: f64) -> f64 {
    let measurements = if asked.force.is_some() && asked.law.sticks { 2.0 } else { 1.0 };
    let way = RISE + SETTLE + (measurements - 1.0) * (SETTLE_AGAIN + MEASURE) + MEASURE;
    way * asked.half_length / (asked.speed * step)
}

/// Steps that bodies which roll steadily take, about, until they do so again with something changed.
#[must_use]
pub fn expected_steps_again(asked: &Options, step: f64) -> f64 {
    (SETTLE_AGAIN + MEASURE) * asked.half_length / (asked.speed * step)
}

/// Rolls bodies until they do so steadily with what is prescribed, and measures; `report` hears how many steps of about how
/// many are taken, and `curve` knows creepages that come near those of forces over f N. The last measurement, and whether the
/// prescribed force was met.
///
/// # Errors
/// Errors of the curve.
pub fn settle<E>(
    rolling: &mut Rolling,
    curve: impl Fn(f64) -> Result<f64, E>,
    report: &mut dyn FnMut(u64, u64),
) -> Result<(Means, bool), E> {
    let expected = expected_steps(&rolling.asked, rolling.step) as u64;
    let mut told = |steps: u64| report(steps, expected.max(steps));
    roll_to_force(rolling, RISE + SETTLE, curve, &mut told)
}

/// The same of bodies that rolled steadily before something changed a little.
///
/// # Errors
/// Errors of the curve.
pub fn settle_again<E>(
    rolling: &mut Rolling,
    curve: impl Fn(f64) -> Result<f64, E>,
    report: &mut dyn FnMut(u64, u64),
) -> Result<(Means, bool), E> {
    let (before, step) = (rolling.steps(), rolling.step);
    let expected = expected_steps_again(&rolling.asked, step) as u64;
    let mut told = |steps: u64| report(steps - before, expected.max(steps - before));
    roll_to_force(rolling, SETTLE_AGAIN, curve, &mut told)
}

fn roll_to_force<E>(
    rolling: &mut Rolling,
    way: f64,
    curve: impl Fn(f64) -> Result<f64, E>,
    told: &mut dyn FnMut(u64),
) -> Result<(Means, bool), E> {
    rolling.roll(way, told);
    let mut means = rolling.roll(MEASURE, told);
    let Options { force: Some(target), law, .. } = rolling.asked else { return Ok((means, true)) };
    let of = |means: &Means| means.force[0] / (law.coefficient * means.force[2]);
    let (aim, mut search) = (curve(target)?, Search::new());
    for before in 1..=MEASUREMENTS {
        let place = curve(of(&means))?;
        let apart = [place - aim, of(&means) - target].map(f64::abs);
        if apart[0] <= CREEPAGE * aim.abs() || apart[1] <= FORCE {
            return Ok((means, true));
        }
        if before == MEASUREMENTS {
            break;
        }
        rolling.motion.creepage = search.next([rolling.motion.creepage, place], aim);
        rolling.roll(SETTLE_AGAIN, told);
        // Where a force wavers by more than is accepted, a longer mean wavers less.
        let longer = before.div_ceil(2).min(4) as f64;
        means = rolling.roll(longer * MEASURE, told);
    }
    Ok((means, false))
}

/// A search for the creepage of a force.
struct Search {
    /// Creepage of a measurement before, of the elements and of the curve; at first nothing, where both curves begin.
    last: [f64; 2],
    measured: bool,
    slope: f64,
}

impl Search {
    /// Before a measurement both curves are taken to be one.
    fn new() -> Self {
        Self { last: [0.0; 2], measured: false, slope: 1.0 }
    }

    /// The creepage for a place on the curve, after a measurement of both. A slope is taken from measurements that are apart, and not
    /// trusted where both curves would be far from one: forces waver a little.
    fn next(&mut self, now: [f64; 2], target: f64) -> f64 {
        let [creepage, place] = now;
        let apart = creepage - self.last[0];
        if apart.abs() > APART * creepage.abs() {
            self.slope = ((place - self.last[1]) / apart).clamp(0.3, 3.0);
            self.last = now;
        } else if !self.measured {
            self.last = now;
        }
        self.measured = true;
        creepage + (target - place) / self.slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A force of nothing is met too, from no creepage on.
    #[test]
    fn no_force() {
        let (mut creepage, mut search) = (0.0, Search::new());
        for _ in 0..2 {
            creepage = search.next([creepage, 0.9 * creepage - 5e-5], 0.0);
        }
        assert!((0.9 * creepage - 5e-5).abs() < 1e-12, "{creepage}");
    }

    /// Along a curve that is proportional one correction is enough, along one with an offset two. Rounding.
    #[test]
    fn a_creepage_is_found() {
        for (offset, corrections) in [(0.0, 1), (5e-4, 2)] {
            let curve = |creepage: f64| 0.9 * creepage + offset;
            let (mut creepage, mut search) = (-2e-3, Search::new());
            for _ in 0..corrections {
                creepage = search.next([creepage, curve(creepage)], curve(-3e-3));
            }
            assert!((creepage + 3e-3).abs() < 1e-15, "{offset} {creepage}");
        }
    }
}
