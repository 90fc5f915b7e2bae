//! Toy participants for system tests and benches, and the test harness. The participants compute
//! almost nothing and misbehave on request.

pub mod harness;
pub mod linear;
pub mod long;
pub mod lumped;
pub mod moving;
pub mod rogue;
pub mod toy;
pub mod volume;
