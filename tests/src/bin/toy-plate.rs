//! Participant of the moving pair whose grid is fixed.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::moving::Moving::Plate)
}
