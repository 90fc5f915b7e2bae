//! The subcommand.

use super::{of_case, of_surrogate};
use crate::ask;
use crate::case_arguments::CaseArguments;
use crate::output;
use clap::Args;
use run::error::RunError;
use std::path::{Path, PathBuf};

/// The command line of `coordinator fmu`: a case, or a surrogate in the place of one.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    of: CaseArguments,
    /// The FMU that is written [default: NAME.fmu].
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes an FMU of FMI 3.0: of a case for co-simulation, of a surrogate for model exchange too.
///
/// # Errors
/// That of the case or of the surrogate, a case without live values, the file system.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let Arguments { of, out } = asked;
    let made = match is_surrogate(&of.case) {
        false => of_case::make(of, out.clone())?,
        true if of.set.is_empty() && of.unset.is_empty() => {
            of_surrogate::make(&ask::document(&of.case)?, out.clone())?
        }
        true => {
            return Err(RunError::Usage(
                "--set and --unset change a case, and a surrogate has none of its keys any more; leave them out"
                    .to_owned(),
            ));
        }
    };
    if quiet { Ok(()) } else { output::print(&made) }
}

/// It is the file of a surrogate, or the folder of a sweep that has one.
fn is_surrogate(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "json") || path.is_dir()
}
