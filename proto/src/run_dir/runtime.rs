//! Folder of all runs of a user, and removal of dead runs from it.
//!
//! The folder is named `cosim-UID` and lies in `/dev/shm`, or in the folder given by
//! `COSIM_RUNTIME_DIR`. It lies in memory because iceoryx2 flushes every small file that describes
//! a service, which is slow on a busy disk. The folder exists only while there are runs; its parent
//! belongs to the user and stays.
//!
//! Only files created by a run are removed. The runtime folder must belong to us alone and must not
//! be a symbolic link. A run is a subfolder named by an identifier, with a `run.json` of the same
//! identifier. A shared-memory file of a run belongs to us and has the run's prefix.

use super::locks::{COORDINATOR_LOCK, MEMBERS_LOCK, RUN_FILE, is_free};
use std::ffi::OsStr;
use std::fs::{self, Metadata};
use std::io;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

pub(super) const SHARED_MEMORY: &str = "/dev/shm";
/// Maximum path length of the runtime folder [byte]: socket paths of services must fit into 108
/// bytes.
const LONGEST_PATH: usize = 44;
/// Prefix of run folders whose locks are not yet held.
const NURSERY: &str = ".new-";
/// Age after which a run without its locks is considered dead.
const NURSERY_AGE: Duration = Duration::from_secs(60);
/// Files in a run's folder before it gets its final name.
const FIRST_FILES: [&str; 3] = [RUN_FILE, COORDINATOR_LOCK, MEMBERS_LOCK];

/// Folder of all runs of this user.
#[derive(Debug)]
pub(super) struct RuntimeFolder(PathBuf);

impl RuntimeFolder {
    /// Opens the folder set by the environment, and creates it if missing; it must be ours alone.
    pub(super) fn open() -> io::Result<Self> {
        if let Some(root) = std::env::var_os("COSIM_RUNTIME_DIR") {
            return Self::within(Path::new(&root));
        }
        let folder = Self::of(Path::new(SHARED_MEMORY))?;
        folder.make()?;
        Ok(folder)
    }

    /// Opens the folder under a root other than `/dev/shm`, where no other user may replace it.
    fn within(root: &Path) -> io::Result<Self> {
        // Normalised by components, because a trailing slash would follow a symbolic link.
        let root: PathBuf = root.components().collect();
        let folder = Self::of(&root)?;
        fs::DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(&root)
            .map_err(|e| at(&root, e))?;
        check_root(&root)?;
        folder.make()?;
        Ok(folder)
    }

    fn of(root: &Path) -> io::Result<Self> {
        let path = root.join(format!("cosim-{}", user()));
        if path.as_os_str().len() > LONGEST_PATH || !path.is_absolute() {
            return Err(io::Error::other(format!(
                "the runtime folder {} must be an absolute path of at most {LONGEST_PATH} bytes; \
                 set COSIM_RUNTIME_DIR to a shorter one",
                path.display()
            )));
        }
        Ok(Self(path))
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    /// Creates the folder if missing; fails if it is not ours alone.
    fn make(&self) -> io::Result<()> {
        let path = &self.0;
        let found = loop {
            match fs::DirBuilder::new().mode(0o700).create(path) {
                Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
                    return Err(at(path, error));
                }
                _ => {}
            }
            match folder(path) {
                // The last run to end removes the folder, possibly at this moment.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                found => break found?,
            }
        };
        if found.uid() != user() {
            return Err(refused(path, "belongs to another user", "remove it"));
        }
        if found.mode() & 0o077 != 0 {
            return Err(refused(path, "is open to other users", "`chmod 700` it"));
        }
        Ok(())
    }

    /// Creates a new folder `.new-ID` for a run, with a unique identifier.
    pub(super) fn nursery(&self) -> io::Result<(String, PathBuf)> {
        let mut seed = SystemTime::now()
            .duration_since(SystemTime::UNIX_EPOCH)
            .map_or(0, |d| d.subsec_nanos() ^ d.as_secs() as u32)
            ^ std::process::id().rotate_left(16);
        loop {
            let id = format!("{seed:08x}");
            let nursery = self.0.join(format!("{NURSERY}{id}"));
            match fs::DirBuilder::new().mode(0o700).create(&nursery) {
                Ok(()) if !self.0.join(&id).exists() => return Ok((id, nursery)),
                Ok(()) => fs::remove_dir(&nursery)?,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                // The last run to end removes the runtime folder, possibly at this moment.
                Err(error) if error.kind() == io::ErrorKind::NotFound => self.make()?,
                Err(error) => return Err(at(&nursery, error)),
            }
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        }
    }

    /// Removes the runs without living processes.
    pub(super) fn remove_dead_runs(&self) {
        let Ok(entries) = fs::read_dir(&self.0) else { return };
        for entry in entries.flatten() {
            let (folder, name) = (entry.path(), entry.file_name());
            let Some(name) = name.to_str().filter(|_| is_ours(&folder)) else { continue };
            match name.strip_prefix(NURSERY) {
                Some(id) if is_identifier(id) => remove_nursery(&folder),
                None if is_dead(&folder) => {
                    tracing::info!(run = name, "removing what a dead run left");
                    remove_run(&folder, &prefix_of(name));
                }
                _ => {}
            }
        }
    }
}

/// Checks that the root belongs to us or to the system, and has the sticky bit if others may write
/// to it.
fn check_root(root: &Path) -> io::Result<()> {
    let found = folder(root)?;
    if ![0, user()].contains(&found.uid()) {
        return Err(refused(root, "belongs to another user", "choose one of your own"));
    }
    if found.mode() & 0o022 != 0 && found.mode() & 0o1000 == 0 {
        return Err(refused(root, "may be changed by other users", "`chmod go-w` it"));
    }
    Ok(())
}

/// Returns the metadata of a folder; fails for a symbolic link and for other files.
fn folder(path: &Path) -> io::Result<Metadata> {
    let found = fs::symlink_metadata(path).map_err(|error| at(path, error))?;
    match found.is_dir() {
        true => Ok(found),
        false if found.is_symlink() => {
            Err(refused(path, "is a symbolic link", "name the folder itself"))
        }
        false => Err(refused(path, "is not a directory", "remove it")),
    }
}

fn refused(path: &Path, why: &str, fix: &str) -> io::Error {
    io::Error::other(format!("the runtime folder {} {why}; {fix}", path.display()))
}

fn at(path: &Path, error: io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("the runtime folder {}: {error}", path.display()))
}

/// Effective user of this process.
pub(super) fn user() -> u32 {
    rustix::process::geteuid().as_raw()
}

/// Returns true for a folder that is ours and not a symbolic link.
fn is_ours(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_dir() && found.uid() == user())
}

fn is_identifier(name: &str) -> bool {
    name.len() == 8 && name.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
}

/// Returns the prefix of the shared-memory files of a run.
pub(super) fn prefix_of(id: &str) -> String {
    format!("cosim_{id}_")
}

/// Returns true if the folder's name is an identifier and the prefix belongs to it.
pub(super) fn belong_together(folder: &Path, prefix: &str) -> bool {
    let id = folder.file_name().and_then(OsStr::to_str);
    id.is_some_and(|id| is_identifier(id) && prefix == prefix_of(id))
}

/// Returns true if the folder is that of a run, of any version, without held locks.
pub(super) fn is_dead(folder: &Path) -> bool {
    let marker = fs::read(folder.join(RUN_FILE)).ok();
    let marker = marker.and_then(|text| serde_json::from_slice::<serde_json::Value>(&text).ok());
    let prefix = marker.as_ref().and_then(|marker| marker["prefix"].as_str());
    prefix.is_some_and(|prefix| belong_together(folder, prefix))
        && [COORDINATOR_LOCK, MEMBERS_LOCK].iter().all(|lock| is_free(&folder.join(lock)))
}

/// Removes the folder of a run whose creation was interrupted long ago, unless it holds other
/// files.
fn remove_nursery(nursery: &Path) {
    let made = fs::metadata(nursery).and_then(|found| found.modified());
    let old = made.is_ok_and(|made| made.elapsed().is_ok_and(|age| age > NURSERY_AGE));
    let first = |name: &OsStr| FIRST_FILES.iter().any(|file| name == OsStr::new(file));
    let Ok(entries) = fs::read_dir(nursery) else { return };
    if old && entries.flatten().all(|entry| first(&entry.file_name())) {
        remove_first_files(nursery);
    }
}

/// Removes the folder of an incomplete run, and the runtime folder if it is then empty.
pub(super) fn remove_first_files(nursery: &Path) {
    for file in FIRST_FILES {
        let _ = fs::remove_file(nursery.join(file));
    }
    let _ = fs::remove_dir(nursery);
    let _ = nursery.parent().map(fs::remove_dir);
}

/// Removes all remains of a run from the machine.
pub(super) fn remove_run(folder: &Path, prefix: &str) {
    for file in shared_memory_of(prefix) {
        let _ = fs::remove_file(file);
    }
    if let Err(error) = remove_folder(folder)
        && error.kind() != io::ErrorKind::NotFound
    {
        tracing::warn!(folder = %folder.display(), %error, "cannot remove the run's folder");
    }
    // Succeeds only for the last run.
    let _ = folder.parent().map(fs::remove_dir);
}

/// Removes a run's folder. The marker file goes last, so that a later run can complete an
/// interrupted removal.
fn remove_folder(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            fs::remove_dir_all(entry.path())?;
        } else if entry.file_name() != RUN_FILE {
            fs::remove_file(entry.path())?;
        }
    }
    fs::remove_file(folder.join(RUN_FILE))?;
    fs::remove_dir(folder)
}

/// Our shared-memory files with a run's prefix.
fn shared_memory_of(prefix: &str) -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten();
    let of_run = move |entry: &fs::DirEntry| {
        entry.file_name().to_str().is_some_and(|name| name.starts_with(prefix))
            && entry.metadata().is_ok_and(|found| found.uid() == user())
    };
    entries.filter(of_run).map(|entry| entry.path())
}

/// Closes the one file that iceoryx2 leaves open to every user: the file that counts the nodes of a
/// run. Each joining process opens this file, and another user could block it there. A copy that
/// only we may open replaces the file; anyone who opened the original holds an unused file.
pub(crate) fn close_to_others(prefix: &str) -> io::Result<()> {
    for file in shared_memory_of(prefix) {
        let open = fs::symlink_metadata(&file)?.mode() & 0o077 != 0;
        if open && file.extension() == Some(OsStr::new("global_mgmt")) {
            let closed = file.with_extension("closed");
            let content = fs::read(&file)?;
            let mut options = fs::OpenOptions::new();
            let mut copy = options.write(true).create_new(true).mode(0o600).open(&closed)?;
            io::Write::write_all(&mut copy, &content)?;
            fs::rename(&closed, &file)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::os::unix::fs::{PermissionsExt, symlink};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;
    use tempfile::TempDir;

    fn place() -> TempDir {
        tempfile::Builder::new().prefix("ct-").tempdir_in(SHARED_MEMORY).unwrap()
    }

    fn message(root: &Path) -> String {
        RuntimeFolder::within(root).map(|_| ()).unwrap_err().to_string()
    }

    /// Creates a folder as left by a dead run, with a file in shared memory.
    fn dead_run(runtime: &Path, id: &str) -> (PathBuf, PathBuf) {
        let (folder, prefix) = (runtime.join(id), prefix_of(id));
        fs::create_dir(&folder).unwrap();
        for lock in [COORDINATOR_LOCK, MEMBERS_LOCK] {
            File::create(folder.join(lock)).unwrap();
        }
        fs::write(folder.join(RUN_FILE), format!("{{\"prefix\": {prefix:?}}}")).unwrap();
        let file = Path::new(SHARED_MEMORY).join(format!("{prefix}left"));
        fs::write(&file, b"x").unwrap();
        (folder, file)
    }

    /// Identifier that no other process uses for its tests.
    fn id(number: u32) -> String {
        format!("{:08x}", std::process::id().wrapping_mul(64) + number)
    }

    #[test]
    fn the_users_own_folder_stays() {
        let root = place();
        let runtime = RuntimeFolder::within(root.path()).unwrap();
        let (folder, file) = dead_run(runtime.path(), &id(0));
        runtime.remove_dead_runs();
        assert!(!folder.exists() && !file.exists());
        assert!(!runtime.path().exists(), "the last run removes the folder of all runs");
        assert!(root.path().exists(), "and not the one that holds it");
    }

    #[test]
    fn only_what_a_run_has_made_is_removed() {
        let root = place();
        let runtime = RuntimeFolder::within(root.path()).unwrap();
        let here = |name: &str| runtime.path().join(name);
        let kept = [here("both-locks"), here(".new-mine"), here(&format!(".new-{}", id(1)))];
        for folder in &kept {
            fs::create_dir(folder).unwrap();
            for name in ["precious", COORDINATOR_LOCK, MEMBERS_LOCK] {
                File::create(folder.join(name)).unwrap();
            }
            set_age(folder, 2 * NURSERY_AGE);
        }
        // Named like a run, with the marker file of another run.
        let (other, other_file) = dead_run(runtime.path(), &id(2));
        let text = fs::read_to_string(other.join(RUN_FILE)).unwrap();
        fs::write(other.join(RUN_FILE), text.replace(&id(2), &id(3))).unwrap();
        // Link to a dead run elsewhere.
        let elsewhere = place();
        let (linked, linked_file) = dead_run(elsewhere.path(), &id(4));
        symlink(&linked, here(&id(4))).unwrap();
        let (dead, file) = dead_run(runtime.path(), &id(5));
        let begun = here(&format!(".new-{}", id(6)));
        fs::create_dir(&begun).unwrap();
        File::create(begun.join(RUN_FILE)).unwrap();
        set_age(&begun, 2 * NURSERY_AGE);
        runtime.remove_dead_runs();
        assert!(!dead.exists() && !file.exists() && !begun.exists());
        assert!(kept.iter().all(|folder| folder.join("precious").exists()), "{kept:?}");
        assert!(other.exists() && other_file.exists() && linked.exists() && linked_file.exists());
        for file in [other_file, linked_file] {
            fs::remove_file(file).unwrap();
        }
    }

    fn set_age(path: &Path, age: Duration) {
        let then = SystemTime::now() - age;
        File::open(path).unwrap().set_modified(then).unwrap();
    }

    #[test]
    fn symbolic_links_are_not_followed() {
        let (root, other) = (place(), place());
        let runtime = RuntimeFolder::within(other.path()).unwrap();
        let (folder, file) = dead_run(runtime.path(), &id(10));
        let link = root.path().join("root");
        symlink(other.path(), &link).unwrap();
        for root in [link.clone(), link.join("")] {
            let text = message(&root);
            assert!(text.contains("is a symbolic link; name the folder itself"), "{text}");
        }
        symlink(runtime.path(), root.path().join(format!("cosim-{}", user()))).unwrap();
        assert!(message(root.path()).contains("is a symbolic link"), "{}", message(root.path()));
        assert!(folder.exists() && file.exists());
        fs::remove_file(file).unwrap();
    }

    #[test]
    fn a_folder_that_others_may_change_is_refused() {
        let root = place();
        let set = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode));
        set(root.path(), 0o777).unwrap();
        assert!(message(root.path()).contains("may be changed by other users"));
        set(root.path(), 0o1777).unwrap();
        let runtime = RuntimeFolder::within(root.path()).unwrap();
        let (folder, file) = dead_run(runtime.path(), &id(20));
        set(runtime.path(), 0o755).unwrap();
        assert!(message(root.path()).contains("is open to other users; `chmod 700` it"));
        assert!(folder.exists() && file.exists());
        fs::remove_file(file).unwrap();
    }

    /// Only root can give a folder to another user.
    #[test]
    fn a_folder_of_another_user_is_refused() {
        if user() != 0 {
            return;
        }
        let root = place();
        let runtime = RuntimeFolder::within(root.path()).unwrap();
        let (folder, file) = dead_run(runtime.path(), &id(30));
        let give = |path: &Path| std::os::unix::fs::chown(path, Some(4321), None).unwrap();
        give(runtime.path());
        assert!(message(root.path()).contains("belongs to another user; remove it"));
        give(root.path());
        assert!(message(root.path()).contains("belongs to another user; choose one of your own"));
        assert!(folder.exists() && file.exists());
        // Shared memory of another user is never removed, whatever its name.
        give(&file);
        remove_run(&folder, &prefix_of(&id(30)));
        assert!(!folder.exists() && file.exists());
        fs::remove_file(file).unwrap();
    }

    /// The last run to end removes the folder, at whatever moment another begins.
    #[test]
    fn a_run_begins_while_the_last_one_ends() {
        let root = place();
        let path = RuntimeFolder::within(root.path()).unwrap().path().to_owned();
        let done = AtomicBool::new(false);
        thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    let _ = fs::remove_dir(&path);
                }
            });
            let begun: Vec<_> = (0..2000).map(|_| RuntimeFolder::within(root.path())).collect();
            done.store(true, Ordering::Relaxed);
            assert!(begun.iter().all(Result::is_ok), "{:?}", begun.iter().find(|one| one.is_err()));
        });
    }

    #[test]
    fn a_path_that_is_too_long_is_refused() {
        let root = place();
        let text = message(&root.path().join("a-long-name/".repeat(4)));
        assert!(text.contains("at most 44 bytes"), "{text}");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0, "nothing is made");
    }
}
