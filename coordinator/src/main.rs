//! The coordinator's executable.

use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    ExitCode::from(coordinator::cli::main(Instant::now()))
}
