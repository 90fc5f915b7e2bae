//! The participant's side of a run: command line, heartbeat, and the state machine that serves a
//! [`Solver`]. A solver takes part as a process ([`main`]), or on a thread of a host program
//! ([`take_part`]).
//!
//! ```text
//! PROGRAM --join RUN_FOLDER --role ROLE   take part in a run, or answer questions before one
//! PROGRAM --describe                      print the description as JSON, for a person
//! ```

mod error;
mod geometry;
mod host;
mod ports;
mod pulse;
mod server;

pub use error::JoinError;
pub use host::{Host, Stop};

use crate::logging::wanted;
use crate::model::Solver;
use crate::run_dir::RunDir;
use crate::transport::prepare_process;
use clap::Parser;
use std::error::Error;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Mutex};
use tracing_subscriber::Layer as _;
use tracing_subscriber::filter::LevelFilter;
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

/// A participant of a co-simulation; started by the coordinator, or by hand with `--join`.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// Print a description of this program as JSON.
    #[arg(long, group = "action")]
    describe: bool,
    /// Take part in the run with this folder.
    #[arg(long, group = "action", value_name = "RUN_FOLDER", requires = "role")]
    join: Option<PathBuf>,
    /// Role to play in the run.
    #[arg(long)]
    role: Option<String>,
}

/// Complete `main` function of a participant.
pub fn main(solver: &dyn Solver) -> ExitCode {
    ExitCode::from(main_from(std::env::args_os(), solver))
}

/// Variant of [`main`] for programs in other languages. The arguments begin with the program name;
/// returns the exit code.
pub fn main_from(arguments: impl IntoIterator<Item = OsString>, solver: &dyn Solver) -> u8 {
    prepare_process();
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .with_ansi(false)
        .without_time()
        .with_filter(wanted(LevelFilter::WARN));
    // A host program's own subscriber stays in place.
    let _ = tracing_subscriber::registry().with(lines).try_init();
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    match act(&arguments, solver) {
        Ok(()) => 0,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: {error}");
            1
        }
    }
}

fn act(arguments: &Arguments, solver: &dyn Solver) -> Result<(), Box<dyn Error>> {
    if arguments.describe {
        print_json(&solver.description())
    } else if let (Some(folder), Some(role)) = (&arguments.join, &arguments.role) {
        Ok(take_part(folder, role, solver, Host::Process)?)
    } else {
        Err("nothing to do; started by hand, a participant needs --describe or --join \
             RUN_FOLDER --role ROLE"
            .into())
    }
}

fn print_json(value: &impl serde::Serialize) -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    serde_json::to_writer_pretty(&mut out, value)?;
    writeln!(out)?;
    Ok(())
}

/// Joins the run with this folder in a role, and serves until the coordinator ends the run or the
/// host is asked to stop.
///
/// # Errors
/// Fails if the run cannot be joined or its shared memory cannot be used.
pub fn take_part(
    folder: &Path,
    role: &str,
    solver: &dyn Solver,
    host: Host,
) -> Result<(), JoinError> {
    let run = RunDir::join(folder, role)?;
    let info = run.info().clone();
    let watch = run.watch()?;
    let index = info.roles.iter().position(|r| r == role).unwrap_or_default();
    // Declared before the server: the ports must close before the participant leaves the run's
    // folder, which may then be removed.
    let run = Arc::new(Mutex::new(Some(run)));
    let (mut server, voice) = server::Server::open(&info, role, index, solver, host.clone())?;
    let pulse = pulse::Heartbeat::start(voice, watch, Arc::clone(&run), host.clone())?;
    let outcome = server.serve();
    drop(pulse);
    outcome?;
    // The last member of the run removes the ports of this process with everything else.
    if let Host::Process = host {
        std::mem::forget(server);
    }
    Ok(())
}
