//! Errors of a normal contact.

use crate::prescribed::Prescribed;
use tables::readable::{number, quantity};
use thiserror::Error;

/// Reason why a normal contact has no solution, or none was found.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum NormalError {
    /// The load is negative or not finite.
    #[error("a normal force of {force} N is not possible: it must be finite and not negative")]
    Load {
        /// Prescribed normal force [N].
        force: f64,
    },
    /// The approach is not finite.
    #[error("an approach of {approach} m is not finite")]
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
    /// The contact outgrows the largest allowed grid.
    #[error(
        "the contact reaches the edge of a grid of {nx} x {ny} elements, and a larger one would \
         exceed {limit} elements"
    )]
    GridLimit {
        /// Elements along x.
        nx: usize,
        /// Elements along y.
        ny: usize,
        /// Largest allowed number of elements.
        limit: usize,
    },
    /// The bodies touch at points too far apart for one grid.
    #[error(
        "the bodies also touch {y} to the side of the first point of contact; a grid that \
         holds both would have {elements} elements, more than the limit of {limit}", y = quantity(*.y, "m", 5))]
    FarApart {
        /// Lateral coordinate of the farther point [m].
        y: f64,
        /// Number of elements of a grid that holds both points.
        elements: usize,
        /// Largest allowed number of elements.
        limit: usize,
    },
    /// The contact reaches a lateral coordinate where a shape is not defined.
    #[error("the contact reaches the end of a profile")]
    EndOfShape,
    /// The contact reaches the edge of a grid of fixed size.
    #[error("the contact reaches the edge of its grid of {nx} x {ny} elements")]
    Edge {
        /// Elements along x.
        nx: usize,
        /// Elements along y.
        ny: usize,
    },
    /// A contact that repeats cannot carry the load under the bound of its pressure.
    #[error(
        "a load of {load} is not possible under a largest pressure of {bound}: at that \
         pressure everywhere the cell carries {most}", load = quantity(*.load, "N", 7), bound = quantity(*.bound, "Pa", 7), most = quantity(*.most, "N", 7))]
    Bound {
        /// Prescribed load [N].
        load: f64,
        /// Largest pressure [Pa].
        bound: f64,
        /// Load of the cell at the largest pressure everywhere [N].
        most: f64,
    },
    /// The residual did not fall below the tolerance.
    #[error(
        "the normal contact did not converge: residual {residual} after {iterations} \
         iterations, tolerance {tolerance}", residual = number(*.residual, 4), tolerance = number(*.tolerance, 2))]
    NotConverged {
        /// Number of iterations.
        iterations: usize,
        /// Residual reached [-].
        residual: f64,
        /// Residual required [-].
        tolerance: f64,
    },
}

/// Checks that the distances and the load or approach are valid.
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
