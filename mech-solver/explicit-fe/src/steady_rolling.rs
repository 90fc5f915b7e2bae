//! Rolling until steady, with the prescribed force or creepage.
//!
//! For a prescribed force the creepage is corrected between measurements along an approximate creep
//! curve ξ(F). The first correction uses the ratio of the measured creepage to that of the curve.
//! Later ones use the straight line, of the curve's ξ over the elements' ξ, through the last two
//! measurements.

use super::rolling::{Means, Options, RISE, Rolling};

/// Distances in half lengths of the contact: for the contact to become steady, the same after a
/// small change, and for a measurement.
const SETTLE: f64 = 4.5;
const SETTLE_AGAIN: f64 = 3.0;
const MEASURE: f64 = 1.0;
/// Relative difference above which two creepages count as distinct.
const APART: f64 = 0.02;
/// Accepted deviations: of the creepage along the curve, relative to that of the prescribed force,
/// or of the force, relative to f N. Largest number of measurements.
const CREEPAGE: f64 = 4e-3;
const FORCE: f64 = 3e-4;
const MEASUREMENTS: usize = 8;

/// Approximate number of steps of a length [s] until rolling is steady.
#[must_use]
pub fn expected_steps(asked: &Options, step: f64) -> f64 {
    let measurements = if asked.force.is_some() && asked.law.sticks { 2.0 } else { 1.0 };
    let way = RISE + SETTLE + (measurements - 1.0) * (SETTLE_AGAIN + MEASURE) + MEASURE;
    way * asked.half_length / (asked.speed * step)
}

/// Approximate number of steps until rolling is steady again after a change.
#[must_use]
pub fn expected_steps_again(asked: &Options, step: f64) -> f64 {
    (SETTLE_AGAIN + MEASURE) * asked.half_length / (asked.speed * step)
}

/// Rolls the bodies until they are steady under the prescribed values, and measures. `report`
/// receives the steps taken and their expected total. `curve` returns an approximate creepage for a
/// force over f N. Returns the last measurement, and whether the prescribed force was met.
///
/// # Errors
/// Passes on errors of the curve.
pub fn settle<E>(
    rolling: &mut Rolling,
    curve: impl Fn(f64) -> Result<f64, E>,
    report: &mut dyn FnMut(u64, u64),
) -> Result<(Means, bool), E> {
    let expected = expected_steps(&rolling.asked, rolling.step) as u64;
    let mut told = |steps: u64| report(steps, expected.max(steps));
    roll_to_force(rolling, RISE + SETTLE, curve, &mut told)
}

/// Rolls bodies that were steady before a small change until they are steady again, like
/// [`settle`].
///
/// # Errors
/// Passes on errors of the curve.
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
        // If a force oscillates by more than the accepted deviation, average over a longer
        // distance.
        let longer = before.div_ceil(2).min(4) as f64;
        means = rolling.roll(longer * MEASURE, told);
    }
    Ok((means, false))
}

/// Search for the creepage of a force.
struct Search {
    /// Last measured creepage, of the elements and of the curve; initially zero, where both curves
    /// begin.
    last: [f64; 2],
    measured: bool,
    slope: f64,
}

impl Search {
    /// Until a measurement both curves are assumed equal.
    fn new() -> Self {
        Self { last: [0.0; 2], measured: false, slope: 1.0 }
    }

    /// Returns the creepage for a target on the curve, after a measurement of both. The slope is
    /// updated only from distinct creepages, and bounded around one, because forces oscillate
    /// slightly.
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

    /// A force of zero is met as well, starting from zero creepage.
    #[test]
    fn no_force() {
        let (mut creepage, mut search) = (0.0, Search::new());
        for _ in 0..2 {
            creepage = search.next([creepage, 0.9 * creepage - 5e-5], 0.0);
        }
        assert!((0.9 * creepage - 5e-5).abs() < 1e-12, "{creepage}");
    }

    /// A proportional curve needs one correction, a curve with an offset two. Tolerance: rounding.
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
