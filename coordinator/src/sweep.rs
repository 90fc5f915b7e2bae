//! `coordinator sweep`: a case over values of its keys, one row a point.
//!
//! `--vary` → [`design`], the points → [`perform`] here, or [`engine`] on other machines → [`rows`], a file that grows by
//! a line a point: a sweep that was stopped goes on with what it lacks → [`table`], and [`page`], which draws what
//! has changed.

mod cli;
mod collect;
mod design;
mod engine;
mod page;
mod perform;
mod rows;
mod study;
mod table;

pub(crate) use cli::{Arguments, main};
pub(crate) use study::Study;
