//! From one recorded event to the next.

use super::feed::Feed;
use super::request::{Replay, Request};
use super::told::Reconfiguration;
use super::walk::{Answer, Walk};
use crate::inspect::FileRecording;
use console::output::print;
use contract::configuration::{Layout, Refusal};
use contract::description::Description;
use contract::field::GEOMETRY;
use contract::grid::Grid;
use contract::message::{
    Command, CommandKind, Failure as Unsuccessful, FieldHeader, Finished, OutputFile, Reply,
    StateFile, Status, Topics,
};
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::recording::{CaseFile, Event, Item, Participant, read_topics};
use proto::transport::{Endpoint, FieldReader, TransportError};
use run::error::{Failure, RunError, file_failure};
use run::peers::{Peers, Phase};
use run::plan::{geometry_bytes, sample_bytes};
use run::session::room_for;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::PathBuf;
use std::time::Instant;

/// One output of the participant.
#[derive(Debug)]
struct Output {
    field: String,
    service: String,
    reader: FieldReader,
    /// Published in every iteration; otherwise only when a window is observed.
    exchanged: bool,
    /// As recorded last.
    recorded: Option<(FieldHeader, Vec<f64>)>,
    /// Recorded since the last restore was held back.
    restored: bool,
    /// Of a geometry: the grid as it was recorded last, and before.
    grids: Vec<Grid>,
}

impl Output {
    fn open(endpoint: &Endpoint, field: &str, service: &str) -> Result<Self, TransportError> {
        let (field, service) = (field.to_owned(), service.to_owned());
        let reader = endpoint.field_reader(&service)?;
        let (exchanged, recorded, restored, grids) = (false, None, false, Vec::new());
        Ok(Self { field, service, reader, exchanged, recorded, restored, grids })
    }

    /// A recorded sample.
    fn take(&mut self, header: &FieldHeader, values: &[f64]) {
        // What comes before any solve is sent in each iteration thereafter, but for a geometry.
        self.exchanged |= header.iteration == 0 && self.grids.is_empty();
        self.restored = true;
        let kept = self.recorded.take().map(|(_, values)| values).unwrap_or_default();
        self.recorded = Some((*header, refilled(kept, values)));
        let moved = self.grids.last().map(|g| g.with_geometry(values, header.grid_revision));
        if let Some(Ok(grid)) = moved {
            self.grids.push(grid);
            let surplus = self.grids.len().saturating_sub(2);
            self.grids.drain(..surplus);
        }
    }
}

/// What the recording says next is not what the participant has just done.
#[derive(Clone, Debug, PartialEq)]
enum Done {
    Nothing,
    Answered(CommandKind, Reply, Vec<u8>),
    Failed(String),
}

/// Drives one participant.
pub(super) struct Driver<'a> {
    request: &'a Request,
    index: usize,
    recorded: &'a Participant,
    peers: &'a mut Peers,
    replay: Replay,
    /// What the program says of itself, once it was asked.
    description: Option<Description>,
    /// Recorded fields that it does not provide.
    left_out: Vec<String>,
    folder: PathBuf,
    files: Vec<CaseFile>,
    feed: Feed,
    outputs: Vec<Output>,
    walk: Walk,
    done: Done,
    /// States to pass before the first solve; `None` once there.
    skipping: Option<u64>,
    /// State that was recorded last.
    state: Vec<u8>,
    /// A restore whose outputs are still to come.
    held: Option<(Command, Vec<Grid>)>,
    /// It has grids that move, and answers every `Accept`.
    moves: bool,
    layout: Layout,
    /// The last command that concerned a step.
    step: Step,
    solving: bool,
    finished: bool,
}

impl<'a> Driver<'a> {
    pub(super) fn new(
        request: &'a Request,
        index: usize,
        recorded: &'a Participant,
        peers: &'a mut Peers,
        from: Option<u64>,
    ) -> Result<Self, RunError> {
        let folder = peers.info().folder.join("replay");
        std::fs::create_dir(&folder).map_err(|error| file_failure(&folder, &error))?;
        let mut replay = Replay {
            role: request.only.clone(),
            recorded_program: program(&recorded.description),
            ..Replay::default()
        };
        if let (Some(window), None) = (request.from.filter(|w| *w > 0), from) {
            replay.remarks.push(format!(
                "the recording holds no state before window {window}: all windows before are \
                 solved too (output.checkpoint_every records states)"
            ));
        }
        let walk = Walk::new(request.step)?;
        Ok(Self {
            request,
            index,
            recorded,
            peers,
            replay,
            description: None,
            left_out: Vec::new(),
            folder,
            files: Vec::new(),
            feed: Feed::default(),
            outputs: Vec::new(),
            walk,
            done: Done::Nothing,
            skipping: from,
            state: Vec::new(),
            held: None,
            moves: false,
            layout: Layout::default(),
            step: Step { iteration: 0, ..Step::STEADY },
            solving: false,
            finished: false,
        })
    }

    /// Puts the files that the case names where the participant can read them.
    pub(super) fn attach_files(&mut self, recording: &FileRecording) -> Result<(), RunError> {
        self.files.clone_from(&recording.head().files);
        for (number, file) in self.files.iter_mut().enumerate() {
            let content = recording.attachment(&file.attachment).unwrap_or_default();
            let path = self.folder.join(format!("file-{number}"));
            std::fs::write(&path, content).map_err(|error| file_failure(&path, &error))?;
            file.key = path.to_string_lossy().into_owned();
        }
        Ok(())
    }

    /// Does what an entry asks for; false when there is nothing more to do.
    pub(super) fn entry(&mut self, item: Item<'_>) -> Result<bool, RunError> {
        match item {
            Item::Event(Event::Command { participant, command, body })
                if usize::from(participant) == self.index =>
            {
                return self.command(command, &body);
            }
            Item::Event(Event::Reply { participant, reply, body })
                if usize::from(participant) == self.index =>
            {
                self.reply(&reply, &body)?;
            }
            Item::Event(Event::Ended { error: Some(error) }) => {
                self.replay.remarks.push(format!("the recorded run failed: {error}"));
            }
            Item::Event(_) => {}
            Item::Sample { service, header, values } => self.sample(service, &header, values)?,
            Item::State { role, bytes } if role == self.request.only => {
                self.recorded_state(bytes)?;
            }
            Item::State { .. } => {}
        }
        Ok(true)
    }

    /// Everything has been driven: lets the participant go. Of a recording that is `incomplete` what
    /// came after its end is not known, and not compared.
    pub(super) fn finish(mut self, incomplete: bool) -> Result<Replay, RunError> {
        if self.done != Done::Nothing {
            let what = "the last command has no recorded answer: what it did there is not compared";
            self.replay.remarks.push(what.to_owned());
        }
        if self.done != Done::Nothing || incomplete {
            self.outputs.clear();
        }
        if !self.finished {
            let finish = Command::new(CommandKind::Finish);
            self.ask(finish, &[])?;
        }
        self.peers.wait_for_exits();
        Ok(self.replay)
    }

    fn command(&mut self, mut command: Command, body: &[u8]) -> Result<bool, RunError> {
        let Some(kind) = CommandKind::from_number(command.kind) else { return Ok(true) };
        let about_steps = matches!(
            kind,
            CommandKind::Solve | CommandKind::Accept | CommandKind::Save | CommandKind::Restore
        );
        if about_steps {
            if kind == CommandKind::Solve
                && self.request.until.is_some_and(|until| command.window > until)
            {
                return Ok(false);
            }
            self.step = command.step();
            if self.skipping.is_some() {
                return Ok(true);
            }
        }
        self.restore()?;
        if self.walk.ask(&self.request.only, &command)? == Answer::Stop {
            return Ok(false);
        }
        match kind {
            CommandKind::Describe => self.ask(command, &[])?,
            CommandKind::Configure => {
                let (body, left_out) = self.reconfiguration().configuration(body)?;
                let remark =
                    |name| format!("`{name}` is not compared: the program does not provide it");
                self.replay.remarks.extend(left_out.iter().map(remark));
                self.left_out = left_out;
                self.ask(command, &body)?;
            }
            CommandKind::Connect => self.connect(command, body)?,
            CommandKind::Initialise => self.ask(command, &[])?,
            CommandKind::Solve => {
                let published = self.feed.publish(&mut command);
                published.map_err(|error| self.transport(&error))?;
                self.solving = true;
                self.replay.solves += 1;
                self.replay.last_window = self.step.window;
                self.ask(command, &[])?;
            }
            CommandKind::Accept if command.flags == 0 && !self.moves => {
                self.peers.post(ParticipantIndex::FIRST, command, &[], false)?;
            }
            CommandKind::Accept => self.ask(command, &[])?,
            CommandKind::Save => {
                let path = self.folder.join("saved.state");
                let file = StateFile { path, outputs: Vec::new(), geometry: Vec::new() };
                self.ask(command, &json(&file))?;
            }
            CommandKind::Restore => {
                self.outputs.iter_mut().for_each(|output| output.restored = false);
                let file: Option<StateFile> = serde_json::from_slice(body).ok();
                let grids = file.map(|file| file.geometry).unwrap_or_default();
                self.held = Some((command, grids));
                // Without exchanged outputs nothing is still to come.
                if self.outputs.iter().all(|output| !output.exchanged) {
                    self.restore()?;
                }
            }
            CommandKind::Finish => {
                self.finished = true;
                self.ask(command, &[])?;
            }
        }
        Ok(true)
    }

    /// Sends a command and keeps what comes back until the recording says what came then.
    fn ask(&mut self, command: Command, body: &[u8]) -> Result<(), RunError> {
        self.nothing_more_was_sent()?;
        self.peers.phase = Phase::of(&command);
        self.peers.post(ParticipantIndex::FIRST, command, body, true)?;
        let deadlines = *self.peers.deadlines();
        let builds = command.kind == CommandKind::Initialise as u32;
        let patience = if builds { deadlines.build } else { deadlines.solve };
        let message = self.peers.reply(ParticipantIndex::FIRST, patience)?;
        let (reply, body) = (message.header(), message.body());
        self.done = match Status::from_number(reply.status) {
            Some(Status::Done) => {
                if self.solving {
                    self.replay.model_s += reply.model_seconds;
                }
                let kind = CommandKind::from_number(command.kind).expect("we have sent it");
                Done::Answered(kind, *reply, body.to_vec())
            }
            _ => Done::Failed(words(body)),
        };
        Ok(())
    }

    /// Everything that was sent has been compared.
    fn nothing_more_was_sent(&mut self) -> Result<(), RunError> {
        for at in 0..self.outputs.len() {
            let received = self.outputs[at].reader.receive().map_err(|e| self.transport(&e))?;
            if received.is_some() {
                let what = format!("it sent more of `{}` than recorded", self.outputs[at].field);
                self.replay.comparison.other(&self.step, &what);
            }
        }
        Ok(())
    }

    fn reply(&mut self, reply: &Reply, body: &[u8]) -> Result<(), RunError> {
        if std::mem::take(&mut self.solving) && reply.model_seconds.is_finite() {
            self.replay.recorded_model_s += reply.model_seconds;
        }
        let done = std::mem::replace(&mut self.done, Done::Nothing);
        let failed_then = reply.status != Status::Done as u32;
        match done {
            Done::Nothing => Ok(()),
            Done::Answered(..) if failed_then => {
                let what = format!("it succeeds; the recording has a failure: {}", words(body));
                self.replay.comparison.other(&self.step, &what);
                Ok(())
            }
            Done::Failed(now) if failed_then => {
                let then = words(body);
                let how = if now == then { "as recorded" } else { "differently than recorded" };
                let mut remark = format!("it fails {how}: {now}");
                if now != then {
                    remark += &format!("; recorded: {then}");
                }
                self.replay.remarks.push(remark);
                Ok(())
            }
            Done::Failed(now) if self.outputs.is_empty() && self.replay.solves == 0 => {
                Err(RunError::Failed(Failure {
                    who: self.request.only.clone(),
                    when: "when it was given what was recorded".to_owned(),
                    what: now,
                    fix: format!(
                        "change its configuration with --set KEY=VALUE, or {}",
                        self.reconfiguration().otherwise()
                    ),
                }))
            }
            Done::Failed(now) => Err(RunError::Failed(Failure {
                who: self.request.only.clone(),
                when: format!(
                    "in window {}, iteration {} of the replay",
                    self.step.window, self.step.iteration
                ),
                what: now,
                fix: "it did not fail when it was recorded".to_owned(),
            })),
            Done::Answered(kind, now, said) => {
                if let Some(what) = unequal(&now, reply, self.request.tolerance) {
                    self.replay.comparison.other(&self.step, &what);
                }
                self.answered(kind, &said, body)
            }
        }
    }

    /// Descriptions, layouts and summaries side by side.
    fn answered(&mut self, kind: CommandKind, now: &[u8], then: &[u8]) -> Result<(), RunError> {
        match kind {
            CommandKind::Describe => self.described(self.parsed(now, "its description")?)?,
            CommandKind::Configure => {
                let now: Layout = self.parsed(now, "its layout")?;
                let then: Layout = self.parsed(then, "its recorded layout")?;
                let placed = |l: &Layout| (l.grids.clone(), l.fields.clone(), l.inputs.clone());
                if placed(&now) != placed(&then) {
                    let what = "its grids, or where its fields live, are not the recorded ones";
                    self.replay.comparison.other.get_or_insert(what.to_owned());
                }
                self.layout = now;
            }
            CommandKind::Finish if self.request.tolerance.is_none() => {
                let now: Finished = self.parsed(now, "its summary")?;
                let then: Finished = self.parsed(then, "its recorded summary")?;
                let unequal = first_unequal(&now.summary, &then.summary, String::new());
                if let Some((key, a, b)) = unequal {
                    let what = format!("its summary: {key} is {a}, recorded {b}");
                    self.replay.comparison.other.get_or_insert(what);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// What the program says of itself: it has to play the role.
    fn described(&mut self, description: Description) -> Result<(), RunError> {
        let (role, plays) = (&self.request.only, &description.role);
        if plays != role {
            let (name, otherwise) = (&description.name, self.reconfiguration().otherwise());
            return Err(RunError::Usage(format!(
                "`{name}` plays `{plays}`, not `{role}`; give a program that does, or {otherwise}"
            )));
        }
        self.replay.program = program(&description);
        self.description = Some(description);
        Ok(())
    }

    fn parsed<T: DeserializeOwned>(&self, body: &[u8], what: &str) -> Result<T, RunError> {
        serde_json::from_slice(body).map_err(|error| self.damaged(&format!("{what}: {error}")))
    }

    fn connect(&mut self, command: Command, body: &[u8]) -> Result<(), RunError> {
        let mut topics = read_topics(body).map_err(|error| self.damaged(&error.to_string()))?;
        topics.outputs.retain(|topic| !self.left_out.contains(&topic.field));
        room_for(self.samples(&topics), "before the fields of the replay were created")?;
        let endpoint = self.peers.endpoint();
        self.feed = Feed::open(endpoint, &topics).map_err(|e| self.transport(&e))?;
        let mut outputs = Vec::new();
        for topic in &mut topics.outputs {
            topic.subscribers = 1;
            let output = Output::open(endpoint, &topic.field, &topic.service);
            outputs.push(output.map_err(|e| self.transport(&e))?);
        }
        for topic in &mut topics.geometry {
            topic.subscribers = 1;
            let output = Output::open(endpoint, GEOMETRY.name, &topic.service);
            let mut output = output.map_err(|e| self.transport(&e))?;
            output.grids.extend(self.layout.grids.iter().find(|g| g.name == topic.grid).cloned());
            outputs.push(output);
        }
        (self.outputs, self.moves) = (outputs, !topics.geometry.is_empty());
        let body = serde_json::to_vec(&topics).expect("topics are plain data");
        self.ask(command, &body)?;
        let deadline = Instant::now() + self.peers.deadlines().start;
        self.feed.wait_for_subscriber(deadline).map_err(|e| self.transport(&e))
    }

    /// Bytes of a sample of each topic.
    fn samples(&self, topics: &Topics) -> Vec<u64> {
        let kind = |name: &str| self.recorded.description.field_kind(name);
        let components = |name: &str| kind(name).map_or(1, |kind| kind.components);
        let all = topics.inputs.iter().chain(&topics.outputs);
        let fields = all.map(|t| sample_bytes(t.grid.points(), components(&t.field)));
        let geometry = |name: &String| self.layout.grids.iter().find(|grid| grid.name == *name);
        let geometry = topics.geometry.iter().filter_map(|topic| geometry(&topic.grid));
        fields.chain(geometry.map(geometry_bytes)).collect()
    }

    /// A recorded sample: an input to come, or an output to compare with.
    fn sample(
        &mut self,
        service: &str,
        header: &FieldHeader,
        values: &[f64],
    ) -> Result<(), RunError> {
        self.feed.take(service, header, values);
        let Some(at) = self.outputs.iter().position(|o| o.service == service) else {
            return Ok(());
        };
        self.outputs[at].take(header, values);
        if self.held.is_some() {
            if self.outputs.iter().all(|output| output.restored || !output.exchanged) {
                self.restore()?;
            }
            return Ok(());
        }
        if self.skipping.is_some() && header.iteration > 0 {
            return Ok(());
        }
        self.compare(at)
    }

    /// The next sample of an output against the recorded one.
    fn compare(&mut self, at: usize) -> Result<(), RunError> {
        let received = self.outputs[at].reader.receive().map_err(|e| self.transport(&e))?;
        let output = &self.outputs[at];
        let Some((header, then)) = &output.recorded else { return Ok(()) };
        match received {
            Some(sample) => {
                let tolerance = self.request.tolerance;
                if let Some(what) = mislabelled(sample.header(), header) {
                    self.replay.comparison.other(&self.step, &what);
                }
                self.replay.comparison.sample((header, then), sample.values(), tolerance);
                if self.request.step
                    && let Some(first) = &self.replay.comparison.first
                    && self.replay.comparison.different_samples == 1
                {
                    print(&(super::show::difference(first) + "\n"))?;
                }
            }
            None => {
                let what = format!("it did not send `{}`", output.field);
                self.replay.comparison.other(&self.step, &what);
            }
        }
        Ok(())
    }

    /// A state of the participant stands in the recording: after a save, or before a restore.
    fn recorded_state(&mut self, bytes: &[u8]) -> Result<(), RunError> {
        self.state = refilled_bytes(std::mem::take(&mut self.state), bytes);
        match &mut self.skipping {
            Some(left) if *left > 1 => *left -= 1,
            Some(_) => {
                self.skipping = None;
                self.replay.from_window = self.step.window + 1;
                let command = Command::about(CommandKind::Restore, &self.step);
                self.held = Some((command, self.grids_of_outputs()));
                self.outputs.iter_mut().for_each(|output| output.restored = output.exchanged);
                self.restore()?;
                // Its grids were recorded when they were accepted, before the state.
                for output in self.outputs.iter().filter(|output| !output.grids.is_empty()) {
                    while output.reader.receive().map_err(|e| self.transport(&e))?.is_some() {}
                }
            }
            None => {}
        }
        Ok(())
    }

    /// The moving grids as they were when the outputs were sent last; none of these is on a volume.
    fn grids_of_outputs(&self) -> Vec<Grid> {
        let revision = |grid: &str| {
            let on_it = |(header, _): &&(FieldHeader, Vec<f64>)| header.grid.as_str() == grid;
            let samples = self.outputs.iter().filter(|o| o.grids.is_empty());
            samples.filter_map(|o| o.recorded.as_ref()).find(on_it).map(|(h, _)| h.grid_revision)
        };
        let moves = |output: &&Output| output.grids.first().is_some_and(|grid| !grid.is_volume());
        let moving = self.outputs.iter().filter(moves);
        let of = |output: &Output| {
            let wanted = revision(&output.grids[0].name);
            let exact = output.grids.iter().find(|grid| Some(grid.revision) == wanted);
            exact.or(output.grids.first()).cloned()
        };
        moving.filter_map(of).collect()
    }

    /// Gives the participant its recorded state, and what it had sent last.
    fn restore(&mut self) -> Result<(), RunError> {
        let Some((command, geometry)) = self.held.take() else { return Ok(()) };
        let path = self.folder.join("recorded.state");
        std::fs::write(&path, &self.state).map_err(|error| file_failure(&path, &error))?;
        let mut files = Vec::new();
        for output in self.outputs.iter().filter(|output| output.exchanged) {
            let Some((_, values)) = &output.recorded else { continue };
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            let path = self.folder.join(format!("{}.values", output.field));
            std::fs::write(&path, bytes).map_err(|error| file_failure(&path, &error))?;
            files.push(OutputFile { field: output.field.clone(), path });
        }
        self.ask(command, &json(&StateFile { path, outputs: files, geometry }))?;
        if let Done::Failed(why) = std::mem::replace(&mut self.done, Done::Nothing) {
            return Err(self.damaged(&format!("its state cannot be restored: {why}")));
        }
        let restored = (0..self.outputs.len()).filter(|&at| self.outputs[at].restored);
        let restored: Vec<usize> = restored.collect();
        restored.into_iter().try_for_each(|at| self.compare(at))
    }

    fn reconfiguration(&self) -> Reconfiguration<'_> {
        let (request, recorded, files) = (self.request, self.recorded, &self.files);
        Reconfiguration { request, recorded, files, description: self.description.as_ref() }
    }

    fn transport(&self, error: &TransportError) -> RunError {
        self.damaged(&error.to_string())
    }

    fn damaged(&self, what: &str) -> RunError {
        RunError::Failed(Failure {
            who: self.request.only.clone(),
            when: "in a replay".to_owned(),
            what: what.to_owned(),
            fix: "see what it wrote; `coordinator inspect` shows what the recording holds"
                .to_owned(),
        })
    }
}

fn json(file: &StateFile) -> Vec<u8> {
    serde_json::to_vec(file).expect("paths of a run are UTF-8")
}

/// What a failed or refusing reply says.
fn words(body: &[u8]) -> String {
    let refusal = serde_json::from_slice::<Refusal>(body).map(|refusal| refusal.to_string());
    let failure = || serde_json::from_slice::<Unsuccessful>(body).map(|failure| failure.error);
    refusal.or_else(|_| failure()).unwrap_or_else(|_| "no reason given".to_owned())
}

/// How a reply differs in what is no time.
fn unequal(now: &Reply, then: &Reply, tolerance: Option<f64>) -> Option<String> {
    let floats = [
        ("heat received", now.heat_received, then.heat_received),
        ("the window it wants", now.wanted_window, then.wanted_window),
    ];
    let within = |a: f64, b: f64| match tolerance {
        _ if a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan() => true,
        None => false,
        Some(tolerance) => (a - b).abs() <= tolerance * b.abs(),
    };
    if let Some((what, a, b)) = floats.into_iter().find(|(_, a, b)| !within(*a, *b)) {
        return Some(format!("{what} is {a:e}, recorded {b:e}"));
    }
    let counts = [
        ("its work", now.work, then.work),
        ("substeps", now.substeps.into(), then.substeps.into()),
        ("inner iterations", now.inner_iterations.into(), then.inner_iterations.into()),
    ];
    let differs = counts.into_iter().find(|(_, a, b)| a != b && tolerance.is_none());
    differs.map(|(what, a, b)| format!("{what}: {a}, recorded {b}"))
}

/// How the label of a sample differs, but for its number.
fn mislabelled(now: &FieldHeader, then: &FieldHeader) -> Option<String> {
    let now = FieldHeader { sequence: then.sequence, protocol: then.protocol, ..*now };
    (now != *then).then(|| {
        let name = then.name.as_str();
        format!("`{name}` is labelled {now:?}, recorded {then:?}")
    })
}

fn program(description: &Description) -> String {
    format!("{} {}", description.name, description.version)
}

fn refilled(mut kept: Vec<f64>, values: &[f64]) -> Vec<f64> {
    kept.clear();
    kept.extend_from_slice(values);
    kept
}

fn refilled_bytes(mut kept: Vec<u8>, bytes: &[u8]) -> Vec<u8> {
    kept.clear();
    kept.extend_from_slice(bytes);
    kept
}

/// The first key in which two trees differ, with both values.
fn first_unequal(now: &Value, then: &Value, key: String) -> Option<(String, Value, Value)> {
    match (now, then) {
        (Value::Object(a), Value::Object(b)) => {
            let names = a.keys().chain(b.keys().filter(|name| !a.contains_key(*name)));
            names.into_iter().find_map(|name| {
                let of = |table: &serde_json::Map<String, Value>| {
                    table.get(name).cloned().unwrap_or(Value::Null)
                };
                let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                first_unequal(&of(a), &of(b), key)
            })
        }
        (a, b) if a == b => None,
        (a, b) => Some((key, a.clone(), b.clone())),
    }
}
