//! Long tests: the whole paper on its own grids, every sweep of the hard cases to its edge, the whole
//! contract in Python and by every model of mechanics, hot steel by explicit elements, and the
//! features of a release. The system tests do the same on coarser grids and with fewer values.
//!
//! The README has the command: it builds all of the workspace with the feature `complete` of the
//! tests.
//!
//! (With `-p tests` in its place cargo chooses other features, and builds all that they depend on again.)

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking")]

mod advise;
mod conform;
mod engines;
mod explicit;
mod failures;
mod licences;
mod paper;
mod picture;
mod release;
#[path = "../shared/failures.rs"]
mod shared_failures;
#[path = "../shared/paper.rs"]
mod shared_paper;
mod snippets;
mod stability;
#[path = "../shared/sweeps.rs"]
mod sweeps;
mod wheel;
