//! A case on a command line, and what is changed of it.

use crate::scenes;
use case::{Alone, RawCase, judge_alone};
use clap::Args;
use run::error::RunError;
use run::plan::{Planned, plan};
use run::signals;
use std::path::{Path, PathBuf};

/// The case of a command that makes one thing of it.
#[derive(Clone, Debug, Args)]
pub struct CaseArguments {
    /// The case file, or - for standard input.
    pub case: PathBuf,
    /// Change a key: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Remove a key.
    #[arg(long, value_name = "KEY")]
    pub unset: Vec<String>,
}

/// Reads a case file. Where there is none of that name, one that is like it is named.
///
/// # Errors
/// [`RunError::Usage`] if it cannot be read, or is no case.
pub fn read_case(path: &Path) -> Result<RawCase, RunError> {
    if path != Path::new("-")
        && !path.exists()
        && let Some(fix) = path.to_str().and_then(meant)
    {
        let shown = path.display();
        return Err(RunError::Usage(format!("{shown}: there is no such file; {fix}")));
    }
    Ok(RawCase::read(path)?)
}

/// Suggests the file meant by a name without an ending, or by the name of a scene.
fn meant(name: &str) -> Option<String> {
    let files = [format!("{name}.toml"), format!("cases/{name}.toml")];
    if let Some(file) = files.iter().find(|file| Path::new(file).is_file()) {
        return Some(format!("did you mean {file}?"));
    }
    let new = || {
        format!("`coordinator new mine --scene {name}` writes the case of that scene as mine.toml")
    };
    scenes::text(name).is_some().then(new)
}

impl CaseArguments {
    /// The file as messages name it.
    pub fn shown(&self) -> String {
        if self.case == Path::new("-") {
            "<stdin>".to_owned()
        } else {
            self.case.display().to_string()
        }
    }

    /// The case with what is changed of it.
    pub fn read(&self) -> Result<RawCase, RunError> {
        // It may be a pipe that nobody writes to.
        let reading = signals::end_at_once();
        let mut raw = read_case(&self.case)?;
        drop(reading);
        raw.apply(&self.set, &self.unset)?;
        Ok(raw)
    }

    /// Plans it.
    pub fn plan(&self) -> Result<Planned, RunError> {
        let raw = self.read()?;
        tracing::info_span!("plan").in_scope(|| plan(raw))
    }

    /// What can be judged without starting a program.
    pub fn alone(&self) -> Result<Alone, RunError> {
        Ok(judge_alone(&self.read()?)?)
    }
}
