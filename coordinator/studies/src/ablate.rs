//! `coordinator ablate`: what each effect changes, and what it costs.
//!
//! A case is run as it is, and once more without each of its effects. The difference in the answer is what
//! the effect is worth in this scene; the difference in time is its price. Effects that need another, or
//! that a model cannot do without, are reported with the reason. Which effects there are is in the
//! plan; nothing here names one.

mod page;
mod perform;
mod runs;
mod study;

pub(crate) use study::Study;

use crate::study::arguments::{CaseArguments, RepeatArguments, StudyArguments};
use crate::study::output::{Kept, Printing, Shown};
use crate::study::planned;
use clap::Args;
use console::command::{Command, Context, Group};
use perform::{Request, study};
use run::error::RunError;
use run::scratch::Scratch;

/// Options of `coordinator ablate`.
#[derive(Debug, Args)]
pub struct AblateCommand {
    #[command(flatten)]
    of: CaseArguments,
    #[command(flatten)]
    times: RepeatArguments,
    #[command(flatten)]
    folder: StudyArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for AblateCommand {
    const NAME: &'static str = "ablate";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str =
        "Switch off each effect in turn: what it changes in the answer, and what it costs";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _participants = self.folder.keep();
        let (case, base) = (self.of.case.clone(), self.of.base());
        let standing = planned(&case, &base)?;
        console::logging::log_warnings(&standing.plan.warnings);
        let name = format!("{}-ablate", standing.plan.name);
        let folder = self.folder.choose(Study::COMMAND, &name, &|_| false)?;
        let scratch = Scratch::new()?;
        let printing = Printing { json: self.json, quiet: context.quiet };
        let request = Request { case, base, repeat: self.times.repeat };
        let study = study(&request, printing.is_silent(), scratch.path())?;
        study.publish(&folder)?;
        printing.print(&study, || runs::text(&study), &folder)
    }
}
