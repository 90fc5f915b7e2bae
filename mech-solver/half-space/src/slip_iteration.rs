//! Friction that follows the slip of every element itself: slip and friction are found in turn.
//!
//! From rest friction falls from pass to pass, from above it rises, so that of several solutions those are found that slip least and most.

use super::tangential::{ElementState, TangentialState};

/// Passes of friction and slip after which they are given up.
const MOST_PASSES: usize = 600;
/// Passes that take all of the slip found; later ones take the share below of its change.
const PLAIN_PASSES: usize = 400;
/// Share of the change of the slip that later passes take.
const DAMPED: f64 = 0.3;
/// Change of the traction bounds, over the largest, at which friction has settled.
const SETTLED: f64 = 1e-7;

/// From which slip velocities the friction of a contact is looked for that follows the slip of every element itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlipStart {
    /// Slip of the step or the row before; at the first from rest.
    Before,
    /// Rest: of several solutions the one that slips least.
    Below,
    /// The rolling speed: of several solutions the one that slips most.
    Above,
}

/// Friction and slip do not settle.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "friction that follows the slip of every element did not settle in {MOST_PASSES} passes: traction bounds still change by {change:.1e} of the \
     largest; let it fall more slowly, or look from another start"
)]
pub struct Unsettled {
    /// Change of the traction bounds over the largest [-].
    pub change: f64,
}

/// The search.
#[derive(Clone, Debug)]
pub struct Settling {
    velocity: Vec<f64>,
    passes: usize,
}

impl Settling {
    /// Looks from slip velocities [m/s] on.
    #[must_use]
    pub fn from(velocity: Vec<f64>) -> Self {
        Self { velocity, passes: 0 }
    }

    /// Slip velocity of every element, by which friction is next [m/s].
    #[must_use]
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Goes towards the slip velocities [m/s] that the latest friction has left; the share of the way.
    pub fn follow(&mut self, now: &[f64]) -> f64 {
        let share = if self.passes < PLAIN_PASSES { 1.0 } else { DAMPED };
        self.passes += 1;
        for (velocity, now) in self.velocity.iter_mut().zip(now) {
            *velocity += share * (now - *velocity);
        }
        share
    }

    /// Returns true if traction bounds [Pa] have settled, after this share of the way.
    ///
    /// # Errors
    /// There were too many passes.
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

/// Slip velocities [m/s] of `count` elements from which those of a contact are looked for: of a state whose step takes `duration` [s], if there is one, from
/// rest or from the rolling speed.
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

/// Slip velocity of every element of a state whose step takes `duration` [s]; 0 where it adheres [m/s].
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
