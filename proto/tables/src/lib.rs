//! Tables of numbers from files named by a user, and the tools to read them.
//!
//! | module | what |
//! |---|---|
//! | [`table`] | columns of numbers or words in a text file, found by name, in SI units |
//! | [`input_file`] | files read as text, within limits |
//! | [`unit`], [`quantity`] | units of measurement; a number with its unit |
//! | [`readable`] | numbers and quantities for a reader |
//! | [`plausible`] | plausible range of a value |
//! | [`suggest`] | nearest valid word for a misspelt one |
//! | [`text`] | checks of text from outside, before it reaches a terminal or a message |

#![forbid(unsafe_code)]

pub mod input_file;
pub mod plausible;
pub mod quantity;
pub mod readable;
pub mod suggest;
pub mod table;
pub mod text;
pub mod unit;
