//! Finished runs of a study that has not finished: they are kept in its folder, and the same
//! request goes on with them.

use super::study::{Request, Run};
use crate::study::folder::StudyFolder;
use run::checkpoint::sum;
use run::error::RunError;
use run::perform::origin;
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
    /// CRC-64 of everything that decides what the runs are.
    request: u64,
    runs: Vec<Run>,
    /// Quantities that participants know in closed form.
    closed_forms: BTreeMap<String, f64>,
}

impl FinishedRuns {
    /// None, for a request.
    pub(super) fn none(request: &Request, standing: &Planned) -> Self {
        Self { request: identity(request, standing), ..Self::default() }
    }

    /// Those of this request in a folder, or none.
    pub(super) fn read(folder: &Path, request: &Request, standing: &Planned) -> Self {
        let none = Self::none(request, standing);
        let read = fs::read(folder.join(FILE)).ok();
        let found = read.and_then(|text| serde_json::from_slice::<Self>(&text).ok());
        found.filter(|found| found.request == none.request).unwrap_or(none)
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

/// What decides which runs there are, and what they give. The quantity that ranks them, and the
/// values that they are compared with, do not.
fn identity(request: &Request, standing: &Planned) -> u64 {
    let vary: Vec<_> = request.vary.iter().map(|axis| (&axis.key, &axis.values)).collect();
    let origin = origin(standing);
    let made_from = json!([origin.version, origin.protocol, origin.case, origin.plan]);
    sum(json!([made_from, vary, request.repeat, request.longest_run]).to_string().as_bytes())
}
