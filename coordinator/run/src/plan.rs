//! From a validated case to a plan: the participants that run, those that do not, and the reasons.
//!
//! Planning starts the programs that the case names, and asks them for descriptions and layouts
//! ([`crate::fleet`]); a run then takes them over, or they end.
//! A [`Plan`] holds no process and no shared memory, and is all that a
//! [`crate::session::Session`] receives.

mod contents;
mod expected;
mod figures;
mod layouts;
mod live;
mod make;
mod mapping;
mod route;
pub(crate) mod sampling;
mod show;
mod threads;
mod volume;

pub use contents::{
    Effect, Field, History, LiveValue, Participant, Plan, Planned, PlannedMapping, SchemeChoice,
    geometry_bytes, sample_bytes, topic_bytes,
};
pub(crate) use layouts::layouts;
pub use make::plan;
pub use mapping::non_matching;
pub(crate) use mapping::{warn_of_coverage, warn_of_missing_areas};
pub use show::CaseOverview;
