//! Connection to a driven coordinator: starts the process from the resources of an FMU, sends one
//! request a line and ends the process.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufRead, BufReader};
use std::os::fd::{AsRawFd, OwnedFd};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// Version of the protocol of `coordinator drive`.
const VERSION: u32 = 1;
/// Grace period between asking the coordinator to end and killing the process.
const LEAVE: Duration = Duration::from_secs(20);

/// Request to the coordinator; see `coordinator drive`.
#[derive(Debug, Serialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
enum Request<'a> {
    Step { set: &'a BTreeMap<&'a str, f64>, end: f64 },
    Save,
    Restore { state: u64 },
    Free { state: u64 },
    Reset,
}

/// Fields of every possible answer.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Answer {
    ready: Option<u32>,
    figures: Option<serde_json::Value>,
    state: Option<u64>,
    error: Option<String>,
    kind: String,
}

impl Answer {
    /// Checks for the first answer of a run, from a coordinator of our protocol version.
    fn is_ready(&self) -> Result<(), Fault> {
        match self.ready {
            Some(VERSION) => Ok(()),
            other => Err(ended(format!(
                "the coordinator of this FMU speaks version {other:?}, its library {VERSION}"
            ))),
        }
    }
}

/// Failed request.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Error message of the coordinator.
    pub error: String,
    /// True if the coordinator accepts no further requests.
    pub ended: bool,
}

/// Running coordinator process.
#[derive(Debug)]
pub struct Coordinator {
    process: Child,
    /// Socket to the standard input of the coordinator; closing it ends the coordinator.
    to: Option<UnixStream>,
    from: BufReader<ChildStdout>,
    outputs: usize,
}

fn ended(error: String) -> Fault {
    Fault { error, ended: true }
}

impl Coordinator {
    /// Starts a coordinator in a folder of resources and waits until it accepts a request for the
    /// first window. `options` go to `coordinator drive`, `programs` are the executables in the
    /// folder, and `outputs` is the number of outputs of a window.
    ///
    /// # Errors
    /// Fails if the process does not start or refuses its case.
    pub fn start(
        resources: &Path,
        (options, programs): (&[String], &[String]),
        outputs: usize,
    ) -> Result<Self, Fault> {
        for program in programs {
            make_executable(&resources.join(program)).map_err(ended)?;
        }
        let program = resources.join("coordinator");
        let failed = |error: io::Error| ended(format!("{}: {error}", program.display()));
        let (ours, theirs) = UnixStream::pair().map_err(failed)?;
        let mut command = Command::new(&program);
        command
            .args(["--quiet", "drive", "case.toml"])
            .args(options)
            .current_dir(resources)
            .stdin(Stdio::from(OwnedFd::from(theirs)))
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .process_group(0);
        let mut process = command.spawn().map_err(failed)?;
        // The command holds the child's end of the socket, which must be closed in this process.
        drop(command);
        let from = process.stdout.take().expect("its standard output is a pipe");
        let mut this = Self { process, to: Some(ours), from: BufReader::new(from), outputs };
        let first = this.hear()?;
        first.is_ready().map(|()| this)
    }

    /// Restarts the run with the same participants and waits until the coordinator accepts a
    /// request for the first window.
    ///
    /// # Errors
    /// Fails if the run does not restart or has ended.
    pub fn reset(&mut self) -> Result<(), Fault> {
        self.ask(&Request::Reset)?.is_ready()
    }

    /// Solves the window up to the time `end` [s] with the values `set` of the live keys. Returns
    /// the outputs; NaN marks an output without a value.
    ///
    /// # Errors
    /// Fails if the window has no solution or the run has ended.
    pub fn step(&mut self, set: &BTreeMap<&str, f64>, end: f64) -> Result<Vec<f64>, Fault> {
        let answer = self.ask(&Request::Step { set, end })?;
        let figures = answer.figures.as_ref().and_then(serde_json::Value::as_array);
        let figures: Vec<f64> = figures
            .map(|all| all.iter().map(|one| one.as_f64().unwrap_or(f64::NAN)).collect())
            .unwrap_or_default();
        if figures.len() != self.outputs {
            let (found, expected) = (figures.len(), self.outputs);
            return Err(ended(format!(
                "the coordinator returned {found} figures, the FMU has {expected}"
            )));
        }
        Ok(figures)
    }

    /// Saves the state after the last window and returns the number of the state.
    ///
    /// # Errors
    /// Fails if the coordinator cannot save the state or the run has ended.
    pub fn save(&mut self) -> Result<u64, Fault> {
        let answer = self.ask(&Request::Save)?;
        answer
            .state
            .ok_or_else(|| ended("the coordinator returned a state without a number".to_owned()))
    }

    /// Restores a saved state.
    ///
    /// # Errors
    /// Fails if no state has this number or the run has ended.
    pub fn restore(&mut self, state: u64) -> Result<(), Fault> {
        self.ask(&Request::Restore { state }).map(drop)
    }

    /// Frees a saved state.
    ///
    /// # Errors
    /// Fails if no state has this number or the run has ended.
    pub fn free(&mut self, state: u64) -> Result<(), Fault> {
        self.ask(&Request::Free { state }).map(drop)
    }

    fn ask(&mut self, request: &Request<'_>) -> Result<Answer, Fault> {
        let line = serde_json::to_string(request).expect("a request is plain data") + "\n";
        let to = self.to.as_ref().expect("it is closed only when this is dropped");
        let mut rest = line.as_bytes();
        while !rest.is_empty() {
            match send(to, rest) {
                Ok(sent) => rest = &rest[sent..],
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                // `hear` reads the coordinator's last message.
                Err(_) => break,
            }
        }
        self.hear()
    }

    fn hear(&mut self) -> Result<Answer, Fault> {
        let mut line = String::new();
        let read = self.from.read_line(&mut line);
        if !matches!(read, Ok(1..)) {
            return Err(ended("the coordinator of this FMU has ended".to_owned()));
        }
        let answer: Answer = serde_json::from_str(&line)
            .map_err(|error| ended(format!("the coordinator says {line:?}: {error}")))?;
        match answer.error {
            Some(error) => Err(Fault { error, ended: answer.kind == "ended" }),
            None => Ok(answer),
        }
    }
}

impl Drop for Coordinator {
    /// Closes the input of the coordinator, which ends it and all processes it started.
    fn drop(&mut self) {
        self.to = None;
        let until = Instant::now() + LEAVE;
        // An error means that the host has already waited for the process.
        while matches!(self.process.try_wait(), Ok(None)) {
            if Instant::now() >= until {
                let _ = self.process.kill();
                let _ = self.process.wait();
                return;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

/// Writes to a socket. A closed connection raises no signal in the host.
fn send(to: &UnixStream, bytes: &[u8]) -> io::Result<usize> {
    let (first, count) = (bytes.as_ptr().cast(), bytes.len());
    // SAFETY: the bytes live until the call returns.
    let sent = unsafe { libc::send(to.as_raw_fd(), first, count, libc::MSG_NOSIGNAL) };
    usize::try_from(sent).map_err(|_| io::Error::last_os_error())
}

/// Restores the executable bit, which some tools drop when they unpack an FMU.
fn make_executable(program: &Path) -> Result<(), String> {
    let named = |error: io::Error| format!("{}: {error}", program.display());
    let mode = fs::metadata(program).map_err(named)?.permissions().mode();
    if mode & 0o100 == 0 {
        fs::set_permissions(program, fs::Permissions::from_mode(mode | 0o755)).map_err(named)?;
    }
    Ok(())
}
