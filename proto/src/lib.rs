//! Exchange between coordinator and participants, as described by the crate [`contract`].
//!
//! A *participant* is an executable that describes itself with `--describe`, joins a run with
//! `--join RUN --role ROLE`, and answers the commands of [`message`]. The modules of the contract
//! are re-exported, so that a participant depends on one crate.
//!
//! | module | what |
//! |---|---|
//! | [`model`] | trait of all models |
//! | [`participant`] | state machine that serves a [`model::Setup`] |
//! | [`command_ports`] | ports of a participant: commands, replies, progress, doorbells |
//! | [`progress`] | progress of long work, for the heartbeat |
//! | [`state`] | reading and writing a state piece by piece |
//! | [`transport`] | shared-memory services; the only module that uses iceoryx2 |
//! | [`run_dir`] | isolation of a run on the machine, and removal of the remains of dead runs |
//! | [`recording`] | recording of all messages of a run, in one file |
//! | [`logging`] | log filter from `RUST_LOG` |
//! | [`binary`] | binary form of data that only this project reads |
//!
//! The invariants are listed in `docs/ARCHITECTURE.md`.

pub use contract::{
    PROTOCOL_VERSION, accuracy, advice, bodies, configuration, description, diagram, field, figure,
    grid, history, input_file, live, message, params, quantity, readable, table, text,
};

pub use grids::state;

pub mod binary;
pub mod command_ports;
pub mod lock_file;
pub mod logging;
pub mod model;
pub mod participant;
pub mod progress;
pub mod recording;
pub mod run_dir;
pub mod transport;
