//! Creepages: motion of the wheel relative to the rail at a patch.
//!
//! The point of the rail is the reference P of the patch. The point of the wheel is Q = P − δ n
//! with the approach δ: rigid slip belongs to undeformed bodies, so that the radius is that of the
//! undeformed wheel. With the velocities v and angular velocities ω of both in track axes, and the
//! axes e_x, t, n of the patch,
//!
//! ξ = (v_Q − v_P)·e_x/V + φ t_P, η = (v_Q − v_P)·t/V − φ x_P, φ = (ω_wheel − ω_rail)·n/V
//!
//! at the origin of the axes, from which P is at (x_P, t_P). The rolling speed
//! V = ½(|v_x| + |Ω-part of v_x|) is the mean of the speeds of the patch along the rail and round
//! the wheel. The track's axes move with the wheelset. In a curve they turn with V_x κ, and the
//! rail turns in the opposite sense.
//!
//! *Off the plane*, with the wheel at the height n_w above Q and the rail at n_r above P, each body
//! adds the slip (ω_t n, −ω_x n); the rail's part is subtracted from the wheel's. Here ω_x and ω_t
//! are components along the axes. This is a rolling radius that varies across the patch, which no
//! creepage describes. n_w is that of the lowest point of a row: along a row both bodies are
//! pressed onto a surface between them, and a particle goes round the axle at the radius of its
//! circle.
//!
//! Source: Kalker (1990) §1.2 for V; CONTACT's user guide, ch. 4, for Q.

use super::local::Frame;
use super::rail::Rail;
use super::wheelset::{Motion, Pose};
use half_space::tangential::Creepage;
use nalgebra::Vector3;
use tables::readable::number;

/// Creepages of the wheel relative to the rail, and the rolling speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rolling {
    /// ξ [-], η [-] and φ [rad/m].
    pub creepage: Creepage,
    /// V [m/s].
    pub speed: f64,
    /// Additional rigid slip off the plane [1/m], along x and along the tangent, per height of the
    /// wheel and of the rail.
    pub by_height: [[f64; 2]; 2],
}

/// Additional rigid slip of a row of elements relative to V, besides the creepages.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RowSlip {
    /// Along x and along the tangent, at x = 0 [-].
    pub slip: [f64; 2],
    /// Spin [1/m]; its slip along the tangent grows with x.
    pub spin: f64,
}

/// Error: the wheelset does not roll forward.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the wheelset does not roll forward: it moves at {along} m/s, and its rim at {round} m/s round the \
     axle; both must be positive", along = number(*.along, 5), round = number(*.round, 5))]
pub struct NotRolling {
    /// Speed of the patch along the rail [m/s].
    pub along: f64,
    /// Speed of the patch round the wheel [m/s].
    pub round: f64,
}

/// Creepages of a patch at the origin of these axes, at this approach [m].
///
/// # Errors
/// Fails if the wheelset does not roll forward.
pub fn rolling(
    frame: &Frame,
    approach: f64,
    rail: &Rail,
    pose: &Pose,
    motion: &Motion,
) -> Result<Rolling, NotRolling> {
    let [ahead, left, up] = frame.axes();
    let on_wheel = frame.reference - up * approach - pose.middle;
    let turning = pose.angular_velocity(motion);
    let middle = Vector3::from(motion.velocity);
    let spinning = pose.rotation * Vector3::new(0.0, motion.angular_velocity, 0.0);
    let round = spinning.cross(&on_wheel);
    let wheel = middle + turning.cross(&on_wheel);

    let [rate_y, rate_z, rate_roll] = rail.rates;
    let curve = -motion.velocity[0] * rail.curvature;
    let on_rail = frame.reference - Vector3::new(0.0, rail.origin[0], rail.origin[1]);
    let rail_turning = Vector3::new(rate_roll, 0.0, curve);
    let of_curve = Vector3::new(0.0, 0.0, curve).cross(&frame.reference);
    let of_roll = Vector3::new(rate_roll, 0.0, 0.0).cross(&on_rail);
    let rail_point = Vector3::new(0.0, rate_y, rate_z) + of_roll + of_curve;

    let along = wheel.x - rail_point.x - round.x;
    if !(along > 0.0 && round.x < 0.0) {
        return Err(NotRolling { along, round: -round.x });
    }
    let speed = 0.5 * (along - round.x);
    let slip = (wheel - rail_point) / speed;
    let spin = (turning - rail_turning).dot(&up) / speed;
    let from_origin = frame.reference - frame.origin;
    let [x, t] = [from_origin.dot(&ahead), from_origin.dot(&left)];
    let creepage = [slip.dot(&ahead) + spin * t, slip.dot(&left) - spin * x, spin];
    let by_height = [turning, -rail_turning]
        .map(|turning| [turning.dot(&left) / speed, -turning.dot(&ahead) / speed]);
    Ok(Rolling { creepage, speed, by_height })
}
