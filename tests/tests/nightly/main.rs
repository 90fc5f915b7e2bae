//! Long tests: the whole paper on its own grids, every sweep of the hard cases to its limit, all
//! conformance checks in Python and for every mechanical model, hot steel by explicit elements, and
//! the features of a release. The system tests do the same on coarser grids and with fewer values.
//!
//! The README gives the command; it builds the whole workspace with the feature `complete` of the
//! tests. The gate builds this target without the feature and runs a tenth of the remaining tests,
//! selected by the commit.
//!
//! (With `-p tests` instead, cargo selects different features and rebuilds all their dependencies.)

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking")]

mod advise;
mod conform;
mod coverage;
mod engines;
mod explicit;
mod failures;
mod grids;
mod licences;
mod measured;
mod paper;
#[cfg(feature = "complete")]
mod picture;
mod precice;
#[cfg(feature = "complete")]
mod release;
mod snippets;
mod stability;
#[cfg(feature = "complete")]
mod wheel;
