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
//!
//! # Two closures, coupled
//!
//! A contact whose friction falls with its temperature, and a body that the friction heats; the loop
//! has a gain of −2.4, so that plain iteration diverges. One participant solves after the other, and
//! what the second one returns is iterated by IQN-ILS.
//!
//! ```
//! use contract::step::Step;
//! use coupling::settings::{Acceleration, Implicit};
//! use coupling::{Coupling, Exchange, ParticipantIndex, Part, parts};
//!
//! struct Pair<F, G> {
//!     power_of: F,       // friction power [W] of a temperature rise [K]
//!     rise_of: G,        // temperature rise [K] of a friction power [W]
//!     iterate: f64,      // the temperature that the first one is told [K]
//!     power: f64,
//!     rise: f64,
//!     data: Vec<Part>,   // what is iterated: one value
//! }
//!
//! impl<F: Fn(f64) -> f64, G: Fn(f64) -> f64> Exchange for Pair<F, G> {
//!     type Error = std::convert::Infallible;
//!
//!     fn participants(&self) -> usize {
//!         2
//!     }
//!
//!     fn solve(&mut self, ones: &[ParticipantIndex], _: &Step) -> Result<(), Self::Error> {
//!         for &one in ones {
//!             match usize::from(one) {
//!                 0 => self.power = (self.power_of)(self.iterate),
//!                 _ => self.rise = (self.rise_of)(self.power),
//!             }
//!         }
//!         Ok(())
//!     }
//!
//!     fn coupling_data(&self) -> &[Part] {
//!         &self.data
//!     }
//!
//!     fn send(&mut self, iterate: &[f64], _: &Step) -> Result<(), Self::Error> {
//!         self.iterate = iterate[0];
//!         Ok(())
//!     }
//!
//!     fn returned(&self, returned: &mut [f64]) {
//!         returned[0] = self.rise;
//!     }
//! }
//!
//! let data = parts([("temperature", 1)]);
//! let (power_of, rise_of) = (|rise: f64| 400.0 - 1.2 * rise, |power: f64| 2.0 * power);
//! let mut pair = Pair { power_of, rise_of, iterate: 0.0, power: 0.0, rise: 0.0, data };
//!
//! let settings = Implicit { acceleration: Acceleration::IqnIls, ..Implicit::default() };
//! let mut coupling = Coupling::implicit(&settings, false, &pair);
//! let outcome = coupling.solve_window(&mut pair, &Step::STEADY).unwrap();
//!
//! assert!(outcome.not_converged.is_none());
//! assert!((pair.rise - 800.0 / 3.4).abs() < 1e-9);
//! assert!(outcome.iterations <= 4, "linear, of one unknown: {}", outcome.iterations);
//! ```

pub mod accelerate;
pub mod converge;
mod exchange;
mod gain;
mod index;
mod iteration;
pub mod map;
mod order;
mod part;
pub mod predict;
pub mod settings;
pub mod state;
pub mod windows;

pub use exchange::Exchange;
pub use index::ParticipantIndex;
pub use iteration::{Coupling, NotConverged, WindowOutcome};
pub use part::{Part, parts};
