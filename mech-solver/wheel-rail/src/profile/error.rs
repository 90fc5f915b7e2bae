//! Errors in the file of a profile.

use crate::outline::OutlineError;
use tables::readable::quantity;

/// Reason why a profile cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// The file is not text.
    #[error("{0}")]
    NotText(String),
    /// The file is not a table of points.
    #[error("{0}")]
    Table(String),
    /// A line does not match the format.
    #[error("line {line} {what}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// Fault and remedy.
        what: String,
    },
    /// A required entry is missing.
    #[error("it has no {0}")]
    Missing(&'static str),
    /// The header announces another number of points than the file has.
    #[error("its header announces {announced} points, and {found} follow; is it complete?")]
    Count {
        /// Number of points announced in the header.
        announced: usize,
        /// Number of points in the file.
        found: usize,
    },
    /// The profile is that of a wheel where a rail is expected, or vice versa.
    #[error("it is the profile of a {0}, but the other body is expected here")]
    OtherBody(&'static str),
    /// The shape does not show the direction of the heights, and the format does not say it.
    #[error(
        "its shape does not show whether heights point up or down; write `profile_heights` of the body"
    )]
    UnclearHeights,
    /// The shape shows heights down in a format of heights up.
    #[error(
        "its heights point down, as its shape shows, and a table has z up; write `profile_heights = \"down\"` of the \
         body, or turn the heights over"
    )]
    HeightsDown,
    /// The flange is on the field side.
    #[error(
        "its flange, lowest at y = {}, is on the field side; mirror the profile along y, or turn its heights \
         over", quantity(*.0, "m", 5))]
    FlangeOutside(f64),
    /// The size is implausible for a profile.
    #[error("its size is {}, where 5 mm to 500 mm are expected; check the unit of length", quantity(*.0, "m", 4))]
    Size(f64),
    /// The points do not form a curve.
    #[error(transparent)]
    Curve(#[from] OutlineError),
}

impl ProfileError {
    /// Fault in a line, counted from 1.
    pub(super) fn line(line: usize, what: impl Into<String>) -> Self {
        Self::Line { line, what: what.into() }
    }
}
