//! Processes started by the coordinator, and processes left behind by them.
//!
//! Each started process leads its own process group and ends with it. A process that has left the
//! group (`setsid`) and outlives its parent becomes a child of the coordinator, which adopts
//! orphans ([`adopt_orphans`]). When the last started process has ended, such a child is killed
//! too. It is recognised by [`MARK`], which it has inherited. A child without the mark is only
//! reported: it may belong to the process that has started the coordinator.

use rustix::process::{
    Pid, Signal, WaitId, WaitIdOptions, WaitOptions, getpid, kill_process, kill_process_group,
    set_child_subreaper, waitid, waitpid,
};
use std::io;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::process::{Child, Command};

/// Environment variable of started processes: process number of the coordinator.
const MARK: &str = "COSIM_STARTED_BY";
/// Environment variable of started processes: path of the coordinator. Participants in Python find
/// `libcosim` beside it.
const EXECUTABLE: &str = "COSIM_COORDINATOR";
/// Longest wait for killed orphans to end.
const PATIENCE: Duration = Duration::from_secs(1);

/// Processes that the coordinator has started. Other programs that use this crate adopt no orphans.
#[derive(Debug)]
struct Started {
    adopting: bool,
    /// Children that the process had when it became the coordinator (`job & exec coordinator`).
    inherited: Vec<Pid>,
    groups: Vec<Pid>,
}

static STARTED: Mutex<Started> =
    Mutex::new(Started { adopting: false, inherited: Vec::new(), groups: Vec::new() });

fn started() -> MutexGuard<'static, Started> {
    STARTED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes orphans among the descendants children of this process. They end with the last process
/// that it has started.
pub fn adopt_orphans() -> io::Result<()> {
    set_child_subreaper(Some(getpid()))?;
    let mut started = started();
    started.inherited = if has_children() { children() } else { Vec::new() };
    started.adopting = true;
    Ok(())
}

/// Kills the process groups of all started processes, at the end of the coordinator itself.
pub(crate) fn end_all() {
    for group in &started().groups {
        let _ = kill_process_group(*group, Signal::KILL);
    }
}

/// A started process. Dropping it kills the process and its group.
#[derive(Debug)]
pub(crate) struct Process {
    // Drops first: the process ends before its group, and before orphans are looked for.
    pub(crate) child: Child,
    pub(crate) group: Group,
}

impl Process {
    /// Starts a program as the leader of a process group.
    pub(crate) fn start(command: &mut Command) -> io::Result<Self> {
        let mark = getpid().as_raw_nonzero().get().to_string();
        command.env(MARK, mark).process_group(0).kill_on_drop(true);
        if std::env::var_os(EXECUTABLE).is_none()
            && let Ok(executable) = std::env::current_exe()
        {
            command.env(EXECUTABLE, executable);
        }
        // Spawns under the lock, because a child that is not in the list is taken for an orphan.
        let mut started = started();
        let child = command.spawn()?;
        let id = child.id().and_then(|id| Pid::from_raw(i32::try_from(id).ok()?));
        let id = id.ok_or_else(|| io::Error::other("the process has no number"))?;
        started.groups.push(id);
        Ok(Self { child, group: Group(id) })
    }
}

/// Process group of a started process. Dropping it kills the remaining processes of the group.
#[derive(Debug)]
pub(crate) struct Group(Pid);

impl Group {
    pub(crate) fn id(&self) -> Pid {
        self.0
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        let _ = kill_process_group(self.0, Signal::KILL);
        let mut started = started();
        started.groups.retain(|group| *group != self.0);
        if started.adopting && started.groups.is_empty() {
            end_orphans(&started.inherited);
        }
    }
}

/// Kills orphans, including those that other orphans leave behind.
fn end_orphans(inherited: &[Pid]) {
    let deadline = Instant::now() + PATIENCE;
    let mut reported = inherited.to_vec();
    while has_children() && Instant::now() < deadline {
        let mut ended = false;
        for orphan in children() {
            if matches!(waitpid(Some(orphan), WaitOptions::NOHANG), Ok(Some(_))) {
                ended = true;
                continue;
            }
            // The kernel removes the environment, and with it the mark, before a process has ended.
            if stat(orphan).is_none_or(|stat| stat.is_ending) {
                ended = true;
                continue;
            }
            let marked = is_marked(orphan);
            if !reported.contains(&orphan) {
                reported.push(orphan);
                report(orphan, marked);
            }
            if marked {
                ended = true;
                let _ = kill_process(orphan, Signal::KILL);
            }
        }
        if !ended {
            return;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
}

fn report(orphan: Pid, marked: bool) {
    let (pid, name) = (orphan.as_raw_nonzero().get(), stat(orphan).map(|stat| stat.name));
    let name = name.unwrap_or_default();
    if marked {
        tracing::info!(pid, name, "killing an orphaned process of a participant");
    } else {
        tracing::warn!("process {pid} ({name}) has lost its parent and is left running");
    }
}

/// Returns whether there are children. Costs a single system call if there are none.
fn has_children() -> bool {
    let look = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    waitid(WaitId::All, look).is_ok()
}

/// Returns the children, including ended ones that have not been collected.
fn children() -> Vec<Pid> {
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let numbers = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    let ours = |pid: &Pid| stat(*pid).is_some_and(|stat| stat.parent == Some(getpid()));
    numbers.filter_map(Pid::from_raw).filter(ours).collect()
}

/// Status of a process, as the kernel reports it.
struct Stat {
    name: String,
    parent: Option<Pid>,
    /// The process is ending, or has ended and has not been collected.
    is_ending: bool,
}

/// Flag of a process that is ending (`PF_EXITING` of the kernel).
const ENDING: u64 = 4;

/// Reads the status of a process (`proc_pid_stat(5)`); `None` if it is gone.
fn stat(process: Pid) -> Option<Stat> {
    let path = format!("/proc/{}/stat", process.as_raw_nonzero());
    let text = std::fs::read(path).ok()?;
    let text = String::from_utf8_lossy(&text);
    // The name stands in brackets, and may itself contain brackets.
    let (name, rest) = text.split_once('(')?.1.rsplit_once(") ")?;
    let fields: Vec<&str> = rest.split(' ').collect();
    let parent = fields.get(1)?.parse().ok().and_then(Pid::from_raw);
    let flags: u64 = fields.get(6)?.parse().ok()?;
    Some(Stat { name: name.to_owned(), parent, is_ending: flags & ENDING != 0 })
}

/// Returns whether a process has inherited the mark.
fn is_marked(process: Pid) -> bool {
    let path = format!("/proc/{}/environ", process.as_raw_nonzero());
    let mark = format!("{MARK}={}", getpid().as_raw_nonzero());
    std::fs::read(path).is_ok_and(|environment| {
        environment.split(|byte| *byte == 0).any(|entry| entry == mark.as_bytes())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A process that has ended but has not been collected has no environment: its mark is not
    /// lost.
    #[test]
    fn a_process_that_ends_is_known() {
        let own = stat(getpid()).unwrap();
        assert!(!own.is_ending);
        let mut child = std::process::Command::new("true").spawn().unwrap();
        let pid = Pid::from_child(&child);
        let deadline = Instant::now() + Duration::from_secs(60);
        while !stat(pid).unwrap().is_ending && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(1));
        }
        let ended = stat(pid).unwrap();
        assert!(ended.is_ending && ended.parent == Some(getpid()), "{}", ended.name);
        assert!(!is_marked(pid));
        child.wait().unwrap();
    }
}
