//! The coordinator that is driven: started from the resources of an FMU, asked line by line, ended.

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

/// Version of the language that is spoken here.
const VERSION: u32 = 1;
/// A coordinator that has been told to end, and has not by then, is ended.
const LEAVE: Duration = Duration::from_secs(20);

/// What is asked for; see `coordinator drive`.
#[derive(Debug, Serialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
enum Request<'a> {
    Step { set: &'a BTreeMap<&'a str, f64>, end: f64 },
    Save,
    Restore { state: u64 },
    Free { state: u64 },
    Reset,
}

/// All that may be answered.
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
    /// It is the first of a run, of a coordinator that speaks our version.
    fn is_ready(&self) -> Result<(), Fault> {
        match self.ready {
            Some(VERSION) => Ok(()),
            other => Err(ended(format!(
                "the coordinator of this FMU speaks version {other:?}, its library {VERSION}"
            ))),
        }
    }
}

/// Why something was not done.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// In the words of the coordinator.
    pub error: String,
    /// Nothing more can be asked of it.
    pub ended: bool,
}

/// A coordinator that is driven.
#[derive(Debug)]
pub struct Coordinator {
    process: Child,
    /// Closed to end it.
    to: Option<UnixStream>,
    from: BufReader<ChildStdout>,
    outputs: usize,
}

fn ended(error: String) -> Fault {
    Fault { error, ended: true }
}

impl Coordinator {
    /// Starts one in a folder of resources, with options of `drive` and the executables there, and waits until its
    /// first window can be asked for. A window gives so many outputs.
    ///
    /// # Errors
    /// It does not start, or refuses its case.
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
        // Its end of the socket would stay open here with the command.
        drop(command);
        let from = process.stdout.take().expect("its standard output is a pipe");
        let mut this = Self { process, to: Some(ours), from: BufReader::new(from), outputs };
        let first = this.hear()?;
        first.is_ready().map(|()| this)
    }

    /// Begins the run again, with the same participants, and waits until its first window can be asked
    /// for.
    ///
    /// # Errors
    /// It does not start, or the run has ended.
    pub fn reset(&mut self) -> Result<(), Fault> {
        self.ask(&Request::Reset)?.is_ready()
    }

    /// Solves the window up to a time [s] with these values of the live keys; the figures, NaN for
    /// those that there are not.
    ///
    /// # Errors
    /// The window has no answer, or the run has ended.
    pub fn step(&mut self, set: &BTreeMap<&str, f64>, end: f64) -> Result<Vec<f64>, Fault> {
        let answer = self.ask(&Request::Step { set, end })?;
        let figures = answer.figures.as_ref().and_then(serde_json::Value::as_array);
        let figures: Vec<f64> = figures
            .map(|all| all.iter().map(|one| one.as_f64().unwrap_or(f64::NAN)).collect())
            .unwrap_or_default();
        if figures.len() != self.outputs {
            let (found, expected) = (figures.len(), self.outputs);
            return Err(ended(format!("{found} figures came, the FMU has {expected}")));
        }
        Ok(figures)
    }

    /// Keeps the state after the last window; its number.
    ///
    /// # Errors
    /// It cannot be kept, or the run has ended.
    pub fn save(&mut self) -> Result<u64, Fault> {
        let answer = self.ask(&Request::Save)?;
        answer.state.ok_or_else(|| ended("a state without a number".to_owned()))
    }

    /// Returns to a state.
    ///
    /// # Errors
    /// There is none of this number, or the run has ended.
    pub fn restore(&mut self, state: u64) -> Result<(), Fault> {
        self.ask(&Request::Restore { state }).map(drop)
    }

    /// Forgets a state.
    ///
    /// # Errors
    /// There is none of this number, or the run has ended.
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
                // What it said before it ended is read below.
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
    /// The end of its input ends it; what it has started ends with it.
    fn drop(&mut self) {
        self.to = None;
        let until = Instant::now() + LEAVE;
        // An error says that the host has waited for it already.
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

/// Writes to a socket; one whose other end has gone raises no signal in the host.
fn send(to: &UnixStream, bytes: &[u8]) -> io::Result<usize> {
    let (first, count) = (bytes.as_ptr().cast(), bytes.len());
    // SAFETY: the bytes are there until the call returns.
    let sent = unsafe { libc::send(to.as_raw_fd(), first, count, libc::MSG_NOSIGNAL) };
    usize::try_from(sent).map_err(|_| io::Error::last_os_error())
}

/// Tools that unpack an FMU may lose the bits that make a file executable.
fn make_executable(program: &Path) -> Result<(), String> {
    let named = |error: io::Error| format!("{}: {error}", program.display());
    let mode = fs::metadata(program).map_err(named)?.permissions().mode();
    if mode & 0o100 == 0 {
        fs::set_permissions(program, fs::Permissions::from_mode(mode | 0o755)).map_err(named)?;
    }
    Ok(())
}
