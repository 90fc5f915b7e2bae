//! From a validated case to a plan: the participants that run, those that do not, and the reasons.
//!
//! Planning asks the programs that the case names to describe themselves and to estimate. `check`
//! and `plan` start a short-lived process for each question. Commands that run the case start its
//! participants first, and ask them ([`crate::crew`]); the run then takes them over, or they end. A
//! [`Plan`] holds no process and no shared memory, and is all that a
//! [`crate::session::Session`] receives.

mod contents;
mod expected;
mod figures;
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
pub use make::{plan, plan_with};
pub use mapping::non_matching;
pub(crate) use mapping::{warn_of_coverage, warn_of_missing_areas};
pub use show::CaseOverview;
