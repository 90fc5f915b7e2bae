//! Two bodies that roll on each other, step by step.
//!
//! The axle of the upper body has a fixed forward speed and turns with a given surface speed. On
//! the way to steady rolling the load presses it down, with a small mass and critical damping
//! instead of a vehicle, so that the approach converges within the passage of a few elements. The
//! load rises smoothly from zero while the bodies roll. Static and rolling contact arise together,
//! and no static solution is needed. Afterwards the axle may be on a suspension
//! ([`elastic::axle`]).

use super::block::Block;
use super::contact::{Contact, Frame, Law, Sums};
use super::plane::Plane;
use elastic::axle::Axle;
use numerics::team;

/// Ratio of the step to the stable step.
const SAFETY: f64 = 0.95;
/// β of a step: damping ratio of the highest frequency.
const DAMPING: f64 = 0.05;
/// Distance over which the load rises, in half lengths of the contact.
pub const RISE: f64 = 1.5;
/// Mass of the axle, relative to the contact stiffness times the squared time in which the load
/// rises.
const AXLE: f64 = 3e-3;
/// Share of a step that counts as rounding.
const ROUNDING: f64 = 1e-6;

/// Prescribed motion, load and friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Rolling speed [m/s].
    pub speed: f64,
    /// Normal force [N].
    pub load: f64,
    /// Friction law between the surfaces.
    pub law: Law,
    /// Longitudinal creepage, or the start of the search for it [-].
    pub creepage: f64,
    /// Longitudinal force on the upper body over f N, if prescribed.
    pub force: Option<f64>,
    /// Expected half length of the contact [m].
    pub half_length: f64,
    /// Expected stiffness of the contact, dN/dδ [N/m].
    pub stiffness: f64,
    /// Number of threads; at most two are used.
    pub threads: usize,
}

/// Means over a number of steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Means {
    /// Force on the upper body, forward, left and up [N].
    pub force: [f64; 3],
    /// Normal forces of all nodes [N].
    pub pressed: f64,
    /// Friction power [W].
    pub friction: f64,
    /// Power supplied to the contact by the rigid motion [W].
    pub given: f64,
    /// Pressed area and sliding area [m²].
    pub areas: [f64; 2],
    /// Approach [m].
    pub approach: f64,
    /// Contact sweeps per step.
    pub sweeps: f64,
    /// Share of the steps in which the impulses did not converge.
    pub unsettled: f64,
    /// Share of the steps in which the bodies did not touch.
    pub apart: f64,
}

/// Motion of the axle, and the distances covered so far.
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
    /// Distances by which both surfaces have moved back since then [m].
    pub travelled: [f64; 2],
    /// Approach [m], forward force [N] and both distances [m] at the end of steady rolling.
    pub steady: [f64; 4],
    /// Number of steps taken, a whole number.
    pub steps: f64,
}

impl Motion {
    fn numbers(&mut self) -> [&mut f64; 11] {
        let Self { creepage, approach, rising, time, travelled, steady, steps } = self;
        let ([u, l], [a, b, c, d]) = (travelled, steady);
        [creepage, approach, rising, time, u, l, a, b, c, d, steps]
    }
}

/// Two bodies that roll on each other.
pub struct Rolling {
    /// Prescribed motion, load and friction.
    pub asked: Options,
    /// Upper and lower body.
    pub bodies: [Block; 2],
    contact: Contact,
    /// Plane of the contact, with the sums since it was last cleared.
    pub plane: Plane,
    /// Largest step in time [s]; the passage of an element of the lower body takes a whole number
    /// of steps.
    pub step: f64,
    /// Motion of the axle.
    pub motion: Motion,
}

impl Rolling {
    /// Creates two bodies that touch in a point; the plane of the contact has the middle of
    /// `plane`.
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

    /// Speeds at which the material of the upper and lower surface moves back [m/s].
    #[must_use]
    pub fn speeds(&self) -> [f64; 2] {
        [self.asked.speed * (1.0 - self.motion.creepage), self.asked.speed]
    }

    /// Number of steps taken.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.motion.steps as u64
    }

    /// Rolls over a distance in half lengths of the contact, in whole passages of elements. Returns
    /// the means; `told` receives the steps.
    pub fn roll(&mut self, way: f64, told: &mut dyn FnMut(u64)) -> Means {
        let passages = (way * self.asked.half_length / self.bodies[1].length).ceil();
        let passage = (self.bodies[1].length / (self.asked.speed * self.step)).round();
        self.take((passages * passage) as u64, self.step, None, told)
    }

    /// Applies thermal expansion to the first layers of the upper and the lower body
    /// ([`Block::expand`]).
    pub fn expand(&mut self, stretch: impl Fn(usize, f64, f64) -> f64) {
        for (which, body) in self.bodies.iter_mut().enumerate() {
            body.expand(|x, y| stretch(which, x, y));
        }
    }

    /// Applies thermal softening to the first layers of the upper and the lower body
    /// ([`Block::soften`]).
    ///
    /// # Errors
    /// Passes on errors of `shares`.
    pub fn soften<E>(
        &mut self,
        mut shares: impl FnMut(usize, f64, f64, f64) -> Result<[f64; 2], E>,
    ) -> Result<(), E> {
        self.bodies
            .iter_mut()
            .enumerate()
            .try_for_each(|(which, body)| body.soften(|x, y, depth| shares(which, x, y, depth)))
    }

    /// Starts rolling in time from steady rolling with these means.
    pub fn begin(&mut self, means: &Means) {
        let [upper, lower] = self.motion.travelled;
        self.motion.steady = [means.approach, means.force[0], upper, lower];
        // The light axle still oscillates slightly.
        self.motion.rising = 0.0;
    }

    /// Rolls for a time [s] on an axle that may move, in steps not longer than those of steady
    /// rolling. Returns the means.
    pub fn pass(&mut self, time: f64, axle: &Axle, told: &mut dyn FnMut(u64)) -> Means {
        let count = self.steps_in(time);
        self.take(count, time / count as f64, Some(axle), told)
    }

    /// Number of steps that [`Rolling::pass`] takes for a time [s].
    #[must_use]
    pub fn steps_in(&self, time: f64) -> u64 {
        (time / self.step * (1.0 - ROUNDING)).ceil().max(1.0) as u64
    }

    /// Takes steps of a length [s]. Returns the means, and updates the plane.
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

    /// Steps both bodies [s], as if they did not touch.
    pub fn step_bodies(&mut self, step: f64) {
        let [upper, lower] = &mut self.bodies;
        team::both(self.asked.threads, || upper.step(step), || lower.step(step));
    }

    /// Takes one step with contact.
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

    /// Moves the axle on the way to steady rolling.
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

    /// Moves an axle on a suspension, and its drive.
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

    /// Visits the complete state on which the next step depends, in a fixed order.
    fn state(&mut self, mut each: impl FnMut(&mut [f64])) {
        for body in &mut self.bodies {
            body.state().into_iter().for_each(&mut each);
            each(std::slice::from_mut(&mut body.behind));
        }
        self.contact.state().into_iter().for_each(&mut each);
        self.motion.numbers().into_iter().for_each(|number| each(std::slice::from_mut(number)));
    }

    /// Copies the complete state, in a fixed order, into a buffer that grows as needed.
    pub fn keep(&mut self, into: &mut Vec<f64>) {
        into.clear();
        self.state(|values| into.extend_from_slice(values));
    }

    /// Restores a state saved by [`Rolling::keep`].
    ///
    /// # Panics
    /// Panics if the state belongs to other bodies.
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
