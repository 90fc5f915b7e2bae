//! The one of the moving pair whose grid stays.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::moving::Moving::Plate)
}
