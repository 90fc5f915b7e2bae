//! Balance of a wheelset with one or two wheels on rails: the roll angle at which both wheels carry
//! their loads, and the angular velocity under a driving torque.
//!
//! **Roll.** Under a given load each wheel alone determines a height z of the axle
//! ([`super::contact`]). A wheelset is one body: at its roll angle φ both heights are equal. The
//! difference z_left − z_right falls with the roll by about the distance of the tape circles, less
//! a part due to the slope of a flange. Secants find φ, first for the heights at which the wheels
//! touch, then from there for the heights under load. Both heights agree within [`SAME_HEIGHT`]
//! times the tolerance times the depth of the wheels; z is their mean.
//!
//! **Torque.** In steady running the driving torque T of the axle balances the moment M_y of the
//! contact forces about the axle, in wheelset axes: T + M_y = 0. The search for the angular
//! velocity Ω starts from the given one. The faster the wheels turn, the more they drive: M_y falls
//! with Ω until all contacts slide. With T = 0 the wheelset rolls freely.
//!
//! Source: Vollebregt, User guide for CONTACT (2022), on the Manchester benchmark, where rolls and
//! angular velocities were found in this way, wheel by wheel.

use super::contact::WheelOnRail;
use super::error::TrackError;
use super::interface::Interface;
use super::patch::{SolveStats, Solved};
use super::rail::{Deviation, Side};
use super::root::RootSearch;
use super::settings::Vertical;
use super::wheelset::{Motion, Wheelset};
use numerics::team;

/// Allowed difference of the heights of both wheels, relative to the force tolerance times the
/// depth.
const SAME_HEIGHT: f64 = 3.0;
/// Tolerance of the height in the search for the roll at which both wheels touch [m].
const TOUCHING: f64 = 1e-9;
/// First step and largest magnitude of the roll in the search [rad].
const ROLL: [f64; 2] = [1e-3, 0.1];
/// First step and largest change of the angular velocity in the search, relative to the given one.
const SPIN: [f64; 2] = [1e-4, 0.5];

/// The wheels of a wheelset on their rails.
#[derive(Debug)]
pub struct WheelsetOnTrack {
    wheels: Vec<(Side, WheelOnRail)>,
    /// Tolerance of the balances, as a share of the forces.
    tolerance: f64,
    /// Lateral distance of the tape circles [m].
    tapes: f64,
    radius: f64,
    /// Last roll found [rad], and the slope of the height difference there [m/rad].
    rolled: Option<[f64; 2]>,
}

/// Loads of a wheelset, besides its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelsetLoads {
    /// Condition along the vertical for the left and the right wheel. With forces on both wheels
    /// the roll is solved for.
    pub vertical: [Vertical; 2],
    /// Torque that drives the axle forward [N m]. If given, the angular velocity is solved for,
    /// starting from the one in the motion.
    pub torque: Option<f64>,
}

/// A wheelset in balance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WheelsetSolution {
    /// Motion of the wheelset, with the height, roll and angular velocity in balance.
    pub motion: Motion,
    /// Solved wheels with their sides, from left to right.
    pub wheels: Vec<(Side, Solved)>,
    /// Work counters of the solution.
    pub work: SolveStats,
}

impl WheelsetSolution {
    /// Sums a force or moment vector over the wheels.
    #[must_use]
    pub fn sum(&self, of: impl Fn(&Solved) -> [f64; 3]) -> [f64; 3] {
        let mut parts = self.wheels.iter().map(|(_, solved)| of(solved));
        let first = parts.next().unwrap_or_default();
        parts.fold(first, |sum, part| std::array::from_fn(|k| sum[k] + part[k]))
    }
}

impl WheelsetOnTrack {
    /// Creates the wheelset from its wheels on their rails, from left to right. The tolerance of
    /// the balances is a share of the forces.
    #[must_use]
    pub fn new(wheels: Vec<(Side, WheelOnRail)>, tolerance: f64, wheelset: &Wheelset) -> Self {
        let tapes = wheelset.flange_back_distance - 2.0 * wheelset.flange_back_position;
        Self { wheels, tolerance, tapes, radius: wheelset.nominal_radius, rolled: None }
    }

    /// Returns the profiles of rail and wheel of each side in a position, as `count` points y and z
    /// in track axes \[m\].
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

    /// Discards the state of earlier positions.
    pub fn forget(&mut self) {
        self.wheels.iter_mut().for_each(|(_, wheel)| wheel.forget());
        self.rolled = None;
    }

    /// Solves one position under the given loads.
    ///
    /// # Errors
    /// Fails if a contact has no solution, if the roll or angular velocity does not converge, or if
    /// the wheelset does not roll forward.
    pub fn solve(
        &mut self,
        motion: &Motion,
        deviation: &Deviation,
        given: &WheelsetLoads,
        interface: &dyn Interface,
    ) -> Result<WheelsetSolution, TrackError> {
        let Some(torque) = given.torque else {
            return self.carry(motion, deviation, given, interface);
        };
        let first = motion.angular_velocity;
        let mut balanced = WheelsetSolution::default();
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
        Ok(WheelsetSolution { work, ..balanced })
    }

    /// Solves all wheels at the given height, or finds the roll under two loads.
    fn carry(
        &mut self,
        motion: &Motion,
        deviation: &Deviation,
        given: &WheelsetLoads,
        interface: &dyn Interface,
    ) -> Result<WheelsetSolution, TrackError> {
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
        let mut balanced = WheelsetSolution::default();
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
        Ok(WheelsetSolution { work, ..balanced })
    }

    /// Heights of the axle at which the wheels touch [m].
    fn touching(&mut self, motion: &Motion, deviation: &Deviation) -> Result<[f64; 2], TrackError> {
        let mut heights = [0.0; 2];
        for ((_, wheel), height) in self.wheels.iter_mut().zip(&mut heights) {
            *height = wheel.touching_height(motion, deviation).ok_or(TrackError::Beside)?;
        }
        Ok(heights)
    }

    /// Solves every wheel independently, both of them in parallel.
    fn each(
        &mut self,
        motion: &Motion,
        deviation: &Deviation,
        given: &WheelsetLoads,
        interface: &dyn Interface,
    ) -> Result<WheelsetSolution, TrackError> {
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
        Ok(WheelsetSolution { motion: Motion { z, ..*motion }, wheels, work })
    }
}
