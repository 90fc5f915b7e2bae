//! `coordinator drive`: a run that is driven from outside, by lines on standard input and output.
//!
//! | file | what |
//! |---|---|
//! | `line.rs` | the language: one JSON object a line, each way |
//! | `ear.rs` | lines of standard input, which come when they come |
//! | `answers.rs` | lines of standard output, which are read when they are read |
//! | `act.rs` | what each line does |

mod act;
mod answers;
mod ear;
mod line;

pub(crate) use act::{Arguments, main, planned};
