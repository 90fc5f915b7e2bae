//! The participant that starts a program and speaks for it.

pub mod coupled;
mod last_words;
pub mod model;
pub mod placement;
pub mod program;
pub mod solver;
pub mod starter;
pub mod wire;
