//! The load of a contact under an axle that runs over an irregularity, for models whose contact has no inertia.
//!
//! M z̈ = N − N_0 − K z − C ż on Hertz's spring, N = N_0 (δ/δ_0)^{3/2} of the approach δ = δ_0 − z − h(Vt), with the approach δ_0 of the
//! load N_0; without contact N is zero. h is how far the lower body is below the smooth one for a round body of the radius R that rolls over
//! it: the least of the hollow and ξ²/2R in the neighbourhood, so that a wheel bridges what is shorter than itself.
//!
//! The load depends on time alone, and not on windows: steps of a thousandth of the contact's period (Runge–Kutta of fourth order)
//! lie on a grid of their own, from the beginning on, and a window has the mean over it, impulse over duration.
//!
//! Source: Jenkins et al., Railway Engng J. 3 (1974) 2–16; Johnson, *Contact Mechanics* (1985), 4.2, for the spring.
//! Left out: the inertia of what is near the contact, and the mass of the track.

use crate::case::ellipse::Ellipse;
use crate::case::scene::{Scene, Speeds};
use elastic::axle::{Axle, Irregularity};
use proto::bodies::UPPER;
use std::cell::RefCell;
use std::f64::consts::TAU;

/// Steps of a period of the wheel on its contact.
const STEPS: f64 = 1000.0;
/// Steps in the time in which an irregularity is passed, at least.
const STEPS_OVER: f64 = 500.0;
/// Steps from one state that is kept to the next.
const EVERY: usize = 16;
/// Places in the neighbourhood that are tried, and halvings of the interval round the best of them.
const PLACES: usize = 24;
const HALVINGS: usize = 30;
/// Periods of the wheel on its contact after an irregularity in which the load may still rise.
const PERIODS_AFTER: f64 = 3.0;
/// Waves of a corrugation, and turns of a flat, over which is looked for the largest load.
const WAVES: f64 = 100.0;
const TURNS: f64 = 10.0;
/// A step over the time constants of the mass on its spring and damper, √(M/K) and M/C, at most.
const OF_CONSTANTS: f64 = 0.5;

/// A load over time.
#[derive(Debug)]
pub(crate) struct AxleLoad {
    axle: Axle,
    /// N_0 and δ_0 [N, m].
    load: f64,
    approach: f64,
    speed: f64,
    /// Radius and circumference of the upper body [m].
    radius: f64,
    circumference: f64,
    /// Length of a step [s].
    step: f64,
    /// States at every so many steps from 0 on, as far as they were asked for.
    kept: RefCell<Vec<State>>,
}

/// The axle at an instant, and what has been since the beginning.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Height over that of steady rolling [m], and its rate [m/s].
    raised: f64,
    rising: f64,
    /// ∫N dt [N s].
    impulse: f64,
    /// Time without contact [s].
    apart: f64,
    /// Largest load [N].
    largest: f64,
}

/// The load of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WindowLoad {
    /// Mean over the window [N].
    pub(crate) mean: f64,
    /// Largest since the beginning [N].
    pub(crate) largest: f64,
    /// Time without contact since the beginning [s].
    pub(crate) apart: f64,
}

impl AxleLoad {
    /// Under an axle, from a contact in equilibrium; `None` where the approach is not known.
    pub(crate) fn new(axle: Axle, scene: &Scene, ellipse: &Ellipse) -> Option<Self> {
        let Speeds { rolling: speed, .. } = scene.speeds;
        let (load, approach) = (ellipse.normal_force, ellipse.approach?);
        let radius = scene.bodies[UPPER].radius_x;
        let mut own = Self {
            axle,
            load,
            approach,
            speed,
            radius,
            circumference: TAU * radius,
            step: 0.0,
            kept: RefCell::new(vec![State { largest: load, ..State::default() }]),
        };
        let passing = axle.irregularity.map_or(f64::INFINITY, |form| form.length / speed);
        let sprung = (axle.mass / axle.damping).min((axle.mass / axle.stiffness).sqrt());
        own.step = (own.period() / STEPS).min(passing / STEPS_OVER).min(OF_CONSTANTS * sprung);
        Some(own)
    }

    /// Period of the wheel on its contact [s].
    fn period(&self) -> f64 {
        TAU * (self.axle.mass * self.approach / (1.5 * self.load)).sqrt()
    }

    /// The load of a window [s].
    pub(crate) fn window(&self, start: f64, end: f64) -> WindowLoad {
        let [first, last] = [start, end].map(|time| self.at(time));
        let mean = match end > start {
            true => (last.impulse - first.impulse) / (end - start),
            false => self.force(&last, end),
        };
        WindowLoad { mean: mean.max(0.0), largest: last.largest, apart: last.apart }
    }

    /// The largest load until all of the irregularity has been passed and the wheel has come down again; of waves, and of a flat that
    /// comes round, that of the first of them, after which it may still rise [N].
    pub(crate) fn largest(&self) -> f64 {
        self.at(self.looked_at()).largest
    }

    /// The time until then [s].
    fn looked_at(&self) -> f64 {
        let way = match self.axle.irregularity {
            None => return 0.0,
            Some(form) if form.begins() == form.at => form.at + WAVES * form.length,
            Some(form) if form.body() == UPPER && self.circumference.is_finite() => {
                form.at + form.length + TURNS * self.circumference
            }
            Some(form) => form.at + form.length,
        };
        way / self.speed + PERIODS_AFTER * self.period()
    }

    /// Steps until the largest load is known.
    pub(crate) fn steps(&self) -> f64 {
        self.looked_at() / self.step
    }

    /// The state at a time, on a straight line between steps [s].
    fn at(&self, time: f64) -> State {
        let place = (time / self.step).max(0.0);
        let before = place as usize;
        let mut kept = self.kept.borrow_mut();
        while kept.len() <= before / EVERY {
            let number = (kept.len() - 1) * EVERY;
            let next = (number..number + EVERY).fold(kept[kept.len() - 1], |state, number| {
                self.next(&state, number as f64 * self.step)
            });
            kept.push(next);
        }
        let number = before / EVERY * EVERY;
        let low = (number..before).fold(kept[before / EVERY], |state, number| {
            self.next(&state, number as f64 * self.step)
        });
        let share = place - before as f64;
        if share == 0.0 {
            return low;
        }
        let high = self.next(&low, before as f64 * self.step);
        let between = |of: fn(&State) -> f64| of(&low) + share * (of(&high) - of(&low));
        State {
            raised: between(|state| state.raised),
            rising: between(|state| state.rising),
            impulse: between(|state| state.impulse),
            apart: between(|state| state.apart),
            largest: high.largest,
        }
    }

    /// A step of the Runge–Kutta scheme of fourth order, of height, rate and impulse.
    fn next(&self, state: &State, time: f64) -> State {
        let Axle { mass, stiffness, damping, .. } = self.axle;
        let rate = |[raised, rising]: [f64; 2], time: f64| {
            let force = self.force(&State { raised, rising, ..*state }, time);
            let pushed = force - self.load - stiffness * raised - damping * rising;
            [rising, pushed / mass, force]
        };
        let from = [state.raised, state.rising];
        let plus = |rate: [f64; 3], step: f64| [from[0] + step * rate[0], from[1] + step * rate[1]];
        let step = self.step;
        let first = rate(from, time);
        let second = rate(plus(first, 0.5 * step), time + 0.5 * step);
        let third = rate(plus(second, 0.5 * step), time + 0.5 * step);
        let fourth = rate(plus(third, step), time + step);
        let mean = |k: usize| (first[k] + 2.0 * second[k] + 2.0 * third[k] + fourth[k]) / 6.0;
        let apart = if second[2] == 0.0 { step } else { 0.0 };
        State {
            raised: state.raised + step * mean(0),
            rising: state.rising + step * mean(1),
            impulse: state.impulse + step * mean(2),
            apart: state.apart + apart,
            largest: state.largest.max(fourth[2]),
        }
    }

    /// N at a time [N].
    fn force(&self, state: &State, time: f64) -> f64 {
        let bridged =
            self.axle.irregularity.map_or(0.0, |form| self.bridged(&form, self.speed * time));
        let approach = (self.approach - state.raised - bridged).max(0.0);
        self.load * (approach / self.approach).powf(1.5)
    }

    /// How far a wheel is below its smooth way that bridges what is shorter than itself [m].
    fn bridged(&self, form: &Irregularity, way: f64) -> f64 {
        let hollow = |at: f64| form.hollow(at, self.circumference);
        if !self.radius.is_finite() || self.radius <= 0.0 {
            return hollow(way);
        }
        let height = |from: f64| hollow(way + from) + 0.5 * from * from / self.radius;
        let own = hollow(way);
        if own == 0.0 {
            return 0.0;
        }
        // Beyond this the round body itself is higher.
        let reach = (2.0 * self.radius * own).sqrt();
        let width = 2.0 * reach / PLACES as f64;
        let places = (0..=PLACES).map(|k| -reach + k as f64 * width);
        let best = places.min_by(|a, b| height(*a).total_cmp(&height(*b))).unwrap_or(0.0);
        let (mut low, mut high) = (best - width, best + width);
        for _ in 0..HALVINGS {
            let [first, second] = [1.0 / 3.0, 2.0 / 3.0].map(|share| low + share * (high - low));
            if height(first) < height(second) { high = second } else { low = first }
        }
        height(0.5 * (low + high)).min(own)
    }
}
