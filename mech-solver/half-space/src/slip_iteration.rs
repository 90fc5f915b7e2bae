//! Friction that depends on the slip of each element: slip and friction are found in turn.
//!
//! Starting from rest, friction falls from pass to pass; starting from the rolling speed, it rises.
//! If there are several solutions, these starts find the one with the least and the one with the
//! most slip.

use super::tangential::{ElementState, TangentialState};
use tables::readable::number;

/// Limit of passes of friction and slip.
const MOST_PASSES: usize = 600;
/// Passes that take over all of the new slip; later ones take the share below of its change.
const PLAIN_PASSES: usize = 400;
/// Share of the change of slip that later passes take over.
const DAMPED: f64 = 0.3;
/// Friction has settled when the change of the traction bounds, over the largest, is below this.
const SETTLED: f64 = 1e-7;

/// Slip velocities from which to look for friction that depends on the slip of each element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlipStart {
    /// Slip of the previous step or row; rest if there is none.
    Before,
    /// Rest: finds the solution with the least slip.
    Below,
    /// Rolling speed: finds the solution with the most slip.
    Above,
}

/// Friction and slip do not converge.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "friction that depends on the slip of each element did not converge in {MOST_PASSES} passes: \
     traction bounds still change by {change} of the largest; let friction fall more slowly \
     with slip, or choose another start", change = number(*.change, 2))]
pub struct Unsettled {
    /// Change of the traction bounds over the largest [-].
    pub change: f64,
}

/// State of the iteration of friction and slip.
#[derive(Clone, Debug)]
pub struct SlipFrictionIteration {
    velocity: Vec<f64>,
    passes: usize,
}

impl SlipFrictionIteration {
    /// Starts from these slip velocities [m/s].
    #[must_use]
    pub fn from(velocity: Vec<f64>) -> Self {
        Self { velocity, passes: 0 }
    }

    /// Slip velocity of every element that sets the friction of the next pass [m/s].
    #[must_use]
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Moves towards the slip velocities found under the latest friction [m/s]; returns the share
    /// of the change taken.
    pub fn follow(&mut self, now: &[f64]) -> f64 {
        let share = if self.passes < PLAIN_PASSES { 1.0 } else { DAMPED };
        self.passes += 1;
        for (velocity, now) in self.velocity.iter_mut().zip(now) {
            *velocity += share * (now - *velocity);
        }
        share
    }

    /// Returns true if the traction bounds [Pa] have settled after this share of the change.
    ///
    /// # Errors
    /// The bounds still change after the last pass.
    pub fn has_settled(
        &self,
        share: f64,
        before: &[f64],
        bound: &[f64],
    ) -> Result<bool, Unsettled> {
        let largest = before.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let off = bound.iter().zip(before).map(|(bound, before)| (bound - before).abs());
        let change = off.fold(0.0, f64::max) / (share * largest);
        match change <= SETTLED {
            false if self.passes == MOST_PASSES => Err(Unsettled { change }),
            settled => Ok(settled),
        }
    }
}

/// Initial slip velocities [m/s] of `count` elements: of the state `near`, whose step takes
/// `duration` [s], at rest, or at the rolling speed.
#[must_use]
pub fn first_velocities(
    start: SlipStart,
    near: Option<&TangentialState>,
    (count, duration, speed): (usize, f64, f64),
) -> Vec<f64> {
    match (start, near) {
        (SlipStart::Above, _) => vec![speed; count],
        (SlipStart::Before, Some(near)) => slip_velocities(near, duration),
        _ => vec![0.0; count],
    }
}

/// Slip velocity of every element of a state whose step takes `duration` [s]; 0 in adhesion [m/s].
#[must_use]
pub fn slip_velocities(state: &TangentialState, duration: f64) -> Vec<f64> {
    let [sx, sy] = &state.slip;
    let pairs = state.element.iter().zip(sx.iter().zip(sy));
    let velocity = |(element, (x, y)): (&ElementState, (&f64, &f64))| match element {
        ElementState::Slip => x.hypot(*y) / duration,
        _ => 0.0,
    };
    pairs.map(velocity).collect()
}
