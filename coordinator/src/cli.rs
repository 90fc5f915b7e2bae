//! The command line.

use crate::case::RawCase;
use crate::error::{RunError, file_failure};
use crate::logging::LogFile;
use crate::plan::{Planned, plan};
use crate::programs;
use crate::progress::Progress;
use crate::results::ResultFolder;
use crate::run;
use clap::{Args, Parser, Subcommand};
use proto::description::Description;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Plans, runs and couples mechanical-thermal contact simulations.
#[derive(Debug, Parser)]
#[command(name = "coordinator", version, propagate_version = true)]
pub struct Arguments {
    /// What reaches the screen: error, warn, info, debug or trace.
    #[arg(long, global = true, value_name = "LEVEL")]
    log: Option<String>,
    /// Print errors only.
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

/// Does what the command line asks for; the exit code.
pub fn main(since: Instant) -> u8 {
    let arguments = Arguments::parse();
    let log = LogFile::install(arguments.log.as_deref());
    match act(&arguments, &log, since) {
        Ok(()) => 0,
        Err(error) => {
            print_error(&error);
            error.exit_code()
        }
    }
}

fn act(arguments: &Arguments, log: &LogFile, since: Instant) -> Result<(), RunError> {
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
        Command::Solvers => solvers(),
    }
}

fn run_case(
    case: &CaseArguments,
    out: Option<&PathBuf>,
    quiet: bool,
    log: &LogFile,
    since: Instant,
) -> Result<(), RunError> {
    let planned = case.plan()?;
    let default = || PathBuf::from("results").join(&planned.plan.name);
    let folder = ResultFolder::prepare(&out.cloned().unwrap_or_else(default))?;
    let log_path = folder.file("log.jsonl");
    log.write_to(&log_path).map_err(|error| file_failure(&log_path, &error))?;
    let mut progress = Progress::new(quiet, planned.plan.windows.count());
    let outcome = run::run(&planned, &folder, &mut progress, since)?;
    match outcome.error {
        Some(error) => Err(error),
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
    let mut stderr = std::io::stderr().lock();
    let _ = match error {
        RunError::Case(problems) => {
            writeln!(stderr, "{}", problems.render(stderr.is_terminal()))
        }
        other => writeln!(stderr, "error: {other}"),
    };
}
