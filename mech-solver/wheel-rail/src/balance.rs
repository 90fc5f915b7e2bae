//! The wheels of a wheelset on their rails, one or both: the roll under which both carry their loads, and the angular velocity under a torque.
//!
//! **Roll.** Under given loads every wheel alone has a height z of the axle ([`super::contact`]). A wheelset is one body, and has the roll φ at which
//! both are the same. z_left − z_right falls with the roll by about the distance of the tape circles, less what a flange adds by its slope:
//! φ is looked for by secants, first for the heights at which the wheels touch, then from there for those under load. Both heights agree within
//! [`SAME_HEIGHT`] times the tolerance, over the depth of the wheels; z is their mean.
//!
//! **Torque.** In steady running the torque T that drives the axle and the moment of the contact forces about it, M_y in wheelset axes, are in balance:
//! T + M_y = 0. The angular velocity Ω is looked for at which they are, from the given one: the more the wheels turn, the more they drive, and
//! M_y falls with Ω until all of the contacts slide. With T = 0 the wheelset rolls freely.
//!
//! Source: Vollebregt, User guide for CONTACT (2022), on the Manchester benchmark, whose rolls and angular velocities were found so, wheel by wheel.

use super::contact::WheelOnRail;
use super::error::TrackError;
use super::interface::Interface;
use super::patch::{SolveStats, Solved};
use super::rail::{Deviation, Side};
use super::root::RootSearch;
use super::settings::Vertical;
use super::wheelset::{Motion, Wheelset};
use numerics::team;

/// Difference of the heights of both wheels, over the tolerance of their forces and their depth.
const SAME_HEIGHT: f64 = 3.0;
/// The roll at which both touch is found to this height [m].
const TOUCHING: f64 = 1e-9;
/// First step of the roll [rad], and how far it is looked for.
const ROLL: [f64; 2] = [1e-3, 0.1];
/// First step of the angular velocity over the given one, and how far it is looked for.
const SPIN: [f64; 2] = [1e-4, 0.5];

/// The wheels of a wheelset on their rails.
#[derive(Debug)]
pub struct WheelsetOnTrack {
    wheels: Vec<(Side, WheelOnRail)>,
    /// Share of the forces to which balances are found.
    tolerance: f64,
    /// Distance of the tape circles [m].
    tapes: f64,
    /// Nominal radius [m].
    radius: f64,
    /// The last roll that was found, and the slope there [rad, m].
    rolled: Option<[f64; 2]>,
}

/// Loads of a wheelset, besides its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Along the vertical, of the left wheel and the right; with forces on both wheels the roll is found.
    pub vertical: [Vertical; 2],
    /// Torque that drives the axle forward [N m]; with it the angular velocity is found, from that of the motion on.
    pub torque: Option<f64>,
}

/// A wheelset in balance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Balanced {
    /// Its motion, with height, roll and angular velocity as they were found.
    pub motion: Motion,
    /// Its wheels with their sides, from left to right.
    pub wheels: Vec<(Side, Solved)>,
    /// Work of the solution.
    pub work: SolveStats,
}

impl Balanced {
    /// A sum over the wheels of a force or a moment.
    #[must_use]
    pub fn sum(&self, of: impl Fn(&Solved) -> [f64; 3]) -> [f64; 3] {
        let mut parts = self.wheels.iter().map(|(_, solved)| of(solved));
        let first = parts.next().unwrap_or_default();
        parts.fold(first, |sum, part| std::array::from_fn(|k| sum[k] + part[k]))
    }
}

impl WheelsetOnTrack {
    /// Wheels of a wheelset on their rails, from left to right. Balances are found to this share of the forces.
    #[must_use]
    pub fn new(wheels: Vec<(Side, WheelOnRail)>, tolerance: f64, wheelset: &Wheelset) -> Self {
        let tapes = wheelset.flange_back_distance - 2.0 * wheelset.flange_back_position;
        Self { wheels, tolerance, tapes, radius: wheelset.nominal_radius, rolled: None }
    }

    /// The profiles of rail and wheel of each side in a position, in so many points, y and z in track axes \[m\].
    pub fn outlines(
        &self,
        motion: &Motion,
        deviation: &Deviation,
        count: usize,
    ) -> impl Iterator<Item = (Side, [Vec<[f64; 2]>; 2])> {
        self.wheels
            .iter()
            .map(move |(side, wheel)| (*side, wheel.outlines(motion, deviation, count)))
    }

    /// Forgets the positions before.
    pub fn forget(&mut self) {
        self.wheels.iter_mut().for_each(|(_, wheel)| wheel.forget());
        self.rolled = None;
    }

    /// Solves a position, with what is given of it.
    ///
    /// # Errors
    /// There is no solution, or none was found.
    pub fn solve(
        &mut self,
        motion: &Motion,
        deviation: &Deviation,
        given: &Given,
        interface: &dyn Interface,
    ) -> Result<Balanced, TrackError> {
        let Some(torque) = given.torque else {
            return self.carry(motion, deviation, given, interface);
        };
        let first = motion.angular_velocity;
        let mut balanced = Balanced::default();
        let mut work = SolveStats::default();
        let [step, far] = SPIN;
        let search = RootSearch {
            first,
            slope: -f64::MIN_POSITIVE,
            reach: step * first,
            range: [(1.0 - far) * first, (1.0 + far) * first],
        };
        let mut motion = *motion;
        let found = search.root(|angular_velocity| {
            motion.angular_velocity = angular_velocity;
            balanced = self.carry(&motion, deviation, given, interface)?;
            work = work.and(&balanced.work);
            let up = balanced.sum(|solved| solved.force)[2].abs();
            let moment = balanced.sum(|solved| solved.moment_wheelset)[1];
            Ok::<_, TrackError>((torque + moment, self.tolerance * up * self.radius))
        })?;
        if !found.met {
            return Err(TrackError::Torque { wanted: torque, found: torque - found.value });
        }
        Ok(Balanced { work, ..balanced })
    }

    /// All wheels at one height, or under their loads.
    fn carry(
        &mut self,
        motion: &Motion,
        deviation: &Deviation,
        given: &Given,
        interface: &dyn Interface,
    ) -> Result<Balanced, TrackError> {
        let loaded =
            |vertical: &Vertical| matches!(vertical, Vertical::Force(force) if *force > 0.0);
        if self.wheels.len() < 2 || !given.vertical.iter().all(loaded) {
            return self.each(motion, deviation, given, interface);
        }
        let [step, far] = ROLL;
        let begin =
            RootSearch { first: motion.roll, slope: -self.tapes, reach: step, range: [-far, far] };
        let [first, slope] = match self.rolled {
            Some(rolled) => rolled,
            None => {
                let touching = begin.root(|roll| {
                    let heights = self.touching(&Motion { roll, ..*motion }, deviation)?;
                    Ok::<_, TrackError>((heights[0] - heights[1], TOUCHING))
                })?;
                [touching.place, touching.slope]
            }
        };
        let mut balanced = Balanced::default();
        let mut work = SolveStats::default();
        let search = RootSearch { first, slope, ..begin };
        let found = search.root(|roll| {
            balanced = self.each(&Motion { roll, ..*motion }, deviation, given, interface)?;
            work = work.and(&balanced.work);
            let depth = self.wheels.iter().map(|(_, wheel)| wheel.depth()).fold(0.0, f64::max);
            let [left, right] = [0, 1].map(|wheel| balanced.wheels[wheel].1.z);
            Ok::<_, TrackError>((left - right, SAME_HEIGHT * self.tolerance * depth))
        })?;
        if !found.met {
            return Err(TrackError::Roll { roll: found.place, apart: found.value });
        }
        self.rolled = Some([found.place, found.slope]);
        Ok(Balanced { work, ..balanced })
    }

    /// Heights of the axle at which the wheels touch [m].
    fn touching(&mut self, motion: &Motion, deviation: &Deviation) -> Result<[f64; 2], TrackError> {
        let mut heights = [0.0; 2];
        for ((_, wheel), height) in self.wheels.iter_mut().zip(&mut heights) {
            *height = wheel.touching_height(motion, deviation).ok_or(TrackError::Beside)?;
        }
        Ok(heights)
    }

    /// Every wheel by itself, both at the same time.
    fn each(
        &mut self,
        motion: &Motion,
        deviation: &Deviation,
        given: &Given,
        interface: &dyn Interface,
    ) -> Result<Balanced, TrackError> {
        let solve = |(side, wheel): &mut (Side, WheelOnRail)| {
            let vertical = given.vertical[usize::from(*side == Side::Right)];
            Ok::<_, TrackError>((*side, wheel.solve(motion, deviation, vertical, interface)?))
        };
        let solved = match &mut self.wheels[..] {
            [left, right] => {
                let [left, right] =
                    <[_; 2]>::from(team::both(team::threads(), || solve(left), || solve(right)));
                vec![left?, right?]
            }
            wheels => wheels.iter_mut().map(solve).collect::<Result<_, _>>()?,
        };
        let wheels: Vec<(Side, Solved)> = solved;
        let work =
            wheels.iter().fold(SolveStats::default(), |work, (_, solved)| work.and(&solved.work));
        let z = wheels.iter().map(|(_, solved)| solved.z).sum::<f64>() / wheels.len() as f64;
        Ok(Balanced { motion: Motion { z, ..*motion }, wheels, work })
    }
}
