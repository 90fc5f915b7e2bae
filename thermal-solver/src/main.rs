//! Executable of the thermal solver.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&thermal_solver::ThermalSolver)
}
