//! The validated case, from which a run is planned.

use super::alternatives::Replaced;
use super::checked_keys::{LiveKey, put};
use super::diagnostics::{Problem, Problems};
use super::filled_case::fill_defaults;
use super::known::{References, Unread, all_keys, instances, read_by};
use super::raw::RawCase;
use super::settings::{Coupling, Limits, Output, ParticipantCase, Timing};
use super::tree::{Origin, Table, Value};
use contract::bodies::Bodies;
use contract::description::Description;
use contract::history::Histories;
use contract::params::Params;
use coupling::map::Mappings;
use serde_json::{Map, Value as Json};
use std::path::Path;

/// A case that has passed every check possible before the run.
#[derive(Clone, Debug)]
pub struct Case {
    /// Short name of the case.
    pub name: String,
    /// Title of the case, in one line.
    pub title: Option<String>,
    /// The participants of the run, in the order of the descriptions.
    pub participants: Vec<ParticipantCase>,
    /// Roles with a section of their own that no active effect needs. They are not started.
    pub idle: Vec<String>,
    /// Names of the active effects, sorted.
    pub effects: Vec<String>,
    /// The bodies in contact, if a participant requires them.
    pub bodies: Option<Bodies>,
    /// Steady, a sequence, or transient with its times.
    pub timing: Timing,
    /// The values that vary over the rows of a table; `values` holds those of the first row.
    pub histories: Option<Histories>,
    /// Values that are set from outside during the run.
    pub live: Vec<LiveKey>,
    /// Settings of the coupling.
    pub coupling: Coupling,
    /// Methods that map fields from one grid to another.
    pub mappings: Mappings,
    /// Memory and threads that a run may use.
    pub limits: Limits,
    /// Fields and checkpoints that a run writes.
    pub output: Output,
    /// Keys of the case that no participant reads.
    pub unread: Vec<Unread>,
    /// All checked keys, nested by table, in SI units, with defaults filled in. Keys of models that
    /// are not chosen are included if the case has them.
    pub values: Params,
    pub(super) raw: RawCase,
    pub(super) references: References,
    /// Keys of the file that an option has replaced.
    pub replaced: Vec<Replaced>,
}

impl Case {
    /// Returns the command of a section, also of one that takes no part in the run.
    #[must_use]
    pub fn command(&self, role: &str) -> Option<Vec<String>> {
        let sections = self.raw.participants();
        sections.into_iter().find(|section| section.role == role)?.command
    }

    /// Returns the case as run: TOML that gives this case again, without options. Relative file
    /// names are resolved against [`Case::folder`].
    #[must_use]
    pub fn text(&self) -> String {
        let mut raw = self.raw.clone();
        absolute_files(&mut raw.tree, "", &self.values);
        raw.text()
    }

    /// Returns the folder against which relative file names are resolved.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.raw.folder()
    }

    /// Creates an error at a dotted key, such as a participant's refusal, with its place in the
    /// file.
    pub fn problem_at(
        &self,
        key: &str,
        reason: impl Into<String>,
        fix: impl Into<String>,
    ) -> Problem {
        self.raw.problem_at(key, reason, fix)
    }

    /// Collects errors of this case for display with their source lines; `None` without errors.
    #[must_use]
    pub fn report(&self, problems: Vec<Problem>) -> Option<Problems> {
        self.raw.report(problems)
    }

    /// Creates the error of this case with a single problem, for display with its source line.
    #[must_use]
    pub fn fail(&self, problem: Problem) -> Problems {
        self.report(vec![problem]).expect("a problem is an error")
    }

    /// Returns the values that a participant reads with a model: keys of the role, the model and
    /// the active effects that it claims, in SI units, with defaults filled in. `effects.NAME` is a
    /// table, perhaps empty, for each of these effects. The model may differ from the chosen one;
    /// keys that only this model requires may then be missing.
    #[must_use]
    pub fn values_for(&self, description: &Description, model: &str) -> Params {
        let keys = read_by(description, model, &self.effects);
        let instances = instances(&keys, &self.raw.tree, &self.references);
        let mut values = self.values.clone();
        fill_defaults(&mut values, &instances);
        let mut read = Json::Object(Map::new());
        for instance in &instances {
            if let Some(value) = values.get(&instance.path) {
                put(&mut read, &instance.path, value.clone());
            }
        }
        let mut read = Params(read);
        let claimed = |name: &&String| description.effects.iter().any(|e| e.name == **name);
        for name in self.effects.iter().filter(claimed) {
            let key = format!("effects.{name}");
            if !read.has(&key) {
                put(&mut read.0, &key, Json::Object(Map::new()));
            }
        }
        read
    }

    /// Returns the keys of live values that a participant reads with a model.
    #[must_use]
    pub fn live_of(&self, description: &Description, model: &str) -> Vec<&str> {
        if self.live.is_empty() {
            return Vec::new();
        }
        let values = self.values_for(description, model);
        let keys = self.live.iter().map(|live| live.field.name.as_str());
        keys.filter(|key| values.has(key)).collect()
    }

    /// Returns the fields that a participant consumes with a model because of key values in this
    /// case, each with its key.
    #[must_use]
    pub fn consumed_by_keys<'a>(
        &self,
        description: &'a Description,
        model: &str,
    ) -> Vec<(&'a str, &'a str)> {
        let mut asking = all_keys(description).filter(|key| !key.consumes.is_empty()).peekable();
        if asking.peek().is_none() {
            return Vec::new();
        }
        let values = self.values_for(description, model);
        let fields = asking.flat_map(|key| {
            let word = values.get(&key.path).and_then(Json::as_str);
            let fields = word.and_then(|word| key.consumes.get(word));
            fields.into_iter().flatten().map(|field| (field.as_str(), key.path.as_str()))
        });
        fields.collect()
    }

    /// Returns the histories of those values that a participant receives.
    #[must_use]
    pub fn histories_of(&self, values: &Params) -> Option<Histories> {
        let mut histories = self.histories.clone()?;
        histories.values.retain(|key, _| values.has(key));
        if let Some(live) = &mut histories.live {
            live.limits.retain(|key, _| values.has(key));
        }
        Some(histories)
    }
}

/// Replaces file names set by options by absolute paths: they are relative to the working
/// directory. Checking changes no other text.
fn absolute_files(table: &mut Table, section: &str, values: &Params) {
    for (name, node) in &mut table.entries {
        let key = if section.is_empty() { name.clone() } else { format!("{section}.{name}") };
        match (&mut node.value, &node.origin) {
            (Value::Table(inner), _) => absolute_files(inner, &key, values),
            (Value::Text(text), Origin::Argument(_)) => {
                if let Some(checked) = values.get(&key).and_then(Json::as_str) {
                    checked.clone_into(text);
                }
            }
            _ => {}
        }
    }
}
