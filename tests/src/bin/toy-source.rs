//! Heat source of the lumped pair.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::lumped::Lumped::Source)
}
