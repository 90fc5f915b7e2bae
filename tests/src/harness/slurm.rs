//! Slurm cluster of one node on this machine, with its own keys, ports and files. Removed on drop.

use super::wait_until;
use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

/// Daemons of the cluster and their folder.
#[derive(Debug)]
pub struct Slurm {
    place: TempDir,
    daemons: Vec<Child>,
}

impl Slurm {
    /// Starts the cluster and waits until the node accepts tasks.
    #[expect(clippy::new_without_default, reason = "daemons are started, not defaulted")]
    pub fn new() -> Self {
        // Sockets need a short path.
        let mut slurm = Self {
            place: tempfile::Builder::new().prefix("slurm-").tempdir_in("/tmp").unwrap(),
            daemons: Vec::new(),
        };
        let at = |name: &str| slurm.place.path().join(name);
        for folder in ["munge", "state", "spool"] {
            fs::create_dir(at(folder)).unwrap();
        }
        let limited = |path: PathBuf, mode| {
            fs::set_permissions(path, PermissionsExt::from_mode(mode)).unwrap()
        };
        limited(slurm.place.path().to_owned(), 0o755);
        limited(at("munge"), 0o700);
        fs::write(at("munge/key"), [7u8; 1024]).unwrap();
        limited(at("munge/key"), 0o400);
        fs::write(at("slurm.conf"), configuration(slurm.place.path())).unwrap();
        let mut munged = daemon("munged", &at("munge/out"));
        munged.args(["--foreground", "--force", "--num-threads=1"]);
        for (option, file) in [
            ("socket", "s"),
            ("key-file", "key"),
            ("pid-file", "pid"),
            ("log-file", "log"),
            ("seed-file", "seed"),
        ] {
            munged.arg(format!("--{option}={}", at("munge").join(file).display()));
        }
        let mut controller = daemon("slurmctld", &at("slurmctld.out"));
        controller.arg("-D").arg("-f").arg(slurm.configuration());
        let mut node = daemon("slurmd", &at("slurmd.out"));
        node.args(["-D", "-N", "localhost", "-f"]).arg(slurm.configuration());
        slurm.daemons.push(munged.spawn().expect(NEEDED));
        wait_until("munge", || slurm.place.path().join("munge/s").exists());
        slurm.daemons.push(controller.spawn().expect(NEEDED));
        slurm.daemons.push(node.spawn().expect(NEEDED));
        wait_until("a node of Slurm", || slurm.said("sinfo", &["-h", "-o", "%t"]).trim() == "idle");
        slurm
    }

    /// Configuration file, for `SLURM_CONF`.
    pub fn configuration(&self) -> PathBuf {
        self.place.path().join("slurm.conf")
    }

    /// Runs a Slurm program and returns its output.
    pub fn said(&self, program: &str, arguments: &[&str]) -> String {
        let ended = self.command(program).args(arguments).output();
        String::from_utf8_lossy(&ended.expect(NEEDED).stdout).into_owned()
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", self.configuration());
        command
    }

    /// Number of waiting and running tasks.
    pub fn tasks(&self) -> usize {
        self.said("squeue", &["-h", "-r"]).lines().count()
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        // Where Slurm is missing, the test panics already; a second panic would end all tests.
        let _ = self.command("scancel").args(["--full", "--user=root"]).output();
        for daemon in self.daemons.iter_mut().rev() {
            let pid = rustix::process::Pid::from_child(daemon);
            let _ = rustix::process::kill_process(pid, rustix::process::Signal::TERM);
            let _ = daemon.wait();
        }
    }
}

const NEEDED: &str = "Slurm is needed to test sweeps on a cluster: apt-get install slurm-wlm munge";

fn daemon(name: &str, out: &Path) -> Command {
    // The folders of daemons are not always on a user's search path.
    let folders = ["/usr/sbin", "/usr/local/sbin"].map(|folder| Path::new(folder).join(name));
    let program = folders.into_iter().find(|path| path.exists()).unwrap_or_else(|| name.into());
    let mut command = Command::new(program);
    let out = fs::File::create(out).unwrap();
    command.stdin(Stdio::null()).stdout(out.try_clone().unwrap()).stderr(out);
    command
}

/// One node with two cores; no cgroups, no job steps over the network, and a scheduler without
/// delay.
fn configuration(place: &Path) -> String {
    let ports = [0, 0].map(|any| TcpListener::bind(("127.0.0.1", any)).unwrap());
    let [controller, node] = ports.map(|port| port.local_addr().unwrap().port());
    let user = if rustix::process::geteuid().is_root() {
        "root".to_owned()
    } else {
        std::env::var("USER").expect("the name of the user")
    };
    let place = place.display();
    format!(
        "ClusterName=test
SlurmctldHost=localhost
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={place}/munge/s
CryptoType=crypto/munge
SlurmctldPort={controller}
SlurmdPort={node}
StateSaveLocation={place}/state
SlurmdSpoolDir={place}/spool
SlurmctldPidFile={place}/slurmctld.pid
SlurmdPidFile={place}/slurmd.pid
SlurmctldLogFile={place}/slurmctld.log
SlurmdLogFile={place}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
MpiDefault=none
SwitchType=switch/none
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,bf_interval=1
NodeName=localhost NodeAddr=127.0.0.1 CPUs=2 RealMemory=500 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"
    )
}
