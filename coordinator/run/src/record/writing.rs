//! Thread that writes a recording.

use proto::recording::{Event, RecordingError, RecordingWriter};
use proto::transport::FieldReader;
use std::fs::File;
use std::sync::mpsc::Receiver;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Progress of the writing thread.
#[derive(Debug, Default)]
pub(super) struct Progress {
    /// Number of iterations written.
    pub(super) done: u64,
    /// Whether every listener has been closed.
    pub(super) closed: bool,
    /// Failure of the thread; all later notes are dropped.
    pub(super) failed: Option<String>,
    /// Whether the failure has been reported as the error of the run.
    pub(super) reported: bool,
}

/// A note of the coupling loop.
#[derive(Debug)]
pub(super) enum Job {
    Listen(Listener),
    /// Every writer exists.
    Connect,
    Event(Event),
    /// The sample of this sequence number is in the queue of a topic.
    Sample {
        topic: usize,
        sequence: u64,
    },
    State {
        role: String,
        bytes: Vec<u8>,
    },
    /// All samples of an iteration have been noted.
    IterationEnds,
    /// No further samples will be taken.
    CloseAll,
    /// No further notes follow.
    Finish,
}

/// A recorded topic.
#[derive(Debug)]
pub(super) struct Listener {
    service: String,
    reader: FieldReader,
}

impl Listener {
    pub(super) fn new(service: &str, reader: FieldReader) -> Self {
        Self { service: service.to_owned(), reader }
    }

    fn lost(&self, what: &str) -> RecordingError {
        RecordingError::Content(format!("{}: {what}", self.service))
    }

    fn connect(&self) -> Result<(), RecordingError> {
        self.reader.connect().map_err(|error| self.lost(&error.to_string()))
    }

    /// Takes samples up to this sequence number and writes them. Each sample is read in place.
    fn write(&self, into: &mut RecordingWriter<File>, sequence: u64) -> Result<(), RecordingError> {
        loop {
            let sample = self.reader.receive().map_err(|error| self.lost(&error.to_string()))?;
            let Some(sample) = sample else {
                return Err(self.lost(&format!("sample {sequence} did not arrive")));
            };
            into.sample(&self.service, sample.header(), sample.values())?;
            if sample.header().sequence >= sequence {
                return Ok(());
            }
        }
    }
}

/// Carries out the notes until the last one, and publishes the progress. After a failure all
/// further notes are dropped, so that no other thread waits forever.
pub(super) fn write_all(
    writer: RecordingWriter<File>,
    batches: &Receiver<Vec<Job>>,
    (progress, news): &(Mutex<Progress>, Condvar),
) {
    let _guard = OnPanic(progress, news);
    let mut writing = Writing { writer: Some(writer), topics: Vec::new() };
    while let Ok(batch) = batches.recv() {
        for job in batch {
            let ends = matches!(job, Job::IterationEnds);
            let closes = matches!(job, Job::CloseAll);
            let last = matches!(job, Job::Finish);
            let outcome = writing.carry_out(job);
            let mut progress = lock(progress);
            progress.done += u64::from(ends);
            progress.closed |= closes;
            if let Err(error) = &outcome {
                progress.failed.get_or_insert_with(|| error.to_string());
            }
            drop(progress);
            // The failure is published first: unsubscribing makes the next sender on a topic fail.
            if outcome.is_err() {
                writing.topics.clear();
                writing.writer = None;
            }
            if ends || closes || outcome.is_err() {
                news.notify_all();
            }
            if last {
                return;
            }
        }
    }
}

/// Publishes a panic of the thread, so that no other thread waits for it.
struct OnPanic<'a>(&'a Mutex<Progress>, &'a Condvar);

impl Drop for OnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let why = || "the writing thread has panicked".to_owned();
            lock(self.0).failed.get_or_insert_with(why);
            self.1.notify_all();
        }
    }
}

/// The file, until writing fails, and the recorded topics.
struct Writing {
    writer: Option<RecordingWriter<File>>,
    topics: Vec<Listener>,
}

impl Writing {
    fn carry_out(&mut self, job: Job) -> Result<(), RecordingError> {
        let Self { writer: Some(writer), topics } = self else { return Ok(()) };
        match job {
            Job::Listen(listener) => topics.push(listener),
            Job::Connect => topics.iter().try_for_each(Listener::connect)?,
            Job::Event(event) => writer.event(&event)?,
            Job::Sample { topic, sequence } => topics[topic].write(writer, sequence)?,
            Job::State { role, bytes } => writer.state(&role, &bytes)?,
            Job::IterationEnds => {}
            Job::CloseAll => topics.clear(),
            Job::Finish => {
                if let Some(writer) = self.writer.take() {
                    writer.finish()?.sync_all()?;
                }
            }
        }
        Ok(())
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
