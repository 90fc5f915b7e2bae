//! A command of the coordinator.
//!
//! A command is a struct: its fields are the options, its constants say under which name, with which
//! help and in which group it is listed, and [`Command::run`] does it. An [`Entry`] is a command in
//! a list; help, parsing, completions and the manual iterate that list.

use crate::colour;
use crate::logging::Logging;
use crate::output;
use contract::text::visible;
use run::error::RunError;
use std::time::Instant;

/// A command and its options.
pub trait Command: clap::Args {
    /// Name on the command line.
    const NAME: &'static str;
    /// Group of the help in which it is listed.
    const GROUP: Group;
    /// Help, as one sentence or two without the last full stop.
    const ABOUT: &'static str;

    /// Does the command.
    ///
    /// # Errors
    /// The failure that ended the command; its exit code is that of the process.
    fn run(&self, context: &Context<'_>) -> Result<(), RunError>;
}

/// A group of commands in the help.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Commands that check, plan and run a case.
    Run,
    /// Commands that show what a run has left.
    Look,
    /// Commands that run a case many times.
    Study,
    /// Commands for authors of solvers.
    Solvers,
    /// Commands for other programs and machines.
    Connect,
    /// Commands that list keys, fields and figures, and document the others.
    Reference,
}

impl Group {
    /// All groups, in the order of the help.
    pub const ALL: [Self; 6] =
        [Self::Run, Self::Look, Self::Study, Self::Solvers, Self::Connect, Self::Reference];

    /// Heading in the help.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Run => "Run a case",
            Self::Look => "Look at results",
            Self::Study => "Study a case",
            Self::Solvers => "Write a solver",
            Self::Connect => "Connect programs",
            Self::Reference => "Look things up",
        }
    }
}

/// State of the process that a command is given besides its own options.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// `--quiet`: nothing but errors is printed.
    pub quiet: bool,
    /// The log of the process.
    pub log: &'a Logging,
    /// Start of the process.
    pub since: Instant,
    /// The whole command line, for completions and the manual.
    pub whole: fn() -> clap::Command,
}

impl Context<'_> {
    /// Prints a text, unless nothing is to be printed.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print(&self, text: &str) -> Result<(), RunError> {
        if self.quiet { Ok(()) } else { output::print(text) }
    }

    /// Prints lines that begin with names, in colours on a terminal.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print_lines(&self, text: &str) -> Result<(), RunError> {
        match self.quiet {
            true => Ok(()),
            false if colour::on(&std::io::stdout()) => {
                output::print_raw(&colour::named_lines(&visible(text)))
            }
            false => output::print(text),
        }
    }
}

/// A command in a list.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// Group of the help.
    pub group: Group,
    /// Help.
    pub about: &'static str,
    options: fn(clap::Command) -> clap::Command,
    run: fn(&clap::ArgMatches, &Context<'_>) -> Result<(), Ended>,
}

/// Failure of a command.
#[derive(Debug)]
pub enum Ended {
    /// Options that do not go together.
    Usage(clap::Error),
    /// Failure while it ran.
    Failed(Box<RunError>),
}

impl Entry {
    /// The entry of a command.
    #[must_use]
    pub const fn of<C: Command>() -> Self {
        Self {
            name: C::NAME,
            group: C::GROUP,
            about: C::ABOUT,
            options: |command| C::augment_args(command),
            run: |found, context| {
                let command = C::from_arg_matches(found).map_err(Ended::Usage)?;
                command.run(context).map_err(|error| Ended::Failed(Box::new(error)))
            },
        }
    }

    /// The command as the parser of the command line has it.
    #[must_use]
    pub fn parser(&self) -> clap::Command {
        // clap would take the doc comment of the struct, or of options flattened into it.
        (self.options)(clap::Command::new(self.name)).about(self.about).long_about(None)
    }

    /// Does the command with the options that were found.
    ///
    /// # Errors
    /// Same errors as [`Command::run`], and options that do not go together.
    pub fn run(&self, found: &clap::ArgMatches, context: &Context<'_>) -> Result<(), Ended> {
        (self.run)(found, context)
    }
}
