//! Parts that the commands of the coordinator share: the trait of a command, the case that it is
//! given, standard output, colours, progress and the log.

#![forbid(unsafe_code)]

pub mod case_arguments;
pub mod colour;
pub mod command;
mod feed;
pub mod keys;
pub mod listing;
pub mod logging;
pub mod output;
pub mod progress;
pub mod scenes;
pub mod steps;
