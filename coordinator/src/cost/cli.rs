//! The subcommand.

use super::{FILE, Request, Study, analysis, csv, page, show, sweep};
use crate::error::RunError;
use crate::report;
use crate::study::axis::Axis;
use crate::study::folder::StudyFolder;
use crate::study::{Variant, scratch};
use clap::Args;
use proto::text::{json, visible};
use std::io::Write;
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
    /// The figure that ranks the runs, a dotted key of summary.json [default: the rail's rise].
    #[arg(long, value_name = "KEY")]
    quantity: Option<String>,
    /// Compare a figure with this value [default: its closed form, or the finest runs extrapolated].
    #[arg(long, value_name = "KEY=VALUE")]
    reference: Vec<String>,
    /// Make each run so often; its times are the least.
    #[arg(long, value_name = "TIMES", default_value_t = 2,
          value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Leave out runs whose solvers expect to take longer.
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0)]
    longest_run: f64,
    /// Folder of the study [default: results/NAME-cost].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
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
    let folder = match &asked.out {
        Some(folder) => folder.clone(),
        None => default_folder(&request)?,
    };
    let folder = StudyFolder::check(&folder, FILE)?;
    let scratch = scratch()?;
    let swept = sweep::sweep(&request, quiet || asked.json, scratch.path())?;
    let study = analysis::study(&request, swept)?;
    let json = json(&study);
    write(&folder, &study, &json)?;
    if asked.json {
        print(&json);
    } else if !quiet {
        print(&format!("{}  results   {}\n", show::text(&study), folder.path().display()));
    }
    Ok(())
}

fn request(asked: &Arguments) -> Result<Request, RunError> {
    let axes = asked.vary.iter().map(|option| Axis::parse(option));
    let references = asked.reference.iter().map(|option| reference(option));
    if asked.longest_run.is_nan() || asked.longest_run <= 0.0 {
        return Err(RunError::Usage("--longest-run is a number of seconds above 0".to_owned()));
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

/// Beside the results of runs of this case.
fn default_folder(request: &Request) -> Result<PathBuf, RunError> {
    let planned = crate::study::planned(&request.case, &request.base)?;
    Ok(Path::new("results").join(format!("{}-cost", planned.plan.name)))
}

fn write(folder: &StudyFolder, study: &Study, json: &str) -> Result<(), RunError> {
    folder.write(FILE, json.as_bytes())?;
    folder.write("cost.csv", csv::text(study).as_bytes())?;
    let first = study.quantities.first();
    if let Some(figure) = first.and_then(|one| page::work_precision(study, one)) {
        folder.write("work-precision.svg", figure.standalone().as_bytes())?;
    }
    report::write(folder.path()).map(drop)
}

fn print(text: &str) {
    // A reader that has gone away (`| head`) is no failure of ours.
    let _ = std::io::stdout().write_all(visible(text).as_bytes());
}
