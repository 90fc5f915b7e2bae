//! Finished runs of a study that has not finished: they are kept in its folder, and the same
//! request goes on with them.

use super::study::{Request, Run};
use crate::study::folder::StudyFolder;
use run::checkpoint::sum;
use run::error::RunError;
use run::identity::Identity;
use run::plan::Planned;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Where they are until the study is done.
const FILE: &str = "cost.unfinished.json";

/// Finished runs, and what they were asked for with.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct FinishedRuns {
    /// CRC-64 of everything that decides which runs there are.
    request: u64,
    /// Programs, values and files of the case.
    identity: Identity,
    runs: Vec<Run>,
    /// Quantities that participants know in closed form.
    closed_forms: BTreeMap<String, f64>,
}

impl FinishedRuns {
    /// None, for a request.
    ///
    /// # Errors
    /// A file that the case names cannot be read.
    pub(super) fn none(request: &Request, standing: &Planned) -> Result<Self, RunError> {
        let identity = Identity::of(standing)?;
        Ok(Self { request: sum_of(request), identity, ..Self::default() })
    }

    /// Reads the finished runs of a folder, if they belong to the same request.
    pub(super) fn read(&self, folder: &Path) -> Option<Self> {
        let text = fs::read(folder.join(FILE)).ok()?;
        let found = serde_json::from_slice::<Self>(&text).ok()?;
        (found.request == self.request && !found.runs.is_empty()).then_some(found)
    }

    /// Reads the finished runs of a folder; returns these if it has none of the same request.
    ///
    /// # Errors
    /// They are of another case: names what differs.
    pub(super) fn resume(self, folder: &Path) -> Result<Self, RunError> {
        let Some(found) = self.read(folder) else { return Ok(self) };
        let fix = "--replace begins anew, --out DIR leaves it as it is";
        found.identity.require_same(&self.identity, &folder.display().to_string(), fix)?;
        Ok(found)
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.runs.len()
    }

    /// The run that these options make.
    pub(super) fn run(&self, options: &[String]) -> Option<&Run> {
        self.runs.iter().find(|run| run.options == options)
    }

    /// Quantities in closed form that the runs' participants have given.
    pub(super) fn closed_forms(&self) -> &BTreeMap<String, f64> {
        &self.closed_forms
    }

    /// Keeps one more run; one without quantities is made again the next time.
    pub(super) fn add(
        &mut self,
        run: &Run,
        closed_forms: &BTreeMap<String, f64>,
        folder: &StudyFolder,
    ) -> Result<(), RunError> {
        if run.failed.is_some() {
            return Ok(());
        }
        self.runs.push(run.clone());
        self.closed_forms.clone_from(closed_forms);
        folder.write(FILE, &serde_json::to_vec(self).expect("runs are plain data"))
    }

    /// The study is done.
    pub(super) fn remove(folder: &StudyFolder) -> Result<(), RunError> {
        folder.remove(FILE)
    }
}

/// Digest of the request values that determine the set of runs. The ranking quantity and the values
/// of comparison are left out.
fn sum_of(request: &Request) -> u64 {
    let vary: Vec<_> = request.vary.iter().map(|axis| (&axis.key, &axis.values)).collect();
    sum(json!([vary, request.repeat, request.longest_run]).to_string().as_bytes())
}
