//! A case on a command line, and what is changed of it.

use case::{Alone, RawCase, judge_alone};
use clap::Args;
use run::error::RunError;
use run::plan::{Planned, plan};
use run::signals;
use std::path::{Path, PathBuf};

/// The case of a command that makes one thing of it.
#[derive(Clone, Debug, Args)]
pub(crate) struct CaseArguments {
    /// The case file, or - for standard input.
    pub(crate) case: PathBuf,
    /// Change a key: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Remove a key.
    #[arg(long, value_name = "KEY")]
    pub(crate) unset: Vec<String>,
}

impl CaseArguments {
    /// The file as messages name it.
    pub(crate) fn shown(&self) -> String {
        if self.case == Path::new("-") {
            "<stdin>".to_owned()
        } else {
            self.case.display().to_string()
        }
    }

    /// The case with what is changed of it.
    pub(crate) fn read(&self) -> Result<RawCase, RunError> {
        // It may be a pipe that nobody writes to.
        let reading = signals::end_at_once();
        let mut raw = RawCase::read(&self.case)?;
        drop(reading);
        raw.apply(&self.set, &self.unset)?;
        Ok(raw)
    }

    /// Plans it.
    pub(crate) fn plan(&self) -> Result<Planned, RunError> {
        let raw = self.read()?;
        tracing::info_span!("plan").in_scope(|| plan(raw))
    }

    /// What can be judged without starting a program.
    pub(crate) fn alone(&self) -> Result<Alone, RunError> {
        Ok(judge_alone(&self.read()?)?)
    }
}
