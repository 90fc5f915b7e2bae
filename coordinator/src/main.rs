//! The coordinator's executable.

use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let since = Instant::now();
    proto::transport::prepare_process();
    if let Err(error) = run::signals::listen() {
        tracing::warn!(%error, "signals will not shut a run down in order");
    }
    if let Err(error) = run::processes::adopt_orphans() {
        tracing::warn!(%error, "orphaned processes of participants will not be ended");
    }
    if let Err(error) = run::damage::report() {
        tracing::warn!(%error, "damaged shared memory will not be reported");
    }
    ExitCode::from(coordinator::cli::main(since))
}
