//! Executable of the relay, started by `coordinator relay`.

#![forbid(unsafe_code)]

use clap::{Args, Parser};
use proto::logging::wanted;
use relay::Packing;
use relay::client::{Client, join};
use relay::key::Key;
use relay::server::{Server, serve};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;
use tracing_subscriber::Layer as _;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

/// Connects a participant on another machine to a run.
///
/// On the other machine: coordinator relay --listen 0.0.0.0:7447 --key FILE -- thermal-solver
///
/// In the case: thermal.command = ["cosim-relay", "--connect", "HOST:7447", "--key", "FILE"]
#[derive(Debug, Parser)]
#[command(name = "cosim-relay", version, max_term_width = 80)]
struct Arguments {
    #[command(flatten)]
    mode: Mode,
    /// File with the key of both ends, readable by its owner only.
    #[arg(long, value_name = "FILE", required_unless_present = "new_key")]
    key: Option<PathBuf>,
    /// Silence of the other end after which the link counts as lost [s].
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, value_parser = seconds)]
    silence: f64,
    #[command(flatten)]
    listening: Listening,
    #[command(flatten)]
    connecting: Connecting,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Mode {
    /// Server: wait for clients at ADDRESS:PORT.
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = address, requires = "program")]
    listen: Option<String>,
    /// Client: represent the participant that runs at HOST:PORT.
    #[arg(long, value_name = "HOST:PORT", value_parser = address)]
    connect: Option<String>,
    /// Write a new key for both ends to a new file.
    #[arg(long, value_name = "FILE")]
    new_key: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct Listening {
    /// End after one run.
    #[arg(long, requires = "listen")]
    once: bool,
    /// Program that takes part, with its arguments.
    #[arg(last = true, value_name = "PROGRAM")]
    program: Vec<String>,
}

#[derive(Debug, Args)]
struct Connecting {
    /// Lossless compression of fields on the network.
    #[arg(long, value_name = "HOW", default_value_t = Packing::None)]
    compress: Packing,
    /// Maximum wait for the server to answer the connection [s].
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = seconds)]
    patience: f64,
    /// Take part in the run with this folder, as a participant does.
    #[arg(long, value_name = "RUN_FOLDER", requires_all = ["role", "connect"])]
    join: Option<PathBuf>,
    /// Role to play in the run.
    #[arg(long)]
    role: Option<String>,
}

fn address(text: &str) -> Result<String, String> {
    let plain = !text.contains('/')
        && text
            .rsplit_once(':')
            .is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok());
    plain.then(|| text.to_owned()).ok_or_else(|| "write HOST:PORT, as in 10.0.0.2:7447".to_owned())
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (0.1..=86_400.0).contains(&value) => Ok(value),
        _ => Err("write seconds from 0.1 to 86400".to_owned()),
    }
}

/// Error message and exit code.
struct Ended(String, u8);

impl Ended {
    fn of(error: impl std::fmt::Display) -> Self {
        Self(error.to_string(), 1)
    }
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    log(arguments.mode.listen.is_some());
    proto::transport::prepare_process();
    match act(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Ended(words, code)) => {
            let words = words.strip_prefix("error: ").unwrap_or(&words);
            let _ = writeln!(std::io::stderr(), "error: {words}");
            ExitCode::from(code)
        }
    }
}

/// Sets up the log: a server logs its actions and the log of its program, a client logs warnings.
fn log(listens: bool) {
    let own = |level| {
        let targets = Targets::new().with_default(LevelFilter::OFF);
        targets.with_target("relay", level).with_target("run", LevelFilter::WARN)
    };
    let chosen = match (std::env::var_os("RUST_LOG"), listens) {
        (Some(_), _) => wanted(LevelFilter::WARN),
        (None, true) => own(LevelFilter::INFO).with_target("participant", LevelFilter::INFO),
        (None, false) => own(LevelFilter::WARN),
    };
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .with_ansi(false)
        .without_time()
        .with_target(false)
        .with_filter(chosen);
    let _ = tracing_subscriber::registry().with(lines).try_init();
}

fn act(arguments: Arguments) -> Result<(), Ended> {
    let Arguments { mode, key, silence, listening, connecting } = arguments;
    if let Some(path) = &mode.new_key {
        return Key::create(path).map_err(Ended::of);
    }
    let key = Key::read(&key.expect("required unless a new one is made")).map_err(Ended::of)?;
    let silence = Duration::from_secs_f64(silence);
    if let Some(address) = mode.listen {
        let Listening { once, program: command } = listening;
        run::signals::listen().map_err(Ended::of)?;
        run::processes::adopt_orphans().map_err(Ended::of)?;
        let server = Server { address, key, command, silence, once };
        return serve(server).map_err(Ended::of);
    }
    let client = Client {
        address: mode.connect.expect("one of the three is required"),
        key,
        packing: connecting.compress,
        patience: Duration::from_secs_f64(connecting.patience),
        silence,
    };
    let (Some(folder), Some(role)) = (&connecting.join, &connecting.role) else {
        let how = "nothing to do; the coordinator starts this end as the command of a participant";
        return Err(Ended::of(how));
    };
    join(&client, folder, role).map_err(|error| Ended(error.words, error.code))
}
