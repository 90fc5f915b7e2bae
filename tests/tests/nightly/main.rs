//! What takes long: the whole paper on its own grids, every sweep of the hard cases to its edge, the whole
//! contract in Python. The system tests do the same on coarser grids and with fewer values.
//!
//! `cargo build --release --workspace && cargo test --release -p tests --test nightly`

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking")]

mod conform;
mod paper;
#[path = "../shared/paper.rs"]
mod shared_paper;
mod stability;
