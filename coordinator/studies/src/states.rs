//! `coordinator states`: the steady states of a case with a loop, and which of them last.
//!
//! A steady case is run from several starts, between which one key varies. Answers that are the same are one state, with the gain
//! of the loop there: a state whose gain is above one is led away from by every pass, and does not last in time.

mod page;
mod perform;
mod study;

pub(crate) use study::Study;

use crate::study::arguments::{CaseArguments, StudyArguments};
use crate::study::axis::Axis;
use crate::study::output::{Kept, Printing, Shown};
use crate::study::{planned, refuse_unread};
use clap::Args;
use console::command::{Command, Context, Group};
use perform::{Request, study};
use run::error::RunError;
use run::scratch::Scratch;

/// Options of `coordinator states`.
#[derive(Debug, Args)]
pub struct StatesCommand {
    #[command(flatten)]
    of: CaseArguments,
    /// What the runs start from: a key, and its values or a range [SI].
    #[arg(long, value_name = "KEY=A,B,C|FROM..TO/COUNT", value_parser = Axis::read)]
    start: Axis,
    #[command(flatten)]
    folder: StudyArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for StatesCommand {
    const NAME: &'static str = "states";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str =
        "Find the steady states of a case with a loop, and which of them last";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _participants = self.folder.keep();
        let (case, base) = (self.of.case.clone(), self.of.base());
        let standing = planned(&case, &base.with(&self.start.key, &self.start.values[0]))?;
        refuse_unread(&standing, &self.start.key, "--start")?;
        console::logging::log_warnings(&standing.plan.warnings);
        let name = format!("{}-states", standing.plan.name);
        let folder = self.folder.choose(Study::COMMAND, &name, &|_| false)?;
        let scratch = Scratch::new()?;
        let printing = Printing { json: self.json, quiet: context.quiet };
        let request = Request { case, base, starts: self.start.clone() };
        let study = study(&request, &standing, printing.is_silent(), scratch.path())?;
        study.publish(&folder)?;
        printing.print(&study, || page::text(&study), &folder)
    }
}
