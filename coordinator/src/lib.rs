//! The executable `coordinator`: its commands, a file each, and the list of all of them ([`cli`]).
//!
//! What a case is, and how it runs, are crates of their own: [`case`], [`run`]. Commands that are much
//! are crates too: [`studies`] run a case many times, [`conformance`] drives participants and reads
//! recordings, [`pages`] draws. What all commands share is in [`console`].

mod catalogue;
mod check;
pub mod cli;
mod compare;
mod drive;
mod fmu;
mod installed;
mod keys;
mod manual;
mod new;
mod new_solver;
mod picture;
mod plan_case;
mod relay;
mod report;
mod run_case;
mod solvers;
