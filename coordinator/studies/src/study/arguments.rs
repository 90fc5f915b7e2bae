//! Command-line options shared by all studies.

use super::bench::Bench;
use super::folder::{FolderRequest, StudyFolder};
use clap::Args;
use run::error::RunError;
use run::fleet::Fleet;
use std::path::{Path, PathBuf};

/// Number of repetitions of each run.
#[derive(Debug, Args)]
pub struct RepeatArguments {
    /// Repeat each run this many times and report the shortest times.
    #[arg(long, value_name = "TIMES", default_value_t = 2,
          value_parser = clap::value_parser!(u32).range(1..))]
    pub repeat: u32,
}

/// Number of runs at a time.
#[derive(Debug, Args)]
pub struct JobsArguments {
    /// Number of runs at a time.
    #[arg(long, value_name = "COUNT", default_value_t = 1,
          value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: u16,
}

/// Options of every study: the result folder and the processes of the runs.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Folder of the study [default: results/NAME, or NAME-2 and so on].
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Replace an earlier study of its kind in that folder.
    #[arg(long)]
    pub replace: bool,
    /// Start new processes for every run, for solvers that carry state from one run to the next.
    #[arg(long)]
    pub fresh: bool,
}

impl StudyArguments {
    /// Returns a bench without cases, with the fleet of [`StudyArguments::fleet`].
    #[must_use]
    pub fn bench(&self) -> Bench {
        Bench::new(self.fleet())
    }

    /// Returns a fleet whose participants stay from one run to the next, unless `--fresh` is set.
    #[must_use]
    pub fn fleet(&self) -> Fleet {
        if self.fresh { Fleet::for_one_run() } else { Fleet::for_study() }
    }

    /// Chooses the folder of a study, with the default name `name`. A folder that holds the same
    /// study, interrupted, is used again.
    ///
    /// # Errors
    /// Same as [`StudyFolder::choose`].
    pub fn choose(
        &self,
        command: &'static str,
        name: &str,
        goes_on: &dyn Fn(&Path) -> bool,
    ) -> Result<StudyFolder, RunError> {
        let (out, replace) = (self.out.as_deref(), self.replace);
        StudyFolder::choose(&FolderRequest { command, name, out, replace, goes_on })
    }
}
