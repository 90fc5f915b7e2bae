//! Starting, watching and ending of participants: processes, watched by a tokio runtime on a
//! separate thread, and threads of linked solvers.
//!
//! Every participant has its own process group. Thus Ctrl-C in a terminal reaches only the
//! coordinator, which then ends the run in order, and all processes that a participant starts end
//! with it ([`crate::processes`]). Output goes into the log line by line. An exit is noticed within
//! milliseconds.

mod words;

use crate::linked::LinkedSolver;
use crate::processes::Process;
use crate::program::Program;
use proto::participant::Stop;
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
use words::{ProcessOutput, relay};

/// End of a participant's process.
#[derive(Clone, Debug)]
pub struct Exit {
    /// Role of the participant.
    pub role: String,
    /// Exit status; absent if the operating system did not report it.
    pub status: Option<ExitStatus>,
    /// Last line that the process wrote, if any.
    pub last_words: Option<String>,
}

impl Exit {
    /// Returns whether the process ended with exit code 0.
    #[must_use]
    pub fn is_success(&self) -> bool {
        self.status.is_some_and(|status| status.success())
    }
}

/// Formats the exit like "ended with exit code 3, saying: out of memory", to follow the name of the
/// process.
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

/// State shared between the supervising thread and the coupling loop.
#[derive(Debug, Default)]
struct Observations {
    /// Number of exits: the coupling loop takes the lock only if there are any.
    exits_seen: AtomicUsize,
    exits: Mutex<Vec<Exit>>,
    processes: Mutex<Vec<Pid>>,
}

impl Observations {
    /// Records that a process has ended, even if its exit status could not be read, because the run
    /// must not wait for it any longer.
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
    /// Program to start.
    pub program: Program,
}

/// Processes and threads of the participants. Dropping this ends the processes, and asks threads to
/// leave; a thread deep in a solve may end later.
#[derive(Debug)]
pub struct Supervisor {
    seen: Arc<Observations>,
    quit: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
    started: usize,
    /// Requests to linked solvers to leave.
    stops: Vec<Stop>,
}

impl Supervisor {
    /// Starts all processes for the run with this folder.
    pub fn start(launches: &[Launch], run_folder: &Path) -> Result<Self, (String, io::Error)> {
        let seen = Arc::new(Observations::default());
        let (quit, quitting) = oneshot::channel();
        let mut stops = Vec::new();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(|e| ("coordinator".to_owned(), e))?;
        {
            let _inside = runtime.enter();
            for launch in launches {
                let started = match &launch.program.linked {
                    Some(solver) => start_linked(&launch.role, solver, run_folder, &seen)
                        .map(|stop| stops.push(stop)),
                    None => start_one(launch, run_folder, &seen),
                };
                started.map_err(|e| (launch.role.clone(), e))?;
            }
        }
        let thread = std::thread::Builder::new()
            .name("supervise".to_owned())
            .spawn(move || {
                // The runtime drives the tasks spawned above until the supervisor is dropped.
                let _ = runtime.block_on(quitting);
            })
            .map_err(|e| ("coordinator".to_owned(), e))?;
        Ok(Self { seen, quit: Some(quit), thread: Some(thread), started: launches.len(), stops })
    }

    /// Returns the participants that have ended so far. Cheap while there are none.
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

    /// Waits until every process has ended by itself. Returns false after `patience`.
    #[must_use]
    pub fn wait_for_exits(&self, patience: Duration) -> bool {
        let deadline = Instant::now() + patience;
        while !self.all_ended() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_micros(500));
        }
        self.all_ended()
    }

    /// Ends all running processes: by SIGTERM, then by SIGKILL. Threads are asked to leave.
    pub fn end_all(&self) {
        self.stops.iter().for_each(Stop::ask);
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
    let words = Arc::new(Mutex::new(ProcessOutput::new(&launch.role)));
    let out = process.child.stdout.take().map(|pipe| relay(pipe, &words));
    let err = process.child.stderr.take().map(|pipe| relay(pipe, &words));
    let role = launch.role.clone();
    tokio::spawn(watch(process, role, [out, err], words, Arc::clone(seen)));
    Ok(())
}

/// Starts a thread on which a linked solver takes part.
fn start_linked(
    role: &str,
    solver: &LinkedSolver,
    run_folder: &Path,
    seen: &Arc<Observations>,
) -> io::Result<Stop> {
    let (role, solver, folder) = (role.to_owned(), solver.clone(), run_folder.to_owned());
    let (seen, stop) = (Arc::clone(seen), Stop::default());
    let wanted = stop.clone();
    std::thread::Builder::new().name(role.clone()).spawn(move || {
        let (code, last_words) = solver.take_part(&folder, &role, wanted);
        let status = ExitStatus::from_raw(i32::from(code) << 8);
        seen.record(role, Ok(status), last_words);
    })?;
    Ok(stop)
}

async fn watch(
    mut process: Process,
    role: String,
    relays: [Option<tokio::task::JoinHandle<()>>; 2],
    words: Arc<Mutex<ProcessOutput>>,
    seen: Arc<Observations>,
) {
    let waited = process.child.wait().await;
    // All processes that it started end with it.
    drop(process);
    for relay in relays.into_iter().flatten() {
        // A grandchild may hold the pipe open; its output is not worth a longer wait.
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
        // Quoted words stay unchanged.
        let told = "ended with exit code 3, saying: the mesh was ended";
        assert_eq!(exit(3 << 8, Some("the mesh was ended")).to_string(), told);
    }
}
