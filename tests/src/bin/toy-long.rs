//! Participant with long solves that report progress.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::long::Long)
}
