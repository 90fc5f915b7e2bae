//! Tests that need programs of others: Chromium, Slurm, HyperQueue, Fortran, C++, `make`, MPI,
//! FMPy, VTK, pytest, notebooks. A test whose program is missing fails and says how to get it.
//!
//! `cargo test --release --workspace --test external` runs them. `.ci/run` installs what they need.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking")]

mod browser;
mod clusters;
mod compilers;
mod packages;
mod pages;
mod paraview;
