//! The thermal solver's executable.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&thermal_solver::ThermalSolver)
}
