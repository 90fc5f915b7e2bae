//! Coupling numerics for participants that exchange fields: iteration to agreement, lengths of
//! windows, and mapping between grids. The library knows no transport, process, file or case.
//!
//! # Iterating a vector
//!
//! The example is a small linear pass whose matrix has eigenvalues of magnitude 1.55, so that plain
//! iteration diverges. IQN-ILS, the default, learns one secant column an iteration. It knows the
//! two unknowns after three iterations, and the fourth confirms convergence.
//!
//! ```
//! use coupling::fixed_point;
//! use coupling::settings::{Acceleration, Implicit};
//!
//! let pass = |x: &[f64], y: &mut [f64]| (y[0], y[1]) = (400.0 - 1.2 * x[1], 2.0 * x[0]);
//! let mut x = [0.0, 0.0];
//! let outcome = fixed_point(&Implicit::default(), &mut x, pass);
//!
//! assert!(outcome.not_converged.is_none());
//! assert_eq!(outcome.iterations, 4);
//! assert!((x[0] - 400.0 / 3.4).abs() < 1e-9);
//!
//! let plain = Implicit { acceleration: Acceleration::None, ..Implicit::default() };
//! let outcome = fixed_point(&plain, &mut [0.0, 0.0], pass);
//! let diverged = outcome.not_converged.unwrap().to_string();
//! assert!(diverged.starts_with("the coupling diverged in window 0, iteration "), "{diverged}");
//! ```
//!
//! # Modules
//!
//! The parts of a coupling are independent of each other:
//!
//! | module or type | purpose |
//! |---|---|
//! | [`settings`] | choices with their words and defaults |
//! | [`Coupling`], [`fixed_point`] | iteration of a window, or of a single vector |
//! | [`Exchange`] | interface to the participants |
//! | [`accelerate`] | next iterate of the coupling data: relaxation and quasi-Newton |
//! | [`converge`] | convergence, divergence and stagnation of a window |
//! | [`predict`] | first iterate of a window |
//! | [`windows`] | lengths of windows, and their acceptance |
//! | [`map`] | mappings between grids that do not match |
//!
//! Accelerators, measures and predictors see slices only.
//!
//! # Coupling two participants
//!
//! The friction of a contact falls with its temperature, and a body is heated by the friction. The
//! loop has a gain of −2.4, so that plain iteration diverges. The participants solve one after the
//! other, and IQN-ILS iterates the value that the second one returns.
//!
//! ```
//! use contract::step::Step;
//! use coupling::settings::{Acceleration, Implicit};
//! use coupling::{Coupling, Exchange, ParticipantIndex, Part, parts};
//!
//! struct Pair<F, G> {
//!     power_of: F,       // friction power [W] of a temperature rise [K]
//!     rise_of: G,        // temperature rise [K] of a friction power [W]
//!     iterate: f64,      // the temperature rise sent to the first participant [K]
//!     power: f64,
//!     rise: f64,
//!     data: Vec<Part>,   // the coupling data: one value
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

#![forbid(unsafe_code)]

pub mod accelerate;
pub mod converge;
mod exchange;
mod gain;
mod iteration;
pub mod map;
pub mod predict;
pub mod settings;
mod vector;
pub mod windows;

pub use exchange::{Exchange, ParticipantIndex};
pub use iteration::{Coupling, NotConverged, WindowOutcome, fixed_point};
pub use vector::{Part, StateMismatch, StateReader, parts};
