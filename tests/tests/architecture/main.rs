//! How the code of this project may be put together: no circle of files, the order of the crates, and
//! what the coordinator does not know. No process is started; sources and manifests are read.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod circles;
mod code;
mod manifests;
mod names;
