//! What a reproduction leaves: `reproduce.json`, with the summaries of all its runs.

use super::study::Study;
use crate::study::output::Kept;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The study, as it was run.
pub(super) const STUDY: &str = "study.toml";
/// Its template.
pub(super) const TEMPLATE: &str = "text.md.j2";

/// All runs of a study.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Record {
    schema: u32,
    study: String,
    /// All runs are done.
    pub(super) complete: bool,
    pub(super) runs: Vec<Done>,
}

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Done {
    pub(super) name: String,
    pub(super) set: Vec<String>,
    pub(super) unset: Vec<String>,
    /// Its result directory, as seen from the record.
    pub(super) folder: PathBuf,
    pub(super) summary: Value,
}

/// What has been run.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    /// `summary.json`.
    pub(super) summary: Value,
    /// The case as run.
    pub(super) case: toml::Table,
}

impl Kept for Record {
    const COMMAND: &'static str = "reproduce";
    const FILE: &'static str = "reproduce.json";
    const SCHEMA: u32 = 1;
}

impl Record {
    /// Of a study of which nothing has been run.
    pub(super) fn begun(study: &Study) -> Self {
        let study = study.name.clone();
        Self { schema: Self::SCHEMA, study, complete: false, runs: Vec::new() }
    }

    /// The result directory of each run in the folder `out`, by its name.
    pub(super) fn folders(&self, out: &Path) -> BTreeMap<String, PathBuf> {
        self.runs.iter().map(|done| (done.name.clone(), out.join(&done.folder))).collect()
    }

    /// What each run in the folder `out` has come to, by its name.
    pub(super) fn outcomes(&self, out: &Path) -> BTreeMap<String, Outcome> {
        let outcome = |done: &Done| {
            let case = fs::read_to_string(out.join(&done.folder).join("case.toml"));
            let case = toml::from_str(&case.unwrap_or_default()).unwrap_or_default();
            (done.name.clone(), Outcome { summary: done.summary.clone(), case })
        };
        self.runs.iter().map(outcome).collect()
    }
}
