//! `coordinator ask`: the figures of a surrogate at a point, or at the rows of a table.

mod cli;
mod file;
mod table;

pub(crate) use cli::{Arguments, main};
pub(crate) use file::document;
