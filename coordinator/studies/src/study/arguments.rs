//! What the command lines of studies have in common.

use super::Variant;
use super::folder::{StudyFolder, Wanted};
use clap::Args;
use run::crew::{self, Keeps};
use run::error::RunError;
use std::path::{Path, PathBuf};

/// The case of a study.
#[derive(Debug, Args)]
pub struct CaseArguments {
    /// The case file, or - for standard input.
    pub case: PathBuf,
    /// Change a key for all runs: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Remove a key for all runs.
    #[arg(long, value_name = "KEY")]
    unset: Vec<String>,
}

/// How often the runs of a study are made.
#[derive(Debug, Args)]
pub struct RepeatArguments {
    /// Make each run so often; its times are the least.
    #[arg(long, value_name = "TIMES", default_value_t = 2,
          value_parser = clap::value_parser!(u32).range(1..))]
    pub repeat: u32,
}

impl CaseArguments {
    /// What is changed for all runs.
    #[must_use]
    pub fn base(&self) -> Variant {
        Variant { set: self.set.clone(), unset: self.unset.clone() }
    }
}

/// Options of every study: its folder, and the processes of its runs.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Folder of the study [default: results/NAME, or NAME-2 and so on].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an earlier study of its kind in that folder.
    #[arg(long)]
    pub replace: bool,
    /// Start new processes for every run, for solvers that keep something of one run in the next.
    #[arg(long)]
    pub fresh: bool,
}

impl StudyArguments {
    /// Lets participants stay from run to run on this thread, unless every run is to have new ones.
    pub fn keep(&self) -> Option<Keeps> {
        (!self.fresh).then(crew::keep)
    }

    /// The folder for a study that a command makes, and which has this name by default. One in which the
    /// same study was stopped is used again.
    ///
    /// # Errors
    /// Those of [`StudyFolder::choose`].
    pub fn choose(
        &self,
        command: &'static str,
        name: &str,
        goes_on: &dyn Fn(&Path) -> bool,
    ) -> Result<StudyFolder, RunError> {
        let (out, replace) = (self.out.as_deref(), self.replace);
        StudyFolder::choose(&Wanted { command, name, out, replace, goes_on })
    }
}
