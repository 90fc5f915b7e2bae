//! Participant of the linear pair that applies the matrix.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::linear::Linear::Operator)
}
