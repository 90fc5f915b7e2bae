//! A block whose fields are on a volume.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::volume::Block)
}
