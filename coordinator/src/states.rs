//! `coordinator states`: the steady states of a case with a loop, and which of them last.
//!
//! A steady case is run from several starts, between which one key varies. Answers that are the same are one state, with the gain
//! of the loop there: a state whose gain is above one is led away from by every pass, and does not last in time.

mod cli;
mod page;
mod perform;
mod study;

pub(crate) use cli::{Arguments, main};
pub(crate) use study::Study;
