//! The subcommand.

use super::{Target, export};
use crate::inspect;
use crate::output::print;
use clap::Args;
use proto::recording::End;
use run::error::RunError;
use run::format::counted;
use run::signals;
use std::path::PathBuf;

/// What `coordinator export` is asked.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("form").required(true).multiple(true).args(["vtk", "csv"]))]
pub(crate) struct Arguments {
    /// The recording.
    recording: PathBuf,
    /// Folder for VTK series (`.vti`, `.vtu`, `.pvd`).
    #[arg(long, value_name = "DIR")]
    vtk: Option<PathBuf>,
    /// Folder for CSV, one file a topic and instant.
    #[arg(long, value_name = "DIR")]
    csv: Option<PathBuf>,
    /// Every iteration, and not only what was accepted.
    #[arg(long)]
    iterations: bool,
}

/// Writes the fields of a recording for other tools.
///
/// # Errors
/// The recording cannot be read, or a file not be written.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let Arguments { recording: path, vtk, csv, iterations } = asked;
    let reading = signals::end_at_once();
    let mut recording = inspect::open(path)?;
    drop(reading);
    let target = Target { vtk: vtk.clone(), csv: csv.clone(), every_iteration: *iterations };
    let instants = export(path, &mut recording, &target)?;
    let mut text = counted(instants, "instant");
    for folder in [vtk, csv].into_iter().flatten() {
        text += &format!(" -> {}", folder.display());
    }
    if let End::Cut(bytes) = recording.end() {
        text += &format!(" (the recording is truncated after {bytes} bytes)");
    }
    if quiet { Ok(()) } else { print(&(text + "\n")) }
}
