//! The participant's heart: a thread that beats while the model computes, and that ends the
//! process when the coordinator is dead.

use crate::command_ports::ProgressReports;
use crate::progress::Progress;
use crate::run_dir::{CoordinatorWatch, RunDir};
use crate::transport::{Beat, Ringer, TransportError};
use std::io::{self, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// From one beat, and one look at the coordinator, to the next.
const INTERVAL: Duration = Duration::from_millis(50);

/// What the participant is doing, for its heartbeat.
#[derive(Clone, Debug, Default)]
pub(super) struct Activity(Arc<AtomicU64>);

/// The number that stands for work on a command.
const BUSY: u64 = u64::MAX;

impl Activity {
    /// A command is being worked on.
    pub(super) fn busy(&self) {
        self.0.store(BUSY, Ordering::Release);
    }

    /// The command with this number has been dealt with, and its reply, if any, sent.
    pub(super) fn idle_after(&self, command: u64) {
        self.0.store(command, Ordering::Release);
    }

    fn beat(&self) -> Beat {
        match self.0.load(Ordering::Acquire) {
            BUSY => Beat::Busy,
            command => Beat::idle_after(command),
        }
    }
}

/// What a beat says, and where.
pub(super) struct Voice {
    /// Index of the participant among the roles of the run.
    pub(super) index: usize,
    pub(super) ringer: Ringer,
    pub(super) activity: Activity,
    pub(super) progress: Progress,
    pub(super) reports: ProgressReports,
}

impl Voice {
    fn beat(&mut self) -> Result<(), TransportError> {
        // Before the coordinator is woken up. A beat counts without a report.
        if let Err(error) = self.reports.send(self.progress.newest()) {
            tracing::debug!(%error, "progress does not reach the coordinator");
        }
        self.ringer.beat(self.index, self.activity.beat())
    }
}

/// Beats until dropped.
pub(super) struct Pulse {
    stop: Option<SyncSender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Pulse {
    pub(super) fn start(
        mut voice: Voice,
        coordinator: CoordinatorWatch,
        run: Arc<Mutex<Option<RunDir>>>,
    ) -> io::Result<Self> {
        let (stop, stopped) = sync_channel(0);
        let thread = std::thread::Builder::new().name("pulse".to_owned()).spawn(move || {
            beat(&mut voice, &coordinator, &run, &stopped);
        })?;
        Ok(Self { stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Pulse {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn beat(
    voice: &mut Voice,
    coordinator: &CoordinatorWatch,
    run: &Mutex<Option<RunDir>>,
    stopped: &Receiver<()>,
) {
    while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
        if !coordinator.is_alive() {
            let _ = writeln!(io::stderr(), "error: the coordinator has ended; this run is over");
            // The model may be deep in a solve: the process ends here, and the run's folder and
            // shared memory are left in order by dropping the membership.
            drop(run.lock().map(|mut run| run.take()));
            // No handler for the end of the process runs: other threads of a program in another
            // language are still at work.
            // SAFETY: ends the process at once.
            unsafe { libc::_exit(1) };
        }
        if let Err(error) = voice.beat() {
            tracing::warn!(%error, "the heartbeat does not reach the coordinator");
        }
    }
}
