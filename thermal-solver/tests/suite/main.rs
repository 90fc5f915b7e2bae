//! Tests of the thermal models, through the interface of a participant.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so does what it calls")]

mod contract;
mod estimates;
mod expanding;
mod fe;
mod in_three_dimensions;
mod passages;
mod resting;
mod rods;
mod steady;
#[path = "../support/mod.rs"]
mod support;
mod transforming;
mod transient;
