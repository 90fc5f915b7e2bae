//! Participant of the moving pair whose grid moves.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::moving::Moving::Mover)
}
