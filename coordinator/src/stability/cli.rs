//! The subcommand.

use super::report::Report;
use super::suite::Suite;
use super::{Request, limits, show, stability};
use crate::output::{Speaker, print};
use crate::study::arguments::StudyArguments;
use crate::study::output::{Kept, Shown};
use clap::Args;
use contract::text::json;
use run::error::{Failure, RunError};
use run::results::write::replace;
use std::path::PathBuf;

/// What `coordinator stability` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The suite.
    #[arg(default_value = "cases/hard/suite.toml")]
    suite: PathBuf,
    /// Run this case alone; may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Run the cases alone, without driving parameters to their edges.
    #[arg(long)]
    no_sweep: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    folder: StudyArguments,
    /// Write the edges that were found, as Markdown.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["only", "no_sweep"])]
    write_limits: Option<PathBuf>,
}

/// Runs the suite and prints how it went.
///
/// # Errors
/// What is asked for cannot be, or a case went otherwise than expected.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let _participants = asked.folder.keep();
    let suite = Suite::read(&asked.suite)?;
    // A case that the suite does not have is reported before anything is printed.
    suite.chosen(&asked.only)?;
    let folder = asked.folder.choose(Report::COMMAND, Report::COMMAND, &Report::is_unfinished)?;
    let request =
        Request { suite, only: asked.only.clone(), sweeps: !asked.no_sweep, out: folder.open()? };
    let mut speaker = Speaker::new(quiet || asked.json);
    // What is interrupted can be begun again in the same folder.
    Report { schema: Report::SCHEMA, ..Report::default() }.write(&folder)?;
    speaker.say(&show::head());
    let report = stability(&request, &mut speaker)?;
    report.publish(&folder)?;
    if asked.json {
        print(&json(&report))?;
    }
    speaker.say(&show::tail(&report, folder.path()));
    let written = verdict(&report).and_then(|()| match &asked.write_limits {
        Some(path) => replace(path, limits::text(&report).as_bytes()),
        None => Ok(()),
    });
    speaker.end(written)
}

fn verdict(report: &Report) -> Result<(), RunError> {
    let other = report.cases.iter().filter(|case| !case.as_expected());
    let names: Vec<&str> = other.map(|case| case.name.as_str()).collect();
    if names.is_empty() {
        return Ok(());
    }
    Err(RunError::Failed(Failure {
        who: report.suite.clone(),
        when: format!("in {} of {} cases", names.len(), report.cases.len()),
        what: format!("{} did not meet expectations", names.join(", ")),
        fix: "`coordinator stability --only NAME` runs one alone".to_owned(),
    }))
}
