//! `coordinator sweep`: a case over values of its keys, one row a point.
//!
//! `--vary` → [`crate::study::axis`] → the points → [`perform`] → [`study`], which is written as it grows: a sweep that
//! was stopped goes on with what it lacks. [`page`] draws what has changed.

mod cli;
mod design;
mod page;
mod perform;
mod study;

pub(crate) use cli::{Arguments, main};
pub(crate) use study::Study;
