//! The subcommand.

use super::report::{FILE, Report, SCHEMA};
use super::suite::Suite;
use super::{Request, limits, show, stability};
use crate::error::{Failure, RunError};
use crate::report;
use crate::results::folder::replace;
use crate::study::folder::StudyFolder;
use clap::Args;
use proto::text::{json, visible};
use std::io::Write;
use std::path::PathBuf;

/// What `coordinator stability` is asked.
#[derive(Debug, Args)]
pub struct Arguments {
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
    /// Output folder: stability.json, report.html and the runs.
    #[arg(long, value_name = "DIR", default_value = "results/stability")]
    out: PathBuf,
    /// Write the edges that were found, as Markdown.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["only", "no_sweep"])]
    write_limits: Option<PathBuf>,
}

/// Runs the suite and prints how it went.
///
/// # Errors
/// What is asked for cannot be, or a case went otherwise than expected.
pub fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let request = Request {
        suite: Suite::read(&asked.suite)?,
        only: asked.only.clone(),
        sweeps: !asked.no_sweep,
        out: asked.out.clone(),
    };
    // A case that the suite does not have is told before anything is printed.
    request.suite.chosen(&request.only)?;
    let silent = quiet || asked.json;
    let say = |text: &str| {
        if !silent {
            print(text);
        }
    };
    let folder = StudyFolder::check(&asked.out, FILE)?;
    // What is interrupted can be begun again in the same folder.
    let begun = Report { schema: SCHEMA, ..Report::default() };
    folder.write(FILE, json(&begun).as_bytes())?;
    say(&show::head());
    let report = stability(&request, &mut |case| say(&show::case(case)))?;
    folder.write(FILE, json(&report).as_bytes())?;
    report::write(folder.path())?;
    if asked.json {
        print(&json(&report));
    }
    say(&show::tail(&report, &asked.out));
    verdict(&report)?;
    match &asked.write_limits {
        Some(path) => replace(path, limits::text(&report).as_bytes()),
        None => Ok(()),
    }
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
        what: format!("{} went otherwise than expected", names.join(", ")),
        fix: "`coordinator stability --only NAME` runs one alone".to_owned(),
    }))
}

fn print(text: &str) {
    // A reader that has gone away (`| head`) is no failure of ours.
    let mut out = std::io::stdout();
    let _ = out.write_all(visible(text).as_bytes()).and_then(|()| out.flush());
}
