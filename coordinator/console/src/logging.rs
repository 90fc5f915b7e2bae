//! Logs: `log.jsonl` in the result directory, and warnings on standard error.
//!
//! `log.jsonl` holds one JSON object per line: every event, every line that a participant writes,
//! and the busy and idle time of every span for a profiler. Messages are kept in memory until the
//! case has been read and its result directory is known. `RUST_LOG` selects the events of both, but
//! the file has at least `info`; `--log LEVEL` selects the messages on the screen.

use crate::colour;
use indicatif::ProgressBar;
use proto::logging::{ignored, wanted};
use run::warnings::Warning;
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tracing_subscriber::Layer as _;
use tracing_subscriber::filter::{FilterExt as _, LevelFilter, Targets};
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::fmt::format::FmtSpan;
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

/// Least severity of messages on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Level {
    /// Failures that end a run.
    Error,
    /// Probable mistakes.
    Warn,
    /// Progress of a run.
    Info,
    /// Every window.
    Debug,
    /// Every message.
    Trace,
}

impl Level {
    fn filter(self) -> Targets {
        Targets::new().with_default(match self {
            Self::Error => LevelFilter::ERROR,
            Self::Warn => LevelFilter::WARN,
            Self::Info => LevelFilter::INFO,
            Self::Debug => LevelFilter::DEBUG,
            Self::Trace => LevelFilter::TRACE,
        })
    }
}

/// The logging of the process.
#[derive(Clone, Debug)]
pub struct Logging {
    file: LogFile,
    /// Name of the file in messages, once there is one.
    path: Arc<Mutex<Option<PathBuf>>>,
    screen: Screen,
}

impl Logging {
    /// Sets up logging for the whole process; without a level, `RUST_LOG` or warnings.
    #[must_use]
    pub fn install(level: Option<Level>) -> Self {
        let file = LogFile(Arc::new(Mutex::new(Sink::default())));
        let log = Self { file, path: Arc::default(), screen: Screen::default() };
        let file = tracing_subscriber::fmt::layer()
            .json()
            .with_ansi(false)
            .with_span_events(FmtSpan::CLOSE)
            .with_writer(log.file.clone())
            // Errors of writing are reported once, at the end.
            .log_internal_errors(false)
            // Messages of a run are part of its results.
            .with_filter(wanted(LevelFilter::INFO).or(LevelFilter::INFO));
        let screen = tracing_subscriber::fmt::layer()
            .with_ansi(colour::on(&io::stderr()))
            .with_writer(log.screen.clone())
            .without_time()
            .log_internal_errors(false)
            .with_target(false)
            .with_filter(level.map_or_else(|| wanted(LevelFilter::WARN), Level::filter));
        // A second call in one process, as in tests, keeps the first set-up.
        let _ = tracing_subscriber::registry().with(file).with(screen).try_init();
        if let Some(reason) = ignored() {
            tracing::warn!("{reason}");
        }
        log
    }

    /// Sends everything, also what was logged before, to a file; `shown` is its name in messages.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_to(&self, mut file: File, shown: PathBuf) -> io::Result<()> {
        let mut sink = self.file.sink();
        if let Sink::Memory(kept) = &*sink {
            file.write_all(kept)?;
        }
        let bytes = file.metadata()?.len();
        *sink = Sink::File { file, bytes };
        *self.path.lock().unwrap_or_else(PoisonError::into_inner) = Some(shown);
        Ok(())
    }

    /// Returns the name of the log file in messages, once there is one.
    #[must_use]
    pub fn path(&self) -> Option<PathBuf> {
        self.path.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the first error of writing to the file.
    #[must_use]
    pub fn failure(&self) -> Option<io::Error> {
        match &mut *self.file.sink() {
            Sink::Failed(error) => error.take(),
            Sink::Memory(_) | Sink::File { .. } => None,
        }
    }

    /// Releases the file. Later messages are kept for the next one.
    pub fn release(&self) {
        *self.file.sink() = Sink::default();
        *self.path.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// Makes the bar step aside for messages on the screen.
    pub fn share_screen(&self, bar: Option<&ProgressBar>) {
        *self.screen.0.lock().unwrap_or_else(PoisonError::into_inner) = bar.cloned();
    }
}

/// Target of `log.jsonl`: memory first, then the file.
#[derive(Clone, Debug)]
struct LogFile(Arc<Mutex<Sink>>);

#[derive(Debug)]
enum Sink {
    Memory(Vec<u8>),
    File {
        file: File,
        /// Length of the file.
        bytes: u64,
    },
    /// Closed; later messages are dropped.
    Failed(Option<io::Error>),
}

impl Default for Sink {
    fn default() -> Self {
        Self::Memory(Vec::new())
    }
}

impl Sink {
    /// Writes an event. The file always ends with a complete event.
    fn write(&mut self, event: &[u8]) {
        match self {
            Self::Memory(kept) => kept.extend_from_slice(event),
            Self::File { file, bytes } => match file.write_all(event) {
                Ok(()) => *bytes += event.len() as u64,
                Err(error) => {
                    let _ = file.set_len(*bytes);
                    *self = Self::Failed(Some(error));
                }
            },
            Self::Failed(_) => {}
        }
    }
}

impl LogFile {
    fn sink(&self) -> MutexGuard<'_, Sink> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Write for LogFile {
    fn write(&mut self, event: &[u8]) -> io::Result<usize> {
        self.sink().write(event);
        Ok(event.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<'a> MakeWriter<'a> for LogFile {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        self.clone()
    }
}

/// Standard error, with or without a bar in its last line.
#[derive(Clone, Debug, Default)]
struct Screen(Arc<Mutex<Option<ProgressBar>>>);

impl Write for Screen {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let bar = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        match bar {
            Some(bar) => bar.suspend(|| io::stderr().write(bytes)),
            None => io::stderr().write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}

impl<'a> MakeWriter<'a> for Screen {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        self.clone()
    }
}

/// Writes the warnings of a plan to the log, before anything of it runs.
pub fn log_warnings(warnings: &[Warning]) {
    for warning in warnings {
        tracing::warn!("{warning}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_goes_into_the_file_and_a_full_one_is_reported() {
        let log = Logging {
            file: LogFile(Arc::new(Mutex::new(Sink::default()))),
            path: Arc::default(),
            screen: Screen::default(),
        };
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("log");
        log.file.clone().write_all(b"before\n").unwrap();
        log.write_to(File::create(&path).unwrap(), path.clone()).unwrap();
        assert_eq!(log.path(), Some(path.clone()));
        log.file.clone().write_all(b"after\n").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"before\nafter\n");
        assert!(log.failure().is_none());
        log.release();
        let full = File::options().write(true).open("/dev/full").unwrap();
        log.write_to(full, PathBuf::from("/dev/full")).unwrap();
        for _ in 0..2 {
            log.file.clone().write_all(b"lost\n").unwrap();
        }
        assert_eq!(log.failure().unwrap().raw_os_error(), Some(28));
        assert!(log.failure().is_none(), "it is reported once");
    }
}
