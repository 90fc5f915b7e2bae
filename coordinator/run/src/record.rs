//! Recording of a run (`--record`): every sample, command and reply, in a file.
//!
//! The coupling loop only notes the events. A separate thread takes the samples from shared memory,
//! as a further subscriber of each topic, and writes them. Thus the coupling path copies nothing.
//! The thread may lag by [`LAG`] iterations: if the disk is slower than the run, the run waits, and
//! no data is lost. Memory use is limited to these iterations and a chunk of the file.

mod portable;
mod writing;

pub use portable::{case_files, fits, named_files, portable_body, without_paths};
pub use proto::recording::Compression;

use crate::error::{Failure, RunError, file_failure};
use crate::plan::Plan;
use crate::results::dir::shown;
use crate::results::write::fresh;
use crate::signals;
use contract::message::{Command, CommandKind, Reply, Status};
use coupling::ParticipantIndex;
use portable::without_files;
use proto::recording::{CaseFile, Event, FORMAT, Head, Participant, RecordingWriter};
use proto::transport::{Endpoint, TransportError};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use writing::{Job, Listener, Progress, lock, write_all};

/// Number of iterations by which the disk may lag: one is written while the next one runs. Together
/// with the noted and the current iteration, no topic's queue overflows.
pub const LAG: u64 = 1;

/// Time between two checks for signals while the run waits for the disk.
const NAP: Duration = Duration::from_millis(20);

/// Longest wait for the disk after the user has interrupted the run.
const LAST_WORDS: Duration = Duration::from_secs(2);

/// A recording in progress.
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    compression: Compression,
    files: Vec<CaseFile>,
    notes: Mutex<Notes>,
    progress: Arc<(Mutex<Progress>, Condvar)>,
    patience: Duration,
}

/// Notes that have not been passed to the writing thread.
#[derive(Debug)]
struct Notes {
    jobs: Sender<Vec<Job>>,
    batch: Vec<Job>,
    /// Number of iterations passed on.
    begun: u64,
    topics: usize,
    thread: Option<JoinHandle<()>>,
}

/// Number of a recorded topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TopicNumber(usize);

impl Recorder {
    /// Creates the file and writes the data that are known before the run.
    ///
    /// # Errors
    /// The file cannot be written, or a file that the case names cannot be read.
    pub fn start(
        path: &Path,
        compression: Compression,
        plan: &Plan,
        case: &str,
    ) -> Result<Self, RunError> {
        let (files, contents): (Vec<CaseFile>, Vec<Vec<u8>>) =
            case_files(plan)?.into_iter().unzip();
        let text = |name: &str, text: &str| (name.to_owned(), without_paths(text).into_bytes());
        let mut attachments = vec![text("case.toml", case), text("plan.txt", &plan.to_string())];
        attachments.extend(files.iter().map(|file| file.attachment.clone()).zip(contents));
        let head = head(plan, files.clone());
        let out = fresh(path).map_err(|error| file_failure(path, &error))?;
        let writer = RecordingWriter::create(out, compression, &head, &attachments)
            .map_err(|error| failed(path, &error.to_string()))?;
        let (jobs, received) = channel();
        let progress = Arc::new((Mutex::new(Progress::default()), Condvar::new()));
        let shared = Arc::clone(&progress);
        let thread = std::thread::Builder::new()
            .name("record".to_owned())
            .spawn(move || write_all(writer, &received, &shared))
            .map_err(|error| failed(path, &error.to_string()))?;
        let (batch, thread) = (Vec::new(), Some(thread));
        let notes = Mutex::new(Notes { jobs, batch, begun: 0, topics: 0, thread });
        let patience = plan.deadlines.solve;
        Ok(Self { path: path.to_owned(), compression, files, notes, progress, patience })
    }

    /// Path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Compression of the file.
    #[must_use]
    pub fn compression(&self) -> Compression {
        self.compression
    }

    /// Subscribes to a topic.
    ///
    /// # Errors
    /// The topic cannot be opened.
    pub fn listen(
        &self,
        endpoint: &Endpoint,
        service: &str,
    ) -> Result<TopicNumber, TransportError> {
        let reader = endpoint.field_reader(service)?;
        let mut notes = self.notes();
        let number = TopicNumber(notes.topics);
        notes.topics += 1;
        notes.batch.push(Job::Listen(Listener::new(service, reader)));
        Ok(number)
    }

    /// Connects to the writers of all topics, which must exist by now. Their samples are then
    /// received even if a writer has ended.
    ///
    /// # Errors
    /// The errors of [`Recorder::wait_for_room`].
    pub fn connect(&self) -> Result<(), RunError> {
        self.notes().batch.push(Job::Connect);
        self.hand_over();
        let begun = self.notes().begun;
        self.wait_until(|progress| progress.done == begun)
    }

    /// Records a command.
    pub fn command(&self, participant: ParticipantIndex, command: &Command, body: &[u8]) {
        let body = match CommandKind::from_number(command.kind) {
            Some(CommandKind::Configure) => portable_body(body, &self.files),
            // Both bodies hold paths on this machine; the states themselves are recorded.
            Some(CommandKind::Save) => Vec::new(),
            Some(CommandKind::Restore) => without_files(body),
            _ => body.to_vec(),
        };
        let participant = index(participant);
        self.event(Event::Command { participant, command: *command, body });
    }

    /// Records a reply.
    pub fn reply(&self, participant: ParticipantIndex, reply: &Reply, body: &[u8]) {
        let (participant, reply) = (index(participant), *reply);
        let body = match Status::from_number(reply.status) {
            Some(Status::Done) => body.to_vec(),
            // The text of a failure may contain any path.
            _ => without_paths(&String::from_utf8_lossy(body)).into_bytes(),
        };
        self.event(Event::Reply { participant, reply, body });
    }

    /// Records any other event.
    pub fn event(&self, event: Event) {
        self.notes().batch.push(Job::Event(event));
    }

    /// Records the sample of this sequence number on a topic.
    pub fn sample(&self, topic: TopicNumber, sequence: u64) {
        self.notes().batch.push(Job::Sample { topic: topic.0, sequence });
    }

    /// Records the state file that a participant has written or is about to read.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn state(&self, role: &str, path: &Path) -> Result<(), RunError> {
        let bytes = std::fs::read(path).map_err(|error| file_failure(path, &error))?;
        self.notes().batch.push(Job::State { role: role.to_owned(), bytes });
        Ok(())
    }

    /// Passes the notes to the writing thread; called while the participants compute.
    pub fn hand_over(&self) {
        let mut notes = self.notes();
        notes.begun += 1;
        notes.batch.push(Job::IterationEnds);
        let batch = std::mem::take(&mut notes.batch);
        // Sending cannot fail: the thread ends only after `finish`.
        let _ = notes.jobs.send(batch);
    }

    /// Waits until the disk lags by no more than [`LAG`] iterations.
    ///
    /// # Errors
    /// The disk has failed, accepts no data for as long as a solve may last, or the user has
    /// interrupted the run.
    pub fn wait_for_room(&self) -> Result<(), RunError> {
        let begun = self.notes().begun;
        self.wait_until(|progress| begun - progress.done <= LAG)
    }

    /// Unsubscribes from every topic, after all noted samples have been taken.
    ///
    /// # Errors
    /// The errors of [`Recorder::wait_for_room`].
    pub fn stop_listening(&self) -> Result<(), RunError> {
        self.notes().batch.push(Job::CloseAll);
        self.hand_over();
        self.wait_until(|progress| progress.closed)
    }

    /// Closes the recording of a failed run. Errors of the recording are reported by `finish`.
    pub fn close(&self) {
        let reported = self.has_reported();
        let _ = self.stop_listening();
        lock(&self.progress.0).reported = reported;
    }

    /// Returns the error that ends a run. An earlier failure of the recording replaces it: the
    /// recorder then unsubscribes from its topics, so that the next sender fails as a consequence.
    #[must_use]
    pub fn cause(&self, error: RunError) -> RunError {
        let mut progress = lock(&self.progress.0);
        match &progress.failed {
            Some(why) if !progress.reported && !error.is_interrupt() => {
                let cause = failed(&self.path, why).and(Err(error));
                progress.reported = true;
                cause
            }
            _ => error,
        }
    }

    /// Completes the recording with the end of the run, and returns the length of the file
    /// \[byte\].
    ///
    /// # Errors
    /// The file could not be written, now or earlier.
    pub fn finish(&self, error: Option<&str>) -> Result<u64, RunError> {
        self.event(Event::Ended { error: error.map(without_paths) });
        self.notes().batch.push(Job::Finish);
        self.hand_over();
        let thread = self.notes().thread.take();
        if let Some(thread) = thread {
            self.wait_for_end(&thread)?;
            thread.join().map_err(|_| failed(&self.path, "the writing thread has panicked"))?;
        }
        if let Some(why) = &lock(&self.progress.0).failed {
            return Err(failed(&self.path, why));
        }
        let length = std::fs::metadata(&self.path).map(|file| file.len());
        length.map_err(|error| file_failure(&self.path, &error))
    }

    /// Returns whether a failure of the recording has already ended the run.
    #[must_use]
    pub fn has_reported(&self) -> bool {
        lock(&self.progress.0).reported
    }

    /// Waits until the end of the file is written and flushed. The wait is shorter after the user
    /// has interrupted the run.
    fn wait_for_end(&self, thread: &JoinHandle<()>) -> Result<(), RunError> {
        let start = Instant::now();
        while !thread.is_finished() {
            let patience = if signals::received().is_some() { LAST_WORDS } else { self.patience };
            if start.elapsed() > patience {
                return Err(failed(&self.path, "its end cannot be written"));
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        Ok(())
    }

    fn wait_until(&self, ready: impl Fn(&Progress) -> bool) -> Result<(), RunError> {
        let (mutex, news) = &*self.progress;
        let start = Instant::now();
        let mut progress = lock(mutex);
        loop {
            if let Some(why) = &progress.failed {
                let error = failed(&self.path, why);
                progress.reported = true;
                return Err(error);
            }
            if ready(&progress) {
                return Ok(());
            }
            if let Some(signal) = signals::received() {
                let when = "while the recording was written".to_owned();
                return Err(RunError::Interrupted { signal, when });
            }
            if start.elapsed() > self.patience {
                let seconds = self.patience.as_secs_f64();
                return Err(failed(
                    &self.path,
                    &format!("the disk accepted no data for {seconds:.0} s"),
                ));
            }
            let waited = news.wait_timeout(progress, NAP);
            progress = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn notes(&self) -> MutexGuard<'_, Notes> {
        lock(&self.notes)
    }
}

fn index(participant: ParticipantIndex) -> u16 {
    u16::try_from(usize::from(participant)).expect("a run has at most twelve participants")
}

fn head(plan: &Plan, files: Vec<CaseFile>) -> Head {
    let participant = |p: &crate::plan::Participant| Participant {
        role: p.role.clone(),
        program: p.program.name(),
        description: (*p.description).clone(),
    };
    Head {
        format: FORMAT,
        protocol: contract::PROTOCOL_VERSION,
        writer: format!("coordinator {}", env!("CARGO_PKG_VERSION")),
        case: plan.name.clone(),
        scheme: plan.scheme.scheme.word().to_owned(),
        acceleration: plan.acceleration().word().to_owned(),
        participants: plan.participants.iter().map(participant).collect(),
        files,
    }
}

fn failed(path: &Path, what: &str) -> RunError {
    RunError::Failed(Failure {
        who: "the recording".to_owned(),
        when: format!("at {}", shown(path).display()),
        what: what.to_owned(),
        fix: "check the free space; what was written before stays readable".to_owned(),
    })
}
