//! A case on a command line, and its changes.

use crate::scenes;
use case::{RawCase, StandaloneCheck, check_without_participants};
use clap::Args;
use run::error::RunError;
use run::fleet::Fleet;
use run::plan::{Planned, plan};
use run::signals;
use std::path::{Path, PathBuf};

/// Changes of a case.
#[derive(Clone, Debug, Default, PartialEq, Eq, Args)]
pub struct Changes {
    /// Change a key: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Remove a key.
    #[arg(long, value_name = "KEY")]
    pub unset: Vec<String>,
}

impl Changes {
    /// Sets a key, replacing an earlier value.
    #[must_use]
    pub fn with(&self, key: &str, value: impl std::fmt::Display) -> Self {
        let mut more = self.clone();
        more.set.retain(|option| set_key(option) != key);
        more.set.push(format!("{key}={value}"));
        more
    }

    /// Returns the keys that are set, each with its value.
    pub fn values(&self) -> impl Iterator<Item = (&str, &str)> {
        let pairs = self.set.iter().filter_map(|option| option.split_once('='));
        pairs.map(|(key, value)| (key.trim(), value.trim()))
    }

    /// Returns the options of `run` with the same changes.
    #[must_use]
    pub fn options(&self) -> Vec<String> {
        let set = self.set.iter().flat_map(|option| ["--set".to_owned(), option.clone()]);
        let unset = self.unset.iter().flat_map(|key| ["--unset".to_owned(), key.clone()]);
        set.chain(unset).collect()
    }
}

/// Returns the key of a `--set` option.
fn set_key(option: &str) -> &str {
    option.split_once('=').map_or(option, |(key, _)| key).trim()
}

/// A case and its changes.
#[derive(Clone, Debug, Args)]
pub struct CaseArguments {
    /// The case file, or - for standard input.
    pub case: PathBuf,
    /// Changes of the case.
    #[command(flatten)]
    pub changes: Changes,
}

/// Reads a case file. The error for a missing file names a similar one.
///
/// # Errors
/// [`RunError::Usage`] if the file cannot be read, or is not a case.
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
    /// Returns the name of the file in messages.
    pub fn shown(&self) -> String {
        if self.case == Path::new("-") {
            "<stdin>".to_owned()
        } else {
            self.case.display().to_string()
        }
    }

    /// Reads the case and applies the changes.
    pub fn read(&self) -> Result<RawCase, RunError> {
        // The file may be a pipe without a writer.
        let reading = signals::end_at_once();
        let mut raw = read_case(&self.case)?;
        drop(reading);
        raw.apply(&self.changes.set, &self.changes.unset)?;
        Ok(raw)
    }

    /// Plans the case for a fleet.
    pub fn plan(&self, fleet: &mut Fleet) -> Result<Planned, RunError> {
        let raw = self.read()?;
        tracing::info_span!("plan").in_scope(|| plan(raw, fleet))
    }

    /// Checks the parts of the case that need no program.
    pub fn alone(&self) -> Result<StandaloneCheck, RunError> {
        Ok(check_without_participants(&self.read()?)?)
    }
}
