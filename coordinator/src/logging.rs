//! Logs: `log.jsonl` in the result directory, and warnings on standard error.
//!
//! `log.jsonl` holds one JSON object a line: every event, everything the participants write, and
//! for every span its busy and idle time when it closes, so that a profiler can be fed from it. The
//! result directory is known only when the case has been read; what is logged before is kept and
//! written then. `RUST_LOG` chooses what is logged to both; `--log LEVEL` what reaches the screen.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::fmt::format::FmtSpan;
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;
use tracing_subscriber::{EnvFilter, Layer as _};

/// Where `log.jsonl` goes: memory first, the file once there is one.
#[derive(Clone, Debug)]
pub struct LogFile(Arc<Mutex<Sink>>);

#[derive(Debug)]
enum Sink {
    Memory(Vec<u8>),
    File(File),
}

impl LogFile {
    /// Sets up logging for the whole process.
    #[must_use]
    pub fn install(level: Option<&str>) -> Self {
        let log = Self(Arc::new(Mutex::new(Sink::Memory(Vec::new()))));
        let wanted = |default: &str| {
            EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(default))
        };
        let file = tracing_subscriber::fmt::layer()
            .json()
            .with_span_events(FmtSpan::CLOSE)
            .with_writer(log.clone())
            .with_filter(wanted("info"));
        let screen = tracing_subscriber::fmt::layer()
            .with_writer(io::stderr)
            .without_time()
            .with_target(false)
            .with_filter(level.map_or_else(|| wanted("warn"), EnvFilter::new));
        // A second call in one process, as in tests, keeps the first set-up.
        let _ = tracing_subscriber::registry().with(file).with(screen).try_init();
        log
    }

    /// Sends everything, also what was logged before, to this file.
    pub fn write_to(&self, path: &Path) -> io::Result<()> {
        let mut sink = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut file = File::create(path)?;
        if let Sink::Memory(kept) = &*sink {
            file.write_all(kept)?;
        }
        *sink = Sink::File(file);
        Ok(())
    }
}

impl Write for LogFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Sink::Memory(kept) => kept.write(bytes),
            Sink::File(file) => file.write(bytes),
        }
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
