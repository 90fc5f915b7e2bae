//! Contract between coordinator and participants: the table of fields, grids, steps, descriptions,
//! configurations, and the fixed layouts of messages. The crate `proto` transports them.
//!
//! | module | what |
//! |---|---|
//! | [`field`] | table of the fields that may cross the interface |
//! | [`bodies`] | the two bodies in contact: their positions and names |
//! | [`grid`] | surface grids, on which fields have their values |
//! | [`step`] | one solve, and the model's report of it |
//! | [`description`] | self-description of a participant: models, effects, case keys, fields |
//! | [`figure`] | figures of a summary: meaning, presentation, comparison |
//! | [`diagram`] | diagrams of two figures, with known lines |
//! | [`configuration`] | configuration of a participant: case values, inputs and outputs |
//! | [`history`] | varying case values: columns of a table |
//! | [`live`] | case values given from outside during a run |
//! | [`params`] | typed access to the case values inside a configuration |
//! | [`advice`] | advice of a participant on the effects in a scene |
//! | [`accuracy`] | expected errors of a model |
//! | [`plausible`] | plausible range of a value |
//! | [`unit`], [`quantity`] | units of measurement; a number with its unit |
//! | [`input_file`], [`table`] | files named by a user, read within limits; tables of numbers |
//! | [`suggest`] | nearest valid word for a misspelt one |
//! | [`message`] | fixed layouts of commands, replies and field headers |
//! | [`text`] | texts from other processes: checks before they reach a terminal or a label |
//! | [`words!`] | enums with one word of a case per variant |
//!
//! Grids and table readers are crates of their own, [`grids`] and [`tables`], for libraries that do
//! not depend on the contract. They are re-exported here as modules. This crate knows no transport
//! and no process; it reads only files named by a user.

#![forbid(unsafe_code)]

pub use grids as grid;
pub use tables::{input_file, plausible, quantity, readable, suggest, table, unit};

pub mod accuracy;
pub mod advice;
pub mod bodies;
pub mod configuration;
pub mod description;
pub mod diagram;
pub mod field;
pub mod figure;
pub mod history;
pub mod live;
pub mod message;
pub mod params;
mod refusal;
pub mod step;
pub mod text;
mod words;

/// Version of the contract; raised when a layout, a command or the meaning of a key changes.
pub const PROTOCOL_VERSION: u32 = 7;
