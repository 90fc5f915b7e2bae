//! The command line: list of commands, parser, and exit codes.

use crate::catalogue::{FieldsCommand, FiguresCommand};
use crate::check::CheckCommand;
use crate::compare::CompareCommand;
use crate::drive::DriveCommand;
use crate::fmu::FmuCommand;
use crate::import::ImportCommand;
use crate::keys::KeysCommand;
use crate::manual::{CompletionsCommand, ManCommand};
use crate::new::NewCommand;
use crate::new_solver::NewSolverCommand;
use crate::picture::PictureCommand;
use crate::plan_case::PlanCommand;
use crate::relay::RelayCommand;
use crate::report::ReportCommand;
use crate::run_case::RunCommand;
use crate::solvers::SolversCommand;
use clap::{Args, FromArgMatches as _};
use conformance::conform::ConformCommand;
use conformance::export::ExportCommand;
use conformance::inspect::InspectCommand;
use conformance::replay::ReplayCommand;
use console::colour::{self, Colours};
use console::command::{Context, Ended, Entry, Group};
use console::logging::{Level, Logging};
use console::output;
use contract::text::one_line;
use run::error::RunError;
use run::wrap;
use std::io::Write as _;
use std::time::Instant;
use studies::ablate::AblateCommand;
use studies::ask::AskCommand;
use studies::cost::CostCommand;
use studies::fit::FitCommand;
use studies::reproduce::ReproduceCommand;
use studies::stability::StabilityCommand;
use studies::states::StatesCommand;
use studies::sweep::SweepCommand;
use watch::WatchCommand;

/// Every command, in the order of the help.
const COMMANDS: &[Entry] = &[
    Entry::of::<RunCommand>(),
    Entry::of::<CheckCommand>(),
    Entry::of::<PlanCommand>(),
    Entry::of::<NewCommand>(),
    Entry::of::<WatchCommand>(),
    Entry::of::<ReportCommand>(),
    Entry::of::<PictureCommand>(),
    Entry::of::<InspectCommand>(),
    Entry::of::<CompareCommand>(),
    Entry::of::<ExportCommand>(),
    Entry::of::<SweepCommand>(),
    Entry::of::<CostCommand>(),
    Entry::of::<AblateCommand>(),
    Entry::of::<StabilityCommand>(),
    Entry::of::<StatesCommand>(),
    Entry::of::<ReproduceCommand>(),
    Entry::of::<FitCommand>(),
    Entry::of::<AskCommand>(),
    Entry::of::<SolversCommand>(),
    Entry::of::<NewSolverCommand>(),
    Entry::of::<ConformCommand>(),
    Entry::of::<ReplayCommand>(),
    Entry::of::<ImportCommand>(),
    Entry::of::<FmuCommand>(),
    Entry::of::<DriveCommand>(),
    Entry::of::<RelayCommand>(),
    Entry::of::<KeysCommand>(),
    Entry::of::<FieldsCommand>(),
    Entry::of::<FiguresCommand>(),
    Entry::of::<CompletionsCommand>(),
    Entry::of::<ManCommand>(),
];

/// Options of every command.
#[derive(Debug, Args)]
struct Options {
    /// Least severe messages on the screen: error, warn, info, debug or trace [default: RUST_LOG,
    /// or warn].
    #[arg(
        long,
        global = true,
        value_name = "LEVEL",
        display_order = 900,
        hide_possible_values = true
    )]
    log: Option<Level>,
    /// Print only errors; overrides --log and RUST_LOG.
    #[arg(long, short, global = true, display_order = 901)]
    quiet: bool,
    /// When to use colours: auto (on a terminal), always or never.
    #[arg(
        long,
        global = true,
        display_order = 902,
        value_name = "WHEN",
        default_value = "auto",
        hide_possible_values = true,
        hide_default_value = true
    )]
    color: Colours,
}

/// Returns the parser of the whole command line.
#[must_use]
pub fn parser() -> clap::Command {
    let command = clap::Command::new("coordinator")
        .version(env!("COORDINATOR_VERSION"))
        .propagate_version(true)
        .max_term_width(wrap::WIDTH)
        .subcommand_required(true)
        .arg_required_else_help(true);
    Options::augment_args(command)
        .about("Plans, runs and couples mechanical-thermal contact simulations")
        .help_template(format!(
            "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}\
             \x1b[1;4mOptions:\x1b[0m\n{{options}}",
            list()
        ))
        .subcommands(COMMANDS.iter().map(Entry::parser))
}

/// Returns the list of commands in the help, by groups.
fn list() -> String {
    let line = |entry: &Entry| {
        // The second sentence is in the help of the command.
        let about = entry.about.split(". ").next().unwrap_or_default();
        let text = wrap::columns(&format!("  {:12}  {about}", entry.name));
        text.replacen(entry.name, &format!("\x1b[1m{}\x1b[0m", entry.name), 1) + "\n"
    };
    let group = |group: Group| {
        let entries: String =
            COMMANDS.iter().filter(|entry| entry.group == group).map(line).collect();
        format!("\x1b[1;4m{}:\x1b[0m\n{entries}\n", group.title())
    };
    Group::ALL.into_iter().map(group).collect()
}

/// Runs the command line and returns the exit code. Faults of the preparation are logged as soon as
/// there is a log.
pub fn main(since: Instant, faults: Vec<(std::io::Error, &str)>) -> u8 {
    let parsed = parser().color(colour::of_help(std::env::args_os())).try_get_matches();
    let (options, found) = match parsed.and_then(|found| {
        let options = Options::from_arg_matches(&found)?;
        Ok((options, found))
    }) {
        Ok(both) => both,
        Err(error) => return usage_error(&error),
    };
    colour::choose(options.color);
    let log = Logging::install(if options.quiet { Some(Level::Error) } else { options.log });
    for (error, what) in faults {
        tracing::warn!(%error, "{what}");
    }
    let context = Context { quiet: options.quiet, log: &log, since, whole: parser };
    let (name, words) = found.subcommand().expect("a command is required");
    let entry = COMMANDS.iter().find(|entry| entry.name == name).expect("the list is the parser's");
    match entry.run(words, &context) {
        Ok(()) => 0,
        Err(Ended::Usage(error)) => usage_error(&error),
        Err(Ended::Failed(error)) => {
            print_error(&error);
            if let Some(path) = log.path() {
                let _ = writeln!(std::io::stderr(), "  log: {}", path.display());
            }
            error.exit_code()
        }
    }
}

/// Prints help, the version, or the error of the command line, and returns the exit code.
fn usage_error(error: &clap::Error) -> u8 {
    match error.print().and_then(|()| std::io::stdout().flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            let error = output::failure(&error);
            print_error(&error);
            error.exit_code()
        }
        _ => u8::try_from(error.exit_code()).unwrap_or(2),
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
            writeln!(stderr, "{}", problems.render(colour::on(&stderr)))
        }
        // An error is one line, even if it quotes several.
        other => {
            let error = colour::error(colour::on(&stderr));
            writeln!(stderr, "{error}: {}", one_line(&other.to_string()))
        }
    };
}
