//! Participant with fields on a volume.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::volume::Block)
}
