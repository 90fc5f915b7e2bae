//! How coordinator and participants exchange what the crate [`contract`] describes.
//!
//! A *participant* is any executable that describes itself with `--describe`, joins a run with
//! `--join RUN --role ROLE`, and answers the commands of [`message`]. Its modules of the contract are
//! re-exported here, so that a participant depends on one crate.
//!
//! | module | what |
//! |---|---|
//! | [`model`] | the trait that every model implements |
//! | [`participant`] | the state machine that serves any [`model::Setup`] |
//! | [`command_ports`] | what a participant opens when it joins: commands, replies, progress, bells |
//! | [`progress`] | how far long work is, for the heartbeat |
//! | [`state`] | pieces of a state on their way to and from a file |
//! | [`transport`] | the only module that knows iceoryx2 |
//! | [`run_dir`] | isolation of a run on the machine, and removal of what dead runs left |
//! | [`recording`] | what was exchanged in a run, in one file |
//! | [`logging`] | what is logged: the directives of `RUST_LOG` |
//! | [`binary`] | the binary form of what only this project reads back |
//!
//! Invariants held here are listed in `docs/ARCHITECTURE.md`.

pub use contract::{
    PROTOCOL_VERSION, accuracy, advice, bodies, configuration, description, diagram, field, figure,
    grid, history, input_file, live, message, params, quantity, table, text,
};

pub use grids::state;

pub mod binary;
pub mod command_ports;
pub mod logging;
pub mod model;
pub mod participant;
pub mod progress;
pub mod recording;
pub mod run_dir;
pub mod transport;
