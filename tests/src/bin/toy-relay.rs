//! The part of the linear pair that sends on what it receives.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::linear::Linear::Relay)
}
