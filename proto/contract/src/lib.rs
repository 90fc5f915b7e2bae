//! What coordinator and participants agree on: the table of fields, grids, steps, descriptions,
//! configurations, and the fixed layouts of messages. How they travel is the crate `proto`.
//!
//! | module | what |
//! |---|---|
//! | [`field`] | the table of fields that may cross the interface |
//! | [`bodies`] | the two bodies in contact: their positions, and the names that a case gives them |
//! | [`grid`] | the surface grids that fields live on |
//! | [`step`] | one solve, and what a model reports of it |
//! | [`description`] | what a participant says of itself: models, effects, case keys, fields |
//! | [`figure`] | the figures of its summary: what they are, and how they are shown and compared |
//! | [`diagram`] | diagrams of two figures, with lines that are known |
//! | [`configuration`] | what a participant receives: its part of the case, its inputs and outputs |
//! | [`history`] | case values that vary: columns of a table |
//! | [`live`] | case values that are given from outside as the run goes |
//! | [`params`] | typed access to the case values inside a configuration |
//! | [`advice`] | what a participant thinks of effects in a scene |
//! | [`accuracy`] | what a model says of its errors |
//! | [`plausible`] | what is expected of a value |
//! | [`unit`], [`quantity`] | units of measurement; a number with its unit |
//! | [`input_file`], [`table`] | a file that a user names, read within limits; tables of numbers in one |
//! | [`suggest`] | the nearest of the words that would have been right |
//! | [`message`] | the fixed layouts of commands, replies and field headers |
//! | [`text`] | text from outside: what may reach a terminal or a label |
//!
//! Grids and the readers of tables are crates of their own, [`grids`] and [`tables`], for libraries
//! that know no contract; they are modules here, too. This crate knows no transport and no process, and of files only
//! those that a user names.

pub use grids as grid;
pub use tables::{input_file, plausible, quantity, suggest, table, unit};

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

/// Version of the contract. Raised whenever a layout, a command or the meaning of a key changes.
pub const PROTOCOL_VERSION: u32 = 5;
