//! Rules for the structure of the code: no circular references between files, dependencies between
//! crates, features, and names the coordinator must not contain. The tests read sources and
//! manifests, partly through cargo.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod circles;
mod code;
mod features;
mod manifests;
mod names;
mod paths;
mod prose;
