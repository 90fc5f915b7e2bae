//! Running the coordinator with a watchdog, and looking at what it leaves behind.

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// No test may take longer; generous, because it only ends what hangs.
const WATCHDOG: Duration = Duration::from_secs(180);

/// The folder of the executables, built once per test process in the profile of the tests.
pub(crate) fn programs() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let test = std::env::current_exe().unwrap();
        let folder = test.parent().unwrap().parent().unwrap().to_owned();
        let mut build = Command::new(env!("CARGO"));
        build.args(["build", "--workspace", "--bins", "--quiet"]).current_dir(root());
        if !cfg!(debug_assertions) {
            build.arg("--release");
        }
        assert!(build.status().unwrap().success(), "the executables do not build");
        folder
    })
}

/// The root of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The path of a shipped case.
pub(crate) fn case(name: &str) -> String {
    root().join("cases").join(name).display().to_string()
}

/// A place to run in: folders of its own.
pub(crate) struct Place {
    runtime: Arc<TempDir>,
    out: TempDir,
}

/// What a finished coordinator left.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// A coordinator that runs.
pub(crate) struct Running<'a> {
    place: &'a Place,
    child: Option<Child>,
}

impl Place {
    pub(crate) fn new() -> Self {
        // Sockets need a short path, and the folder has to lie in memory as the default one does.
        let runtime = tempfile::Builder::new().prefix("ct-").tempdir_in("/dev/shm").unwrap();
        Self { runtime: Arc::new(runtime), out: tempfile::tempdir().unwrap() }
    }

    /// A place with results of its own, whose runs share a runtime folder with this one's.
    pub(crate) fn neighbour(&self) -> Self {
        Self { runtime: Arc::clone(&self.runtime), out: tempfile::tempdir().unwrap() }
    }

    /// The result directory of [`Place::run`].
    pub(crate) fn out(&self) -> PathBuf {
        self.out.path().join("out")
    }

    /// The folder of the runs, in the one that the environment names.
    pub(crate) fn runtime(&self) -> PathBuf {
        self.runtime.path().join(format!("cosim-{}", rustix::process::geteuid().as_raw()))
    }

    pub(crate) fn start(&self, arguments: &[&str]) -> Running<'_> {
        self.launch(self.command(arguments))
    }

    /// The coordinator with these arguments, to be changed before it is launched.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        self.becoming(Command::new(programs().join("coordinator")), arguments)
    }

    /// A program that becomes the coordinator with these arguments.
    pub(crate) fn becoming(&self, mut program: Command, arguments: &[&str]) -> Command {
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

    /// Starts a program that becomes the coordinator, with its runs in a folder of the caller's choice.
    pub(crate) fn start_in(
        &self,
        runtime: &Path,
        program: Command,
        arguments: &[&str],
    ) -> Running<'_> {
        let mut command = self.becoming(program, arguments);
        command.env("COSIM_RUNTIME_DIR", runtime);
        self.launch(command)
    }

    pub(crate) fn launch(&self, mut command: Command) -> Running<'_> {
        Running { place: self, child: Some(command.spawn().unwrap()) }
    }

    /// Starts `run CASE --out OUT --replace` with more arguments.
    pub(crate) fn start_run(&self, case: &str, more: &[&str]) -> Running<'_> {
        let out = self.out().display().to_string();
        let mut arguments = vec!["run", case, "--out", &out, "--replace"];
        arguments.extend(more);
        self.start(&arguments)
    }

    pub(crate) fn run(&self, case: &str, more: &[&str]) -> Ended {
        self.start_run(case, more).wait()
    }

    /// Runs, and demands success; the summary.
    pub(crate) fn summary(&self, case: &str, more: &[&str]) -> Value {
        let ended = self.run(case, more);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        self.assert_nothing_left();
        let summary = self.read_summary();
        assert_eq!(summary["schema"], 1);
        let status = summary["status"].as_str().unwrap();
        assert!(["completed", "converged"].contains(&status), "{status}");
        summary
    }

    pub(crate) fn read_summary(&self) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.out().join("summary.json")).unwrap())
            .unwrap()
    }

    /// The events of `log.jsonl` so far.
    pub(crate) fn log(&self) -> Vec<Value> {
        let text = std::fs::read_to_string(self.out().join("log.jsonl")).unwrap_or_default();
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    }

    fn logged(&self, message: &str) -> Vec<Value> {
        let is = |event: &Value| event["fields"]["message"] == message;
        self.log().into_iter().filter(is).map(|event| event["fields"].clone()).collect()
    }

    /// Waits until something stands in the log.
    pub(crate) fn wait_for_log(&self, message: &str) {
        wait_until(&format!("`{message}` in the log"), || !self.logged(message).is_empty());
    }

    /// The process of a participant, by what the coordinator logged.
    pub(crate) fn pid_of(&self, role: &str) -> Pid {
        let started = self.logged("participant started");
        let of_role = started.iter().find(|event| event["role"] == role).unwrap();
        Pid::from_raw(of_role["pid"].as_i64().unwrap() as i32).unwrap()
    }

    /// No process, no run folder, no shared-memory file of any run that was started here.
    pub(crate) fn assert_nothing_left(&self) {
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

fn shared_memory_files() -> impl Iterator<Item = String> {
    let entries = std::fs::read_dir("/dev/shm").unwrap().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok())
}

/// The process exists and is more than an entry that nobody has collected yet.
fn is_running(pid: i64) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let state = stat.rsplit(") ").next().and_then(|rest| rest.chars().next());
    state.is_some_and(|state| state != 'Z')
}

/// Waits, up to the watchdog's patience.
pub(crate) fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let deadline = Instant::now() + WATCHDOG;
    while !done() {
        assert!(Instant::now() < deadline, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

impl Running<'_> {
    pub(crate) fn pid(&self) -> Pid {
        Pid::from_raw(self.child.as_ref().unwrap().id() as i32).unwrap()
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill_process(self.pid(), signal).unwrap();
    }

    pub(crate) fn wait(mut self) -> Ended {
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
        let deadline = Instant::now() + WATCHDOG;
        let child = self.child.as_mut().unwrap();
        loop {
            if let Some(status) = child.try_wait().unwrap() {
                return status;
            }
            assert!(Instant::now() < deadline, "the coordinator hangs: {:?}", self.place.log());
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

/// A test that fails does not leave its coordinator running; its participants follow it.
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
