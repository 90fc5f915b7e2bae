//! `coordinator relay`: starts `cosim-relay`, so that the coordinator itself has no network code.

use clap::Args;
use console::command::{Command, Context, Group};
use run::error::RunError;
use run::program::Program;
use std::ffi::OsString;
use std::os::unix::process::CommandExt as _;
use std::{io, process};

/// Name of the executable.
const PROGRAM: &str = "cosim-relay";

/// Options of `coordinator relay`, which `cosim-relay` reads.
#[derive(Clone, Debug, Args)]
#[command(disable_help_flag = true)]
pub(crate) struct RelayCommand {
    /// --listen ENDPOINT --key FILE -- PROGRAM there; --connect ENDPOINT --key FILE at home;
    /// --new-key FILE; --help for all options.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    options: Vec<OsString>,
}

impl Command for RelayCommand {
    const NAME: &'static str = "relay";
    const GROUP: Group = Group::Connect;
    const ABOUT: &'static str = "Serve a participant to a run on another machine";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator relay --listen 0.0.0.0:7447 --key FILE -- thermal-solver"];

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        let program = Program::of_role("", Some(&[PROGRAM.to_owned()]));
        let error = process::Command::new(&program.path).args(&self.options).exec();
        let shown = program.path.display();
        Err(RunError::Usage(match error.kind() {
            io::ErrorKind::NotFound => format!(
                "there is no {PROGRAM} beside the coordinator; build it: cargo build --release -p relay, \
                 or install it: cargo install --locked --path bridges/relay"
            ),
            _ => format!("{shown}: {error}"),
        }))
    }
}
