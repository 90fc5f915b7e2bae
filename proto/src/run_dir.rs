//! Isolation of a run on the machine, and removal of all its files.
//!
//! Every run has its own folder under the runtime folder, and its own prefix of shared-memory
//! files. Advisory locks in the folder show which processes are alive. The kernel releases them
//! when a process ends for any reason:
//!
//! - `coordinator.lock` is held exclusively by the coordinator for the whole run. A participant
//!   that can take this lock knows that the coordinator is dead.
//! - `participant-ROLE.lock` is held exclusively by the participant in this role. By this lock the
//!   coordinator notices the end of a participant that was started by someone else.
//! - `members.lock` is held shared by all members of the run. The process that can take this lock
//!   exclusively is the last one; it removes the folder and every shared-memory file with the run's
//!   prefix.
//!
//! By the same rule, a starting coordinator removes the remains of runs whose processes were all
//! killed. The module [`runtime`] manages the runtime folder itself.

mod locks;
mod runtime;

use crate::lock_file::LockFile;
use locks::{COORDINATOR_LOCK, MEMBERS_LOCK, RUN_FILE};
use runtime::{
    RuntimeFolder, SHARED_MEMORY, belong_together, prefix_of, remove_first_files, remove_run, user,
};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

pub(crate) use runtime::close_to_others;

/// Information that a participant needs to join: the content of `run.json` in the run's folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunInfo {
    /// [`crate::PROTOCOL_VERSION`] of the coordinator.
    pub protocol: u32,
    /// Folder of the run; the root path of its services.
    pub folder: PathBuf,
    /// Prefix of the shared-memory files.
    pub prefix: String,
    /// Roles of the participants; heartbeats carry the index of the role.
    pub roles: Vec<String>,
}

/// Membership in a run: holds the locks, and cleans up when the last member leaves.
#[derive(Debug)]
pub struct RunDir {
    info: RunInfo,
    members: LockFile,
    /// Exclusive lock: the coordinator's, or the participant's own.
    own: LockFile,
}

impl RunInfo {
    /// Reads `run.json` of a folder. Checks that the folder is ours and that the prefix belongs to
    /// the run, because the last member removes the files with this prefix.
    fn read(folder: &Path) -> io::Result<Self> {
        let no_run = |error: io::Error| {
            io::Error::new(error.kind(), format!("no run at {}: {error}", folder.display()))
        };
        let text = fs::read(folder.join(RUN_FILE)).map_err(no_run)?;
        let info: Self = serde_json::from_slice(&text)?;
        let (here, named) = (fs::metadata(folder)?, fs::metadata(&info.folder).map_err(no_run)?);
        if here.uid() != user() {
            return Err(io::Error::other(format!(
                "the run at {} belongs to another user",
                folder.display()
            )));
        }
        let same = (here.dev(), here.ino()) == (named.dev(), named.ino());
        if !same || !belong_together(&info.folder, &info.prefix) {
            return Err(io::Error::other(format!(
                "{} does not describe its run: folder {} and prefix {:?} do not belong to it",
                folder.join(RUN_FILE).display(),
                info.folder.display(),
                info.prefix
            )));
        }
        Ok(info)
    }
}

impl RunDir {
    /// Creates the folder of a new run and takes the coordinator's locks.
    pub fn create(roles: &[String]) -> io::Result<Self> {
        let runtime = RuntimeFolder::open()?;
        runtime.remove_dead_runs();
        let (id, nursery) = runtime.nursery()?;
        let made = Self::create_in(&runtime, &id, &nursery, roles);
        if made.is_err() {
            remove_first_files(&nursery);
        }
        made
    }

    fn create_in(
        runtime: &RuntimeFolder,
        id: &str,
        nursery: &Path,
        roles: &[String],
    ) -> io::Result<Self> {
        let coordinator = LockFile::from(File::create(nursery.join(COORDINATOR_LOCK))?);
        let members = LockFile::from(File::create(nursery.join(MEMBERS_LOCK))?);
        coordinator.try_lock()?;
        members.try_lock_shared()?;
        let folder = runtime.path().join(id);
        let info = RunInfo {
            protocol: crate::PROTOCOL_VERSION,
            folder: folder.clone(),
            prefix: prefix_of(id),
            roles: roles.to_vec(),
        };
        fs::write(nursery.join(RUN_FILE), serde_json::to_vec_pretty(&info)?)?;
        // A folder gets its final name only after it is locked, so that no process takes it for a
        // dead run.
        fs::rename(nursery, &folder)?;
        Ok(Self { info, members, own: coordinator })
    }

    /// Joins a run in this role.
    pub fn join(folder: &Path, role: &str) -> io::Result<Self> {
        let info = RunInfo::read(folder)?;
        if info.protocol != crate::PROTOCOL_VERSION {
            let (theirs, ours) = (info.protocol, crate::PROTOCOL_VERSION);
            return Err(io::Error::other(format!(
                "the coordinator speaks protocol {theirs}, this program {ours}"
            )));
        }
        let members = LockFile::from(File::open(folder.join(MEMBERS_LOCK))?);
        members.try_lock_shared()?;
        if !info.roles.iter().any(|known| known == role) {
            let known = info.roles.join(", ");
            return Err(io::Error::other(format!("the run has no role `{role}`; it has {known}")));
        }
        let own = LockFile::from(File::create(info.folder.join(participant_lock(role)))?);
        own.try_lock().map_err(|_| {
            io::Error::other(format!(
                "another process plays the role `{role}` in this run; of several that are started as \
                 one participant (MPI ranks) only one joins (docs/write-a-solver.md)"
            ))
        })?;
        Ok(Self { info, members, own })
    }

    /// Returns true if the participant has joined and left: its lock exists and is free.
    #[must_use]
    pub fn has_left(&self, role: &str) -> bool {
        File::open(self.info.folder.join(participant_lock(role)))
            .is_ok_and(|lock| LockFile::from(lock).try_lock_shared().is_ok())
    }

    /// Returns the information about the run.
    #[must_use]
    pub fn info(&self) -> &RunInfo {
        &self.info
    }

    /// Returns a watch on the coordinator, for another thread.
    pub fn watch(&self) -> io::Result<CoordinatorWatch> {
        Ok(CoordinatorWatch { lock: File::open(self.info.folder.join(COORDINATOR_LOCK))? })
    }

    /// Releases the locks. For the other members, this process has left the run.
    pub fn release(&self) {
        for lock in [&self.own, &self.members] {
            let _ = lock.unlock();
        }
    }
}

/// Leaves the run. The last member removes the folder and the shared memory of the run.
impl Drop for RunDir {
    fn drop(&mut self) {
        self.release();
        if self.members.try_lock().is_ok() {
            remove_run(&self.info.folder, &self.info.prefix);
        }
    }
}

fn participant_lock(role: &str) -> String {
    format!("participant-{role}.lock")
}

/// Watch on the coordinator of a run.
#[derive(Debug)]
pub struct CoordinatorWatch {
    lock: File,
}

impl CoordinatorWatch {
    /// Returns true if the coordinator holds its lock.
    #[must_use]
    pub fn is_alive(&self) -> bool {
        match self.lock.try_lock_shared() {
            Ok(()) => {
                let _ = self.lock.unlock();
                false
            }
            Err(_) => true,
        }
    }
}

/// Returns the free shared memory [byte]; `u64::MAX` if unknown.
#[must_use]
pub fn free_shared_memory() -> u64 {
    rustix::fs::statvfs(SHARED_MEMORY).map_or(u64::MAX, |s| s.f_bavail.saturating_mul(s.f_frsize))
}

/// Returns the peak resident memory of this process since its start or the last reset [byte], if
/// known.
#[must_use]
pub fn peak_resident_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

/// Resets [`peak_resident_memory`], if the system supports it (`proc_pid_clear_refs(5)`).
pub fn forget_peak_resident_memory() {
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Returns the user and system processor time of this process so far [s].
#[must_use]
pub fn processor_seconds() -> f64 {
    let spent = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    spent.tv_sec as f64 + 1e-9 * spent.tv_nsec as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_member_removes_the_run() {
        let run = RunDir::create(&["mech".to_owned()]).unwrap();
        let folder = run.info().folder.clone();
        let file = Path::new(SHARED_MEMORY).join(format!("{}probe", run.info().prefix));
        fs::write(&file, b"x").unwrap();
        let member = RunDir::join(&folder, "mech").unwrap();
        assert!(RunDir::join(&folder, "mech").is_err(), "the role is taken");
        assert!(RunDir::join(&folder, "thermal").is_err(), "there is no such role");
        assert!(!run.has_left("mech"));
        assert_eq!(member.info(), run.info());
        let watch = member.watch().unwrap();
        assert!(watch.is_alive());
        drop(run);
        assert!(!watch.is_alive());
        assert!(folder.exists() && file.exists(), "a member still lives");
        drop(member);
        assert!(!folder.exists() && !file.exists());
    }

    #[test]
    fn a_living_run_is_not_taken_for_dead() {
        let run = RunDir::create(&[]).unwrap();
        assert!(!runtime::is_dead(&run.info().folder));
        let other = RunDir::create(&[]).unwrap();
        assert!(run.info().folder.exists());
        assert_ne!(run.info().prefix, other.info().prefix);
    }

    #[test]
    fn what_a_dead_run_left_is_removed_by_the_next() {
        let run = RunDir::create(&[]).unwrap();
        let (folder, prefix) = (run.info().folder.clone(), run.info().prefix.clone());
        let file = Path::new(SHARED_MEMORY).join(format!("{prefix}left"));
        fs::write(&file, b"x").unwrap();
        // Like a killed process: the kernel releases the locks, and nothing is removed.
        run.release();
        std::mem::forget(run);
        assert!(folder.exists());
        drop(RunDir::create(&[]).unwrap());
        assert!(!folder.exists() && !file.exists());
    }

    #[test]
    fn joining_a_run_that_is_not_there_names_the_folder() {
        let error = RunDir::join(Path::new("/nonexistent/run"), "mech").unwrap_err();
        assert!(error.to_string().contains("/nonexistent/run"));
    }

    /// The last member would remove the files named by a foreign `run.json`.
    #[test]
    fn a_run_that_names_what_is_not_its_own_is_not_joined() {
        let run = RunDir::create(&["mech".to_owned()]).unwrap();
        let (info, other) = (run.info().clone(), RunDir::create(&[]).unwrap());
        let everything = RunInfo { prefix: String::new(), ..info.clone() };
        let elsewhere = RunInfo { folder: other.info().folder.clone(), ..info.clone() };
        let others = RunInfo { prefix: other.info().prefix.clone(), ..info.clone() };
        for wrong in [everything, elsewhere, others] {
            fs::write(info.folder.join(RUN_FILE), serde_json::to_vec(&wrong).unwrap()).unwrap();
            let error = RunDir::join(&info.folder, "mech").unwrap_err().to_string();
            assert!(error.contains("do not belong to it"), "{error}");
        }
        fs::write(info.folder.join(RUN_FILE), serde_json::to_vec(&info).unwrap()).unwrap();
    }

    /// No other user may open a file of a run, because this would let that user block joining
    /// processes.
    #[test]
    fn the_shared_memory_of_a_run_is_closed_to_others() {
        let run = RunDir::create(&["mech".to_owned()]).unwrap();
        let endpoint = crate::transport::Endpoint::open(run.info()).unwrap();
        let _bell = endpoint.doorbell("coordinator").unwrap();
        let entries = fs::read_dir(SHARED_MEMORY).unwrap().flatten();
        let of_run = |entry: &fs::DirEntry| {
            entry.file_name().to_string_lossy().starts_with(&run.info().prefix)
        };
        let files: Vec<_> = entries.filter(of_run).collect();
        assert!(files.len() > 1, "{files:?}");
        for file in &files {
            let mode = file.metadata().unwrap().mode() & 0o777;
            assert_eq!(mode & 0o077, 0, "{file:?}: {mode:o}");
        }
        // A joining process finds the same count of nodes and can open the existing services.
        let second = crate::transport::Endpoint::open(run.info()).unwrap();
        second.ringer("coordinator").unwrap().ring().unwrap();
    }

    #[test]
    fn a_run_of_another_protocol_is_not_joined() {
        let run = RunDir::create(&["mech".to_owned()]).unwrap();
        let folder = run.info().folder.clone();
        let other = RunInfo { protocol: 999, ..run.info().clone() };
        fs::write(folder.join(RUN_FILE), serde_json::to_vec(&other).unwrap()).unwrap();
        let error = RunDir::join(&folder, "mech").unwrap_err().to_string();
        assert!(error.contains("protocol 999"), "{error}");
        assert!(error.ends_with(&crate::PROTOCOL_VERSION.to_string()), "{error}");
    }

    #[test]
    fn memory_figures_are_plausible() {
        assert!(free_shared_memory() > 0);
        assert!(peak_resident_memory().unwrap() > 100_000);
        let before = processor_seconds();
        assert!(before > 0.0 && processor_seconds() >= before);
    }
}
