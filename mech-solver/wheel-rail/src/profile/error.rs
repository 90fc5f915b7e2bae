//! What may be wrong with the file of a profile.

use crate::outline::OutlineError;

/// Why a profile cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// It is not text.
    #[error("{0}")]
    NotText(String),
    /// It is not a table of points.
    #[error("{0}")]
    Table(String),
    /// A line is not what it should be.
    #[error("line {line} {what}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// The fault, and the remedy.
        what: String,
    },
    /// Something that has to be there is not.
    #[error("it has no {0}")]
    Missing(&'static str),
    /// The file announces another number of points than it has.
    #[error("its header announces {announced} points, and {found} follow; is it complete?")]
    Count {
        /// Number in the header.
        announced: usize,
        /// Number of points.
        found: usize,
    },
    /// A wheel in the place of a rail, or the reverse.
    #[error("it is the profile of a {0}, and stands for the other body")]
    OtherBody(&'static str),
    /// The flange is on the field side.
    #[error(
        "its flange, lowest at y = {0:.4e} m, is on the field side; mirror the profile along y"
    )]
    FlangeOutside(f64),
    /// The size is none of a profile.
    #[error("its size is {0:.3e} m, where 5 mm to 500 mm are expected; check the unit of length")]
    Size(f64),
    /// The points are no curve.
    #[error(transparent)]
    Curve(#[from] OutlineError),
}

impl ProfileError {
    /// Something wrong with a line, counted from 1.
    pub(super) fn line(line: usize, what: impl Into<String>) -> Self {
        Self::Line { line, what: what.into() }
    }
}
