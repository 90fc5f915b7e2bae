//! The coordinator's executable.

use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let since = Instant::now();
    if let Err(error) = coordinator::signals::listen() {
        tracing::warn!(%error, "signals will not end a run in order");
    }
    ExitCode::from(coordinator::cli::main(since))
}
