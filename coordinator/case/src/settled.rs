//! The validated case: what the planner starts from.

use super::alternatives::Replaced;
use super::checker::{fill_defaults, put};
use super::diagnostics::{Problem, Problems};
use super::known::{References, all_keys, instances, read_by};
use super::live_key::LiveKey;
use super::raw::RawCase;
use super::settings::Settings;
use super::tree::{Origin, Table, Value};
use super::unread::Unread;
use contract::bodies::Bodies;
use contract::configuration::Mode;
use contract::description::Description;
use contract::history::Histories;
use contract::message::Interpolation;
use contract::params::Params;
use coupling::map::Mappings;
use coupling::settings::{Implicit, Scheme};
use serde_json::{Map, Value as Json};
use std::path::Path;

/// A case in which everything that can be known before the run is right.
#[derive(Clone, Debug)]
pub struct Case {
    /// Short name of the case.
    pub name: String,
    /// One line for people.
    pub title: Option<String>,
    /// The participants that take part, in the order of the descriptions.
    pub participants: Vec<ParticipantCase>,
    /// Roles with a section of their own that no active effect needs; they are not started.
    pub idle: Vec<String>,
    /// Names of the active effects, sorted.
    pub effects: Vec<String>,
    /// The bodies in contact, where a participant asks for them.
    pub bodies: Option<Bodies>,
    /// Steady, a sequence, or transient with its times.
    pub timing: Timing,
    /// The values that vary; those of the first row stand among `values`.
    pub histories: Option<Histories>,
    /// Values that are given from outside as the run goes.
    pub live: Vec<LiveKey>,
    /// How the participants are coupled.
    pub coupling: Coupling,
    /// How fields come from one grid to another.
    pub mappings: Mappings,
    /// What a run may use.
    pub limits: Limits,
    /// What a run writes.
    pub output: Output,
    /// Keys of the case that nothing reads.
    pub unread: Vec<Unread>,
    /// All checked keys, nested by table, in SI units, defaults filled in. Keys of models that
    /// are not chosen are among them if the case has them.
    pub values: Params,
    pub(super) raw: RawCase,
    pub(super) references: References,
    /// Keys of the file that an option has replaced.
    pub replaced: Vec<Replaced>,
}

/// A participant as the case has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParticipantCase {
    /// Name of its section.
    pub role: String,
    /// The chosen model.
    pub model: String,
    /// Program and arguments that start it; absent: the usual one of the role.
    pub command: Option<Vec<String>>,
    /// It is started by hand, and waited for.
    pub attach: bool,
}

/// Steady or transient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Timing {
    /// One window without duration.
    Steady,
    /// A steady window for each row of a table.
    Sequence {
        /// A row without an answer is passed over; otherwise it ends the run.
        skip: bool,
    },
    /// Windows from 0 on.
    Transient {
        /// Coupling window \[s\].
        window: f64,
        /// End of the run \[s\], at least one window.
        end: f64,
        /// Lengths of the windows.
        control: Control,
    },
}

/// What decides how long a window is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// All have the same length.
    Fixed,
    /// They are as long as the error allows; the first is the shortest.
    Adaptive {
        /// Relative error of what is exchanged that is aimed at \[-\].
        tolerance: f64,
        /// Shortest window \[s\].
        shortest: f64,
        /// Longest window \[s\].
        longest: f64,
    },
}

/// The shortest adaptive window, over `time.window`, unless the case says otherwise: ten halvings.
const SHORTEST: f64 = 1.0 / 1024.0;

impl Timing {
    /// The mode, as participants know it.
    #[must_use]
    pub fn mode(&self) -> Mode {
        match self {
            Self::Steady | Self::Sequence { .. } => Mode::Steady,
            Self::Transient { .. } => Mode::Transient,
        }
    }
}

/// Settings of the coupling.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// Order and iteration.
    pub scheme: Scheme,
    /// How an implicit scheme iterates.
    pub implicit: Implicit,
    /// How inputs vary within a window.
    pub interpolation: Interpolation,
    /// Longest wait for one solve \[s\].
    pub solve_deadline: f64,
    /// Longest wait for a participant to start \[s\].
    pub start_deadline: f64,
    /// Longest wait for a model to be built [s].
    pub build_deadline: f64,
    /// Longest silence of a participant \[s\].
    pub heartbeat_deadline: f64,
}

/// What a run may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most shared memory \[byte\]; absent: no limit of the case.
    pub shared_memory: Option<u64>,
    /// Threads that may compute at the same time; absent: as many as there are cores.
    pub threads: Option<usize>,
}

/// What a run writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// Fields that are written.
    pub fields: OutputFields,
    /// Windows between outputs; absent: the last window only.
    pub every: Option<u64>,
    /// Windows between checkpoints; absent: none are written.
    pub checkpoint_every: Option<u64>,
}

/// Fields that a run writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OutputFields {
    /// All that there are.
    All,
    /// None.
    None,
    /// Those of these names.
    Named(Vec<String>),
}

impl Case {
    /// The case as run: TOML that gives this case again, without options. Relative file names in it
    /// are meant from [`Case::folder`].
    #[must_use]
    pub fn text(&self) -> String {
        let mut raw = self.raw.clone();
        absolute_files(&mut raw.tree, "", &self.values);
        raw.text()
    }

    /// The folder from which relative file names are meant.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.raw.folder()
    }

    /// An error at a dotted key, such as a participant's refusal, with its place in the file.
    pub fn problem_at(
        &self,
        key: &str,
        reason: impl Into<String>,
        fix: impl Into<String>,
    ) -> Problem {
        self.raw.problem_at(key, reason, fix)
    }

    /// Errors of this case, to be shown with its source lines; `None` if there are none.
    #[must_use]
    pub fn report(&self, problems: Vec<Problem>) -> Option<Problems> {
        self.raw.report(problems)
    }

    /// The values that a participant reads with a model: keys of the role, the model and the
    /// active effects it claims, in SI units, defaults filled in; `effects.NAME` is a table, maybe
    /// empty, for each of these effects. The model need not be the chosen one; then keys that
    /// only it requires may be absent.
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
}

impl Case {
    /// The keys of live values that a participant reads with a model.
    #[must_use]
    pub fn live_of(&self, description: &Description, model: &str) -> Vec<&str> {
        if self.live.is_empty() {
            return Vec::new();
        }
        let values = self.values_for(description, model);
        let keys = self.live.iter().map(|live| live.field.name.as_str());
        keys.filter(|key| values.has(key)).collect()
    }

    /// The fields that a participant consumes with a model because of what the case says of its keys, each with
    /// that key.
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

    /// The histories of those of the values that a participant is given.
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

/// A file named by an option is meant from where the program runs: it gets its absolute path. It is
/// the only kind of text that checking changes.
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

impl Settings<'_> {
    pub(super) fn timing(&self) -> Timing {
        match (
            self.text("time.mode").as_deref(),
            self.number("time.window"),
            self.number("time.end"),
        ) {
            (Some("transient"), Some(window), Some(end)) => {
                Timing::Transient { window, end, control: self.control(window, end) }
            }
            (Some("sequence"), ..) => {
                Timing::Sequence { skip: self.text("time.on_failure").as_deref() == Some("skip") }
            }
            _ => Timing::Steady,
        }
    }

    fn control(&self, window: f64, end: f64) -> Control {
        if self.text("time.control").as_deref() != Some("adaptive") {
            return Control::Fixed;
        }
        Control::Adaptive {
            tolerance: self.number("time.tolerance").expect("an own key with a default"),
            shortest: self.number("time.window_min").unwrap_or(SHORTEST * window),
            longest: self.number("time.window_max").unwrap_or(end),
        }
    }

    pub(super) fn coupling(&self) -> Coupling {
        let seconds = |name: &str| {
            self.number(&format!("coupling.{name}")).expect("own keys with defaults have a value")
        };
        let word = self.text("coupling.scheme");
        Coupling {
            scheme: word.as_deref().and_then(Scheme::from_word).unwrap_or(Scheme::Auto),
            implicit: self.implicit(),
            interpolation: self.interpolation(),
            solve_deadline: seconds("solve_deadline"),
            start_deadline: seconds("start_deadline"),
            build_deadline: seconds("build_deadline"),
            heartbeat_deadline: seconds("heartbeat_deadline"),
        }
    }

    pub(super) fn limits(&self) -> Limits {
        // A cast saturates, and the values are at least 1.
        Limits {
            shared_memory: self.number("limits.shared_memory").map(|bytes| bytes as u64),
            threads: self.number("limits.threads").map(|threads| threads as usize),
        }
    }

    pub(super) fn output(&self) -> Output {
        let fields = match self.0.get("output.fields") {
            Some(Json::Array(names)) => {
                let names = names.iter().filter_map(Json::as_str);
                OutputFields::Named(names.map(|name| self.field_name(name)).collect())
            }
            Some(Json::String(word)) if word == "none" => OutputFields::None,
            _ => OutputFields::All,
        };
        let count = |key: &str| self.0.get(key).and_then(Json::as_u64);
        let (every, checkpoint_every) = (count("output.every"), count("output.checkpoint_every"));
        Output { fields, every, checkpoint_every }
    }

    pub(super) fn participant(&self, role: &str) -> ParticipantCase {
        let get = |name: &str| self.0.get(&format!("{role}.{name}"));
        let texts = |list: &Json| {
            let list = list.as_array()?;
            list.iter().map(|item| item.as_str().map(str::to_owned)).collect()
        };
        ParticipantCase {
            role: role.to_owned(),
            model: self.text(&format!("{role}.model")).expect("a model is required and checked"),
            command: get("command").and_then(texts),
            attach: get("attach").and_then(Json::as_bool).unwrap_or(false),
        }
    }
}
