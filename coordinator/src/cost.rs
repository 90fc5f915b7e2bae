//! `coordinator cost`: what accuracy costs in time.
//!
//! One case is run with every choice of models that can run it, over their resolutions, and, where
//! the case has them, over the length of its windows and the tolerance of its coupling ([`sweep`]).
//! Each quantity of interest is compared with a reference ([`analysis`]): its closed form where a
//! participant knows one, else the finest runs of the most faithful models, extrapolated. So every run
//! has an error and a cost; those that no other beats in both are the Pareto front.
//!
//! ```text
//! Request ──sweep──► Run (quantities, cost) ──analysis──► Study ──► table, cost.json, cost.csv, page
//! ```
//!
//! Models, resolutions and what models leave out come from the descriptions of the programs
//! ([`contract::accuracy`]); nothing here names one.

mod analysis;
mod cli;
mod finished;
mod page;
mod runs;
mod show;
mod study;
mod sweep;

pub(crate) use cli::{Arguments, main};
pub(crate) use study::Study;
