//! Programs of participants: finding them, and asking for their descriptions, estimates and advice.
//!
//! A participant without `command` is the program `ROLE-solver`. The coordinator looks for it in
//! its own folder and then on the search path. A question (`--describe`, `--estimate`, `--advise`)
//! starts the program, reads its answer and ends it. No part of a run is started.

pub use crate::program::Program;

use crate::error::{Failure, RunError, machine_failure};
use crate::processes::Process;
use crate::program::our_folder;
use crate::signals;
use contract::advice::{Opinion, Scene};
use contract::configuration::{Configuration, Estimate};
use contract::description::Description;
use serde::de::DeserializeOwned;
use std::io;
use std::os::fd::AsFd;
use std::process::{Output, Stdio};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWriteExt};
use tokio::process::Command;
use tokio::sync::watch;

/// Longest answer that is read [byte].
const LONGEST_ANSWER: usize = 16 << 20;

/// Waits for the answer of a program outside of a run.
///
/// # Errors
/// The error of the question, or the machine has no files left for a conversation.
pub fn wait_for<T>(answer: impl Future<Output = Result<T, RunError>>) -> Result<T, RunError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let failed = |error: io::Error| {
        let fix = "raise the limit of open files (`ulimit -n`)";
        machine_failure("the machine", "when programs were to be asked", &error, fix)
    };
    runtime.map_err(failed)?.block_on(answer)
}

impl Program {
    /// Asks the program for its description.
    pub async fn describe(&self, role: &str, deadline: Duration) -> Result<Description, RunError> {
        match &self.linked {
            Some(solver) => Ok(solver.describe()),
            None => self.ask(role, "--describe", Vec::new(), deadline).await,
        }
    }

    /// Asks the program for its estimate of a run with this configuration.
    pub async fn estimate(
        &self,
        configuration: &Configuration,
        deadline: Duration,
    ) -> Result<Estimate, RunError> {
        if let Some(solver) = &self.linked {
            return Ok(solver.estimate(configuration));
        }
        let input = serde_json::to_vec(configuration).expect("a configuration is plain data");
        self.ask(&configuration.role, "--estimate", input, deadline).await
    }

    /// Asks the program for its opinion on effects in a scene.
    pub async fn advise(
        &self,
        role: &str,
        scene: &Scene,
        deadline: Duration,
    ) -> Result<Opinion, RunError> {
        if let Some(solver) = &self.linked {
            return Ok(solver.advise(scene));
        }
        let input = serde_json::to_vec(scene).expect("a scene is plain data");
        self.ask(role, "--advise", input, deadline).await
    }

    async fn ask<T: DeserializeOwned>(
        &self,
        role: &str,
        question: &str,
        input: Vec<u8>,
        deadline: Duration,
    ) -> Result<T, RunError> {
        let said = self.answer(role, question, input, deadline).await?;
        serde_json::from_slice(&said).map_err(|error| {
            let why = match answers(&said) {
                0 | 1 => format!("its answer is not valid: {error}"),
                _ => "it answers more than once: of several processes that are started as one \
                      participant (MPI ranks) only one answers, and joins (docs/write-a-solver.md)"
                    .to_owned(),
            };
            self.failed(role, question, &why)
        })
    }

    /// Asks the program a question (such as `--describe`), and returns its standard output
    /// unchanged.
    ///
    /// # Errors
    /// The program does not exist, fails, or is late, or the user has interrupted the command.
    pub async fn answer(
        &self,
        role: &str,
        question: &str,
        input: Vec<u8>,
        deadline: Duration,
    ) -> Result<Vec<u8>, RunError> {
        let asked = || format!("while {role} was asked to {}", question.trim_start_matches('-'));
        let answer = tokio::select! {
            answer = tokio::time::timeout(deadline, self.converse(question, input)) => answer,
            signal = signals::wait() => {
                return Err(RunError::Interrupted { signal, when: asked() });
            }
        };
        let output = match answer {
            Ok(Ok(output)) => output,
            Ok(Err(error)) if error.kind() == io::ErrorKind::NotFound => {
                return Err(RunError::NoProgram { role: role.to_owned(), program: self.clone() });
            }
            Ok(Err(error)) => return Err(self.failed(role, question, &error.to_string())),
            Err(_) => {
                let seconds = deadline.as_secs_f64();
                let why = format!("no answer within {seconds:.0} s");
                return Err(self.failed(role, question, &why));
            }
        };
        if let Some(signal) = signals::received_like(output.status) {
            return Err(RunError::Interrupted { signal, when: asked() });
        }
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or("nothing");
            let why = format!("it ended with {}, saying: {last}", output.status);
            return Err(self.failed(role, question, &why));
        }
        Ok(output.stdout)
    }

    async fn converse(&self, question: &str, input: Vec<u8>) -> io::Result<Output> {
        let mut command = Command::new(&self.path);
        command
            .args(&self.arguments)
            .arg(question)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut process = Process::start(&mut command)?;
        let child = &mut process.child;
        let (stdin, stdout, stderr) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let (over, ended) = watch::channel(());
        let say = async {
            if let Some(mut stdin) = stdin {
                // A program that ignores its input may close it early; the answer decides.
                let mut ended = ended.clone();
                tokio::select! {
                    _ = stdin.write_all(&input) => (),
                    _ = ended.changed() => (),
                }
            }
        };
        let status = async {
            let status = child.wait().await;
            drop(over);
            status
        };
        let (stdout, stderr) = (read_some(stdout, ended.clone()), read_some(stderr, ended.clone()));
        let ((), stdout, stderr, status) = tokio::join!(say, stdout, stderr, status);
        Ok(Output { status: status?, stdout: stdout?, stderr: stderr? })
    }

    /// Returns the error for an invalid answer.
    #[must_use]
    pub fn misled(&self, role: &str, fault: String) -> RunError {
        RunError::Failed(Failure {
            who: format!("{role} ({})", self.name()),
            when: "while planning".to_owned(),
            what: fault,
            fix: "the program violates the participant contract (docs/ARCHITECTURE.md)".to_owned(),
        })
    }

    fn failed(&self, role: &str, question: &str, why: &str) -> RunError {
        RunError::Failed(Failure {
            who: format!("{role} ({})", self.name()),
            when: format!("asked to {}", question.trim_start_matches("--")),
            what: why.to_owned(),
            fix: format!("run `{} {question}` by hand", self.command_line()),
        })
    }
}

/// Returns the number of JSON values at the beginning of a text, or of interleaved answers: each
/// answer holds `protocol`, or `grids` if it is a layout, exactly once.
fn answers(text: &[u8]) -> usize {
    let values = serde_json::Deserializer::from_slice(text).into_iter::<serde::de::IgnoredAny>();
    let whole = values.take_while(Result::is_ok).count();
    let text = String::from_utf8_lossy(text);
    let mixed = ["\"protocol\":", "\"grids\":"].map(|mark| text.matches(mark).count());
    mixed.into_iter().fold(whole, usize::max)
}

/// Reads the output of a program, up to [`LONGEST_ANSWER`]; output beyond is not read. The answer
/// ends when the program ends, even if other processes hold the pipe open: the written bytes are
/// still in the pipe.
async fn read_some(
    pipe: Option<impl AsyncRead + AsFd + Unpin>,
    mut ended: watch::Receiver<()>,
) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let Some(mut pipe) = pipe else { return Ok(bytes) };
    while bytes.len() < LONGEST_ANSWER {
        let read = tokio::select! {
            read = pipe.read_buf(&mut bytes) => read?,
            _ = ended.changed() => {
                read_the_rest(&pipe, &mut bytes);
                0
            }
        };
        if read == 0 {
            break;
        }
    }
    bytes.truncate(LONGEST_ANSWER);
    Ok(bytes)
}

/// Reads the remaining bytes of a non-blocking pipe.
fn read_the_rest(pipe: &impl AsFd, bytes: &mut Vec<u8>) {
    let mut piece = [0; 4096];
    while bytes.len() < LONGEST_ANSWER {
        match rustix::io::read(pipe, &mut piece) {
            Ok(0) => break,
            Ok(count) => bytes.extend_from_slice(&piece[..count]),
            Err(rustix::io::Errno::INTR) => {}
            Err(_) => break,
        }
    }
}

/// Returns the programs beside the coordinator that look like participants, for `coordinator
/// solvers`.
#[must_use]
pub fn installed() -> Vec<(String, Program)> {
    let Some(folder) = our_folder() else { return Vec::new() };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<_> = entries
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            let role = name.strip_suffix("-solver")?.to_owned();
            Some((role, Program::new(entry.path(), Vec::new())))
        })
        .collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}
