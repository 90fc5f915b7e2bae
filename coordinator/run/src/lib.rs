//! A run: from a validated case to its results.
//!
//! [`case::Case`] → [`plan::Plan`] → [`session::Session`] → [`results`]. Each arrow is one module; only
//! the left side of an arrow reaches it.

pub mod checkpoint;
pub mod damage;
pub mod error;
pub mod format;
pub mod perform;
pub mod plan;
pub mod plan_file;
pub mod processes;
pub mod programs;
pub mod progress;
pub mod record;
pub mod results;
pub mod session;
pub mod signals;
pub mod supervise;
