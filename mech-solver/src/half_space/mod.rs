//! Contact of elastic half-spaces on a regular grid of rectangular elements.
//!
//! | module | what |
//! |---|---|
//! | [`influence`] | displacement of an element's centre by a unit traction on another element |
//! | [`convolution`] | sums of influence over the grid by Fourier transforms |
//! | [`normal`] | the normal contact by bound-constrained conjugate gradients |
//! | [`patch`] | a grid that grows until the contact fits |
//! | [`normal_contact`] | the pressures a model starts from |
//! | [`slip_operator`] | from tractions to slip in steady rolling, and its approximate inverse |
//! | [`gmres`] | Krylov solver for a few iterations on tall vectors |
//! | [`steady_rolling`] | the tangential problem of steady rolling on one grid |
//! | [`levels`] | the same by continuation in resolution, creepage or force prescribed |
//!
//! A field on nx × ny elements is a slice of nx·ny values, row after row: element (i, j) has the
//! index j·nx + i, i along x and j along y.

pub mod convolution;
pub mod gmres;
pub mod influence;
mod initial_pressure;
pub mod levels;
pub mod normal;
pub mod normal_contact;
pub mod patch;
pub mod slip_operator;
pub mod steady_rolling;
