//! Request of a replay, and the resulting configuration: the recorded one, with readable paths for
//! the files of the case, and with the requested changes.

use contract::description::{Description, KeySpec};
use proto::recording::{CaseFile, Participant};
use run::error::RunError;
use run::program::Program;
use run::record::fits;
use serde_json::{Map, Value};
use std::path::PathBuf;

/// Request of a replay.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    /// Path of the recording.
    pub recording: PathBuf,
    /// Role of the participant to drive.
    pub only: String,
    /// Program to drive; `None`: the coordinator's own solver of the role.
    pub program: Option<Program>,
    /// Whether the program is started by hand; there are no deadlines then.
    pub serve: bool,
    /// Largest difference that passes, relative to the largest value of the sample; `None`:
    /// bit-identical.
    pub tolerance: Option<f64>,
    /// First window to solve; earlier ones are skipped as far as a recorded state allows.
    pub from: Option<u64>,
    /// Last window to solve.
    pub until: Option<u64>,
    /// Changes of the recorded configuration: dotted key and SI value.
    pub set: Vec<(String, serde_json::Value)>,
    /// Window from whose first solve on to ask before every command; 0: from the first command on.
    pub step: Option<u64>,
}

/// Participant to configure, and its recorded data.
pub(super) struct Reconfiguration<'a> {
    pub(super) request: &'a Request,
    pub(super) recorded: &'a Participant,
    /// Description given by the program.
    pub(super) description: Option<&'a Description>,
    /// Attachments, with paths on this machine instead of keys.
    pub(super) files: &'a [CaseFile],
}

impl Reconfiguration<'_> {
    /// Returns the configuration to send for a recorded one. Also returns the observed fields that
    /// are omitted because the program does not provide them.
    ///
    /// # Errors
    /// The recorded configuration is invalid, the program does not have the model, or a key to be
    /// changed does not exist.
    pub(super) fn configuration(&self, body: &[u8]) -> Result<(Vec<u8>, Vec<String>), RunError> {
        let mut configuration: Value = serde_json::from_slice(body).map_err(|error| {
            RunError::Usage(format!("the recorded configuration is invalid: {error}"))
        })?;
        replace_texts(&mut configuration, self.files);
        for (key, value) in &self.request.set {
            self.change(&mut configuration, key, value)?;
        }
        self.knows_model(&configuration)?;
        let left_out = self.leave_out(&mut configuration);
        Ok((serde_json::to_vec(&configuration).expect("it was JSON before"), left_out))
    }

    /// Removes the observed fields that neither the model nor an effect of the program provides.
    fn leave_out(&self, configuration: &mut Value) -> Vec<String> {
        let Some(said) = self.description else { return Vec::new() };
        let model = said.models.iter().filter(|model| configuration["model"] == *model.name);
        let effects = said.effects.iter().flat_map(|effect| &effect.provides);
        let provided: Vec<&String> = model.flat_map(|m| &m.provides).chain(effects).collect();
        let mut left_out = Vec::new();
        if let Some(observed) = configuration["observed"].as_array_mut() {
            observed.retain(|field| {
                let name = field.as_str().unwrap_or_default();
                let known = provided.iter().any(|provided| *provided == name);
                left_out.extend((!known).then(|| name.to_owned()));
                known
            });
        }
        left_out
    }

    /// Changes the model, a recorded value, or a value that the program reads.
    fn change(&self, tree: &mut Value, key: &str, value: &Value) -> Result<(), RunError> {
        let role = &self.request.only;
        let pointer = match key == format!("{role}.model") {
            true => "/model".to_owned(),
            false => format!("/case/{}", key.replace('.', "/")),
        };
        match tree.pointer_mut(&pointer) {
            Some(found) => found.clone_from(value),
            None if self.reads(key) => insert(&mut tree["case"], key, value),
            None => {
                return Err(RunError::Usage(format!(
                    "the recorded configuration of {role} has no `{key}`"
                )));
            }
        }
        Ok(())
    }

    /// Returns whether the program describes the key.
    fn reads(&self, key: &str) -> bool {
        let Some(said) = self.description else { return false };
        let models = said.models.iter().flat_map(|model| &model.keys);
        let effects = said.effects.iter().flat_map(|effect| &effect.keys);
        let parts: Vec<&str> = key.split('.').collect();
        let reads = |spec: &KeySpec| fits(&spec.path, &parts);
        said.keys.iter().chain(models).chain(effects).any(reads)
    }

    fn knows_model(&self, configuration: &Value) -> Result<(), RunError> {
        let (Some(said), Some(model)) = (self.description, configuration["model"].as_str()) else {
            return Ok(());
        };
        if said.models.iter().any(|known| known.name == model) {
            return Ok(());
        }
        let known: Vec<&str> = said.models.iter().map(|model| model.name.as_str()).collect();
        let (role, program, known) = (&self.request.only, &said.name, known.join(", "));
        Err(RunError::Usage(format!(
            "`{program}` has no model `{model}`, which is in the recorded configuration of {role}; \
             choose one of its own with --set {role}.model=NAME ({known}), or {}",
            self.otherwise()
        )))
    }

    /// Returns the advice to replay with the recorded program.
    pub(super) fn otherwise(&self) -> String {
        format!("replay with the program that was recorded, `{}`", self.recorded.program)
    }
}

/// Inserts a value at a dotted key, and creates tables as needed.
fn insert(tree: &mut Value, key: &str, value: &Value) {
    let mut at = tree;
    for part in key.split('.') {
        if !at.is_object() {
            *at = Value::Object(Map::new());
        }
        at = &mut at[part];
    }
    at.clone_from(value);
}

/// Replaces the names of attachments by paths, in all texts.
fn replace_texts(tree: &mut Value, files: &[CaseFile]) {
    match tree {
        Value::String(text) => {
            if let Some(file) = files.iter().find(|file| file.attachment == *text) {
                text.clone_from(&file.key);
            }
        }
        Value::Object(table) => table.values_mut().for_each(|value| replace_texts(value, files)),
        Value::Array(list) => list.iter_mut().for_each(|value| replace_texts(value, files)),
        _ => {}
    }
}
