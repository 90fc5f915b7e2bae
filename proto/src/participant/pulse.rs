//! Heartbeat of the participant: a thread that beats while the model computes, and that ends the
//! participant when the coordinator dies.

use super::host::Host;
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

/// Interval between heartbeats, each with a check of the coordinator.
const INTERVAL: Duration = Duration::from_millis(50);

/// Activity of the participant, as reported by the heartbeat.
#[derive(Clone, Debug, Default)]
pub(super) struct Activity(Arc<AtomicU64>);

/// Value of [`Activity`] during a command.
const BUSY: u64 = u64::MAX;

impl Activity {
    /// Marks a command as in progress.
    pub(super) fn busy(&self) {
        self.0.store(BUSY, Ordering::Release);
    }

    /// Marks the command with this number as completed, with its reply, if any, sent.
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

/// Content and destination of heartbeats.
pub(super) struct HeartbeatSender {
    /// Index of the participant among the roles of the run.
    pub(super) index: usize,
    pub(super) ringer: Ringer,
    pub(super) activity: Activity,
    pub(super) progress: Progress,
    pub(super) reports: ProgressReports,
}

impl HeartbeatSender {
    fn beat(&mut self) -> Result<(), TransportError> {
        // Sent before the coordinator wakes up. A heartbeat counts even if the report fails.
        if let Err(error) = self.reports.send(self.progress.newest()) {
            tracing::debug!(%error, "progress does not reach the coordinator");
        }
        self.ringer.beat(self.index, self.activity.beat())
    }
}

/// Running heartbeat; stops when dropped.
pub(super) struct Heartbeat {
    stop: Option<SyncSender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Heartbeat {
    pub(super) fn start(
        mut voice: HeartbeatSender,
        coordinator: CoordinatorWatch,
        run: Arc<Mutex<Option<RunDir>>>,
        host: Host,
    ) -> io::Result<Self> {
        let (stop, stopped) = sync_channel(0);
        let thread = std::thread::Builder::new().name("pulse".to_owned()).spawn(move || {
            beat(&mut voice, &coordinator, (&run, &host), &stopped);
        })?;
        Ok(Self { stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Heartbeat {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn beat(
    voice: &mut HeartbeatSender,
    coordinator: &CoordinatorWatch,
    (run, host): (&Mutex<Option<RunDir>>, &Host),
    stopped: &Receiver<()>,
) {
    while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
        if !coordinator.is_alive() {
            if let Host::Thread(stop) = host {
                stop.ask();
                return;
            }
            let _ = writeln!(io::stderr(), "error: the coordinator has ended; this run is over");
            // The model may be deep in a solve, so the process ends here. Dropping the membership
            // cleans up the run's folder and shared memory.
            drop(run.lock().map(|mut run| run.take()));
            // Exit handlers must not run, because other threads of a host program may still be
            // working.
            // SAFETY: ends the process at once.
            unsafe { libc::_exit(1) };
        }
        if let Err(error) = voice.beat() {
            tracing::warn!(%error, "the heartbeat does not reach the coordinator");
        }
    }
}
