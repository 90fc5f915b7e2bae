//! Slip velocities of the elements, on which friction may depend.
//!
//! A falling law of friction may have several solutions in a step of transient rolling. The slip at
//! the start selects one of them: rest the one with the least slip, the rolling speed the one with
//! the most slip.

use super::tangential::{ElementState, TangentialState};

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
