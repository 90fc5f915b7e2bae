//! Small participants for system tests and benches. They compute almost nothing, and can be told
//! to misbehave.

pub mod linear;
pub mod lumped;
pub mod moving;
pub mod rogue;
pub mod toy;
