//! Surrogates of sweeps: figures of a contact between the points of a sweep, for programs such as a
//! vehicle simulation that needs the contact of each wheel in each step.
//!
//! `coordinator sweep --fit` and `coordinator fit` write a surrogate. [`Surrogate::read`] reads and
//! validates the file. [`Surrogate::ask`] evaluates all figures at a point without allocating, and
//! refuses a point outside the region of the sweep. Each figure states its error at points that
//! were held out of the fit ([`HeldOutError`]).
//!
//! # Mathematics
//!
//! The varied keys of a case are the numbers `p_k`. A coordinate is one of them, or the quotient of
//! two, `x_i = p_k / p_l`. On the interval `[from, to]` it is scaled to `s ∈ [-1, 1]`:
//!
//! ```text
//! linear:  s = (2 x - from - to) / (to - from)          log:  s = (2 ln x - ln from - ln to) / (ln to - ln from)
//! ```
//!
//! A figure is a sum of products of Chebyshev polynomials, or the exponential of such a sum:
//!
//! ```text
//! z = Σ_j c_j Π_i T_{n_ij}(s_i)                         linear:  y = z          log:  y = ± exp(z)
//! ```
//!
//! A power law `y = c Π x_i^{m_i}` thus has one term per coordinate in logarithmic scales. Products
//! common to several figures are computed once. docs/surrogate.md describes the format and its
//! origin.
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

#![forbid(unsafe_code)]

mod evaluate;
mod file;
#[cfg(test)]
mod tests;

pub use evaluate::{Figure, Outside, Refused, Surrogate, Workspace};
pub use file::{
    Coordinate, Document, Fault, FittedFigure, HeldOutError, Key, LARGEST_DEGREE, LONGEST, Measure,
    Origin, SCHEMA, Scale,
};
