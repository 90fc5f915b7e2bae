//! The participant's heart: a thread that beats while the model computes, and that ends the
//! process when the coordinator is dead.

use crate::run_dir::{CoordinatorWatch, RunDir};
use crate::transport::Ringer;
use std::io::{self, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// From one beat, and one look at the coordinator, to the next.
const INTERVAL: Duration = Duration::from_millis(50);

/// Beats until dropped.
pub(super) struct Pulse {
    stop: Option<SyncSender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Pulse {
    pub(super) fn start(
        ringer: Ringer,
        index: usize,
        coordinator: CoordinatorWatch,
        run: Arc<Mutex<Option<RunDir>>>,
    ) -> io::Result<Self> {
        let (stop, stopped) = sync_channel(0);
        let thread = std::thread::Builder::new()
            .name("pulse".to_owned())
            .spawn(move || beat(&ringer, index, &coordinator, &run, &stopped))?;
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
    ringer: &Ringer,
    index: usize,
    coordinator: &CoordinatorWatch,
    run: &Mutex<Option<RunDir>>,
    stopped: &Receiver<()>,
) {
    while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
        if !coordinator.is_alive() {
            let _ = writeln!(io::stderr(), "error: the coordinator is gone; this run is over");
            // The model may be deep in a solve: the process ends here, and the run's folder and
            // shared memory are left in order by dropping the membership.
            drop(run.lock().map(|mut run| run.take()));
            std::process::exit(1);
        }
        if let Err(error) = ringer.beat(index) {
            tracing::warn!(%error, "the coordinator does not hear the heartbeat");
        }
    }
}
