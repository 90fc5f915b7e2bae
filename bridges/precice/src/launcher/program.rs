//! The program of a user as a child process, and the connection to the library inside it.

use super::last_words::LastWords;
use crate::protocol::{self, Answer, Request, SOCKET};
use std::ffi::{OsStr, OsString};
use std::fmt;
use std::io;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Time between two checks whether the program has connected or ended.
const PAUSE: Duration = Duration::from_millis(2);
/// Time for the end of a program that has closed its connection.
const GRACE: Duration = Duration::from_secs(2);
/// Time for the end of a program after the simulation, in which it may write results.
const FAREWELL: Duration = Duration::from_secs(20);
/// Time for the end of a program that has been told why it is refused.
const PARTING: Duration = Duration::from_millis(500);
/// Longest reason of a program that is passed on [character].
const LONGEST_REASON: usize = 2000;
/// File names under which programs look for the library.
const LIBRARY_NAMES: [&str; 2] = ["libprecice.so", "libprecice.so.3"];
/// Environment variable with the number of threads of OpenMP and of libraries for linear algebra.
const THREADS: &str = "OMP_NUM_THREADS";
/// Environment variable with the folders of libraries.
const LIBRARY_PATH: &str = "LD_LIBRARY_PATH";

/// Reason why the program does not take part.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The program could not be started.
    #[error("`{program}` cannot be started: {error}")]
    Start {
        /// Name of the program.
        program: String,
        /// Reason.
        error: io::Error,
    },
    /// The socket or the folder of the library could not be made.
    #[error("{path}: {error}")]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Reason.
        error: io::Error,
    },
    /// The program has ended.
    #[error("the program has ended ({status}) {when}{}", words(.last_words))]
    Ended {
        /// Exit status.
        status: String,
        /// Stage of the simulation.
        when: &'static str,
        /// Last line that it wrote to its standard error.
        last_words: Option<String>,
    },
    /// The library refused a call of the program.
    #[error("the program made a call that was refused: {0}")]
    Call(String),
    /// The connection does not work.
    #[error("connection to the program: {0}")]
    Connection(#[from] io::Error),
    /// The program's request does not fit the stage.
    #[error("the program {0}")]
    Order(&'static str),
    /// The program's data do not fit its interface.
    #[error("{0}")]
    Data(String),
}

/// Returns the last words of a program as the end of a sentence.
fn words(last_words: &Option<String>) -> String {
    last_words.as_ref().map(|words| format!(", saying: {words}")).unwrap_or_default()
}

/// Command line and folder of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramCommand {
    /// Program and arguments.
    pub words: Vec<OsString>,
    /// Folder in which the program runs; absent: the folder of the launcher.
    pub directory: Option<PathBuf>,
}

/// A running program. Dropping it tells the program that the simulation has ended, and ends it.
#[derive(Debug)]
pub struct Program {
    child: Child,
    stream: UnixStream,
    buffer: Vec<u8>,
    /// True if the program waits for an answer.
    waits: bool,
    /// Time that the program has to end by itself, once the simulation is over.
    farewell: Duration,
    last_words: LastWords,
}

impl Program {
    /// Starts the program, which may compute on `threads` threads, and waits until it creates its
    /// participant. Socket and library are in `folder`.
    ///
    /// # Errors
    /// Fails if the program cannot be started, or ends before it has connected.
    pub fn start(
        command: &ProgramCommand,
        folder: &Path,
        threads: usize,
    ) -> Result<Self, ProgramError> {
        let socket = folder.join("socket");
        let at = |path: &Path| {
            let path = path.to_owned();
            move |error| ProgramError::File { path, error }
        };
        // A participant may be configured again, after an earlier configuration was refused.
        match std::fs::remove_dir_all(folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(at(folder)(error)),
            _ => std::fs::create_dir_all(folder).map_err(at(folder))?,
        }
        let libraries = offer_library(folder)?;
        let listener = UnixListener::bind(&socket).map_err(at(&socket))?;
        listener.set_nonblocking(true).map_err(at(&socket))?;
        let program = command.words.first().map(OsString::as_os_str).unwrap_or_default();
        let mut started = Command::new(program);
        started.args(command.words.iter().skip(1)).env(SOCKET, &socket);
        started.env(LIBRARY_PATH, libraries);
        if std::env::var_os(THREADS).is_none() {
            started.env(THREADS, threads.to_string());
        }
        command.directory.iter().for_each(|directory| {
            started.current_dir(directory);
        });
        started.stderr(Stdio::piped());
        let mut child = started.spawn().map_err(|error| ProgramError::Start {
            program: program.to_string_lossy().into_owned(),
            error,
        })?;
        let last_words = LastWords::of(child.stderr.take());
        match accept(&listener, &mut child, &last_words) {
            Ok(stream) => Ok(Self {
                child,
                stream,
                buffer: Vec::new(),
                waits: false,
                farewell: Duration::ZERO,
                last_words,
            }),
            Err(error) => {
                end(&mut child, Duration::ZERO);
                Err(error)
            }
        }
    }

    /// Receives a request.
    ///
    /// # Errors
    /// Fails if the program has ended or reports a refused call.
    pub fn receive(&mut self, when: &'static str) -> Result<Request, ProgramError> {
        match protocol::receive(&mut self.stream, &mut self.buffer) {
            Ok(Request::Fail { reason }) => {
                Err(ProgramError::Call(reason.chars().take(LONGEST_REASON).collect()))
            }
            Ok(request) => {
                self.waits = !matches!(request, Request::Finalise);
                Ok(request)
            }
            Err(error) if error.kind() == io::ErrorKind::InvalidData => Err(error.into()),
            Err(_) => {
                let status = wait(&mut self.child, GRACE);
                let status = status.map_or_else(
                    || "it has closed its connection".to_owned(),
                    |status| status.to_string(),
                );
                Err(ProgramError::Ended { status, when, last_words: self.last_words.take() })
            }
        }
    }

    /// Ends the program at once.
    pub fn kill(mut self) {
        self.waits = false;
    }

    /// Tells the program why it is refused, if it waits for an answer, and soon ends it.
    pub fn refuse(&mut self, reason: &dyn fmt::Display) {
        if self.waits {
            self.answer(&Answer::Refused(reason.to_string()));
            self.farewell = PARTING;
        }
    }

    /// Sends an answer. A program that has ended is noticed by the next [`Program::receive`].
    pub fn answer(&mut self, answer: &Answer) {
        self.waits = false;
        let _ = protocol::send(&mut self.stream, answer, &mut self.buffer);
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        if !std::mem::take(&mut self.waits) {
            end(&mut self.child, self.farewell);
            return;
        }
        self.answer(&Answer::Ended);
        if let Some(status) = end(&mut self.child, FAREWELL).filter(|status| !status.success()) {
            tracing::warn!(%status, "the program failed after the end of the simulation");
        }
    }
}

/// Waits for the connection of the program.
fn accept(
    listener: &UnixListener,
    child: &mut Child,
    last_words: &LastWords,
) -> Result<UnixStream, ProgramError> {
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false)?;
                return Ok(stream);
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        if let Some(status) = child.try_wait()? {
            let last_words = last_words.take();
            let when = match (status.code(), &last_words) {
                (Some(_), None) => {
                    "before it created its participant; is it linked with libprecice?"
                }
                _ => "before it created its participant",
            };
            return Err(ProgramError::Ended { status: status.to_string(), when, last_words });
        }
        std::thread::sleep(PAUSE);
    }
}

/// Waits for the end of a process; `None` after the time.
fn wait(child: &mut Child, time: Duration) -> Option<ExitStatus> {
    let deadline = Instant::now() + time;
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Some(status),
            Ok(None) if Instant::now() < deadline => std::thread::sleep(PAUSE),
            _ => return None,
        }
    }
}

/// Ends a process that does not end by itself in this time; returns its exit status.
fn end(child: &mut Child, time: Duration) -> Option<ExitStatus> {
    wait(child, time).or_else(|| {
        let _ = child.kill();
        child.wait().ok()
    })
}

/// Makes a folder in which programs find the library under its usual names; returns the value of
/// the library path with this folder in front.
fn offer_library(folder: &Path) -> Result<OsString, ProgramError> {
    let own = std::env::current_exe()
        .ok()
        .and_then(|program| program.parent().map(|parent| parent.join(LIBRARY_NAMES[0])));
    let earlier = std::env::var_os(LIBRARY_PATH).unwrap_or_default();
    let Some(own) = own.filter(|path| path.exists()) else { return Ok(earlier) };
    for name in LIBRARY_NAMES {
        let path = folder.join(name);
        std::os::unix::fs::symlink(&own, &path)
            .map_err(|error| ProgramError::File { path, error })?;
    }
    let mut path = folder.as_os_str().to_owned();
    if !earlier.is_empty() {
        path.push(OsStr::new(":"));
        path.push(earlier);
    }
    Ok(path)
}

#[cfg(test)]
impl Program {
    /// Returns a program that hangs, and the other end of its connection.
    pub(super) fn hanging() -> (Self, UnixStream) {
        let child = Command::new("sleep").arg("600").spawn().unwrap();
        let (stream, other) = UnixStream::pair().unwrap();
        let (buffer, last_words) = (Vec::new(), LastWords::of(None));
        let farewell = Duration::ZERO;
        (Self { child, stream, buffer, waits: false, farewell, last_words }, other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(script: &str) -> String {
        let words = ["sh", "-c", script].map(OsString::from).into();
        let command = ProgramCommand { words, directory: None };
        let folder = tempfile::tempdir().unwrap();
        Program::start(&command, &folder.path().join("run"), 1).unwrap_err().to_string()
    }

    #[test]
    fn a_program_that_ends_early_is_quoted() {
        let expected = "the program has ended (exit status: 3) before it created its participant, \
            saying: ModuleNotFoundError: No module named 'precice'";
        let script =
            "echo first >&2; echo \"ModuleNotFoundError: No module named 'precice'\" >&2; exit 3";
        assert_eq!(ended(script), expected);
        let silent = ended("exit 0");
        assert!(silent.ends_with("its participant; is it linked with libprecice?"), "{silent}");
        let killed = ended("kill -9 $$");
        assert!(killed.ends_with("before it created its participant"), "{killed}");
    }

    #[test]
    fn a_long_reason_of_a_program_is_cut() {
        let (mut program, mut other) = Program::hanging();
        let request = Request::Fail { reason: "x".repeat(1 << 20) };
        let sender =
            std::thread::spawn(move || protocol::send(&mut other, &request, &mut Vec::new()));
        let error = program.receive("in a test").unwrap_err().to_string();
        assert!(error.len() < LONGEST_REASON + 100, "{}", error.len());
        sender.join().unwrap().unwrap();
    }
}
