//! Figures of a sweep between its points, for whatever links to them: a vehicle simulation that asks for the
//! contact of each wheel in each step.
//!
//! `coordinator sweep --fit` and `coordinator fit` write a surrogate; [`Surrogate::read`] reads it, and refuses
//! a file that is none; [`Surrogate::ask`] gives all its figures at a point, without an allocation, and refuses
//! a point outside the region that it was made in. Each figure has the error that it was found to have at points
//! that its fit had not seen ([`Held`]).
//!
//! # Mathematics
//!
//! The keys of a case that varied are the numbers `p_k`; a coordinate is one of them, or the quotient of two,
//! `x_i = p_k / p_l`. On the interval `[from, to]` it is scaled to `s ∈ [-1, 1]`,
//!
//! ```text
//! linear:  s = (2 x - from - to) / (to - from)          log:  s = (2 ln x - ln from - ln to) / (ln to - ln from)
//! ```
//!
//! and a figure is a sum of products of Chebyshev polynomials, or its exponential,
//!
//! ```text
//! z = Σ_j c_j Π_i T_{n_ij}(s_i)                         linear:  y = z          log:  y = ± exp(z)
//! ```
//!
//! so that a power law `y = c Π x_i^{m_i}` has one term a coordinate in logarithmic scales. Products that
//! figures have in common are made once. docs/surrogate.md has the format and where it comes from.
//!
//! ```no_run
//! let text = std::fs::read("results/wheel-rail-sweep/fit.json")?;
//! let contact = surrogate::Surrogate::read(&text)?;
//! let rise = contact.position("temperature.rail.max_rise_k").ok_or("no such figure")?;
//! let mut room = contact.room();
//! for speed in [20.0, 30.0, 40.0] {
//!     let figures = contact.ask(&[0.2, 100e3, speed, 0.5], &mut room)?;
//!     println!("{} K, within {}", figures[rise], contact.figures()[rise].held.bound(figures[rise]));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod evaluate;
mod file;
#[cfg(test)]
mod tests;

pub use evaluate::{Figure, Outside, Refused, Room, Surrogate};
pub use file::{
    Coordinate, Document, Fault, FittedFigure, Held, Key, LARGEST_DEGREE, LONGEST, Measure, Origin,
    SCHEMA, Scale,
};
