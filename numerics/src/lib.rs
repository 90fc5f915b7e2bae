#![doc = include_str!("../README.md")]
//! # Modules
//!
//! | module | what |
//! |---|---|
//! | [`bessel`] | modified Bessel functions of the second kind |
//! | [`convolution`] | sums of a kernel over a grid by Fourier transforms |
//! | [`gmres`] | Krylov solver for a few iterations on tall vectors |
//! | [`quadrature`] | integrals of functions over an interval |
//! | [`rows`] | the same of kernels that vary across x |
//! | [`search`] | maximum and root of a function of one variable |
//! | [`team`] | independent pieces of work, on several threads |
//! | [`vector`] | sums and products of long vectors |
//! | [`waves`] | fields that repeat without end, as sums of waves |

pub mod bessel;
pub mod convolution;
pub mod gmres;
pub mod quadrature;
pub mod rows;
pub mod search;
pub mod team;
pub mod vector;
pub mod waves;
