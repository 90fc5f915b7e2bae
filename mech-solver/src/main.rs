//! The mech solver's executable.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&mech_solver::MechSolver)
}
