//! A command of the coordinator.
//!
//! A command is a struct. Its fields are the options; its constants are name, group, help and
//! examples; [`Command::run`] runs it. An [`Entry`] is a command in a list, over which help,
//! parser, completions and manual iterate.

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
    /// Help: a sentence that fits a line of the list, and perhaps a second one with details. The
    /// last full stop is left out.
    const ABOUT: &'static str;
    /// Command lines at the end of the help.
    const EXAMPLES: &'static [&'static str];

    /// Runs the command.
    ///
    /// # Errors
    /// The failure that ended the command. Its exit code becomes that of the process.
    fn run(&self, context: &Context<'_>) -> Result<(), RunError>;
}

/// A group of commands in the help.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Commands that check, plan and run a case.
    Run,
    /// Commands that show results.
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

/// State of the process, shared by all commands.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// `--quiet`: only errors are printed.
    pub quiet: bool,
    /// Log of the process.
    pub log: &'a Logging,
    /// Start of the process.
    pub since: Instant,
    /// The whole command line, for completions and the manual.
    pub whole: fn() -> clap::Command,
}

impl Context<'_> {
    /// Prints a text, unless `--quiet` is given.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print(&self, text: &str) -> Result<(), RunError> {
        if self.quiet { Ok(()) } else { output::print(text) }
    }

    /// Prints lines that begin with names; on a terminal the names are coloured.
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
    /// Command lines at the end of the help.
    pub examples: &'static [&'static str],
    options: fn(clap::Command) -> clap::Command,
    run: fn(&clap::ArgMatches, &Context<'_>) -> Result<(), Ended>,
}

/// Failure of a command.
#[derive(Debug)]
pub enum Ended {
    /// Options that exclude each other.
    Usage(clap::Error),
    /// Failure of the command itself.
    Failed(Box<RunError>),
}

impl Entry {
    /// Returns the entry of a command.
    #[must_use]
    pub const fn of<C: Command>() -> Self {
        Self {
            name: C::NAME,
            group: C::GROUP,
            about: C::ABOUT,
            examples: C::EXAMPLES,
            options: |command| C::augment_args(command),
            run: |found, context| {
                let command = C::from_arg_matches(found).map_err(Ended::Usage)?;
                command.run(context).map_err(|error| Ended::Failed(Box::new(error)))
            },
        }
    }

    /// Returns the parser of the command.
    #[must_use]
    pub fn parser(&self) -> clap::Command {
        let lines: String = self.examples.iter().map(|line| format!("\n  {line}")).collect();
        let examples = format!("\x1b[1;4mExamples:\x1b[0m{lines}");
        // Without `long_about`, clap takes the doc comment of the struct, or of flattened options.
        (self.options)(clap::Command::new(self.name))
            .about(self.about)
            .long_about(None)
            .after_help(examples)
    }

    /// Runs the command with its options.
    ///
    /// # Errors
    /// Same errors as [`Command::run`], or options that exclude each other.
    pub fn run(&self, found: &clap::ArgMatches, context: &Context<'_>) -> Result<(), Ended> {
        (self.run)(found, context)
    }
}
