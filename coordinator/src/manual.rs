//! Completions of shells and pages of the manual, from the command line itself.

use clap::Args;
use run::error::{RunError, file_failure};
use run::results::write::replace;
use std::path::PathBuf;

/// Which shell.
#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell.
    shell: clap_complete::Shell,
}

/// Which folder.
#[derive(Debug, Args)]
pub(crate) struct Pages {
    /// Folder for a page of each command.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// The script that a shell reads.
#[must_use]
pub(crate) fn completions(asked: &Completions, mut command: clap::Command) -> String {
    let name = command.get_name().to_owned();
    let mut script = Vec::new();
    clap_complete::generate(asked.shell, &mut command, name, &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Writes a page of the manual about each command; the line to print.
///
/// # Errors
/// The file system.
pub(crate) fn pages(asked: &Pages, mut command: clap::Command) -> Result<String, RunError> {
    command.build();
    let folder = &asked.folder;
    std::fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    let mut written = 0u64;
    let subcommands = command.get_subcommands().filter(|one| one.get_name() != "help");
    for one in std::iter::once(&command).chain(subcommands) {
        // Of a built command the name is that of its page: coordinator-run.
        let name = one.get_display_name().unwrap_or(one.get_name()).to_owned();
        let mut page = Vec::new();
        let path = folder.join(format!("{name}.1"));
        let rendered = clap_mangen::Man::new(one.clone()).render(&mut page);
        rendered.map_err(|error| file_failure(&path, &error))?;
        replace(&path, &page)?;
        written += 1;
    }
    let pages = run::format::counted(written, "page");
    Ok(format!("{pages} -> {}\n", folder.display()))
}
