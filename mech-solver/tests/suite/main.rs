//! Tests of the crate from outside, as one program.

mod common;
mod description;
mod fastsim;
mod half_space;
mod hertz_carter;
