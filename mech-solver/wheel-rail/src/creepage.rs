//! How the wheel moves over the rail at a patch.
//!
//! Of the rail it is the reference P of the patch, of the wheel the point Q = P − δ n, δ the approach: as rigid slip
//! is that of undeformed bodies, the radius is that of the undeformed wheel. With their velocities v and angular
//! velocities ω in track axes, and the axes e_x, t, n of the patch,
//!
//! ξ = (v_Q − v_P)·e_x/V + φ t_P, η = (v_Q − v_P)·t/V − φ x_P, φ = (ω_wheel − ω_rail)·n/V
//!
//! at the origin of the axes, from which P is at (x_P, t_P). The rolling speed V = ½(|v_x| + |Ω-part of v_x|) is the mean of the speeds at which the patch goes along the
//! rail and round the wheel. The track's axes go with the wheelset: in a curve they turn with V_x κ, and the rail
//! turns against that.
//!
//! *Off the plane* at the height n_w of the wheel over Q and n_r of the rail over P, rigid slip is
//! (ω_t n, −ω_x n) of the wheel less that of the rail more, with the components ω_x, ω_t along the axes: a rolling
//! radius that varies across the patch, which no creepage has. n_w is that of the lowest point of a row: along a row
//! both bodies are pressed onto a surface between them, and the radius at which a particle goes round the axle is
//! that of its circle.
//!
//! Source: Kalker (1990) §1.2 for V; CONTACT's user guide, ch. 4, for Q.

use super::local::Frame;
use super::rail::Rail;
use super::wheelset::{Motion, Pose};
use half_space::tangential::Creepage;
use nalgebra::Vector3;

/// Creepages of the wheel relative to the rail, and the rolling speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rolling {
    /// ξ [-], η [-] and φ [rad/m].
    pub creepage: Creepage,
    /// V [m/s].
    pub speed: f64,
    /// Rigid slip more off the plane [1/m]: along x and along the tangent, by a height of the wheel and of the
    /// rail.
    pub by_height: [[f64; 2]; 2],
}

/// Rigid slip of a row of elements over V, beside that of the creepages.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RowSlip {
    /// Along x and along the tangent, at x = 0 [-].
    pub slip: [f64; 2],
    /// Spin [1/m]: along the tangent it grows with x.
    pub spin: f64,
}

/// A wheelset that does not roll forward.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the wheelset does not roll forward: it goes at {along:.4e} m/s, and its rim at {round:.4e} m/s round the \
     axle; both have to be above zero"
)]
pub struct NotRolling {
    /// Speed of the patch along the rail [m/s].
    pub along: f64,
    /// Speed of the patch round the wheel [m/s].
    pub round: f64,
}

/// The creepages of a patch with these axes at this approach [m], at their origin.
///
/// # Errors
/// The wheelset does not roll forward.
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
