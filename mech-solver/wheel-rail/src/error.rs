//! Why a wheel on a rail has no solution.

use super::creepage::NotRolling;
use half_space::grid_continuation::TangentialError;
use half_space::normal::NormalError;
use half_space::slip_iteration::Unsettled;

/// Why a wheel on a rail has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// The bodies are of different materials.
    #[error(
        "wheel and rail are of different elastic constants, whose pressures and tractions act on each other; \
         here they have to be of the same"
    )]
    Different,
    /// The wheel is not above the rail.
    #[error("the wheel is beside the rail: their profiles do not meet at any height")]
    Beside,
    /// The force is none that a contact carries.
    #[error("a vertical force of {0} N cannot press a wheel on a rail")]
    Force(f64),
    /// The force is not met.
    #[error(
        "the height of the wheelset is not found for a vertical force of {wanted:.6e} N: {found:.6e} N is \
         nearest"
    )]
    NotFound {
        /// Force asked for [N].
        wanted: f64,
        /// Force reached [N].
        found: f64,
    },
    /// The wheels do not stand at one height.
    #[error(
        "the roll of the wheelset is not found at which both wheels carry their loads: at {roll:.6e} rad the left \
         one is {apart:.3e} m above the right one; under a flange that is steep both heights rise together"
    )]
    Roll {
        /// Roll that is nearest [rad].
        roll: f64,
        /// Height of the axle over the left wheel less that over the right one [m].
        apart: f64,
    },
    /// The torque is not met.
    #[error(
        "the wheels do not carry a torque of {wanted:.6e} N m at any angular velocity: {found:.6e} N m is nearest"
    )]
    Torque {
        /// Torque asked for [N m].
        wanted: f64,
        /// Torque reached [N m].
        found: f64,
    },
    /// A patch has too many elements.
    #[error(
        "a patch at a penetration of {penetration:.3e} m needs {elements} elements, more than {limit}"
    )]
    Elements {
        /// Penetration of the undeformed bodies [m].
        penetration: f64,
        /// Elements of the patch.
        elements: usize,
        /// Most elements.
        limit: usize,
    },
    /// A patch on a curved surface has too many rows.
    #[error(
        "a patch on a curved surface needs influence numbers of every pair of its {rows} rows, of {elements} elements each, \
         which is too much; take fewer by mech.lateral_resolution"
    )]
    Rows {
        /// Elements of a row.
        elements: usize,
        /// Rows of the patch.
        rows: usize,
    },
    /// Pressure and tractions of a patch on a curved surface.
    #[error(
        "on a curved surface pressure and tractions did not settle: they still change by {change:.1e} of the largest pressure"
    )]
    Turns {
        /// Their change over the largest pressure.
        change: f64,
    },
    /// The normal contact of a patch.
    #[error(transparent)]
    Normal(#[from] NormalError),
    /// The tangential contact of a patch.
    #[error(transparent)]
    Tangential(#[from] TangentialError),
    /// The friction of a patch.
    #[error("{0}")]
    Friction(String),
    /// Friction that follows the slip of every element.
    #[error(transparent)]
    Unsettled(#[from] Unsettled),
    /// The motion of the wheelset.
    #[error(transparent)]
    Rolling(#[from] NotRolling),
}
