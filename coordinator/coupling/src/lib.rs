//! Coupling numerics: how participants that exchange fields are iterated until they agree, how long
//! the windows are, and how fields come from one grid to another. A library: it knows no transport,
//! no process, no file and no case.
//!
//! Independent axes, each on its own:
//!
//! - [`Exchange`] is all that is asked of the participants,
//! - [`settings`] has the choices and their words,
//! - an [`accelerate::Accelerator`] chooses the next iterate of the coupling data,
//! - a [`converge::Convergence`] decides whether the window is done,
//! - a [`predict::Predictor`] gives the first iterate of a window,
//! - [`Coupling`] iterates a window with them,
//! - [`windows`] decides how long windows are, and which are accepted,
//! - [`map`] has the mappings between grids that do not match.
//!
//! Accelerators, measures and predictors see slices only.

pub mod accelerate;
pub mod converge;
mod exchange;
mod iteration;
pub mod map;
mod order;
mod part;
pub mod predict;
pub mod settings;
pub mod state;
pub mod windows;

pub use exchange::Exchange;
pub use iteration::{Coupling, NotConverged, WindowOutcome};
pub use part::{Part, parts};
