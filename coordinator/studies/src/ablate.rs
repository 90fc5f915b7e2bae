//! `coordinator ablate`: measures the influence and the cost of each effect.
//!
//! A case runs unmodified, and once more without each of its effects. The difference between the
//! results is the influence of the effect in this case; the difference in time is its cost. Effects
//! that another effect or a model requires are reported with the reason. The effects come from the
//! plan; the code knows none by name.

mod study;
mod table;

pub(crate) use study::Study;

use crate::study::arguments::{RepeatArguments, StudyArguments};
use crate::study::finished::FinishedRuns;
use crate::study::output::{Printing, StudyFile, StudyPage};

use crate::study::runner::Runner;
use crate::study::variants::Variants;
use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use run::error::RunError;
use serde_json::json;
use study::study;

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
    const ABOUT: &'static str = "Measure what each effect changes, and what it costs";
    const EXAMPLES: &'static [&'static str] = &["coordinator ablate CASE"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let mut bench = self.folder.bench();
        let standing = bench.planned(&self.of.case, &self.of.changes)?;
        console::logging::log_warnings(&standing.plan.warnings);
        let none = FinishedRuns::none(&json!(self.times.repeat), &standing)?;
        let name = format!("{}-ablate", standing.plan.name);
        let folder = self.folder.choose(Study::COMMAND, &name, &|folder| none.are_in(folder))?;
        let printing = Printing { json: self.json, quiet: context.quiet };
        let variants = Variants { repeat: self.times.repeat, ..Variants::of(&self.of.case) };
        let mut runner = Runner::new(variants, &self.folder, bench, printing.is_silent())?
            .keep_finished(none, &folder)?;
        let study = study(&self.of, &standing, &mut runner)?;
        study.publish(&folder)?;
        runner.complete()?;
        printing.print(&study, || table::text(&study), &folder)
    }
}
