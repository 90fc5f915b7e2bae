//! Drives a participant from one recorded event to the next.

use super::configuration::{Reconfiguration, Request};
use super::fields::{Inputs, Output, moving_grids, open_outputs, sample_sizes};
use super::report::{Replay, difference, first_unequal, mislabelled, unequal};
use crate::recording_file::FileRecording;
use console::output::print;
use contract::configuration::{Layout, Refusal};
use contract::description::Description;
use contract::grid::Grid;
use contract::message::{
    Command, CommandKind, Failure as Unsuccessful, FieldHeader, Finished, OutputFile, Reply,
    StateFile, Status,
};
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::recording::{CaseFile, Event, Item, Participant, read_topics};
use proto::transport::TransportError;
use run::error::{Failure, RunError, file_failure};
use run::peers::{Peers, Phase};
use run::session::room_for;
use serde::de::DeserializeOwned;
use std::io::{self, BufRead};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Result of the last command, held until the recorded reply has been read.
#[derive(Clone, Debug, PartialEq)]
enum LastResult {
    Nothing,
    Answered(CommandKind, Reply, Vec<u8>),
    Failed(String),
}

/// Driver of one participant.
pub(super) struct Driver<'a> {
    request: &'a Request,
    index: usize,
    recorded: &'a Participant,
    peers: &'a mut Peers,
    replay: Replay,
    /// Description given by the program, once it has been asked.
    description: Option<Description>,
    /// Recorded fields that the program does not provide.
    left_out: Vec<String>,
    folder: PathBuf,
    files: Vec<CaseFile>,
    inputs: Inputs,
    outputs: Vec<Output>,
    prompt: Prompt,
    last: LastResult,
    /// Number of states to pass before the first solve; `None` after them.
    skipping: Option<u64>,
    /// Last recorded state.
    state: Vec<u8>,
    /// A restore that waits for its recorded outputs.
    held: Option<(Command, Vec<Grid>)>,
    layout: Layout,
    /// Step of the last command about a step.
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
        let folder = peers.run().info().folder.join("replay");
        std::fs::create_dir(&folder).map_err(|error| file_failure(&folder, &error))?;
        let mut replay = Replay {
            role: request.only.clone(),
            recorded_program: program(&recorded.description),
            ..Replay::default()
        };
        if let (Some(window), None) = (request.from.filter(|w| *w > 0), from) {
            replay.remarks.push(format!(
                "the recording holds no state before window {window}: all earlier windows are \
                 solved too (output.checkpoint_every records states)"
            ));
        }
        let prompt = Prompt::new(request.step)?;
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
            inputs: Inputs::default(),
            outputs: Vec::new(),
            prompt,
            last: LastResult::Nothing,
            skipping: from,
            state: Vec::new(),
            held: None,
            layout: Layout::default(),
            step: Step { iteration: 0, ..Step::STEADY },
            solving: false,
            finished: false,
        })
    }

    /// Writes the files that the case names to paths that the participant can read.
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

    /// Returns the place of the replay in the recording, for a message.
    pub(super) fn position(&self) -> String {
        format!("in the replay, after window {}", self.step.window)
    }

    /// Handles a recorded entry. Returns false at the end of the requested windows.
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

    /// Ends the participant after everything has been driven. Outputs after the end of an
    /// `incomplete` recording are unknown, and not compared.
    pub(super) fn finish(mut self, incomplete: bool) -> Result<Replay, RunError> {
        if self.last != LastResult::Nothing {
            let what = "the last command has no recorded reply: its result is not compared";
            self.replay.remarks.push(what.to_owned());
        }
        if self.last != LastResult::Nothing || incomplete {
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
        if self.prompt.ask(&self.request.only, &command)? == Choice::Stop {
            return Ok(false);
        }
        match kind {
            CommandKind::Describe => self.ask(command, &[])?,
            CommandKind::Advise => {}
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
                let published = self.inputs.publish(&mut command);
                published.map_err(|error| self.transport(&error))?;
                self.solving = true;
                self.replay.solves += 1;
                self.replay.last_window = self.step.window;
                self.ask(command, &[])?;
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
                // Without exchanged outputs there is nothing to wait for.
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

    /// Sends a command, and holds its reply until the recorded one has been read.
    fn ask(&mut self, command: Command, body: &[u8]) -> Result<(), RunError> {
        self.nothing_more_was_sent()?;
        // Recordings of protocol 5 have no reply to some `Accept`.
        if let LastResult::Failed(now) = std::mem::replace(&mut self.last, LastResult::Nothing) {
            self.replay.comparison.other(&self.step, &format!("it fails: {now}"));
        }
        self.peers.phase = Phase::of(&command);
        self.peers.post(ParticipantIndex::FIRST, command, body)?;
        let deadlines = *self.peers.deadlines();
        let builds = command.kind == CommandKind::Initialise as u32;
        let patience = if builds { deadlines.build } else { deadlines.solve };
        let message = self.peers.reply(ParticipantIndex::FIRST, patience)?;
        let (reply, body) = (message.header(), message.body());
        self.last = match Status::from_number(reply.status) {
            Some(Status::Done) => {
                if self.solving {
                    self.replay.model_s += reply.model_seconds;
                }
                let kind = CommandKind::from_number(command.kind).expect("we have sent it");
                LastResult::Answered(kind, *reply, body.to_vec())
            }
            _ => LastResult::Failed(words(body)),
        };
        Ok(())
    }

    /// Checks that all samples sent so far have been compared.
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
        let done = std::mem::replace(&mut self.last, LastResult::Nothing);
        let failed_then = reply.status != Status::Done as u32;
        match done {
            LastResult::Nothing => Ok(()),
            LastResult::Answered(..) if failed_then => {
                let what = format!("it succeeds; the recording has a failure: {}", words(body));
                self.replay.comparison.other(&self.step, &what);
                Ok(())
            }
            LastResult::Failed(now) if failed_then => {
                let then = words(body);
                let how = if now == then { "as recorded" } else { "differently than recorded" };
                let mut remark = format!("it fails {how}: {now}");
                if now != then {
                    remark += &format!("; recorded: {then}");
                }
                self.replay.remarks.push(remark);
                Ok(())
            }
            LastResult::Failed(now) if self.outputs.is_empty() && self.replay.solves == 0 => {
                Err(RunError::Failed(Failure {
                    who: self.request.only.clone(),
                    when: "when it received the recorded commands".to_owned(),
                    what: now,
                    fix: format!(
                        "change its configuration with --set KEY=VALUE, or {}",
                        self.reconfiguration().otherwise()
                    ),
                }))
            }
            LastResult::Failed(now) => Err(RunError::Failed(Failure {
                who: self.request.only.clone(),
                when: format!(
                    "in window {}, iteration {} of the replay",
                    self.step.window, self.step.iteration
                ),
                what: now,
                fix: "it did not fail when it was recorded".to_owned(),
            })),
            LastResult::Answered(kind, now, said) => {
                if let Some(what) = unequal(&now, reply, self.request.tolerance) {
                    self.replay.comparison.other(&self.step, &what);
                }
                self.answered(kind, &said, body)
            }
        }
    }

    /// Compares descriptions, layouts and summaries with the recorded ones.
    fn answered(&mut self, kind: CommandKind, now: &[u8], then: &[u8]) -> Result<(), RunError> {
        match kind {
            CommandKind::Describe => self.described(self.parsed(now, "its description")?)?,
            CommandKind::Configure => {
                let now: Layout = self.parsed(now, "its layout")?;
                let then: Layout = self.parsed(then, "its recorded layout")?;
                let placed = |l: &Layout| (l.grids.clone(), l.fields.clone(), l.inputs.clone());
                if placed(&now) != placed(&then) {
                    let what = "its grids, or the places of its fields, differ from the recording";
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

    /// Takes the description of the program, which must have the driven role.
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
        let sizes = sample_sizes(&topics, &self.layout, &self.recorded.description);
        room_for(sizes, "before the fields of the replay were created")?;
        let endpoint = self.peers.endpoint();
        self.inputs = Inputs::open(endpoint, &topics).map_err(|e| self.transport(&e))?;
        let outputs = open_outputs(endpoint, &mut topics, &self.layout);
        self.outputs = outputs.map_err(|e| self.transport(&e))?;
        let body = serde_json::to_vec(&topics).expect("topics are plain data");
        self.ask(command, &body)?;
        let deadline = Instant::now() + self.peers.deadlines().start;
        self.inputs.wait_for_subscriber(deadline).map_err(|e| self.transport(&e))
    }

    /// Takes a recorded sample: an input to publish, or an output to compare.
    fn sample(
        &mut self,
        service: &str,
        header: &FieldHeader,
        values: &[f64],
    ) -> Result<(), RunError> {
        self.inputs.take(service, header, values);
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

    /// Compares the next sample of an output with the recorded one.
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
                if self.request.step.is_some()
                    && let Some(first) = &self.replay.comparison.first
                    && self.replay.comparison.different_samples == 1
                {
                    print(&(difference(first) + "\n"))?;
                }
            }
            None => {
                let what = format!("it did not send `{}`", output.field);
                self.replay.comparison.other(&self.step, &what);
            }
        }
        Ok(())
    }

    /// Takes a recorded state of the participant, which follows a save or precedes a restore.
    fn recorded_state(&mut self, bytes: &[u8]) -> Result<(), RunError> {
        bytes.clone_into(&mut self.state);
        match &mut self.skipping {
            Some(left) if *left > 1 => *left -= 1,
            Some(_) => {
                self.skipping = None;
                self.replay.from_window = self.step.window + 1;
                let command = Command::about(CommandKind::Restore, &self.step);
                self.held = Some((command, moving_grids(&self.outputs)));
                self.outputs.iter_mut().for_each(|output| output.restored = output.exchanged);
                self.restore()?;
                // The geometry of its grids was recorded when they were accepted, before the state.
                // Skips it.
                for output in self.outputs.iter().filter(|output| !output.grids.is_empty()) {
                    while output.reader.receive().map_err(|e| self.transport(&e))?.is_some() {}
                }
            }
            None => {}
        }
        Ok(())
    }

    /// Restores the recorded state of the participant, with its last outputs.
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
        if let LastResult::Failed(why) = std::mem::replace(&mut self.last, LastResult::Nothing) {
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
            fix: "see its output; `coordinator inspect` shows the content of the recording"
                .to_owned(),
        })
    }
}

fn json(file: &StateFile) -> Vec<u8> {
    serde_json::to_vec(file).expect("paths of a run are UTF-8")
}

/// Returns the reason in a reply that fails or refuses.
fn words(body: &[u8]) -> String {
    let refusal = serde_json::from_slice::<Refusal>(body).map(|refusal| refusal.to_string());
    let failure = || serde_json::from_slice::<Unsuccessful>(body).map(|failure| failure.error);
    refusal.or_else(|_| failure()).unwrap_or_else(|_| "no reason given".to_owned())
}

fn program(description: &Description) -> String {
    format!("{} {}", description.name, description.version)
}

/// Choice of the user at the prompt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    Continue,
    Stop,
}

/// Prompt before each command, until the user continues without it.
#[derive(Debug)]
struct Prompt {
    asking: bool,
    /// Window whose first solve is the first command that is asked about.
    from: Option<u64>,
}

impl Prompt {
    fn new(from: Option<u64>) -> Result<Self, RunError> {
        if from.is_some() {
            print("Enter: send · c: continue without asking · q: stop here\n")?;
        }
        Ok(Self { asking: from == Some(0), from: from.filter(|window| *window > 0) })
    }

    fn ask(&mut self, role: &str, command: &Command) -> Result<Choice, RunError> {
        let kind = CommandKind::from_number(command.kind);
        let reached = self.from.is_some_and(|window| command.window >= window);
        if reached && kind == Some(CommandKind::Solve) {
            (self.asking, self.from) = (true, None);
        }
        if !self.asking {
            return Ok(Choice::Continue);
        }
        let what = kind.map_or_else(|| "?".to_owned(), |kind| format!("{kind:?}"));
        let place = match kind {
            Some(CommandKind::Solve) => format!(
                " window {}, iteration {}, {} s to {} s",
                command.window, command.iteration, command.start, command.end
            ),
            Some(CommandKind::Accept | CommandKind::Save | CommandKind::Restore) => {
                format!(" window {}", command.window)
            }
            _ => String::new(),
        };
        print(&format!("{role}: {what}{place} > "))?;
        let mut line = String::new();
        let failed = |error| file_failure(Path::new("standard input"), &error);
        let read = io::stdin().lock().read_line(&mut line).map_err(failed)?;
        match line.trim() {
            "q" => return Ok(Choice::Stop),
            "c" => self.asking = false,
            // Standard input has ended.
            _ if read == 0 => self.asking = false,
            _ => {}
        }
        Ok(Choice::Continue)
    }
}
