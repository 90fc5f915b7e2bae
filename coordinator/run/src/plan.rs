//! From a validated case to a plan: what will run, what will not, and why.
//!
//! Planning starts nothing of the run and touches no shared memory; it only asks the executables
//! that the case names to describe themselves and to estimate. A [`Plan`] is all that a
//! [`crate::session::Session`] gets.

mod alone;
mod contents;
mod expected;
mod figures;
mod live;
mod make;
mod mapping;
mod rewind;
mod route;
mod show;
mod threads;
mod volume;

pub use alone::Shown;
pub use contents::{
    Effect, Field, History, LiveValue, Participant, Plan, Planned, PlannedMapping, SchemeChoice,
    geometry_bytes, sample_bytes, topic_bytes,
};
pub use make::plan;
pub use mapping::non_matching;
pub(crate) use mapping::warn_of_coverage;
