//! The tables that grow as a run goes.

use crate::checkpoint::Checkpoint;
use crate::error::RunError;
use crate::plan::Plan;
use crate::results::ResultFolder;
use crate::results::history::{self, HistoryTable};
use crate::results::iterations::IterationTable;

/// All of them.
pub(super) struct Tables {
    pub(super) iterations: IterationTable,
    pub(super) history: HistoryTable,
}

impl Tables {
    /// Those of a run, from its beginning or from a checkpoint.
    pub(super) fn open(
        plan: &Plan,
        folder: &ResultFolder,
        from: Option<&Checkpoint>,
    ) -> Result<Self, RunError> {
        let paths = [folder.file("iterations.csv"), folder.file(history::FILE)];
        let given = plan.participants.iter().flat_map(|participant| &participant.figures);
        let given: Vec<&str> = given.map(String::as_str).collect();
        let figures = &plan.figures;
        if let Some(Checkpoint { state, .. }) = from {
            return Ok(Self {
                iterations: IterationTable::resume(&paths[0], state.table_bytes)?,
                history: HistoryTable::resume(&paths[1], state.history_bytes, figures, &given)?,
            });
        }
        let roles: Vec<&str> = plan.participants.iter().map(|p| p.role.as_str()).collect();
        let fed_back = plan.fields.iter().filter(|field| !field.fed_back.is_empty());
        let fields: Vec<String> = fed_back.map(|field| plan.shown(&field.kind.name)).collect();
        Ok(Self {
            iterations: IterationTable::create(&paths[0], &roles, &fields)?,
            history: HistoryTable::create(&paths[1], figures, &given)?,
        })
    }

    /// Writes what is not in the files yet.
    pub(super) fn flush(&mut self) -> Result<(), RunError> {
        self.iterations.flush()?;
        self.history.flush()
    }
}
