//! The result directory: `summary.json`, `iterations.csv`, `fields/`, the case as run, `log.jsonl`.

pub mod iterations;
pub mod show;
pub mod summary;
pub mod vtk;

use crate::error::{RunError, file_failure};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Files and folders that a run writes; nothing else in the folder is touched.
const OURS: [&str; 5] = ["summary.json", "iterations.csv", "fields", "case.toml", "log.jsonl"];

/// The folder that a run writes into.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
}

impl ResultFolder {
    /// Creates the folder, or clears the results of an earlier run out of it.
    pub fn prepare(path: &Path) -> Result<Self, RunError> {
        let failed = |error| file_failure(path, &error);
        fs::create_dir_all(path).map_err(failed)?;
        for name in OURS {
            let old = path.join(name);
            let removed =
                if old.is_dir() { fs::remove_dir_all(&old) } else { fs::remove_file(&old) };
            match removed {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(file_failure(&old, &error));
                }
                _ => {}
            }
        }
        Ok(Self { path: path.to_owned() })
    }

    /// Path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of a file in it.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes a small file in one go.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        let path = self.file(name);
        fs::write(&path, content).map_err(|error| file_failure(&path, &error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_results_go_and_foreign_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("fields")).unwrap();
        fs::write(at("fields/old.vti"), "x").unwrap();
        fs::write(at("summary.json"), "{}").unwrap();
        fs::write(at("notes.txt"), "mine").unwrap();
        ResultFolder::prepare(folder.path()).unwrap();
        assert!(!at("fields").exists() && !at("summary.json").exists());
        assert_eq!(fs::read_to_string(at("notes.txt")).unwrap(), "mine");
    }
}
