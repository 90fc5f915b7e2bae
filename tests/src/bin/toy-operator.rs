//! The part of the linear pair that multiplies.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::linear::Linear::Operator)
}
