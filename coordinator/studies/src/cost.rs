//! `coordinator cost`: what accuracy costs in time.
//!
//! One case is run with every choice of models that can run it, over their resolutions, and, where
//! the case has them, over the length of its windows and the tolerance of its coupling ([`sweep`]).
//! Each quantity of interest is compared with a reference ([`analysis`]): its closed form where a
//! participant knows one, else the finest runs of the most faithful models, extrapolated. So every run
//! has an error and a cost; those that no other beats in both are the Pareto front.
//!
//! ```text
//! Request ──sweep──► Run (quantities, cost) ──analysis──► Study ──► table, cost.json, cost.csv, page
//! ```
//!
//! Models, resolutions and what models leave out come from the descriptions of the programs
//! ([`contract::accuracy`]); nothing here names one.

mod analysis;
mod finished;
mod page;
mod runs;
mod show;
mod study;
mod sweep;

pub(crate) use study::Study;

use crate::study::arguments::{CaseArguments, RepeatArguments, StudyArguments};
use crate::study::axis::Axis;
use crate::study::folder::StudyFolder;
use crate::study::output::{Kept, Printing, Shown};
use crate::study::planned;
use clap::Args;
use console::command::{Command, Context, Group};
use finished::FinishedRuns;
use run::error::RunError;
use run::scratch::Scratch;
use std::path::Path;
use study::Request;
use sweep::Places;

/// Options of `coordinator cost`.
#[derive(Debug, Args)]
pub struct CostCommand {
    #[command(flatten)]
    of: CaseArguments,
    #[command(flatten)]
    times: RepeatArguments,
    /// Vary a key, coarsest value first, in place of the default plan: a model, a resolution, a
    /// window, a tolerance; may be given several times.
    #[arg(long, value_name = "KEY=V1,V2")]
    vary: Vec<String>,
    /// The quantity that ranks the runs, a dotted key of summary.json [default: the first that is
    /// described].
    #[arg(long, value_name = "KEY")]
    quantity: Option<String>,
    /// Compare a quantity with this value [default: its closed form, or the finest runs
    /// extrapolated].
    #[arg(long, value_name = "KEY=VALUE")]
    reference: Vec<String>,
    /// Leave out runs whose solvers expect to take longer.
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0)]
    longest_run: f64,
    #[command(flatten)]
    folder: StudyArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for CostCommand {
    const NAME: &'static str = "cost";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str =
        "Show what accuracy costs in time, over models, resolutions, windows and tolerances";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _participants = self.folder.keep();
        let request = request(self)?;
        let standing = planned(&request.case, &request.base)?;
        console::logging::log_warnings(&standing.plan.warnings);
        let none = FinishedRuns::none(&request, &standing)?;
        let name = format!("{}-cost", standing.plan.name);
        let goes_on = |folder: &Path| none.read(folder).is_some();
        let folder = self.folder.choose(Study::COMMAND, &name, &goes_on)?;
        let kept = if self.folder.replace { none } else { none.resume(folder.path())? };
        tell_kept(kept.count());
        let scratch = Scratch::new()?;
        let printing = Printing { json: self.json, quiet: context.quiet };
        let mut places = Places { scratch: scratch.path(), study: &folder, kept };
        let swept = sweep::sweep(&request, &standing, printing.is_silent(), &mut places);
        let swept = swept.inspect_err(|error| tell_stopped(error, &places))?;
        let study = analysis::study(&request, swept)?;
        write(&study, &folder)?;
        printing.print(&study, || show::text(&study), &folder)
    }
}

/// Runs of a study that was stopped are not made again.
fn tell_kept(count: usize) {
    if count > 0 {
        tracing::warn!("{count} runs of the interrupted study are reused; --replace repeats all");
    }
}

/// What becomes of the runs of a study that is stopped.
fn tell_stopped(error: &RunError, places: &Places<'_>) {
    let (count, path) = (places.kept.count(), places.study.path().display());
    if error.is_interrupt() && count > 0 {
        tracing::warn!(
            "{count} finished runs are kept in {path}; the same command resumes with them"
        );
    }
}

/// Writes the files of a study in the place of its finished runs.
fn write(study: &Study, folder: &StudyFolder) -> Result<(), RunError> {
    folder.write("cost.csv", runs::csv(study).as_bytes())?;
    let first = study.quantities.first();
    if let Some(figure) = first.and_then(|one| page::work_precision(study, one)) {
        folder.write("work-precision.svg", figure.standalone().as_bytes())?;
    }
    study.publish(folder)?;
    FinishedRuns::remove(folder)
}

fn request(asked: &CostCommand) -> Result<Request, RunError> {
    let axes = asked.vary.iter().map(|option| Axis::read(option).map_err(RunError::Usage));
    let references = asked.reference.iter().map(|option| reference(option));
    if asked.longest_run.is_nan() || asked.longest_run <= 0.0 {
        return Err(RunError::Usage(
            "--longest-run must be a number of seconds above 0".to_owned(),
        ));
    }
    Ok(Request {
        case: asked.of.case.clone(),
        base: asked.of.base(),
        vary: axes.collect::<Result<_, _>>()?,
        quantity: asked.quantity.clone(),
        references: references.collect::<Result<_, _>>()?,
        repeat: asked.times.repeat,
        longest_run: asked.longest_run,
    })
}

fn reference(option: &str) -> Result<(String, f64), RunError> {
    let read = |(key, value): (&str, &str)| {
        let value = value.trim().parse::<f64>().ok().filter(|value| value.is_normal())?;
        Some((key.to_owned(), value))
    };
    option.split_once('=').and_then(read).ok_or_else(|| {
        RunError::Usage(format!("`--reference {option}` is not KEY=NUMBER, other than 0"))
    })
}
