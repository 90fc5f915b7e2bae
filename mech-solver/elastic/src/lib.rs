#![forbid(unsafe_code)]
#![doc = include_str!("../README.md")]
//! # Modules
//!
//! | module | contents |
//! |---|---|
//! | [`Material`], [`Elasticity`] | elastic constants of a body, and of a pair of bodies |
//! | [`hertz`] | Hertz's contact of ellipses and lines; `elliptic_integrals` |
//! | [`carter`], [`cattaneo`] | partial slip: a rolling line, a circle under shear |
//! | [`kalker`] | Kalker's creep coefficients and forces of the linear theory |
//! | [`creep_force`] | creep forces of the simplified theory in closed form, Polach's formula |
//! | [`strips`], [`slip`] | Carter's solution in strips of an ellipse, and means over elements |
//! | [`fastsim`] | springs in place of half-spaces: FASTSIM and FASTRIP, strip by strip |
//! | [`hunter`] | a cylinder that rolls on a viscoelastic half-space |
//! | [`dissimilar`] | bodies of different elastic constants |
//! | [`cut_off`], [`shakedown`] | friction cut off at a largest traction; limits of shakedown |
//! | [`subsurface`], [`Stress`] | stresses inside bodies; a stress tensor |
//! | [`axle`] | a mass on a suspension that runs over an irregularity |
//!
//! Axes, bodies and signs are Kalker's: x along the rolling direction, y to the left, z up; body 1
//! is the upper one. Tractions act on the upper body, slip is of the upper body relative to the
//! lower one. All quantities are in SI units.

pub mod axle;
pub mod carter;
pub mod cattaneo;
pub mod creep_force;
pub mod cut_off;
pub mod dissimilar;
mod elasticity;
pub mod elliptic_integrals;
pub mod fastsim;
pub mod hertz;
pub mod hunter;
pub mod kalker;
mod material;
pub mod shakedown;
pub mod slip;
mod stress;
pub mod strips;
pub mod subsurface;

pub use elasticity::Elasticity;
pub use material::Material;
pub use stress::Stress;
