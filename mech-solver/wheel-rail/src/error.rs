//! Errors of the contact of a wheel and a rail.

use super::creepage::NotRolling;
use half_space::grid_continuation::TangentialError;
use half_space::normal::NormalError;
use tables::readable::{number, quantity};

/// Reason why a wheel on a rail has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// The bodies have different materials.
    #[error(
        "wheel and rail have different elastic constants, so that pressure and tractions are coupled; \
         this model needs the same constants for both"
    )]
    Different,
    /// The wheel is not above the rail.
    #[error("the wheel is beside the rail: their profiles do not meet at any height")]
    Beside,
    /// A contact cannot carry this force.
    #[error("a vertical force of {0} N cannot press a wheel on a rail")]
    Force(f64),
    /// No height of the wheelset has the requested force.
    #[error(
        "no height of the wheelset gives a vertical force of {wanted}: {found} is the \
         nearest", wanted = quantity(*.wanted, "N", 7), found = quantity(*.found, "N", 7))]
    NotFound {
        /// Requested force [N].
        wanted: f64,
        /// Nearest force found [N].
        found: f64,
    },
    /// No roll angle brings both wheels to one height.
    #[error(
        "no roll of the wheelset lets both wheels carry their loads: at {roll} rad the left \
         one is {apart} above the right one; on a steep flange both heights rise together", roll = number(*.roll, 7), apart = quantity(*.apart, "m", 4))]
    Roll {
        /// Roll of the best attempt [rad].
        roll: f64,
        /// Height of the axle over the left wheel less that over the right one [m].
        apart: f64,
    },
    /// No angular velocity carries the torque.
    #[error(
        "the wheels do not carry a torque of {wanted} N m at any angular velocity: the nearest is {found} N m", wanted = number(*.wanted, 7), found = number(*.found, 7))]
    Torque {
        /// Requested torque [N m].
        wanted: f64,
        /// Nearest torque found [N m].
        found: f64,
    },
    /// A patch has too many elements.
    #[error(
        "a patch at a penetration of {penetration} needs {elements} elements, more than {limit}", penetration = quantity(*.penetration, "m", 4))]
    Elements {
        /// Penetration of the undeformed bodies [m].
        penetration: f64,
        /// Elements of the patch.
        elements: usize,
        /// Largest allowed number of elements.
        limit: usize,
    },
    /// A patch on a curved surface has too many rows.
    #[error(
        "a patch on a curved surface needs influence numbers of every pair of its {rows} rows, of {elements} elements each, \
         which is too much; reduce mech.lateral_resolution"
    )]
    Rows {
        /// Elements of a row.
        elements: usize,
        /// Rows of the patch.
        rows: usize,
    },
    /// Pressure and tractions of a patch on a curved surface did not converge.
    #[error(
        "on a curved surface pressure and tractions did not converge: they still change by {change} of the largest pressure", change = number(*.change, 2))]
    Turns {
        /// Last change relative to the largest pressure.
        change: f64,
    },
    /// The displacements of patches by each other did not converge.
    #[error(
        "patches that displace each other did not converge: their normal forces still change by \
         {change} of the sum; choose elements of another size (mech.resolution), or write \
         mech.patch_influence = \"none\"", change = number(*.change, 2))]
    Patches {
        /// Last change of a normal force relative to the sum of all.
        change: f64,
    },
    /// Error of the normal contact of a patch.
    #[error(transparent)]
    Normal(#[from] NormalError),
    /// Error of the tangential contact of a patch.
    #[error(transparent)]
    Tangential(#[from] TangentialError),
    /// Error of the friction law of a patch.
    #[error("{0}")]
    Friction(String),
    /// The wheelset does not roll forward.
    #[error(transparent)]
    Rolling(#[from] NotRolling),
}
