#![forbid(unsafe_code)]
#![doc = include_str!("../README.md")]
//! # Modules
//!
//! | module | contents |
//! |---|---|
//! | [`influence`] | displacement of an element's centre by a unit traction on another element |
//! | [`leading_edge`] | leading edges of a computed pressure, and its means over rows that begin there |
//! | [`normal`] | normal contact by bound-constrained conjugate gradients |
//! | [`aligned`] | grids whose rows begin at the leading edge of the contact |
//! | [`area`] | area of a contact, resolved below the size of its elements |
//! | [`extent`] | a grid that grows until the contact fits; moments of a pressure |
//! | [`conformal`] | contact of conforming, curved surfaces, by boundary elements |
//! | [`friction`] | friction coefficient and largest traction of each element |
//! | [`patches`] | patches of a pressure: load, position and size of each |
//! | [`coupling`] | coupling of normal and tangential contact when the bodies differ |
//! | [`difference`] | differences of displacements along x: the elastic slip of steady rolling |
//! | [`dissipation`] | numerical dissipation of these differences |
//! | [`slip_operator`] | from tractions to slip in steady rolling, and its approximate inverse |
//! | [`tangential`] | the tangential problem on one grid: steady rolling, a rolling step, a shift |
//! | [`slip_zone`] | slip zones at the trailing edges of rows, resolved below the size of elements |
//! | [`slip_velocity`] | slip velocities of the elements, on which friction may depend |
//! | [`grid_continuation`] | the tangential problem by continuation in resolution |
//! | [`viscoelastic`] | influence numbers of viscoelastic bodies in steady rolling |
//! | [`retarded`] | viscoelastic bodies that are pressed and shifted in place |
//! | [`yielding`] | yielding layer in series with friction |
//! | [`subsurface`] | stresses inside a body by loads and heat, at points and on sections |
//!
//! A field on nx × ny elements is a slice of nx·ny values, row after row: element (i, j) has the
//! index j·nx + i, i along x and j along y. Sums of influence over the grid are convolutions of
//! [`numerics::convolution`].

pub use elastic::{Elasticity, Material};
pub use grids::Structured;

pub mod aligned;
pub mod area;
pub mod conformal;
pub mod coupling;
pub mod difference;
pub mod dissipation;
pub mod extent;
pub mod friction;
pub mod grid_continuation;
pub mod influence;
mod initial_pressure;
pub mod leading_edge;
pub mod normal;
pub mod patches;
mod prescribed;
pub mod retarded;
pub mod slip_operator;
pub mod slip_velocity;
pub mod slip_zone;
pub mod subsurface;
pub mod tangential;
pub mod viscoelastic;
pub mod yielding;
