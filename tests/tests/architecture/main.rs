//! How the code of this project may be put together: no circle of files, the order of the crates, their features, and
//! what the coordinator does not know. Sources and manifests are read, by cargo too.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod circles;
mod code;
mod features;
mod manifests;
mod names;
mod paths;
