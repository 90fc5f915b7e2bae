//! `coordinator fmu`: a case or a surrogate as an FMU, for simulations that couple by FMI.
//!
//! | file | what |
//! |---|---|
//! | `variables.rs` | inputs and outputs of the FMU of a plan, or of a surrogate |
//! | `description.rs` | `modelDescription.xml` |
//! | `page.rs` | the documentation inside |
//! | `resources.rs` | the case, its files and the executables |
//! | `pack.rs` | the archive |
//! | `whole.rs` | all of it, in order |
//! | `of_case.rs`, `of_surrogate.rs` | from a case, from a surrogate |
//! | `make.rs` | the command line |

mod description;
mod of_case;
mod of_surrogate;
mod pack;
mod page;
mod resources;
mod variables;
mod whole;

use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use console::output;
use run::error::RunError;
use std::path::{Path, PathBuf};
use studies::ask;

/// Options of `coordinator fmu`: a case, or a surrogate in the place of one.
#[derive(Debug, Args)]
pub(crate) struct FmuCommand {
    #[command(flatten)]
    of: CaseArguments,
    /// The FMU that is written [default: NAME.fmu].
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Command for FmuCommand {
    const NAME: &'static str = "fmu";
    const GROUP: Group = Group::Connect;
    const ABOUT: &'static str = "Write a case, or a surrogate, as an FMU (FMI 3.0): live values or keys are inputs, figures outputs";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let FmuCommand { of, out } = self;
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
        if context.quiet { Ok(()) } else { output::print(&made) }
    }
}

/// It is the file of a surrogate, or the folder of a sweep that has one.
fn is_surrogate(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "json") || path.is_dir()
}
