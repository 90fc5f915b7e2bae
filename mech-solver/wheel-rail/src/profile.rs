//! Profiles of rails and wheels as they are measured: Miniprof, SIMPACK, and columns of numbers.
//!
//! | module | what |
//! |---|---|
//! | [`read`] | a text, and how it is to be taken, to a curve |
//! | [`miniprof`], [`simpack`], [`columns`] | the formats: a text to points as they stand in the file |
//! | [`heights`] | a profile as a height over y, for bodies without flanks |
//! | [`slice_list`] | files that name profiles at positions |
//! | [`orientation`] | from the axes of a file to ours |
//! | [`error`] | what may be wrong with a file |
//! | `text` | lines and numbers |
//!
//! **Axes of a profile**: y from the middle of the track to the field side, z up, points with y rising on the
//! whole: from the gauge face over the crown to the field side, or from the back of the flange over the tread
//! to the field side. On the left that is y to the left; the right profile is its mirror image
//! ([`crate::outline::Outline::mirrored`]).

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
