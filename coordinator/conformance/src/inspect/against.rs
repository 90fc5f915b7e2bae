//! Comparison of two recordings of a case: the first difference, its cause, and its growth.
//!
//! Both files are read once, side by side. Samples are matched by topic, window, iteration, and the
//! attempt at the window if it is repeated. Solvers of a parallel scheme may therefore answer in
//! another order, and windows may take another number of iterations. Values are compared bit by
//! bit. Everything that was sent before the first difference is equal. The sender of the first
//! difference has therefore received the same values as in the other recording.

use crate::recording_file::failed;
use crate::replay::{Comparison, difference, first_unequal, growth_lines, mislabelled};
use contract::message::{CommandKind, FieldHeader};
use contract::text::one_line;
use proto::recording::{Event, Head, Item, Recording};
use run::error::RunError;
use run::format::counted;
use run::peers::COORDINATOR;
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;

/// Difference of a recording from a reference.
#[derive(Debug, Default, Serialize)]
pub(crate) struct RecordingDifference {
    /// Comparison of all samples.
    pub(crate) comparison: Comparison,
    /// Role of the sender of the first difference, and its program with its version.
    sender: Option<[String; 2]>,
    /// Cause of the first difference, as far as the recordings show it.
    cause: Option<String>,
    /// Command that drives the sender through the smallest range of windows with the difference.
    replay: Option<String>,
}

/// Key of a sample: topic, window, iteration, number of earlier samples with these three.
type Key = (String, u64, u32, u32);

/// A recording that is read as far as needed.
struct Side<'a, R: Read> {
    recording: &'a mut Recording<R>,
    path: &'a Path,
    /// Roles of the participants.
    roles: Vec<String>,
    /// Samples that were read before they were needed.
    waiting: HashMap<Key, (FieldHeader, Vec<f64>)>,
    /// Newest window of a sample.
    window: u64,
    /// Number of samples of the newest window, by topic and iteration.
    attempts: HashMap<(String, u32), u32>,
    /// Configuration of each role.
    configurations: BTreeMap<String, Value>,
    /// Last window with a saved state, by role.
    saved: BTreeMap<String, u64>,
}

impl<'a, R: Read> Side<'a, R> {
    fn new(recording: &'a mut Recording<R>, path: &'a Path) -> Self {
        let participants = &recording.head().participants;
        Self {
            roles: participants.iter().map(|one| one.role.clone()).collect(),
            recording,
            path,
            waiting: HashMap::new(),
            window: 0,
            attempts: HashMap::new(),
            configurations: BTreeMap::new(),
            saved: BTreeMap::new(),
        }
    }

    /// Reads to the next sample and returns its key; `None` at the end.
    fn next(&mut self) -> Result<Option<(Key, FieldHeader, Vec<f64>)>, RunError> {
        loop {
            let entry = self.recording.read().map_err(|error| failed(self.path, &error))?;
            let Some(entry) = entry else { return Ok(None) };
            match entry.item {
                Item::Sample { service, header, values } => {
                    if header.window > self.window {
                        self.window = header.window;
                        self.attempts.clear();
                    }
                    let attempts =
                        self.attempts.entry((service.to_owned(), header.iteration)).or_default();
                    let key = (service.to_owned(), header.window, header.iteration, *attempts);
                    *attempts += 1;
                    return Ok(Some((key, header, values.to_vec())));
                }
                Item::Event(Event::Command { participant, command, body }) => {
                    let role = || self.roles[usize::from(participant)].clone();
                    match CommandKind::from_number(command.kind) {
                        Some(CommandKind::Configure) => {
                            // The reader reports a damaged configuration itself.
                            let given = serde_json::from_slice(&body).unwrap_or_default();
                            self.configurations.insert(role(), given);
                        }
                        Some(CommandKind::Save) => {
                            self.saved.insert(role(), command.window);
                        }
                        _ => {}
                    }
                }
                Item::Event(_) | Item::State { .. } => {}
            }
        }
    }

    /// Returns the sample with this key, if the recording has it.
    fn take(&mut self, wanted: &Key) -> Result<Option<(FieldHeader, Vec<f64>)>, RunError> {
        let window = wanted.1;
        self.waiting.retain(|key, _| key.1 >= window);
        if let Some(found) = self.waiting.remove(wanted) {
            return Ok(Some(found));
        }
        while self.window <= window {
            match self.next()? {
                None => break,
                Some((key, header, values)) if key == *wanted => return Ok(Some((header, values))),
                Some((key, header, values)) => {
                    self.waiting.insert(key, (header, values));
                }
            }
        }
        Ok(None)
    }
}

/// Compares a recording with a reference.
///
/// # Errors
/// A recording that cannot be read to its end.
pub(crate) fn compare<R: Read>(
    (recording, path): (&mut Recording<R>, &Path),
    (reference, reference_path): (&mut Recording<R>, &Path),
) -> Result<RecordingDifference, RunError> {
    let mut now = Side::new(recording, path);
    let mut then = Side::new(reference, reference_path);
    let mut found = RecordingDifference::default();
    let mut first: Option<(Key, Option<u64>)> = None;
    while let Some((key, header, values)) = now.next()? {
        let comparison = &mut found.comparison;
        match then.take(&key)? {
            Some((recorded, recorded_values)) => {
                if let Some(label) = mislabelled(&header, &recorded) {
                    comparison.other(&header.step(), &label);
                }
                comparison.sample((&recorded, &recorded_values), &values, None);
            }
            None => {
                let what = format!("`{}` is not in the other recording", header.name.as_str());
                comparison.other(&header.step(), &what);
            }
        }
        if first.is_none() && found.comparison.differs() {
            let saved = now.saved.get(sender(&key)).copied();
            first = Some((key, saved));
        }
    }
    let missing = then.next()?.filter(|_| !found.comparison.differs());
    if let Some((key, header, _)) = missing {
        let what = format!("the recording ends before `{}`", header.name.as_str());
        found.comparison.other(&header.step(), &what);
        first = Some((key, None));
    }
    if let Some((key, saved)) = first {
        let role = sender(&key);
        let heads = [now.recording.head(), then.recording.head()];
        let program = program(heads[0], role);
        found.cause = Some(cause(role, heads, [&now.configurations, &then.configurations]));
        found.replay = (role != COORDINATOR && found.comparison.first.is_some()).then(|| {
            let from = saved
                .map_or_else(String::new, |window| format!(" --from {}", window.saturating_add(1)));
            let path = quoted(&reference_path.display().to_string());
            let role = quoted(role);
            format!("coordinator replay {path} --only {role}{from} --until {}", key.1)
        });
        found.sender = Some([role.to_owned(), program]);
    }
    Ok(found)
}

/// Quotes a word for a shell. Names in a recording may come from anywhere.
fn quoted(word: &str) -> String {
    shlex::try_quote(word).map_or_else(|_| "''".to_owned(), std::borrow::Cow::into_owned)
}

/// Returns the role that sends the topic of a sample, `field/ROLE/…` or `geometry/ROLE/…`.
fn sender(key: &Key) -> &str {
    key.0.split('/').nth(1).unwrap_or_default()
}

/// Returns the program of a role with its version.
fn program(head: &Head, role: &str) -> String {
    let participant = head.participants.iter().find(|one| one.role == role);
    participant.map_or_else(
        || head.writer.clone(),
        |one| format!("{} {}", one.description.name, one.description.version),
    )
}

/// Returns the cause of a first difference that this role has sent.
fn cause(role: &str, heads: [&Head; 2], configurations: [&BTreeMap<String, Value>; 2]) -> String {
    let [now, then] = configurations.map(|all| all.get(role));
    if let (Some(now), Some(then)) = (now, then)
        && let Some((key, now, then)) = first_unequal(now, then, String::new())
    {
        return format!("its configuration: {key} is {now}, recorded {then}");
    }
    let [now, then] = heads.map(|head| program(head, role));
    if now != then {
        return format!("its program: {now}, recorded {then}; it has received the same values");
    }
    let [now, then] = heads.map(|head| (&head.scheme, &head.acceleration));
    match role {
        COORDINATOR if now != then => "the coupling scheme or its acceleration".to_owned(),
        COORDINATOR => "the iterates of the coordinator: its settings, or its build".to_owned(),
        _ => "its build or its state: configuration, received values and earlier answers are equal"
            .to_owned(),
    }
}

/// Describes the difference in a few lines.
pub(crate) fn text(found: &RecordingDifference, paths: [&Path; 2]) -> String {
    let compared = &found.comparison;
    let [path, reference] = paths.map(Path::display);
    let mut out = format!(
        "{path} against {reference}\n  {} of {} compared\n",
        counted(compared.samples, "sample"),
        counted(compared.values, "value")
    );
    match (compared.differs(), &compared.first) {
        (false, _) => out += "  bit-identical\n",
        (true, None) => out += "  DIFFER, though not in their values\n",
        (true, Some(_)) => {
            let _ = writeln!(out, "  DIFFER in {}", counted(compared.different_samples, "sample"));
        }
    }
    let mut line = |name: &str, text: &str| {
        let _ = writeln!(out, "  {name:9} {text}");
    };
    if let Some(first) = &compared.first {
        line("first", &one_line(&difference(first)));
    }
    if let Some(other) = &compared.other {
        line(if compared.first.is_some() { "also" } else { "first" }, &one_line(other));
    }
    if let Some([role, program]) = &found.sender {
        line("sender", &format!("{role} ({})", one_line(program)));
    }
    if let Some(cause) = &found.cause {
        line("cause", &one_line(cause));
    }
    if compared.first.is_some() {
        line("growth", &growth_lines(&compared.growth).join("\n            "));
    }
    if let Some(replay) = &found.replay {
        line("replay", &one_line(replay));
        let window = compared.first.as_ref().map_or(0, |first| first.window);
        line("debugger", &format!("add --serve --step={window}: it asks before the first solve"));
    }
    out
}
