//! A run: from a validated case to its results.
//!
//! [`case::Case`] → [`plan::Plan`] → [`session::Session`] → [`results`]. Each arrow is one module,
//! and only the left side of an arrow uses it.
//!
//! | modules | content |
//! |---|---|
//! | [`plan`] | the plan of a run, made before anything starts |
//! | [`peers`], [`supervise`], [`fleet`], [`linked`] | participants: start, supervision, reuse |
//! | [`session`] | exchange during a run: fields, mappings, geometry, audit, checkpoints |
//! | [`perform`], [`stopped`] | a whole run, from its beginning or from a checkpoint |
//! | [`results`], [`record`], [`checkpoint`] | files that a run leaves |
//! | [`warnings`], [`error`], [`signals`] | warnings, errors and interrupts |
//!
//! # A run from Rust
//!
//! Solvers that are linked into the program take part on threads; all others are started as
//! processes.
//!
//! ```
//! use case::RawCase;
//! use run::fleet::Fleet;
//! use run::linked::LinkedSolvers;
//! use run::perform::{RunOptions, run};
//! use run::plan::plan;
//! use run::results::{Existing, ResultFolder};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let file = std::path::Path::new("../../cases/wheel-rail.toml");
//! let mut case = RawCase::read(file)?;
//! case.apply(&["mech.resolution=10".to_owned()], &[])?;
//!
//! let solvers = LinkedSolvers::default()
//!     .with("mech-solver", mech_solver::MechSolver)
//!     .with("thermal-solver", thermal_solver::ThermalSolver);
//! let mut fleet = Fleet::for_one_run().with(solvers);
//! let planned = plan(case, &mut fleet)?;
//! assert_eq!(planned.plan.participants.len(), 2);
//!
//! let place = tempfile::tempdir()?;
//! let folder = ResultFolder::prepare(&place.path().join("out"), file, Existing::Refuse)?;
//! let outcome = run(&planned, &mut fleet, &folder, RunOptions::default());
//! assert!(outcome.error.is_none());
//! let rise = outcome.summary.value("temperature.rail.max_rise_k");
//! // Half-spaces: some 230 K, on a grid as coarse as this one too.
//! assert!(rise.is_some_and(|rise| (225.0..235.0).contains(&rise)), "{rise:?}");
//! # Ok(())
//! # }
//! ```

pub mod advice;
pub mod checkpoint;
pub mod damage;
pub mod deadlines;
pub mod error;
pub mod fleet;
pub mod format;
pub mod identity;
pub mod linked;
pub mod peers;
pub mod perform;
pub mod plan;
pub mod plan_file;
pub mod processes;
pub mod program;
pub mod progress;
pub mod record;
pub mod results;
pub mod scratch;
pub mod sealed;
pub mod session;
pub mod signals;
pub mod stopped;
pub mod supervise;
pub mod warnings;
pub mod watching;
pub mod wrap;

/// Returns the settings of tests over arbitrary bytes: 400 cases, or the number in `FUZZ_CASES`.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
