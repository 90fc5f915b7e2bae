//! Measured profiles of rails and wheels: Miniprof, SIMPACK, and columns of numbers.
//!
//! | module | content |
//! |---|---|
//! | [`read`] | conversion of a text to a curve, with the settings for it |
//! | [`miniprof`], [`simpack`], [`columns`] | formats: from a text to points as in the file |
//! | [`heights`] | a profile as a height over y, for bodies without flanks |
//! | [`slice_list`] | files that name profiles at positions |
//! | [`orientation`] | from the axes of a file to those of a profile |
//! | [`error`] | errors of a file |
//! | `text` | lines and numbers |
//!
//! **Axes of a profile**: y from the middle of the track to the field side, z up. Points run with
//! rising y on the whole: from the gauge face over the crown to the field side, or from the back of
//! the flange over the tread to the field side. On the left side of the track y is to the left; the
//! right profile is the mirror image ([`crate::outline::Outline::mirrored`]).

pub mod columns;
pub mod error;
pub mod heights;
pub mod miniprof;
pub mod orientation;
pub mod read;
pub mod simpack;
pub mod slice_list;
#[cfg(test)]
mod tests;
mod text;

pub use error::ProfileError;
pub use read::{Format, Reading, read};
pub use slice_list::{SliceFormat, SliceList, read_slices};
