#![forbid(unsafe_code)]
#![doc = include_str!("../README.md")]
//! # Modules
//!
//! | module | content |
//! |---|---|
//! | [`columns`] | conduction normal to the surface, with the exact Abel kernel |
//! | [`moving_source`] | conduction in three dimensions under a moving flux, at any speed |
//! | [`mod@periodic`] | conduction under a flux that repeats, wave by wave and exact in time |
//! | [`fe`] | finite elements, with properties that may depend on the temperature |
//! | [`closed_form`] | closed forms: scales, polynomials, elliptic and uniform fluxes |
//! | [`window`] | a window of time: how its heat enters the bodies |
//! | [`Material`] | thermal properties of a body |
//!
//! Conventions: x is the rolling direction, y to the left, z up, with the origin at the centre of
//! the contact; the frame moves with the contact. Material enters the contact at its leading edge
//! (large x) and moves towards −x at the surface speed. Temperatures are rises over the initial
//! temperature [K]; a heat flux into a body is positive. Pairs of values are ordered upper, lower.
//! All quantities are in SI units.

pub mod closed_form;
pub mod columns;
pub mod fe;
mod material;
pub mod moving_source;
pub mod periodic;
pub mod window;

pub use material::Material;
