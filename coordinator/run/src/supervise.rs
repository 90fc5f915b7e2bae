//! Starting, watching and ending the participants' processes, on a tokio thread of its own.
//!
//! Every participant is its own process group, so that Ctrl-C in a terminal reaches the
//! coordinator alone, which then ends everything in order, and so that what a participant starts
//! ends with it ([`crate::processes`]). Output goes into the log line by line. An exit is known within milliseconds.

mod words;

use crate::processes::Process;
use crate::programs::Program;
use rustix::process::{Pid, Signal, kill_process_group};
use std::io;
use std::path::Path;
use std::process::{ExitStatus, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::process::Command;
use tokio::sync::oneshot;
use words::{Words, relay};

/// A participant's process as last seen.
#[derive(Clone, Debug)]
pub struct Exit {
    /// Role of the participant.
    pub role: String,
    /// How it ended.
    pub status: ExitStatus,
    /// The last line it wrote, if any.
    pub last_words: Option<String>,
}

/// Shared between the supervising thread and the coupling loop.
#[derive(Debug, Default)]
struct Observations {
    /// Raised by every exit, so that the coupling loop looks only when there is news.
    exits_seen: AtomicUsize,
    exits: Mutex<Vec<Exit>>,
    processes: Mutex<Vec<Pid>>,
}

/// A process to start.
#[derive(Clone, Debug)]
pub struct Launch {
    /// Role to play.
    pub role: String,
    /// What to start.
    pub program: Program,
}

/// The participants' processes. Dropping it ends them all.
#[derive(Debug)]
pub struct Supervisor {
    seen: Arc<Observations>,
    quit: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
    started: usize,
}

impl Supervisor {
    /// Starts all processes for the run with this folder.
    pub fn start(launches: &[Launch], run_folder: &Path) -> Result<Self, (String, io::Error)> {
        let seen = Arc::new(Observations::default());
        let (quit, quitting) = oneshot::channel();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(|e| ("coordinator".to_owned(), e))?;
        {
            let _inside = runtime.enter();
            for launch in launches {
                start_one(launch, run_folder, &seen).map_err(|e| (launch.role.clone(), e))?;
            }
        }
        let thread = std::thread::Builder::new()
            .name("supervise".to_owned())
            .spawn(move || {
                // The runtime drives the tasks spawned above until we are asked to quit.
                let _ = runtime.block_on(quitting);
            })
            .map_err(|e| ("coordinator".to_owned(), e))?;
        Ok(Self { seen, quit: Some(quit), thread: Some(thread), started: launches.len() })
    }

    /// The participants that have ended so far; cheap while there is none.
    #[must_use]
    pub fn exits(&self) -> Vec<Exit> {
        if self.seen.exits_seen.load(Ordering::Acquire) == 0 {
            return Vec::new();
        }
        self.seen.exits.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn all_ended(&self) -> bool {
        self.seen.exits_seen.load(Ordering::Acquire) >= self.started
    }

    /// Waits until every process has ended by itself; false when the time is up.
    #[must_use]
    pub fn wait_for_exits(&self, patience: Duration) -> bool {
        let deadline = Instant::now() + patience;
        while !self.all_ended() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_micros(500));
        }
        self.all_ended()
    }

    /// Ends what still runs: SIGTERM, and SIGKILL for what does not follow.
    pub fn end_all(&self) {
        for (signal, patience) in [(Signal::TERM, 1), (Signal::KILL, 10)] {
            if self.all_ended() {
                return;
            }
            let processes = self.seen.processes.lock().unwrap_or_else(PoisonError::into_inner);
            for process in processes.iter() {
                let _ = kill_process_group(*process, signal);
            }
            drop(processes);
            let _ = self.wait_for_exits(Duration::from_secs(patience));
        }
    }
}

impl Drop for Supervisor {
    fn drop(&mut self) {
        self.end_all();
        if let Some(quit) = self.quit.take() {
            let _ = quit.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn start_one(launch: &Launch, run_folder: &Path, seen: &Arc<Observations>) -> io::Result<()> {
    let mut command = Command::new(&launch.program.path);
    command
        .args(&launch.program.arguments)
        .arg("--join")
        .arg(run_folder)
        .args(["--role", &launch.role])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut process = Process::start(&mut command)?;
    let pid = process.group.id();
    tracing::info!(role = launch.role, pid = pid.as_raw_nonzero().get(), "participant started");
    seen.processes.lock().unwrap_or_else(PoisonError::into_inner).push(pid);
    let words = Arc::new(Mutex::new(Words::new(&launch.role)));
    let out = process.child.stdout.take().map(|pipe| relay(pipe, &words));
    let err = process.child.stderr.take().map(|pipe| relay(pipe, &words));
    let role = launch.role.clone();
    tokio::spawn(watch(process, role, [out, err], words, Arc::clone(seen)));
    Ok(())
}

async fn watch(
    mut process: Process,
    role: String,
    relays: [Option<tokio::task::JoinHandle<()>>; 2],
    words: Arc<Mutex<Words>>,
    seen: Arc<Observations>,
) {
    let Ok(status) = process.child.wait().await else { return };
    // What it started ends with it.
    drop(process);
    for relay in relays.into_iter().flatten() {
        // A grandchild may hold the pipe open; its words are not worth waiting for.
        let _ = tokio::time::timeout(Duration::from_millis(50), relay).await;
    }
    let last_words = words.lock().unwrap_or_else(PoisonError::into_inner).end();
    tracing::info!(role, %status, "participant ended");
    let mut exits = seen.exits.lock().unwrap_or_else(PoisonError::into_inner);
    exits.push(Exit { role, status, last_words });
    seen.exits_seen.store(exits.len(), Ordering::Release);
}
