#![doc = include_str!("../README.md")]
//! # Modules
//!
//! | module | what |
//! |---|---|
//! | [`influence`] | displacement of an element's centre by a unit traction on another element |
//! | [`normal`] | the normal contact by bound-constrained conjugate gradients |
//! | [`area`] | area of a contact, finer than its elements |
//! | [`extent`] | a grid that grows until the contact fits; moments of a pressure |
//! | [`conformal`] | contact of surfaces that are one round a corner, by boundary elements |
//! | [`friction`] | friction coefficient and largest traction of each element |
//! | [`patches`] | the patches of a pressure: load, place and size of each |
//! | [`coupling`] | what normal and tangential contact do to each other when the bodies differ |
//! | [`difference`] | differences of displacements along x, the elastic slip of steady rolling |
//! | [`dissipation`] | numerical dissipation of that difference |
//! | [`slip_operator`] | from tractions to slip in steady rolling, and its approximate inverse |
//! | [`tangential`] | the tangential problem on one grid: steady rolling, a rolling step, a shift |
//! | [`slip_iteration`] | friction that follows the slip of every element |
//! | [`grid_continuation`] | the tangential problem by continuation in resolution |
//! | [`viscoelastic`] | the same displacement of bodies with a memory that roll |
//! | [`retarded`] | of bodies with a memory that are pressed and shifted in place |
//! | [`yielding`] | a layer that yields, in series with friction |
//! | [`subsurface`] | stresses inside a body, at points and on vertical sections, and those of heat |
//!
//! A field on nx × ny elements is a slice of nx·ny values, row after row: element (i, j) has the
//! index j·nx + i, i along x and j along y. Sums of influence over the grid are convolutions of
//! [`numerics::convolution`].

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
pub mod normal;
pub mod patches;
mod prescribed;
pub mod retarded;
pub mod slip_iteration;
pub mod slip_operator;
pub mod subsurface;
pub mod tangential;
pub mod viscoelastic;
pub mod yielding;
