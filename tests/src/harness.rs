//! Runs the coordinator under a watchdog and inspects its results and leftovers.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod answers;
pub mod browser;
pub mod compiled;
pub mod coverage;
pub mod failures;
pub mod paper;
pub mod precice;
mod programs;
pub mod python;
pub mod slurm;
pub mod snippets;
pub mod sweeps;
mod watchdog;
pub mod watched;

pub use answers::{Table, field, field_files, number};
pub use programs::{example, library, programs, root, toy};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;
use tempfile::TempDir;

/// Maximum duration of a run or a wait, on the clock of [`watchdog`]. Generous, because it serves
/// only to end processes that hang.
const WATCHDOG: Duration = Duration::from_secs(400);

/// Returns the path of a shipped case.
pub fn case(name: &str) -> String {
    root().join("cases").join(name).display().to_string()
}

/// Returns the text of the main case with replacements: pairs of old and new text.
pub fn changed(changes: &[(&str, &str)]) -> String {
    let mut text = std::fs::read_to_string(case("wheel-rail.toml")).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "`{from}` is not in the case");
        text = text.replace(from, to);
    }
    text
}

/// Replaces line breaks and runs of spaces by single spaces.
pub fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Generates a solver in a folder with `coordinator new-solver`; returns the exit code and the
/// output.
pub fn new_solver(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut coordinator = Command::new(programs().join("coordinator"));
    let ended = coordinator.arg("new-solver").args(arguments).current_dir(folder).output().unwrap();
    let said = [ended.stdout, ended.stderr].concat();
    (ended.status.code(), String::from_utf8(said).unwrap())
}

/// Puts `--set` before each setting.
pub fn sets<'a>(settings: &[&'a str]) -> Vec<&'a str> {
    settings.iter().flat_map(|set| ["--set", set]).collect()
}

/// Runs a shipped case with these settings and asserts success. Returns the place and the summary.
pub fn completed(name: &str, settings: &[&str]) -> (Place, Value) {
    let place = Place::new();
    let summary = place.summary(&case(name), &sets(settings));
    (place, summary)
}

/// Isolated folders for runs: a runtime folder and a result folder.
#[derive(Debug)]
pub struct Place {
    runtime: Arc<TempDir>,
    out: TempDir,
}

/// Outcome of a finished coordinator.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; `None` if a signal ended the process.
    pub code: Option<i32>,
    /// Complete standard output.
    pub stdout: String,
    /// Complete standard error.
    pub stderr: String,
}

/// Running coordinator.
#[derive(Debug)]
pub struct Running<'a> {
    place: &'a Place,
    child: Option<Child>,
}

impl Place {
    /// Creates new folders.
    #[expect(clippy::new_without_default, reason = "a place is made, not defaulted")]
    pub fn new() -> Self {
        // Sockets need a short path. The folder must lie in memory, like the default one.
        let runtime = tempfile::Builder::new().prefix("ct-").tempdir_in("/dev/shm").unwrap();
        Self { runtime: Arc::new(runtime), out: tempfile::tempdir().unwrap() }
    }

    /// Creates a place with its own result folder that shares the runtime folder of this one.
    pub fn neighbour(&self) -> Self {
        Self { runtime: Arc::clone(&self.runtime), out: tempfile::tempdir().unwrap() }
    }

    /// Result folder of [`Place::run`].
    pub fn out(&self) -> PathBuf {
        self.out.path().join("out")
    }

    /// Folder of the runs, below the one in `COSIM_RUNTIME_DIR`.
    pub fn runtime(&self) -> PathBuf {
        self.runtime.path().join(format!("cosim-{}", rustix::process::geteuid().as_raw()))
    }

    /// Starts the coordinator with these arguments.
    pub fn start(&self, arguments: &[&str]) -> Running<'_> {
        self.launch(self.command(arguments))
    }

    /// Command that runs the coordinator with these arguments; pass it to [`Place::launch`].
    pub fn command(&self, arguments: &[&str]) -> Command {
        self.becoming(Command::new(programs().join("coordinator")), arguments)
    }

    /// Configures a program that becomes the coordinator, with these arguments.
    pub fn becoming(&self, mut program: Command, arguments: &[&str]) -> Command {
        program
            .args(arguments)
            .env("COSIM_RUNTIME_DIR", self.runtime.path())
            .env_remove("RUST_LOG")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .current_dir(root());
        program
    }

    /// Starts a program that becomes the coordinator, with a given runtime folder.
    pub fn start_in(&self, runtime: &Path, program: Command, arguments: &[&str]) -> Running<'_> {
        let mut command = self.becoming(program, arguments);
        command.env("COSIM_RUNTIME_DIR", runtime);
        self.launch(command)
    }

    /// Starts a command from [`Place::command`] or [`Place::becoming`].
    pub fn launch(&self, mut command: Command) -> Running<'_> {
        hear_signals(&mut command);
        Running { place: self, child: Some(command.spawn().unwrap()) }
    }

    /// Starts `run CASE --out OUT --replace` with more arguments.
    pub fn start_run(&self, case: &str, more: &[&str]) -> Running<'_> {
        let out = self.out().display().to_string();
        let mut arguments = vec!["run", case, "--out", &out, "--replace"];
        arguments.extend(more);
        self.start(&arguments)
    }

    /// Runs a case to its end.
    pub fn run(&self, case: &str, more: &[&str]) -> Ended {
        self.start_run(case, more).wait()
    }

    /// Runs a case, asserts success and returns the summary.
    pub fn summary(&self, case: &str, more: &[&str]) -> Value {
        let ended = self.run(case, more);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        self.assert_nothing_left();
        let summary = self.read_summary();
        assert_eq!(summary["schema"], 1);
        let status = summary["status"].as_str().unwrap();
        assert!(["completed", "converged"].contains(&status), "{status}");
        summary
    }

    /// Reads `summary.json` of [`Place::run`].
    pub fn read_summary(&self) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.out().join("summary.json")).unwrap())
            .unwrap()
    }

    /// Reads a table of the results, by its path in the result folder.
    pub fn table(&self, file: &str) -> Table {
        Table::read(&self.out().join(file))
    }

    /// Reads a field with one component from an image in `fields`.
    pub fn field(&self, file: &str, name: &str) -> Vec<f64> {
        field(&self.out().join("fields").join(file), name)
    }

    /// Reads the events in `log.jsonl` so far.
    pub fn log(&self) -> Vec<Value> {
        let text = std::fs::read_to_string(self.out().join("log.jsonl")).unwrap_or_default();
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    }

    fn logged(&self, message: &str) -> Vec<Value> {
        let is = |event: &Value| event["fields"]["message"] == message;
        self.log().into_iter().filter(is).map(|event| event["fields"].clone()).collect()
    }

    /// Waits until the log contains a message.
    pub fn wait_for_log(&self, message: &str) {
        wait_until(&format!("`{message}` in the log"), || !self.logged(message).is_empty());
    }

    /// Waits until a run waits for a participant that is started by hand. Returns its folder.
    pub fn waiting_for(&self, role: &str) -> String {
        let waits = || {
            let told = format!("waiting for {role}: ");
            let is = |event: &Value| event["fields"]["message"].as_str()?.find(&told);
            self.log().iter().any(|event| is(event).is_some())
        };
        wait_until(&format!("a run that waits for {role}"), waits);
        let runs = self.logged("run created");
        runs.last().expect("a run was created")["folder"].as_str().unwrap().to_owned()
    }

    /// Returns the `folder` or the `prefix` of the first run, as logged by the coordinator.
    pub fn created(&self, key: &str) -> String {
        let runs = self.logged("run created");
        runs.first().expect("a run was created")[key].as_str().unwrap().to_owned()
    }

    /// Returns the process of a participant, as logged by the coordinator.
    pub fn pid_of(&self, role: &str) -> Pid {
        let started = self.logged("participant started");
        let of_role = started.iter().find(|event| event["role"] == role).unwrap();
        Pid::from_raw(of_role["pid"].as_i64().unwrap() as i32).unwrap()
    }

    /// Asserts that the runs of this place leave no process, no run folder and no shared memory.
    pub fn assert_nothing_left(&self) {
        let pids = self.logged("participant started");
        for pid in pids.iter().map(|event| event["pid"].as_i64().unwrap()) {
            wait_until(&format!("the end of process {pid}"), || !is_running(pid));
        }
        if Arc::strong_count(&self.runtime) == 1 {
            wait_until("the end of the runtime folder", || !self.runtime().exists());
        }
        for run in self.logged("run created") {
            let prefix = run["prefix"].as_str().unwrap();
            let left: Vec<_> = shared_memory_files().filter(|f| f.starts_with(prefix)).collect();
            assert!(left.is_empty(), "left in shared memory: {left:?}");
        }
    }
}

/// Restores the default signal handlers. A background shell or `nohup` makes the tests ignore
/// signals; child processes would inherit that and hang.
fn hear_signals(command: &mut Command) {
    let signals = [libc::SIGHUP, libc::SIGINT, libc::SIGQUIT, libc::SIGTERM];
    // SAFETY: between fork and exec, `signal` is async-signal-safe and touches no memory.
    unsafe {
        command.pre_exec(move || {
            for signal in signals {
                libc::signal(signal, libc::SIG_DFL);
            }
            Ok(())
        })
    };
}

fn shared_memory_files() -> impl Iterator<Item = String> {
    let entries = std::fs::read_dir("/dev/shm").unwrap().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok())
}

/// True if the process exists and is not a zombie.
fn is_running(pid: i64) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let state = stat.rsplit(") ").next().and_then(|rest| rest.chars().next());
    state.is_some_and(|state| state != 'Z')
}

/// Waits until `done` returns true, at most for the time of the watchdog.
pub fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let deadline = watchdog::now() + WATCHDOG;
    while !done() {
        assert!(watchdog::now() < deadline, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

impl Running<'_> {
    /// Process of the coordinator.
    pub fn pid(&self) -> Pid {
        Pid::from_raw(self.child.as_ref().unwrap().id() as i32).unwrap()
    }

    /// Sends a signal to the coordinator.
    pub fn signal(&self, signal: Signal) {
        kill_process(self.pid(), signal).unwrap();
    }

    /// Types a text into standard input, which must be a pipe, and closes it.
    pub fn type_text(&mut self, text: &str) {
        let mut input = self.child.as_mut().unwrap().stdin.take().unwrap();
        input.write_all(text.as_bytes()).unwrap();
    }

    /// Waits for the first line of the output. The rest of the output is lost.
    pub fn first_line(&mut self) -> String {
        let out = self.child.as_mut().unwrap().stdout.take().unwrap();
        let reading = std::thread::spawn(move || {
            let mut line = String::new();
            BufReader::new(out).read_line(&mut line).unwrap();
            line.trim_end().to_owned()
        });
        wait_until("the first line of the output", || reading.is_finished());
        reading.join().unwrap()
    }

    /// Waits until the coordinator has ended, at most for the time of the watchdog.
    pub fn wait(mut self) -> Ended {
        let child = self.child.as_mut().unwrap();
        let out = child.stdout.take().map(read_all);
        let err = child.stderr.take().map(read_all);
        let status = self.status();
        let text = |reader: Option<JoinHandle<String>>| match reader {
            Some(reader) => reader.join().unwrap(),
            None => String::new(),
        };
        let (stdout, stderr) = (text(out), text(err));
        Ended { code: status.code(), stdout, stderr }
    }

    fn status(&mut self) -> ExitStatus {
        let deadline = watchdog::now() + WATCHDOG;
        let child = self.child.as_mut().unwrap();
        loop {
            if let Some(status) = child.try_wait().unwrap() {
                return status;
            }
            assert!(watchdog::now() < deadline, "the coordinator hangs: {:?}", self.place.log());
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

fn read_all(mut pipe: impl std::io::Read + Send + 'static) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut text = String::new();
        pipe.read_to_string(&mut text).unwrap();
        text
    })
}

/// Kills the coordinator of a failed test; its participants end with it.
impl Drop for Running<'_> {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child
            && child.try_wait().is_ok_and(|status| status.is_none())
        {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}
