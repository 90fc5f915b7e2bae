//! Two bodies that roll on each other, step by step.
//!
//! The axle of the upper body has a fixed speed forward and turns with a given surface speed. On the way to steady rolling it is
//! pressed down by the load, with a small mass and critical damping in the place of a vehicle, so that the approach settles within
//! a few elements' passages; the load rises smoothly from nothing while the bodies roll: static and rolling contact arise
//! together, and no static solution is needed. From there on it may be an axle on a suspension ([`elastic::axle`]).

use super::block::Block;
use super::contact::{Contact, Frame, Law, Sums};
use super::plane::Plane;
use elastic::axle::Axle;
use numerics::team;

/// Share of the stable step that is taken.
const SAFETY: f64 = 0.95;
/// β of a step: damping of the highest frequency.
const DAMPING: f64 = 0.05;
/// Way in half lengths of the contact over which the load rises.
pub const RISE: f64 = 1.5;
/// Mass of the axle over the stiffness of the contact and the square of the time in which the load rises.
const AXLE: f64 = 3e-3;
/// Part of a step that is rounding.
const ROUNDING: f64 = 1e-6;

/// Prescribed motion, load and friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Rolling speed [m/s].
    pub speed: f64,
    /// Normal force [N].
    pub load: f64,
    /// Law of friction between the surfaces.
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

/// Means over some steps.
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
    /// Share of the steps in which the bodies did not touch.
    pub apart: f64,
}

/// Motion of the axle, and the ways and the work so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Creepage [-].
    pub creepage: f64,
    /// Overlap of the undeformed bodies [m].
    pub approach: f64,
    /// Velocity of the upper body upwards [m/s].
    pub rising: f64,
    /// Time since the load began to rise [s].
    pub time: f64,
    /// Ways that both surfaces have gone back since then [m].
    pub travelled: [f64; 2],
    /// Approach, force forward [N] and ways where steady rolling ended.
    pub steady: [f64; 4],
    /// Steps that were taken, a whole number.
    pub steps: f64,
}

impl Motion {
    fn numbers(&mut self) -> [&mut f64; 11] {
        let Self { creepage, approach, rising, time, travelled, steady, steps } = self;
        let ([u, l], [a, b, c, d]) = (travelled, steady);
        [creepage, approach, rising, time, u, l, a, b, c, d, steps]
    }
}

/// Rolling bodies.
pub struct Rolling {
    /// Prescribed motion, load and friction.
    pub asked: Options,
    /// Upper and lower body.
    pub bodies: [Block; 2],
    contact: Contact,
    /// Nodes of contact, and what has happened to them since they were last cleared.
    pub plane: Plane,
    /// Longest step in time [s]; a whole number of them is a passage of an element of the lower body.
    pub step: f64,
    /// The axle.
    pub motion: Motion,
}

impl Rolling {
    /// Two bodies that touch in a point; the plane of the contact has the middle of `plane`.
    #[must_use]
    pub fn new(mut bodies: [Block; 2], plane: Plane, asked: Options) -> Self {
        let highest = bodies.iter().map(Block::highest_frequency).fold(0.0, f64::max);
        let longest = SAFETY * 2.0 / highest * ((1.0 + DAMPING * DAMPING).sqrt() - DAMPING);
        let passage = bodies[1].length / asked.speed;
        let step = passage / (passage / longest).ceil();
        bodies.iter_mut().for_each(|body| body.damping = DAMPING * step);
        Self {
            contact: Contact::new(&bodies[0], &bodies[1]),
            bodies,
            plane,
            step,
            motion: Motion { creepage: asked.creepage, ..Motion::default() },
            asked,
        }
    }

    /// Speeds at which the material of the upper and lower surface goes back [m/s].
    #[must_use]
    pub fn speeds(&self) -> [f64; 2] {
        [self.asked.speed * (1.0 - self.motion.creepage), self.asked.speed]
    }

    /// Steps that were taken.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.motion.steps as u64
    }

    /// Rolls over a way in half lengths of the contact, in whole passages of elements; means over it. `told` hears the steps.
    pub fn roll(&mut self, way: f64, told: &mut dyn FnMut(u64)) -> Means {
        let passages = (way * self.asked.half_length / self.bodies[1].length).ceil();
        let passage = (self.bodies[1].length / (self.asked.speed * self.step)).round();
        self.take((passages * passage) as u64, self.step, None, told)
    }

    /// Lets the first layers of the upper and the lower body expand ([`Block::expand`]).
    pub fn expand(&mut self, stretch: impl Fn(usize, f64, f64) -> f64) {
        for (which, body) in self.bodies.iter_mut().enumerate() {
            body.expand(|x, y| stretch(which, x, y));
        }
    }

    /// Lets the first layers of the upper and the lower body be softer ([`Block::soften`]).
    ///
    /// # Errors
    /// Errors of `shares`.
    pub fn soften<E>(
        &mut self,
        mut shares: impl FnMut(usize, f64, f64, f64) -> Result<[f64; 2], E>,
    ) -> Result<(), E> {
        self.bodies
            .iter_mut()
            .enumerate()
            .try_for_each(|(which, body)| body.soften(|x, y, depth| shares(which, x, y, depth)))
    }

    /// Begins anew from steady rolling, of which these are means.
    pub fn begin(&mut self, means: &Means) {
        let [upper, lower] = self.motion.travelled;
        self.motion.steady = [means.approach, means.force[0], upper, lower];
        // The axle was light and wavered a little.
        self.motion.rising = 0.0;
    }

    /// Rolls for a time [s] on an axle that may move, in steps that are not longer than those of steady rolling; means over it.
    pub fn pass(&mut self, time: f64, axle: &Axle, told: &mut dyn FnMut(u64)) -> Means {
        let count = self.steps_in(time);
        self.take(count, time / count as f64, Some(axle), told)
    }

    /// Steps that such a time [s] takes.
    #[must_use]
    pub fn steps_in(&self, time: f64) -> u64 {
        (time / self.step * (1.0 - ROUNDING)).ceil().max(1.0) as u64
    }

    /// Takes steps of a length [s]; means over them, and what happens on the plane.
    fn take(
        &mut self,
        count: u64,
        step: f64,
        axle: Option<&Axle>,
        told: &mut dyn FnMut(u64),
    ) -> Means {
        self.plane.clear();
        let (mut all, mut approach, mut apart) = (Sums::default(), 0.0, 0_u64);
        for _ in 0..count {
            let sums = self.advance(step, axle);
            all.add(&sums);
            apart += u64::from(sums.pressed == 0.0);
            approach += self.motion.approach;
            self.motion.steps += 1.0;
            told(self.steps());
        }
        let (count, time) = (count as f64, count as f64 * step);
        (self.plane.time, self.plane.step) = (time, step);
        Means {
            force: all.impulse.map(|impulse| impulse / time),
            pressed: all.pressed / time,
            friction: all.friction / time,
            given: all.work / time,
            areas: all.areas.map(|area| area / count),
            approach: approach / count,
            sweeps: all.sweeps as f64 / count,
            unsettled: all.unsettled as f64 / count,
            apart: apart as f64 / count,
        }
    }

    /// A step [s] of both bodies, as if they did not touch.
    pub fn step_bodies(&mut self, step: f64) {
        let [upper, lower] = &mut self.bodies;
        team::both(self.asked.threads, || upper.step(step), || lower.step(step));
    }

    /// One step, with contact.
    fn advance(&mut self, step: f64, axle: Option<&Axle>) -> Sums {
        self.step_bodies(step);
        let speeds = self.speeds();
        let ways = speeds.map(|speed| speed * step);
        let Motion { approach, rising, travelled, steady, .. } = self.motion;
        let frame = Frame {
            approach: approach - step * rising,
            rising,
            speeds,
            ways,
            irregularity: axle.and_then(|axle| axle.irregularity),
            travelled: [travelled[0] - steady[2], travelled[1] - steady[3]],
        };
        let sums = self.contact.resolve(
            self.bodies.each_mut(),
            &frame,
            self.asked.law,
            step,
            &mut self.plane,
        );
        if self.bodies[0].travel(ways[0]) {
            self.contact.shift(&self.bodies[0]);
        }
        self.bodies[1].travel(ways[1]);
        self.motion.time += step;
        for (travelled, way) in self.motion.travelled.iter_mut().zip(ways) {
            *travelled += way;
        }
        match axle {
            Some(axle) => self.carry(axle, &sums, step),
            None => self.press(&sums, step),
        }
        self.motion.approach -= step * self.motion.rising;
        sums
    }

    /// The axle on the way to steady rolling.
    fn press(&mut self, sums: &Sums, step: f64) {
        let Options { half_length, speed, stiffness, load, .. } = self.asked;
        let rise = RISE * half_length / speed;
        let mass = AXLE * stiffness * rise * rise;
        let part = (self.motion.time / rise).min(1.0);
        let load = load * part * part * (3.0 - 2.0 * part);
        let damping = 2.0 * (stiffness * mass).sqrt();
        let pushed = self.motion.rising + (sums.impulse[2] - step * load) / mass;
        self.motion.rising = pushed / (1.0 + step * damping / mass);
    }

    /// An axle on a suspension, and what drives it.
    fn carry(&mut self, axle: &Axle, sums: &Sums, step: f64) {
        let [approach, force, ..] = self.motion.steady;
        let raised = approach - self.motion.approach;
        let load = self.asked.load + axle.stiffness * raised;
        let pushed = self.motion.rising + (sums.impulse[2] - step * load) / axle.mass;
        self.motion.rising = pushed / (1.0 + step * axle.damping / axle.mass);
        if let Some(inertia) = axle.rotary_inertia {
            let radius = self.bodies[0].solid.radius;
            let faster = (step * force - sums.impulse[0]) * radius * radius / inertia;
            self.motion.creepage -= faster / self.asked.speed;
        }
    }

    /// All that the next step depends on, in one order.
    fn state(&mut self, mut each: impl FnMut(&mut [f64])) {
        for body in &mut self.bodies {
            body.state().into_iter().for_each(&mut each);
            each(std::slice::from_mut(&mut body.behind));
        }
        self.contact.state().into_iter().for_each(&mut each);
        self.motion.numbers().into_iter().for_each(|number| each(std::slice::from_mut(number)));
    }

    /// Copies its state, in which the numbers have one order, to where there is room or will be.
    pub fn keep(&mut self, into: &mut Vec<f64>) {
        into.clear();
        self.state(|values| into.extend_from_slice(values));
    }

    /// Takes a state that was kept.
    ///
    /// # Panics
    /// It is of other bodies.
    pub fn restore(&mut self, kept: &[f64]) {
        let mut rest = kept;
        self.state(|values| {
            let (own, more) = rest.split_at(values.len());
            values.copy_from_slice(own);
            rest = more;
        });
        assert!(rest.is_empty(), "a state of these bodies");
    }
}
