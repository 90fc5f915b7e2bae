//! Participant of the linear pair that sends back the values it receives.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::linear::Linear::Relay)
}
