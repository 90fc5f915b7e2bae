//! Tables of numbers from files that a user names, and what reading them takes.
//!
//! | module | what |
//! |---|---|
//! | [`table`] | columns of numbers or words in a text file, found by name, converted from their units |
//! | [`input_file`] | a file read within limits, as text |
//! | [`unit`], [`quantity`] | units of measurement; a number with its unit |
//! | [`plausible`] | the range in which a value is expected |
//! | [`suggest`] | the nearest of the words that would have been right |
//! | [`text`] | text from outside: what may reach a terminal or a message |

pub mod input_file;
pub mod plausible;
pub mod quantity;
pub mod suggest;
pub mod table;
pub mod text;
pub mod unit;
