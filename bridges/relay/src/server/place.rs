//! Files of a conversation: files named by the case, and states. This end chooses all file names.

use proto::recording::CaseFile;
use run::record::portable_body;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Maximum number and total size [byte] of the files named by a case.
const FILES: usize = 256;
const BYTES: u64 = 4 << 30;
/// Maximum number of parts of a state: the state itself and the saved outputs.
const PARTS: u16 = 256;
const LARGEST_STATE: u64 = 64 << 30;

/// Folder of a conversation, and its files.
pub(super) struct Place {
    /// Removed on drop; if the process is killed, with the folder of the run.
    folder: TempDir,
    /// Local path of each file, by its key in the case.
    files: BTreeMap<String, PathBuf>,
    /// File being written.
    open: Option<(PathBuf, File)>,
    file_bytes: u64,
    state_bytes: u64,
}

impl Place {
    /// Creates the folder within the folder of a run.
    pub(super) fn new(run: &Path) -> io::Result<Self> {
        let folder = tempfile::Builder::new().prefix("relay-").tempdir_in(run)?;
        let files = BTreeMap::new();
        Ok(Self { folder, files, open: None, file_bytes: 0, state_bytes: 0 })
    }

    /// Writes a piece of the file named under a key of the case.
    pub(super) fn file(
        &mut self,
        key: &str,
        ending: &str,
        bytes: &[u8],
        last: bool,
    ) -> io::Result<()> {
        let known = self.files.len();
        let path = match self.files.get(key) {
            Some(path) => path.clone(),
            None if known >= FILES => {
                return Err(io::Error::other("the case names too many files"));
            }
            None => {
                let simple =
                    ending.len() <= 16 && ending.bytes().all(|b| b.is_ascii_alphanumeric());
                let mut path = self.folder.path().join(format!("file-{known}"));
                if simple && !ending.is_empty() {
                    path.set_extension(ending);
                }
                self.files.insert(key.to_owned(), path.clone());
                path
            }
        };
        self.file_bytes += bytes.len() as u64;
        if self.file_bytes > BYTES {
            return Err(io::Error::other(format!(
                "the files of the case have more than {} GiB",
                BYTES >> 30
            )));
        }
        self.piece(path, bytes, last)
    }

    /// Writes a piece of a part of a state.
    pub(super) fn state(&mut self, part: u16, bytes: &[u8], last: bool) -> io::Result<()> {
        self.state_bytes += bytes.len() as u64;
        if part >= PARTS || self.state_bytes > LARGEST_STATE {
            return Err(io::Error::other("the state is too large"));
        }
        self.piece(self.part(part), bytes, last)
    }

    fn piece(&mut self, path: PathBuf, bytes: &[u8], last: bool) -> io::Result<()> {
        let open = match self.open.take() {
            Some((same, file)) if same == path => (same, file),
            _ => {
                let file = File::create(&path)?;
                (path, file)
            }
        };
        (&open.1).write_all(bytes)?;
        self.open = (!last).then_some(open);
        Ok(())
    }

    /// Returns the path of a part of a state.
    pub(super) fn part(&self, part: u16) -> PathBuf {
        self.folder.path().join(format!("part-{part}"))
    }

    /// Removes the files of a state.
    pub(super) fn clear_state(&mut self) {
        self.state_bytes = 0;
        for part in 0..PARTS {
            if std::fs::remove_file(self.part(part)).is_err() {
                return;
            }
        }
    }

    /// Replaces the client's paths in a configuration by local ones.
    pub(super) fn configuration(&self, body: &[u8]) -> Vec<u8> {
        let file = |(key, path): (&String, &PathBuf)| CaseFile {
            key: key.clone(),
            attachment: path.to_string_lossy().into_owned(),
        };
        let files: Vec<CaseFile> = self.files.iter().map(file).collect();
        portable_body(body, &files)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_put_together_and_named_here() {
        let run = tempfile::tempdir().unwrap();
        let mut place = Place::new(run.path()).unwrap();
        place.file("bodies.rail.profile", "csv", b"1,", false).unwrap();
        place.file("bodies.rail.profile", "csv", b"2", true).unwrap();
        place.file("../../etc.passwd", "../x", b"x", true).unwrap();
        let inside = |path: &PathBuf| path.parent() == Some(place.folder.path());
        assert!(place.files.values().all(inside), "{:?}", place.files);
        let body = br#"{"case": {"bodies": {"rail": {"profile": "/home/me/rail.csv"}}}}"#;
        let there = String::from_utf8(place.configuration(body)).unwrap();
        assert!(there.contains("file-0.csv") && !there.contains("/home/me"), "{there}");
        let path = place.files["bodies.rail.profile"].clone();
        assert_eq!(std::fs::read(path).unwrap(), b"1,2");
        assert_eq!(place.configuration(b"no JSON"), b"no JSON");
    }

    #[test]
    fn there_is_an_end_to_files() {
        let run = tempfile::tempdir().unwrap();
        let mut place = Place::new(run.path()).unwrap();
        for number in 0..FILES {
            place.file(&number.to_string(), "", b"", true).unwrap();
        }
        assert!(place.file("one.more", "", b"", true).is_err());
        assert!(place.state(PARTS, b"", true).is_err());
        place.state(0, b"a", true).unwrap();
        place.clear_state();
        assert!(!place.part(0).exists());
    }
}
