//! Two bodies that roll on each other, until that is steady.
//!
//! The axle of the upper body has a fixed speed forward and turns with a given surface speed; it is pressed down by the load, with
//! a small mass and critical damping in the place of a vehicle, so that the approach settles within a few elements' passages. The
//! load rises smoothly from nothing while the bodies roll: static and rolling contact arise together, and no static
//! solution is needed. A creepage for a prescribed force is corrected between measurements by the law of Johnson &
//! Vermeulen (Int. J. Mech. Sci. 6 (1964)), F/(fN) = 1 − (1 − ξ/ξ_s)³: with the ξ_s that the first measurement gives, then along
//! the straight line that 1 − ∛(1 − F/(fN)) has over ξ through the last two, where the law has a line through the origin.

use super::block::Block;
use super::contact::{Contact, Frame, Law, Sums};
use super::plane::Plane;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Share of the stable step that is taken.
const SAFETY: f64 = 0.95;
/// β of a step: damping of the highest frequency.
const DAMPING: f64 = 0.05;
/// Ways in half lengths of the contact: over which the load rises, after which what is prescribed has settled, and over
/// which is measured.
const RISE: f64 = 1.5;
const SETTLE: f64 = 3.0;
const SETTLE_AGAIN: f64 = 2.5;
const MEASURE: f64 = 0.5;
/// Creepages that are apart, over themselves.
const APART: f64 = 0.02;
/// Deviation of a force from the prescribed one, over f N, that is accepted, and measurements at most.
const FORCE: f64 = 1e-3;
const MEASUREMENTS: usize = 8;
/// Mass of the axle over the stiffness of the contact and the square of the time in which the load rises.
const AXLE: f64 = 3e-3;

/// What is prescribed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asked {
    /// Rolling speed [m/s].
    pub speed: f64,
    /// Normal force [N].
    pub load: f64,
    /// What holds between the surfaces.
    pub law: Law,
    /// Longitudinal creepage, or where the search for it begins [-].
    pub creepage: f64,
    /// Longitudinal force on the upper body over f N, if that is prescribed.
    pub force: Option<f64>,
    /// Expected half length of the contact [m].
    pub half_length: f64,
    /// Expected stiffness of the contact, dN/dδ [N/m].
    pub stiffness: f64,
    /// Threads, of which two are used at most.
    pub threads: usize,
}

/// Means over a measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Means {
    /// Force on the upper body, forward, left and up [N].
    pub force: [f64; 3],
    /// Normal forces of all nodes [N].
    pub pressed: f64,
    /// Power of friction [W].
    pub friction: f64,
    /// Power that the rigid motion gives the contact [W].
    pub given: f64,
    /// Area that is pressed, and that slides [m²].
    pub areas: [f64; 2],
    /// Approach [m].
    pub approach: f64,
    /// Sweeps of the contact a step.
    pub sweeps: f64,
    /// Share of the steps in which the impulses did not come to rest.
    pub unsettled: f64,
}

/// Steady rolling.
pub struct Rolling {
    asked: Asked,
    /// Upper and lower body.
    pub bodies: [Block; 2],
    contact: Contact,
    /// The plane of the last measurement.
    pub plane: Plane,
    /// Step in time [s].
    pub step: f64,
    /// Creepage [-].
    pub creepage: f64,
    approach: f64,
    rising: f64,
    mass: f64,
    time: f64,
    /// Steps that were taken.
    pub steps: u64,
}

impl Rolling {
    /// Two bodies that touch in a point; the plane of the contact has the middle of `plane`.
    #[must_use]
    pub fn new(mut bodies: [Block; 2], plane: Plane, asked: Asked) -> Self {
        let highest = bodies.iter().map(Block::highest_frequency).fold(0.0, f64::max);
        let longest = SAFETY * 2.0 / highest * ((1.0 + DAMPING * DAMPING).sqrt() - DAMPING);
        let passage = bodies[1].length / asked.speed;
        let step = passage / (passage / longest).ceil();
        bodies.iter_mut().for_each(|body| body.damping = DAMPING * step);
        let rise = RISE * asked.half_length / asked.speed;
        Self {
            contact: Contact::new(&bodies[0], &bodies[1]),
            bodies,
            plane,
            step,
            creepage: asked.creepage,
            approach: 0.0,
            rising: 0.0,
            mass: AXLE * asked.stiffness * rise * rise,
            time: 0.0,
            steps: 0,
            asked,
        }
    }

    /// Steps that it will take, about.
    #[must_use]
    pub fn expected_steps(asked: &Asked, step: f64) -> f64 {
        let measurements = if asked.force.is_some() { 3.0 } else { 1.0 };
        let way = RISE + SETTLE + (measurements - 1.0) * (SETTLE_AGAIN + MEASURE) + MEASURE;
        way * asked.half_length / (asked.speed * step)
    }

    /// Expected half length of the contact [m].
    #[must_use]
    pub fn half_length(&self) -> f64 {
        self.asked.half_length
    }

    /// Speeds at which the material of the upper and lower surface goes back [m/s].
    #[must_use]
    pub fn speeds(&self) -> [f64; 2] {
        [self.asked.speed * (1.0 - self.creepage), self.asked.speed]
    }

    /// Rolls until it is steady with what is prescribed, and measures; `report` hears how many steps of about how many
    /// are taken. The last measurement, and whether the prescribed force was met.
    pub fn settle(&mut self, report: &mut dyn FnMut(u64, u64)) -> (Means, bool) {
        let expected = Self::expected_steps(&self.asked, self.step) as u64;
        let mut told = |steps: u64| report(steps, expected.max(steps));
        if self.asked.threads < 2 {
            return self.measure_all(&mut told, None);
        }
        let step = self.step;
        std::thread::scope(|scope| {
            let ((to, from), (back_to, back)) = (sync_channel::<Block>(1), sync_channel(1));
            scope.spawn(move || {
                while let Ok(mut block) = from.recv() {
                    block.step(step);
                    if back_to.send(block).is_err() {
                        return;
                    }
                }
            });
            let helper = Helper { to, back };
            self.measure_all(&mut told, Some(&helper))
        })
    }

    fn measure_all(&mut self, told: &mut dyn FnMut(u64), helper: Option<&Helper>) -> (Means, bool) {
        self.roll(RISE + SETTLE, told, helper, false);
        let mut means = self.roll(MEASURE, told, helper, true);
        let Some(target) = self.asked.force else { return (means, true) };
        let mut search = Search::default();
        for before in 1..MEASUREMENTS {
            let ratio = means.force[0] / (self.asked.law.coefficient * means.force[2]);
            if (ratio - target).abs() <= FORCE {
                return (means, true);
            }
            self.creepage = search.next([self.creepage, reduced(ratio)], reduced(target));
            self.roll(SETTLE_AGAIN, told, helper, false);
            // Where a force wavers by more than is accepted, a longer mean wavers less.
            let longer = before.div_ceil(2).min(4) as f64;
            means = self.roll(longer * MEASURE, told, helper, true);
        }
        let ratio = means.force[0] / (self.asked.law.coefficient * means.force[2]);
        (means, (ratio - target).abs() <= FORCE)
    }

    /// Rolls over a way in half lengths, in whole passages of elements; means over it, with what happened on the plane if
    /// it `counts`.
    fn roll(
        &mut self,
        way: f64,
        told: &mut dyn FnMut(u64),
        helper: Option<&Helper>,
        counts: bool,
    ) -> Means {
        let passages = (way * self.asked.half_length / self.bodies[1].length).ceil();
        let passage = (self.bodies[1].length / (self.asked.speed * self.step)).round();
        let steps = (passages * passage) as usize;
        if counts {
            self.plane = Plane::new(self.plane.grid, self.plane.first_row);
        }
        let (mut all, mut approach) = (Sums::default(), 0.0);
        for _ in 0..steps {
            let sums = self.advance(helper, counts);
            for k in 0..3 {
                all.impulse[k] += sums.impulse[k];
            }
            for k in 0..2 {
                all.areas[k] += sums.areas[k];
            }
            all.pressed += sums.pressed;
            all.friction += sums.friction;
            all.work += sums.work;
            all.sweeps += sums.sweeps;
            all.unsettled += sums.unsettled;
            approach += self.approach;
            self.steps += 1;
            told(self.steps);
        }
        let (count, time) = (steps as f64, steps as f64 * self.step);
        self.plane.time = time;
        Means {
            force: all.impulse.map(|impulse| impulse / time),
            pressed: all.pressed / time,
            friction: all.friction / time,
            given: all.work / time,
            areas: all.areas.map(|area| area / count),
            approach: approach / count,
            sweeps: all.sweeps as f64 / count,
            unsettled: all.unsettled as f64 / count,
        }
    }

    /// One step.
    fn advance(&mut self, helper: Option<&Helper>, counts: bool) -> Sums {
        let Self { asked, step, .. } = *self;
        match helper {
            Some(helper) => helper.both(&mut self.bodies, step),
            None => self.bodies.iter_mut().for_each(|body| body.step(step)),
        }
        let speeds = self.speeds();
        let ways = speeds.map(|speed| speed * step);
        let frame = Frame {
            approach: self.approach - step * self.rising,
            rising: self.rising,
            speeds,
            ways,
        };
        let (law, plane) = (asked.law, &mut self.plane);
        let sums = self.contact.resolve(self.bodies.each_mut(), &frame, law, step, plane, counts);
        if self.bodies[0].travel(ways[0]) {
            self.contact.shift(&self.bodies[0]);
        }
        self.bodies[1].travel(ways[1]);
        self.time += step;
        let rise = RISE * asked.half_length / asked.speed;
        let part = (self.time / rise).min(1.0);
        let load = asked.load * part * part * (3.0 - 2.0 * part);
        let damping = 2.0 * (asked.stiffness * self.mass).sqrt();
        let pushed = self.rising + (sums.impulse[2] - step * load) / self.mass;
        self.rising = pushed / (1.0 + step * damping / self.mass);
        self.approach -= step * self.rising;
        sums
    }
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

/// A thread that steps the upper body.
struct Helper {
    to: SyncSender<Block>,
    back: Receiver<Block>,
}

impl Helper {
    fn both(&self, bodies: &mut [Block; 2], step: f64) {
        let [upper, lower] = bodies;
        self.to.send(upper.lent()).expect("the thread lives as long as the channel");
        lower.step(step);
        *upper = self.back.recv().expect("the thread panics on its own");
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
