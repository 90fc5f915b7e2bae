//! `coordinator cost`: accuracy against run time.
//!
//! A case runs with every possible combination of models and over their resolutions. Where
//! applicable, the window length and the tolerance of the coupling vary as well ([`sweep`]). Each
//! quantity of interest is compared with a reference ([`analysis`]): a closed form if a participant
//! knows one, otherwise the extrapolated finest runs of the most faithful models. Every run thus
//! has an error and a cost. The runs that no other beats in both form the Pareto front.
//!
//! ```text
//! Request ──sweep──► Run (quantities, cost) ──analysis──► Study ──► table, cost.json, cost.csv, page
//! ```
//!
//! Models, resolutions and simplifications come from the descriptions of the programs
//! ([`contract::accuracy`]); the code knows none by name.

mod analysis;
mod page;
mod runs;
mod show;
mod study;
mod sweep;

pub(crate) use study::Study;

use crate::study::arguments::{RepeatArguments, StudyArguments};
use crate::study::axis::Axis;
use crate::study::finished::FinishedRuns;
use crate::study::folder::StudyFolder;
use crate::study::output::{Printing, StudyFile, StudyPage};

use crate::study::runner::Runner;
use crate::study::variants::Variants;
use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use run::error::RunError;
use study::Request;

/// Options of `coordinator cost`.
#[derive(Debug, Args)]
pub struct CostCommand {
    #[command(flatten)]
    of: CaseArguments,
    #[command(flatten)]
    times: RepeatArguments,
    /// Vary a key instead of the default plan, coarsest value first: a model, a resolution, a
    /// window or a tolerance; may be repeated.
    #[arg(long, value_name = "KEY=V1,V2")]
    vary: Vec<String>,
    /// Quantity that ranks the runs, a dotted key of summary.json [default: the first described
    /// quantity].
    #[arg(long, value_name = "KEY")]
    quantity: Option<String>,
    /// Compare a quantity with this value [default: its closed form, or the extrapolated finest
    /// runs].
    #[arg(long, value_name = "KEY=VALUE")]
    reference: Vec<String>,
    /// Skip runs with a longer expected solver time.
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
    const ABOUT: &'static str = "Measure error against run time, over models and grids";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator cost CASE", "coordinator cost CASE --vary mech.resolution=5,10,20"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let mut bench = self.folder.bench();
        let request = request(self)?;
        let standing = bench.planned(&request.case, &request.base)?;
        console::logging::log_warnings(&standing.plan.warnings);
        let none = FinishedRuns::none(&request.decides_runs(), &standing)?;
        let name = format!("{}-cost", standing.plan.name);
        let folder = self.folder.choose(Study::COMMAND, &name, &|folder| none.are_in(folder))?;
        let printing = Printing { json: self.json, quiet: context.quiet };
        let Request { repeat, longest_run, .. } = request;
        let variants = Variants { repeat, longest_run, ..Variants::of(&self.of.case) };
        let mut runner = Runner::new(variants, &self.folder, bench, printing.is_silent())?
            .keep_finished(none, &folder)?;
        let swept = sweep::sweep(&request, &standing, &mut runner)?;
        let study = analysis::study(&request, swept)?;
        write(&study, &folder)?;
        runner.complete()?;
        printing.print(&study, || show::text(&study), &folder)
    }
}

/// Writes the files of the study.
fn write(study: &Study, folder: &StudyFolder) -> Result<(), RunError> {
    folder.write("cost.csv", runs::csv(study).as_bytes())?;
    let first = study.quantities.first();
    if let Some(figure) = first.and_then(|one| page::work_precision(study, one)) {
        folder.write("work-precision.svg", figure.standalone().as_bytes())?;
    }
    study.publish(folder)
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
        base: asked.of.changes.clone(),
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
