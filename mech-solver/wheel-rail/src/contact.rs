//! A wheel on a rail: the patches at a height of the wheelset, or under a vertical force.
//!
//! **Force.** The depth d of the wheelset below the height at which it touches is looked for at which
//! F_z(d) = Σ N (cos α + κ sin α) over the patches, κ = F_s/N their lateral tractions at last, meets the force:
//! as F_z^(2/3) is linear in d on smooth bodies, by secants of it from (0, 0), within a bracket. Then the tractions
//! are solved, and κ follows; on a flank of 70° an error of κ comes back multiplied by f tan α/(1 + f tan α) < ½.
//!
//! Meanwhile patches stay parted as they were at the first depth. If the criterion says otherwise at the last one,
//! they are parted anew and the height is found again, and after [`MOST_PARTINGS`] times are left as they are: there
//! is no height then at which the criterion holds and the force is met.
//!
//! **Sequences.** One position after another starts from the pressures, the tractions, the depth and the κ of the
//! one before; [`WheelOnRail::forget`] makes a position independent of those before, to the accuracy that is
//! asked for.

use super::error::TrackError;
use super::interface::Interface;
use super::outline::Outline;
use super::pair::{Pair, nearest};
use super::patch::{SolveStats, Solved};
use super::rail::{Deviation, NoGauge, Rail, Side, Track};
use super::settings::{Normal, Settings, Vertical};
use super::surface::Surface;
use super::wheelset::{Motion, Wheel, Wheelset};

/// Heights that are tried for a force.
const MOST_HEIGHTS: usize = 60;
/// Rounds of tractions and heights.
const MOST_ROUNDS: usize = 40;
/// Rounds in which patches are parted or joined anew.
const MOST_PARTINGS: usize = 3;
/// A first depth [m].
const FIRST_DEPTH: f64 = 2e-5;
/// A first depth where the force may jump as the wheel goes down [m], and by how much more the next is.
const FROM_ABOVE: (f64, f64) = (3e-6, 1.25);
/// By how much more the next depth is where it does not.
const LARGEST_STEP: f64 = 3.0;
/// A bracket as narrow as this share of the depth holds a jump.
const COLLAPSED: f64 = 1e-10;
/// Exponent that makes a force linear in the depth.
const LINEAR: f64 = 2.0 / 3.0;

/// A wheel on a rail.
#[derive(Debug)]
pub struct WheelOnRail {
    pair: Pair,
    /// Depth below touching at last [m].
    depth: f64,
    /// Lean of the forces of patches by their tractions, with their places along the tape.
    leaning: Vec<(f64, f64)>,
}

/// A depth and its force.
#[derive(Clone, Copy, Debug)]
struct Trial {
    depth: f64,
    force: f64,
}

impl WheelOnRail {
    /// The wheel and the rail of one side, of profiles in the axes of [`super::profile`].
    ///
    /// # Errors
    /// The rail's profile has no gauge point.
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

    /// The same of surfaces that may vary along the rail and round the wheel, their profiles in the same axes.
    ///
    /// # Errors
    /// The rail's profile has no gauge point.
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

    /// Solves a position: the wheelset, how the rail is off its place, what is given along the vertical, and the
    /// heights and the friction of the elements.
    ///
    /// # Errors
    /// There is no solution, or none was found.
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

    /// The profiles of rail and wheel in a position, in so many points, y and z in track axes \[m\].
    #[must_use]
    pub fn outlines(
        &self,
        motion: &Motion,
        deviation: &Deviation,
        count: usize,
    ) -> [Vec<[f64; 2]>; 2] {
        self.pair.outlines(motion, deviation, count)
    }

    /// Depth below touching of the last position under a force [m].
    #[must_use]
    pub fn depth(&self) -> f64 {
        self.depth
    }

    /// Forgets the positions before.
    pub fn forget(&mut self) {
        self.pair.forget();
        self.depth = FIRST_DEPTH;
        self.leaning.clear();
    }

    /// Looks for the height under a force.
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
            // Several depths may have the force: the least one is meant.
            Normal::Kpec | Normal::Analyn => FROM_ABOVE.0.min(self.depth),
        };
        // Numbers of curved surfaces are those of the bodies where patches in planes carry the force without tractions: whatever was before.
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

    /// Presses to the depth of a force, the tractions leaning as they did last, from a depth on.
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

    /// Vertical force of the pressures, and of tractions that lean as they did.
    fn leaning_force(&self) -> f64 {
        let of = |pressed: &super::pressed::Pressed| {
            let known = nearest(&self.leaning, pressed.region.s, |(s, _)| *s);
            pressed.vertical(known.map_or(0.0, |(_, leaning)| *leaning))
        };
        self.pair.pressed.iter().map(of).sum()
    }

    /// Work of the last position.
    #[must_use]
    pub fn work(&self) -> SolveStats {
        self.pair.work
    }
}
