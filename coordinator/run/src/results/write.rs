//! Writing of files: each is written under another name beside its place, and renamed when it is
//! complete. Therefore a file under its final name is complete, and a link in its place is
//! replaced, not followed.
//!
//! Files that grow during a run (the log, the table of iterations, the recording) have their names
//! from the start. Each of them is readable up to its last complete row.

use super::dir::Dir;
use crate::error::{RunError, file_failure};
use rustix::fs::{FallocateFlags, fallocate};
use rustix::io::Errno;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Ending of the name of an unfinished file.
pub const UNFINISHED: &str = ".new";

/// Replaces a file as a whole: a reader sees the old or the new content, even after a crash.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), RunError> {
    create(path, |out| out.write_all(content))
}

/// Replaces a file as a whole by the output of `write`.
pub fn create(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), RunError> {
    let new = beside(path);
    let written = fresh(&new).map(BufWriter::new).and_then(|mut out| {
        write(&mut out)?;
        out.flush()?;
        fs::rename(&new, path)
    });
    written.map_err(|error| {
        // Half a file is useless, and may be what fills the disk.
        let _ = fs::remove_file(&new);
        file_failure(path, &error)
    })
}

/// Creates a new file, replacing an existing one.
pub fn fresh(path: &Path) -> io::Result<File> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// Removes a file, if it exists.
pub fn remove(path: &Path) -> Result<(), RunError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(file_failure(path, &error)),
        _ => Ok(()),
    }
}

/// Returns the path of the new content of a file before the file is renamed.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(UNFINISHED);
    PathBuf::from(name)
}

/// Disk space reserved for a small file, so that it can be written to a full disk.
#[derive(Debug)]
pub struct Reserve {
    /// Keeps the folder open: the path leads through its handle.
    _dir: Dir,
    path: PathBuf,
    file: File,
}

impl Reserve {
    /// Reserves disk space in a file of this name.
    pub fn keep(dir: &Dir, name: &str, bytes: u64) -> Result<Self, RunError> {
        let path = dir.path().join(name);
        let keep = || {
            let file = fresh(&path)?;
            match fallocate(&file, FallocateFlags::KEEP_SIZE, 0, bytes) {
                // Some file systems cannot reserve space.
                Ok(()) | Err(Errno::OPNOTSUPP | Errno::NOSYS) => Ok(file),
                Err(error) => Err(error.into()),
            }
        };
        match keep() {
            Ok(file) => Ok(Self { _dir: dir.clone(), path, file }),
            Err(error) => Err(file_failure(&path, &error)),
        }
    }

    /// Writes the file into the reserved space, and renames it.
    pub fn write(mut self, path: &Path, content: &[u8]) -> Result<(), RunError> {
        let written = self.file.write_all(content).and_then(|()| fs::rename(&self.path, path));
        written.map_err(|error| file_failure(path, &error))?;
        // Releases the space beyond the content. Failure does not affect the content.
        let _ = self.file.set_len(content.len() as u64);
        Ok(())
    }
}

/// Removes the reserved file if it has not been used.
impl Drop for Reserve {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::{MetadataExt, symlink};

    #[test]
    fn a_file_has_its_name_when_it_is_complete() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("file");
        replace(&path, b"old").unwrap();
        let torn = create(&path, |out| {
            out.write_all(&[0; 100_000])?;
            Err(io::Error::other("full"))
        });
        assert!(torn.unwrap_err().to_string().contains("full"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1, "nothing half-written stays");
    }

    #[test]
    fn a_link_is_replaced_and_its_target_stays() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        fs::write(at("target"), "mine").unwrap();
        for link in ["file", "file.new"] {
            symlink(at("target"), at(link)).unwrap();
        }
        replace(&at("file"), b"new").unwrap();
        assert_eq!(fs::read(at("target")).unwrap(), b"mine");
        assert_eq!(fs::read(at("file")).unwrap(), b"new");
        assert!(!at("file").is_symlink());
    }

    #[test]
    fn space_is_kept_and_becomes_the_file() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        let dir = Dir::open(place.path()).unwrap();
        drop(Reserve::keep(&dir, "kept", 64 << 10).unwrap());
        assert!(!at("kept").exists());
        let reserve = Reserve::keep(&dir, "kept", 64 << 10).unwrap();
        let kept = fs::metadata(at("kept")).unwrap();
        assert!(kept.blocks() * 512 >= 64 << 10, "{} blocks", kept.blocks());
        reserve.write(&at("file"), b"content").unwrap();
        assert_eq!(fs::read(at("file")).unwrap(), b"content");
        assert!(!at("kept").exists());
    }
}
