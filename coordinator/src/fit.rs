//! `coordinator fit`, and `sweep --fit`: a surrogate of a sweep, its figures as functions of the keys that varied.
//!
//! The table of a sweep → [`samples`] (numbers in SI units; [`region`]: a box without points that have no answer) →
//! for each figure its scales ([`scales`]) and its terms ([`grow`]), by the error at points held out ([`held`]) →
//! a [`surrogate::Document`], which that crate reads and evaluates. docs/surrogate.md has the mathematics.

mod cli;
mod grow;
mod held;
mod make;
mod region;
mod samples;
mod scales;
mod show;
#[cfg(test)]
mod tests;

pub(crate) use cli::{Arguments, FILE, after_sweep, main};
pub(crate) use samples::number;
