//! Tests of the crate from outside, as one program.

mod common;
mod description;
mod hertz_carter;
