//! Rolling until that is steady, with the force that is prescribed.
//!
//! A creepage for a prescribed force is corrected between measurements by the law of Johnson & Vermeulen (Int. J. Mech. Sci.
//! 6 (1964)), F/(fN) = 1 − (1 − ξ/ξ_s)³: with the ξ_s that the first measurement gives, then along the straight line
//! that 1 − ∛(1 − F/(fN)) has over ξ through the last two, where the law has a line through the origin.

use super::rolling::{Asked, Means, RISE, Rolling};

/// Ways in half lengths of the contact: after which what is prescribed has settled, and over which is measured.
const SETTLE: f64 = 3.0;
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
    let measurements = if asked.force.is_some() { 3.0 } else { 1.0 };
    let way = RISE + SETTLE + (measurements - 1.0) * (SETTLE_AGAIN + MEASURE) + MEASURE;
    way * asked.half_length / (asked.speed * step)
}

/// Rolls bodies until they do so steadily with what is prescribed, and measures; `report` hears how many steps of about how
/// many are taken. The last measurement, and whether the prescribed force was met.
pub fn settle(rolling: &mut Rolling, report: &mut dyn FnMut(u64, u64)) -> (Means, bool) {
    let expected = expected_steps(&rolling.asked, rolling.step) as u64;
    let mut told = |steps: u64| report(steps, expected.max(steps));
    rolling.roll(RISE + SETTLE, &mut told);
    let mut means = rolling.roll(MEASURE, &mut told);
    let Asked { force: Some(target), law, .. } = rolling.asked else { return (means, true) };
    let of = |means: &Means| means.force[0] / (law.coefficient * means.force[2]);
    let mut search = Search::default();
    for before in 1..MEASUREMENTS {
        if (of(&means) - target).abs() <= FORCE {
            return (means, true);
        }
        let now = [rolling.motion.creepage, reduced(of(&means))];
        rolling.motion.creepage = search.next(now, reduced(target));
        rolling.roll(SETTLE_AGAIN, &mut told);
        // Where a force wavers by more than is accepted, a longer mean wavers less.
        let longer = before.div_ceil(2).min(4) as f64;
        means = rolling.roll(longer * MEASURE, &mut told);
    }
    (means, (of(&means) - target).abs() <= FORCE)
}

/// What the law of Johnson & Vermeulen makes proportional to the creepage, of a force over f N.
fn reduced(ratio: f64) -> f64 {
    ratio.signum() * (1.0 - (1.0 - ratio.abs().min(0.999_999)).cbrt())
}

/// A search for the creepage of a force.
#[derive(Default)]
struct Search {
    /// Creepage and reduced force of a measurement before.
    last: [f64; 2],
    slope: f64,
}

impl Search {
    /// The creepage for a reduced force, after a measurement of both. A slope is taken from measurements that are apart, and not
    /// trusted where it is far from that of the line through the origin: forces waver a little.
    fn next(&mut self, now: [f64; 2], target: f64) -> f64 {
        let [creepage, force] = now;
        let apart = creepage - self.last[0];
        if apart.abs() > APART * creepage.abs() {
            let whole = force / creepage;
            self.slope = whole * ((force - self.last[1]) / (apart * whole)).clamp(0.3, 3.0);
            self.last = now;
        }
        creepage + (target - force) / self.slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With the law itself one correction is enough, with an offset of the creepage two. Rounding.
    #[test]
    fn a_creepage_is_found() {
        for (offset, corrections) in [(0.0, 1), (5e-4, 2)] {
            let force = |creepage: f64| (1.0 - (creepage.abs() - offset) / 0.01).powi(3) - 1.0;
            let (mut creepage, mut search) = (-2e-3, Search::default());
            for _ in 0..corrections {
                creepage = search.next([creepage, reduced(force(creepage))], reduced(-0.5));
            }
            assert!((force(creepage) + 0.5).abs() < 1e-12, "{offset} {creepage}");
        }
    }
}
