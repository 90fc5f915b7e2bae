//! What can go wrong in a normal contact.

use crate::prescribed::Prescribed;
use thiserror::Error;

/// Why a normal contact has no solution, or none was found.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum NormalError {
    /// The load is negative or not finite.
    #[error("a normal force of {force} N cannot press two bodies together")]
    Load {
        /// Prescribed normal force [N].
        force: f64,
    },
    /// The approach is not finite.
    #[error("an approach of {approach} m is not a number to work with")]
    Approach {
        /// Prescribed approach [m].
        approach: f64,
    },
    /// An undeformed distance is not finite.
    #[error("the undeformed distance of element {element} is {distance} m")]
    Distance {
        /// Index of the element.
        element: usize,
        /// Undeformed distance there [m].
        distance: f64,
    },
    /// The contact outgrows the largest grid allowed.
    #[error(
        "the contact reaches the edge of a grid of {nx} x {ny} elements, and a larger one would \
         exceed {limit} elements"
    )]
    GridLimit {
        /// Elements along x.
        nx: usize,
        /// Elements along y.
        ny: usize,
        /// Most elements allowed.
        limit: usize,
    },
    /// The bodies touch at places too far apart for one grid.
    #[error(
        "the bodies also touch at {y:.4e} m from the first touch, and a grid that holds both places \
         would have {elements} elements, more than {limit}"
    )]
    FarApart {
        /// Lateral coordinate of the farther place [m].
        y: f64,
        /// Elements of that grid.
        elements: usize,
        /// Most elements allowed.
        limit: usize,
    },
    /// The contact reaches lateral coordinates for which a shape is not given.
    #[error("the contact reaches the end of a profile")]
    EndOfShape,
    /// The contact reaches the edge of a grid that does not grow.
    #[error("the contact reaches the edge of its grid of {nx} x {ny} elements")]
    Edge {
        /// Elements along x.
        nx: usize,
        /// Elements along y.
        ny: usize,
    },
    /// The residual did not fall below the tolerance.
    #[error(
        "the normal contact did not converge: residual {residual:.3e} after {iterations} \
         iterations, tolerance {tolerance:.1e}"
    )]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Residual reached [-].
        residual: f64,
        /// Residual asked for [-].
        tolerance: f64,
    },
}

/// Refuses what has no solution.
pub(super) fn check(distance: &[f64], prescribed: Prescribed) -> Result<(), NormalError> {
    match prescribed {
        Prescribed::Load(force) if !(force >= 0.0 && force.is_finite()) => {
            return Err(NormalError::Load { force });
        }
        Prescribed::Approach(approach) if !approach.is_finite() => {
            return Err(NormalError::Approach { approach });
        }
        _ => {}
    }
    match distance.iter().position(|value| !value.is_finite()) {
        Some(element) => Err(NormalError::Distance { element, distance: distance[element] }),
        None => Ok(()),
    }
}
