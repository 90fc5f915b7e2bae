//! A stopped run, which can continue from its newest intact checkpoint.

use crate::checkpoint::{Checkpoint, Checkpoints, Corrupt};
use crate::error::RunError;
use crate::results::ResultFolder;
use case::RawCase;
use std::path::Path;

/// A stopped run, with the data that it needs to continue.
#[derive(Debug)]
pub struct StoppedRun {
    /// Result folder of the run.
    pub folder: ResultFolder,
    /// The newest intact checkpoint.
    pub checkpoint: Checkpoint,
    /// The case as it was run.
    pub case: RawCase,
}

impl StoppedRun {
    /// Reads the folder of a stopped run; `None` if the run has ended regularly.
    ///
    /// # Errors
    /// The folder does not belong to a run, is in use, or holds no intact checkpoint.
    pub fn read(path: &Path) -> Result<Option<Self>, RunError> {
        let folder = ResultFolder::resume(path)?;
        if folder.has_ended() {
            return Ok(None);
        }
        let (newest, corrupt) = Checkpoints::of(&folder.path()).newest();
        for Corrupt { name, reason } in &corrupt {
            let next = if newest.is_some() { "; using the previous one" } else { "" };
            tracing::warn!("checkpoint {name} is not used: {reason}{next}");
        }
        let shown = path.display();
        let checkpoint = newest.ok_or_else(|| {
            let whole = if corrupt.is_empty() { "no checkpoint" } else { "no intact checkpoint" };
            RunError::Usage(format!(
                "{shown} holds {whole}; a case writes them with output.checkpoint_every"
            ))
        })?;
        let case = folder.read_case()?.with_folder(checkpoint.state.origin.folder.clone());
        Ok(Some(Self { folder, checkpoint, case }))
    }
}
