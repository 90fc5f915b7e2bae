//! Executable of the thermal solver.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&thermal_solver::ThermalSolver)
}
