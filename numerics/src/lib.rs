#![doc = include_str!("../README.md")]
//! # Modules
//!
//! | module | what |
//! |---|---|
//! | [`bessel`] | modified Bessel functions of the second kind |
//! | [`convolution`] | convolution of fields on a grid with a kernel, by Fourier transforms |
//! | [`fourier`] | Fourier transforms of one length, compiled once |
//! | [`gmres`] | Krylov solver for a few iterations on tall vectors |
//! | [`quadrature`] | integrals of functions over an interval |
//! | [`rows`] | convolution along x with kernels that vary across the rows |
//! | [`search`] | maximum and root of a function of one variable |
//! | [`secants`] | corrections of an iteration that learn from earlier ones |
//! | [`team`] | parallel computation of independent pieces of work |
//! | [`vector`] | sums and products of long vectors |
//! | [`waves`] | periodic fields as sums of waves |

pub mod bessel;
pub mod convolution;
pub mod fourier;
pub mod gmres;
pub mod quadrature;
pub mod rows;
pub mod search;
pub mod secants;
pub mod team;
pub mod vector;
pub mod waves;
