//! Starting, watching and ending the participants' processes, on a tokio thread of its own.
//!
//! Every participant is its own process group, so that Ctrl-C in a terminal reaches the
//! coordinator alone, which then ends everything in order, and so that what a participant starts
//! ends with it ([`crate::processes`]). Output goes into the log line by line. An exit is known within milliseconds.

mod words;

use crate::processes::Process;
use crate::programs::Program;
use rustix::process::{Pid, Signal, kill_process_group};
use std::fmt;
use std::io;
use std::os::unix::process::ExitStatusExt;
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
    /// Exit status; absent if the operating system did not report it.
    pub status: Option<ExitStatus>,
    /// The last line it wrote, if any.
    pub last_words: Option<String>,
}

impl Exit {
    /// Whether the process ended with exit code 0.
    #[must_use]
    pub fn is_success(&self) -> bool {
        self.status.is_some_and(|status| status.success())
    }
}

/// "ended with exit code 3, saying: out of memory", to follow the name of the process.
impl fmt::Display for Exit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let status = self.status;
        match (status.and_then(|status| status.signal()), status.and_then(|status| status.code())) {
            (Some(7), _) => f.write_str(
                "was killed by signal 7 (/dev/shm is full, or the run's files there were truncated)",
            ),
            (Some(signal), _) => write!(f, "was killed by signal {signal}"),
            (_, Some(code)) => write!(f, "ended with exit code {code}"),
            (None, None) => f.write_str("ended; its exit status could not be read"),
        }?;
        self.last_words.as_ref().map_or(Ok(()), |words| write!(f, ", saying: {words}"))
    }
}

/// Shared between the supervising thread and the coupling loop.
#[derive(Debug, Default)]
struct Observations {
    /// Raised by every exit, so that the coupling loop looks only when there is news.
    exits_seen: AtomicUsize,
    exits: Mutex<Vec<Exit>>,
    processes: Mutex<Vec<Pid>>,
}

impl Observations {
    /// Records that a process has ended, also if its exit status could not be read: the run must not
    /// wait for it any longer.
    fn record(&self, role: String, waited: io::Result<ExitStatus>, last_words: Option<String>) {
        let status = match waited {
            Ok(status) => {
                tracing::info!(role, %status, "participant ended");
                Some(status)
            }
            Err(error) => {
                tracing::warn!(role, %error, "the exit status of a participant could not be read");
                None
            }
        };
        let mut exits = self.exits.lock().unwrap_or_else(PoisonError::into_inner);
        exits.push(Exit { role, status, last_words });
        self.exits_seen.store(exits.len(), Ordering::Release);
    }
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
    let waited = process.child.wait().await;
    // What it started ends with it.
    drop(process);
    for relay in relays.into_iter().flatten() {
        // A grandchild may hold the pipe open; its words are not worth waiting for.
        let _ = tokio::time::timeout(Duration::from_millis(50), relay).await;
    }
    let last_words = words.lock().unwrap_or_else(PoisonError::into_inner).end();
    seen.record(role, waited, last_words);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exit_whose_status_cannot_be_read_is_recorded_all_the_same() {
        let seen = Observations::default();
        let said = Some("goodbye".to_owned());
        seen.record("mech".to_owned(), Err(io::Error::other("no child process")), said);
        assert_eq!(seen.exits_seen.load(Ordering::Acquire), 1);
        let exits = seen.exits.lock().unwrap();
        assert!(!exits[0].is_success());
        let told = "ended; its exit status could not be read, saying: goodbye";
        assert_eq!(exits[0].to_string(), told);
    }

    #[test]
    fn an_exit_is_told_in_words() {
        let exit = |raw: i32, last_words: Option<&str>| Exit {
            role: "mech".to_owned(),
            status: Some(ExitStatus::from_raw(raw)),
            last_words: last_words.map(str::to_owned),
        };
        assert_eq!(exit(9, None).to_string(), "was killed by signal 9");
        // Quoted words stay as they were said.
        let told = "ended with exit code 3, saying: the mesh was ended";
        assert_eq!(exit(3 << 8, Some("the mesh was ended")).to_string(), told);
    }
}
