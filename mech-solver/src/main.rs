//! The mech solver's executable.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&mech_solver::MechSolver)
}
