//! A wheel on a rail: the contact patches at a given height of the wheelset, or under a vertical
//! force.
//!
//! **Force.** The unknown is the depth d of the wheelset below the height at which it touches. The
//! vertical force is F_z(d) = Σ N (cos α + κ sin α) over the patches, with the ratio κ = F_s/N of
//! the latest lateral tractions. On smooth bodies F_z^(2/3) is linear in d. Secants of that power,
//! starting at (0, 0) and kept within a bracket, therefore find the depth. Then the tractions are
//! solved and give a new κ. On a flank of 70° an error of κ comes back multiplied by f tan α/(1 + f
//! tan α) < ½.
//!
//! Meanwhile the separation into patches stays as it was at the first depth. If the criterion for
//! patches differs at the final depth, the patches are separated anew and the height is solved
//! again. After [`MOST_PARTINGS`] rounds they are left as they are: then no height satisfies both
//! the criterion and the force.
//!
//! **Sequences.** Each position starts from the pressures, tractions, depth and κ of the previous
//! one. [`WheelOnRail::forget`] makes a position independent of earlier ones, to the requested
//! accuracy.

use super::error::TrackError;
use super::interface::Interface;
use super::outline::Outline;
use super::pair::{Pair, nearest};
use super::patch::{SolveStats, Solved};
use super::rail::{Deviation, NoGauge, Rail, Side, Track};
use super::settings::{Normal, Settings, Vertical};
use super::surface::Surface;
use super::wheelset::{Motion, Wheel, Wheelset};

/// Most heights tried for one force.
const MOST_HEIGHTS: usize = 60;
/// Most alternations between tractions and heights.
const MOST_ROUNDS: usize = 40;
/// Most rounds in which patches are split or joined anew.
const MOST_PARTINGS: usize = 3;
/// First depth of the search [m].
const FIRST_DEPTH: f64 = 2e-5;
/// First depth [m] where the force may jump as the wheel goes down, and growth factor of the depth
/// there.
const FROM_ABOVE: (f64, f64) = (3e-6, 1.25);
/// Growth factor of the depth where the force does not jump.
const LARGEST_STEP: f64 = 3.0;
/// Width of a bracket, relative to the depth, below which it holds a jump of the force.
const COLLAPSED: f64 = 1e-10;
/// Exponent that makes the force linear in the depth.
const LINEAR: f64 = 2.0 / 3.0;

/// A wheel on a rail.
#[derive(Debug)]
pub struct WheelOnRail {
    pair: Pair,
    /// Latest depth below touching [m].
    depth: f64,
    /// Position along the tape and ratio F_s/N of each patch of the last solution.
    leaning: Vec<(f64, f64)>,
}

/// Depth and the vertical force there.
#[derive(Clone, Copy, Debug)]
struct Trial {
    depth: f64,
    force: f64,
}

impl WheelOnRail {
    /// Creates the wheel and the rail of one side, from profiles in the axes of [`super::profile`].
    ///
    /// # Errors
    /// Fails if the rail's profile has no gauge point.
    pub fn new(
        profiles: [&Outline; 2],
        side: Side,
        track: &Track,
        wheelset: &Wheelset,
        settings: Settings,
    ) -> Result<Self, NoGauge> {
        let surfaces = profiles.map(|profile| Surface::from(profile.clone()));
        Self::of_surfaces(&surfaces, side, track, wheelset, settings)
    }

    /// Creates the wheel and the rail of one side from surfaces that may vary along the rail and
    /// round the wheel. Profiles are in the axes of [`super::profile`].
    ///
    /// # Errors
    /// Fails if the rail's profile has no gauge point.
    pub fn of_surfaces(
        [wheel, rail]: &[Surface; 2],
        side: Side,
        track: &Track,
        wheelset: &Wheelset,
        settings: Settings,
    ) -> Result<Self, NoGauge> {
        let rail = Rail::placed(rail, side, track)?;
        let wheel = Wheel::placed(wheel, side, wheelset);
        let pair = Pair::new((rail, wheel), side, *wheelset, settings);
        Ok(Self { pair, depth: FIRST_DEPTH, leaning: Vec::new() })
    }

    /// Solves one position, given the motion of the wheelset, the deviation of the rail, the
    /// condition along the vertical, and the heights and friction of the interface.
    ///
    /// # Errors
    /// Fails if the bodies have different elastic constants, if the wheel is beside the rail, if
    /// the force is negative or not reached, if a patch is too large, or if a contact or its
    /// friction does not converge.
    pub fn solve(
        &mut self,
        motion: &Motion,
        deviation: &Deviation,
        vertical: Vertical,
        interface: &dyn Interface,
    ) -> Result<Solved, TrackError> {
        if self.pair.settings.bodies.is_coupled() {
            return Err(TrackError::Different);
        }
        self.pair.go_to(motion, deviation);
        match vertical {
            Vertical::Height => {
                self.pair.press(interface)?;
                self.pair.complete()?;
                self.pair.slide(interface)
            }
            Vertical::Force(force) if force >= 0.0 && force.is_finite() => {
                self.under(force, interface)
            }
            Vertical::Force(force) => Err(TrackError::Force(force)),
        }
    }

    /// Height of the wheelset at which the wheel touches in a position [m]; `None` beside the rail.
    pub fn touching_height(&mut self, motion: &Motion, deviation: &Deviation) -> Option<f64> {
        self.pair.go_to(motion, deviation);
        self.pair.touching_height()
    }

    /// Returns the profiles of rail and wheel in a position, as `count` points y and z in track
    /// axes \[m\].
    #[must_use]
    pub fn outlines(
        &self,
        motion: &Motion,
        deviation: &Deviation,
        count: usize,
    ) -> [Vec<[f64; 2]>; 2] {
        self.pair.outlines(motion, deviation, count)
    }

    /// Depth below touching of the last position solved under a force [m].
    #[must_use]
    pub fn depth(&self) -> f64 {
        self.depth
    }

    /// Discards the state of earlier positions.
    pub fn forget(&mut self) {
        self.pair.forget();
        self.depth = FIRST_DEPTH;
        self.leaning.clear();
    }

    /// Finds the height under a vertical force.
    fn under(&mut self, force: f64, interface: &dyn Interface) -> Result<Solved, TrackError> {
        let touching = self.pair.touching_height().ok_or(TrackError::Beside)?;
        if force == 0.0 {
            self.pair.lift_to(touching);
            let solved = Solved { z: touching, ..Solved::default() };
            return Ok(solved);
        }
        let tolerance = self.pair.settings.tolerance * force;
        let (mut found, mut partings) = (0.0, 0);
        let mut depth = match self.pair.settings.normal {
            Normal::HalfSpace => self.depth,
            // Several depths may have this force. Start shallow to find the smallest.
            Normal::Kpec | Normal::Analyn => FROM_ABOVE.0.min(self.depth),
        };
        // Compute the influence numbers of curved surfaces at the height where plane patches carry
        // the force without tractions, so that they do not depend on earlier positions.
        if self.pair.is_curved() {
            self.leaning.clear();
            self.pair.stay_plane();
            depth = self.press_to(touching, (force, depth), interface)?.depth;
            self.pair.turn();
        }
        for _ in 0..MOST_ROUNDS {
            let trial = self.press_to(touching, (force, depth), interface)?;
            self.depth = trial.depth;
            self.pair.complete()?;
            let solved = self.pair.slide(interface)?;
            found = solved.force[2];
            self.leaning = solved.patches.iter().map(|patch| (patch.tape, patch.leaning)).collect();
            if (found - force).abs() <= tolerance {
                partings += 1;
                if partings > MOST_PARTINGS || self.pair.part() {
                    return Ok(solved);
                }
            }
            depth = trial.depth * (force / found).powf(LINEAR);
        }
        Err(TrackError::NotFound { wanted: force, found })
    }

    /// Presses the wheel to the depth of a force, from a first depth on, with F_s/N of each patch
    /// kept.
    fn press_to(
        &mut self,
        touching: f64,
        (force, first): (f64, f64),
        interface: &dyn Interface,
    ) -> Result<Trial, TrackError> {
        let mut last = Trial { depth: 0.0, force: 0.0 };
        let tolerance = 0.3 * self.pair.settings.tolerance * force;
        let largest_step = match self.pair.settings.normal {
            Normal::HalfSpace => LARGEST_STEP,
            Normal::Kpec | Normal::Analyn => FROM_ABOVE.1,
        };
        let mut bracket = [0.0, f64::INFINITY];
        let mut depth = first;
        for _ in 0..MOST_HEIGHTS {
            self.pair.lift_to(touching - depth);
            self.pair.press(interface)?;
            let trial = Trial { depth, force: self.leaning_force() };
            let off = trial.force - force;
            if off.abs() <= tolerance {
                return Ok(trial);
            }
            bracket[usize::from(off > 0.0)] = depth;
            let linear = |trial: &Trial| trial.force.max(0.0).powf(LINEAR);
            let rise = (linear(&trial) - linear(&last)) / (trial.depth - last.depth);
            let next = depth + (force.powf(LINEAR) - linear(&trial)) / rise;
            let [low, high] = bracket;
            if high.is_finite() && high - low <= COLLAPSED * high {
                return Err(TrackError::NotFound { wanted: force, found: trial.force });
            }
            depth = match next > low && next < high {
                true => next.min(largest_step * depth),
                false if high.is_finite() => 0.5 * (low + high),
                false => 2.0 * depth,
            };
            last = trial;
        }
        Err(TrackError::NotFound { wanted: force, found: last.force })
    }

    /// Vertical force of the pressures, and of lateral tractions with the known F_s/N.
    fn leaning_force(&self) -> f64 {
        let of = |pressed: &super::pressed::NormalPatch| {
            let known = nearest(&self.leaning, pressed.region.s, |(s, _)| *s);
            pressed.vertical(known.map_or(0.0, |(_, leaning)| *leaning))
        };
        self.pair.pressed.iter().map(of).sum()
    }

    /// Work counters of the last position.
    #[must_use]
    pub fn work(&self) -> SolveStats {
        self.pair.work
    }
}
