//! Small participants for system tests and benches, which compute almost nothing and can be told to
//! misbehave, and the harness of the tests that run them.

pub mod harness;
pub mod linear;
pub mod long;
pub mod lumped;
pub mod moving;
pub mod rogue;
pub mod toy;
pub mod volume;
