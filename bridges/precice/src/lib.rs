//! Programs with a preCICE adapter as participants, without change.
//!
//! Two parts speak to each other over a local socket:
//!
//! - the library `libprecice.so`, which has preCICE's functions and is loaded by the program
//!   ([`library`]);
//! - the executable `precice-participant`, an ordinary participant that starts the program and
//!   turns its calls into the contract ([`launcher`]).
//!
//! ```text
//! coordinator ◄── contract ──► precice-participant ◄── socket ──► libprecice in the program
//!
//! Configure     starts the program         createParticipant, setMeshVertices, …, initialize
//! Solve         answers with the window    initialize or advance returns
//!               waits                      readData, the program's steps, writeData
//!               publishes, replies         advance fills the window
//! Solve again   answers: it repeats        advance returns, requiresReadingCheckpoint() = 1
//! Accept        remembers the outputs
//! Finish        answers: it has ended      advance returns, isCouplingOngoing() = 0
//! ```
//!
//! Mapping, acceleration, convergence and the order of the participants are the coordinator's. Of
//! preCICE's configuration only the meshes and data of the participant are used.
//!
//! Source of the interface: preCICE 3, documentation of its C and C++ interfaces
//! (<https://precice.org>).

pub mod launcher;
pub mod library;
pub mod protocol;
