//! The program of a user as a child process, and the connection to the library inside it.

use crate::protocol::{self, Answer, Request, SOCKET};
use std::ffi::{OsStr, OsString};
use std::io;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

/// Time between two checks whether the program has connected or ended.
const PAUSE: Duration = Duration::from_millis(2);
/// Time for the end of a program that has closed its connection.
const GRACE: Duration = Duration::from_secs(2);
/// Time for the end of a program after the simulation, in which it may write results.
const FAREWELL: Duration = Duration::from_secs(20);
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
    #[error("the program has ended ({status}) {when}")]
    Ended {
        /// Exit status.
        status: String,
        /// Stage of the simulation.
        when: &'static str,
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
        let mut child = started.spawn().map_err(|error| ProgramError::Start {
            program: program.to_string_lossy().into_owned(),
            error,
        })?;
        match accept(&listener, &mut child) {
            Ok(stream) => Ok(Self { child, stream, buffer: Vec::new(), waits: false }),
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
            Ok(Request::Fail { reason }) => Err(ProgramError::Call(reason)),
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
                Err(ProgramError::Ended { status, when })
            }
        }
    }

    /// Ends the program at once.
    pub fn kill(mut self) {
        self.waits = false;
    }

    /// Sends an answer. A program that has ended is noticed by the next [`Program::receive`].
    pub fn answer(&mut self, answer: &Answer) {
        self.waits = false;
        let _ = protocol::send(&mut self.stream, answer, &mut self.buffer);
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let farewell = match std::mem::take(&mut self.waits) {
            true => {
                self.answer(&Answer::Ended);
                FAREWELL
            }
            false => Duration::ZERO,
        };
        match end(&mut self.child, farewell) {
            Some(status) if !status.success() && farewell > Duration::ZERO => {
                tracing::warn!(%status, "the program failed after the end of the simulation");
            }
            _ => {}
        }
    }
}

/// Waits for the connection of the program.
fn accept(listener: &UnixListener, child: &mut Child) -> Result<UnixStream, ProgramError> {
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
            let when = match status.code() {
                Some(_) => "before it created its participant; is it linked with libprecice?",
                None => "before it created its participant",
            };
            return Err(ProgramError::Ended { status: status.to_string(), when });
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
