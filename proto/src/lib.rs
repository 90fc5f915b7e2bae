//! The contract between the coordinator and its participants.
//!
//! A *participant* is any executable that describes itself with `--describe`, joins a run with
//! `--join RUN --role ROLE`, and answers the commands of [`message`]. This crate holds everything
//! both sides must agree on, and nothing physical beyond the names and units of fields:
//!
//! | module | what |
//! |---|---|
//! | [`field`] | the table of fields that may cross the interface |
//! | [`grid`] | the surface grids that fields live on |
//! | [`description`] | what a participant says of itself: models, effects, case keys, fields |
//! | [`configuration`] | what a participant is given: its part of the case, its inputs and outputs |
//! | [`params`] | typed access to the case values inside a configuration |
//! | [`model`] | the trait that every model implements |
//! | [`message`] | the fixed layouts of commands, replies and field headers |
//! | [`recording`] | what was exchanged in a run, in one file |
//! | [`logging`] | what is logged: the directives of `RUST_LOG` |
//! | [`text`] | text from outside: what may reach a terminal or a label |
//! | [`binary`] | the binary form of what only this project reads back |
//! | [`run_dir`] | isolation of a run on the machine, and removal of what dead runs left |
//! | [`transport`] | the only module that knows iceoryx2 |
//! | [`participant`] | the state machine that serves any [`model::Setup`] |
//!
//! Invariants held here are listed in `docs/ARCHITECTURE.md`.

pub mod accuracy;
pub mod binary;
pub mod configuration;
pub mod description;
pub mod field;
pub mod grid;
pub mod logging;
pub mod message;
pub mod model;
pub mod params;
pub mod participant;
pub mod recording;
pub mod run_dir;
pub mod text;
pub mod transport;

/// Version of the contract. Raised whenever a layout, a command or the meaning of a key changes.
pub const PROTOCOL_VERSION: u32 = 4;
