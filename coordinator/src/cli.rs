//! The command line.

use crate::case::RawCase;
use crate::error::{RunError, file_failure};
use crate::logging::{Level, Logging};
use crate::plan::{Planned, plan};
use crate::programs;
use crate::progress::Progress;
use crate::results::ResultFolder;
use crate::run::{self, Clock};
use clap::{Args, Parser, Subcommand};
use proto::description::Description;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Plans, runs and couples mechanical-thermal contact simulations.
#[derive(Debug, Parser)]
#[command(name = "coordinator", version, propagate_version = true)]
pub struct Arguments {
    /// What reaches the screen [default: RUST_LOG, or warn].
    #[arg(long, global = true, value_name = "LEVEL")]
    log: Option<Level>,
    /// Print errors only, whatever else says what reaches the screen.
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a case and write its results.
    Run {
        #[command(flatten)]
        case: CaseArguments,
        /// Result directory [default: results/NAME].
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Check a case: every error at once, each with its place, reason and fix.
    Check {
        #[command(flatten)]
        case: CaseArguments,
    },
    /// Show what a case will run and what not, and why.
    Plan {
        #[command(flatten)]
        case: CaseArguments,
    },
    /// Show the models and effects that the installed solvers offer.
    Solvers,
}

#[derive(Debug, Args)]
struct CaseArguments {
    /// The case file.
    case: PathBuf,
    /// Change a key: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Remove a key.
    #[arg(long, value_name = "KEY")]
    unset: Vec<String>,
}

impl CaseArguments {
    fn plan(&self) -> Result<Planned, RunError> {
        let mut raw = RawCase::read(&self.case)?;
        raw.apply(&self.set, &self.unset)?;
        tracing::info_span!("plan").in_scope(|| plan(raw))
    }
}

/// An error of a command, and the log in which there is more to read.
#[derive(Debug)]
struct Ended {
    error: Box<RunError>,
    log: Option<PathBuf>,
}

impl From<RunError> for Ended {
    fn from(error: RunError) -> Self {
        Self { error: Box::new(error), log: None }
    }
}

/// Does what the command line asks for; the exit code.
pub fn main(since: Instant) -> u8 {
    let arguments = Arguments::parse();
    let level = if arguments.quiet { Some(Level::Error) } else { arguments.log };
    let log = Logging::install(level);
    match act(&arguments, &log, since) {
        Ok(()) => 0,
        Err(ended) => {
            print_error(&ended.error);
            if let Some(log) = &ended.log {
                let _ = writeln!(std::io::stderr(), "  log: {}", log.display());
            }
            ended.error.exit_code()
        }
    }
}

fn act(arguments: &Arguments, log: &Logging, since: Instant) -> Result<(), Ended> {
    match &arguments.command {
        Command::Run { case, out } => run_case(case, out.as_ref(), arguments.quiet, log, since),
        Command::Check { case } => {
            case.plan()?;
            print(arguments.quiet, &format!("{}: no errors\n", case.case.display()));
            Ok(())
        }
        Command::Plan { case } => {
            print(false, &case.plan()?.plan.to_string());
            Ok(())
        }
        Command::Solvers => Ok(solvers()?),
    }
}

fn run_case(
    case: &CaseArguments,
    out: Option<&PathBuf>,
    quiet: bool,
    log: &Logging,
    since: Instant,
) -> Result<(), Ended> {
    let planning = Instant::now();
    let planned = case.plan()?;
    let clock = Clock { since, plan_seconds: planning.elapsed().as_secs_f64() };
    let default = || PathBuf::from("results").join(&planned.plan.name);
    let folder = ResultFolder::prepare(&out.cloned().unwrap_or_else(default), &case.case)?;
    let log_path = folder.log_path();
    log.write_to(folder.log()?).map_err(|error| file_failure(&log_path, &error))?;
    let mut progress = Progress::new(quiet, planned.plan.windows.count());
    log.share_screen(progress.bar());
    let told = |error| Ended { error: Box::new(error), log: Some(log_path.clone()) };
    let outcome = run::run(&planned, &folder, &mut progress, clock).map_err(told)?;
    match outcome.error {
        Some(error) => Err(told(error)),
        None => {
            print(quiet, &run::report(&outcome, &planned.plan, &folder));
            Ok(())
        }
    }
}

fn solvers() -> Result<(), RunError> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|error| file_failure(std::path::Path::new("tokio"), &error))?;
    for (role, program) in programs::installed() {
        let described = runtime.block_on(program.describe(&role, Duration::from_secs(30)))?;
        print(false, &show_solver(&described));
    }
    Ok(())
}

fn show_solver(of: &Description) -> String {
    let mut text = format!("{} {} (role {})\n", of.name, of.version, of.role);
    for model in &of.models {
        let modes = match (model.steady, model.transient) {
            (true, true) => "steady, transient",
            (true, false) => "steady",
            _ => "transient",
        };
        text += &format!("  model   {:16} {} [{modes}]\n", model.name, model.summary);
        text += &format!("          {:16} source: {}\n", "", model.source);
    }
    for effect in &of.effects {
        text += &format!("  effect  {:16} {}\n", effect.name, effect.law);
        text += &format!("          {:16} models: {}\n", "", effect.models.join(", "));
        text += &format!("          {:16} source: {}\n", "", effect.source);
    }
    text
}

fn print(quiet: bool, text: &str) {
    if !quiet {
        // A reader that has gone away (`| head`) is no failure of ours.
        let _ = std::io::stdout().write_all(text.as_bytes());
    }
}

fn print_error(error: &RunError) {
    if let RunError::Both { first, second } = error {
        print_error(first);
        return print_error(second);
    }
    let mut stderr = std::io::stderr().lock();
    let _ = match error {
        RunError::Case(problems) => {
            writeln!(stderr, "{}", problems.render(stderr.is_terminal()))
        }
        other => writeln!(stderr, "error: {other}"),
    };
}
