//! Load of a contact under an axle that runs over an irregularity, for models whose contact has no
//! inertia.
//!
//! M z̈ = N − N_0 − K z − C ż on the Hertz spring, N = N_0 (δ/δ_0)^{3/2}. The approach is
//! δ = δ_0 − z − h(Vt), and δ_0 is the approach at the load N_0. Without contact N is zero. For a
//! round body of radius R, h is the depth of the rolling body below its height on a smooth surface:
//! the minimum of hollow + ξ²/2R over the distance ξ from the contact. A wheel thus bridges short
//! irregularities.
//!
//! The load depends only on time, not on the windows. The steps are at most a thousandth of the
//! contact period (Runge–Kutta of fourth order), on a grid of their own from the beginning of the
//! run. The load of a window is its mean, the impulse divided by the duration.
//!
//! Source: Jenkins et al., Railway Engng J. 3 (1974) 2–16; Johnson, *Contact Mechanics* (1985),
//! 4.2, for the spring. Neglected: the inertia of the parts near the contact, and the mass of the
//! track.

use crate::case::ellipse::Ellipse;
use crate::case::scene::{Scene, Speeds};
use elastic::axle::{Axle, Irregularity};
use proto::bodies::UPPER;
use std::cell::RefCell;
use std::f64::consts::TAU;

/// Smallest number of steps per period of the wheel on its contact spring.
const STEPS: f64 = 1000.0;
/// Smallest number of steps while an irregularity is passed.
const STEPS_OVER: f64 = 500.0;
/// Number of steps between stored states.
const EVERY: usize = 16;
/// Positions tried around the contact, and interval reductions around the best of them.
const PLACES: usize = 24;
const HALVINGS: usize = 30;
/// Time after an irregularity in which the load may still rise, in periods of the wheel on its
/// contact.
const PERIODS_AFTER: f64 = 3.0;
/// Number of corrugation wavelengths, and of wheel revolutions for a flat, searched for the largest
/// load.
const WAVES: f64 = 100.0;
const TURNS: f64 = 10.0;
/// Largest step relative to the time constants √(M/K) and M/C of the mass on its spring and damper.
const OF_CONSTANTS: f64 = 0.5;

/// Load of a contact over time.
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
    /// States at every [`EVERY`]-th step from 0 on, computed on demand.
    kept: RefCell<Vec<State>>,
}

/// State of the axle at an instant, with the totals since the beginning.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Height above that of steady rolling [m], and its rate [m/s].
    raised: f64,
    rising: f64,
    /// ∫N dt [N s].
    impulse: f64,
    /// Time without contact [s].
    apart: f64,
    /// Largest load [N].
    largest: f64,
}

/// Load of a window.
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
    /// Creates the load under an axle, starting from a contact in equilibrium; `None` if the
    /// approach is unknown.
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

    /// Period of the wheel on its contact spring [s].
    fn period(&self) -> f64 {
        TAU * (self.axle.mass * self.approach / (1.5 * self.load)).sqrt()
    }

    /// Load of the window from `start` to `end` [s].
    pub(crate) fn window(&self, start: f64, end: f64) -> WindowLoad {
        let [first, last] = [start, end].map(|time| self.at(time));
        let mean = match end > start {
            true => (last.impulse - first.impulse) / (end - start),
            false => self.force(&last, end),
        };
        WindowLoad { mean: mean.max(0.0), largest: last.largest, apart: last.apart }
    }

    /// Largest load [N] until the irregularity has been passed and the wheel has settled again. For
    /// corrugation, and for a flat that returns every turn, only the first of them are searched;
    /// the load may rise further after them.
    pub(crate) fn largest(&self) -> f64 {
        self.at(self.looked_at()).largest
    }

    /// Duration that is searched for the largest load [s].
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

    /// Number of steps until the largest load is known.
    pub(crate) fn steps(&self) -> f64 {
        self.looked_at() / self.step
    }

    /// State at a time [s], linear between the steps.
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

    /// Advances height, rate and impulse by one Runge–Kutta step of fourth order.
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

    /// Normal force at a time [N].
    fn force(&self, state: &State, time: f64) -> f64 {
        let bridged =
            self.axle.irregularity.map_or(0.0, |form| self.bridged(&form, self.speed * time));
        let approach = (self.approach - state.raised - bridged).max(0.0);
        self.load * (approach / self.approach).powf(1.5)
    }

    /// Depth of the wheel centre below its height on a smooth surface [m], including the geometric
    /// filtering by the wheel radius.
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
        // Farther away, the profile of the round body exceeds the depth.
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
