//! The participant that works long.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::long::Long)
}
