//! The subcommand.

use super::kept::Kept;
use super::sweep::Places;
use super::{FILE, Request, Study, analysis, csv, page, show, sweep};
use crate::output::print;
use crate::report;
use crate::study::axis::Axis;
use crate::study::folder::{StudyFolder, Wanted};
use crate::study::{Variant, planned, scratch};
use clap::Args;
use contract::text::json;
use run::error::RunError;
use std::path::{Path, PathBuf};

/// What `coordinator cost` is asked.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The case file.
    case: PathBuf,
    /// Change a key for all runs: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Remove a key for all runs.
    #[arg(long, value_name = "KEY")]
    unset: Vec<String>,
    /// Vary a key, coarsest value first, in place of the default plan: a model, a resolution, a
    /// window, a tolerance; may be given several times.
    #[arg(long, value_name = "KEY=V1,V2")]
    vary: Vec<String>,
    /// The quantity that ranks the runs, a dotted key of summary.json [default: the rail's rise].
    #[arg(long, value_name = "KEY")]
    quantity: Option<String>,
    /// Compare a quantity with this value [default: its closed form, or the finest runs
    /// extrapolated].
    #[arg(long, value_name = "KEY=VALUE")]
    reference: Vec<String>,
    /// Make each run so often; its times are the least.
    #[arg(long, value_name = "TIMES", default_value_t = 2,
          value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Leave out runs whose solvers expect to take longer.
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0)]
    longest_run: f64,
    /// Folder of the study; one that was stopped is resumed [default: results/NAME-cost, or
    /// NAME-cost-2 and so on].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an earlier study in that folder.
    #[arg(long)]
    replace: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Makes the study, writes its files and prints it.
///
/// # Errors
/// A case that cannot run, options that cannot be, the file system.
pub fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let request = request(asked)?;
    let standing = planned(&request.case, &request.base)?;
    crate::logging::warn_of_replaced(&standing.case);
    let kept = |folder: &Path| Kept::read(folder, &request, &standing);
    let study = StudyFolder::choose(&Wanted {
        command: "cost",
        name: &format!("{}-cost", standing.plan.name),
        out: asked.out.as_deref(),
        replace: asked.replace,
        goes_on: &|folder| kept(folder).count() > 0,
    })?;
    let kept = match asked.replace {
        true => Kept::none(&request, &standing),
        false => kept(study.path()),
    };
    tell_kept(kept.count());
    let scratch = scratch()?;
    let mut places = Places { scratch: scratch.path(), study: &study, kept };
    let swept = sweep::sweep(&request, &standing, quiet || asked.json, &mut places);
    let swept = swept.inspect_err(|error| tell_stopped(error, &places))?;
    finish(asked, quiet, &study, &analysis::study(&request, swept)?)
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

/// Writes the files of a study and prints it.
fn finish(
    asked: &Arguments,
    quiet: bool,
    folder: &StudyFolder,
    study: &Study,
) -> Result<(), RunError> {
    let json = json(study);
    write(folder, study, &json)?;
    Kept::remove(folder)?;
    print(&match (asked.json, quiet) {
        (true, _) => json,
        (false, true) => String::new(),
        (false, false) => {
            format!("{}  results   {}\n", show::text(study), folder.path().display())
        }
    })
}

fn request(asked: &Arguments) -> Result<Request, RunError> {
    let axes = asked.vary.iter().map(|option| Axis::parse(option));
    let references = asked.reference.iter().map(|option| reference(option));
    if asked.longest_run.is_nan() || asked.longest_run <= 0.0 {
        return Err(RunError::Usage(
            "--longest-run must be a number of seconds above 0".to_owned(),
        ));
    }
    Ok(Request {
        case: asked.case.clone(),
        base: Variant { set: asked.set.clone(), unset: asked.unset.clone() },
        vary: axes.collect::<Result<_, _>>()?,
        quantity: asked.quantity.clone(),
        references: references.collect::<Result<_, _>>()?,
        repeat: asked.repeat,
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

fn write(folder: &StudyFolder, study: &Study, json: &str) -> Result<(), RunError> {
    folder.write(FILE, json.as_bytes())?;
    folder.write("cost.csv", csv::text(study).as_bytes())?;
    let first = study.quantities.first();
    if let Some(figure) = first.and_then(|one| page::work_precision(study, one)) {
        folder.write("work-precision.svg", figure.standalone().as_bytes())?;
    }
    report::write(&folder.open()?).map(drop)
}
