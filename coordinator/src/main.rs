//! The coordinator's executable.

#![forbid(unsafe_code)]

use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let since = Instant::now();
    proto::transport::prepare_process();
    let prepared = [
        (run::signals::listen(), "signals will not shut a run down in order"),
        (run::processes::adopt_orphans(), "orphaned processes of participants will not be ended"),
        (run::damage::report(), "damaged shared memory and full files will not be reported"),
    ];
    let faults = prepared.into_iter().filter_map(|(done, what)| Some((done.err()?, what)));
    ExitCode::from(coordinator::cli::main(since, faults.collect()))
}
