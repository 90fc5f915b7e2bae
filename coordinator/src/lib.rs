//! The executable `coordinator`: its commands, a file each, and the list of all of them ([`cli`]).
//!
//! Cases and runs are crates of their own: [`case`], [`run`]. So are groups of large commands:
//! [`studies`] runs a case many times, [`conformance`] drives participants and reads recordings,
//! [`pages`] draws. [`console`] has the parts that all commands share.

#![forbid(unsafe_code)]

mod catalogue;
mod check;
pub mod cli;
mod compare;
mod drive;
mod fmu;
mod import;
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
