//! `coordinator relay`: handed over to an executable of its own, so that nothing of a network is in this one.

use clap::Args;
use run::error::RunError;
use run::programs::Program;
use std::ffi::OsString;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::Command;

/// The executable.
const PROGRAM: &str = "cosim-relay";

#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// --listen ENDPOINT --key FILE -- PROGRAM there; --connect ENDPOINT --key FILE at home; --new-key FILE; --help
    /// for all options.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    options: Vec<OsString>,
}

/// Becomes the relay.
///
/// # Errors
/// It is not there.
pub(crate) fn main(asked: &Arguments) -> Result<(), RunError> {
    let program = Program::of_role("", Some(&[PROGRAM.to_owned()]));
    let error = Command::new(&program.path).args(&asked.options).exec();
    let shown = program.path.display();
    Err(RunError::Usage(match error.kind() {
        io::ErrorKind::NotFound => format!(
            "there is no {PROGRAM} beside the coordinator; build it: cargo build --release -p relay, \
             or install it: cargo install --locked --path bridges/relay"
        ),
        _ => format!("{shown}: {error}"),
    }))
}
