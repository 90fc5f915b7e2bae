//! The folder of a study: nothing but an earlier study of the same kind is ever replaced.

use crate::error::{RunError, file_failure};
use crate::results::folder::replace;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder that a study may write into; it is made when the first file is written.
#[derive(Clone, Debug)]
pub struct StudyFolder {
    path: PathBuf,
}

impl StudyFolder {
    /// The folder at this path, for a study whose record has this name.
    ///
    /// # Errors
    /// [`RunError::Usage`] if it is a file, or holds files but no such record.
    pub fn check(path: &Path, record: &str) -> Result<Self, RunError> {
        let shown = path.display();
        if path.ancestors().any(Path::is_file) {
            let what = format!("{shown} is, or lies in, a file; give a folder with --out");
            return Err(RunError::Usage(what));
        }
        let filled = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
        if filled && !is_record(&path.join(record)) {
            let what = format!("{shown} holds files but no {record}; give a new folder with --out");
            return Err(RunError::Usage(what));
        }
        Ok(Self { path: path.to_owned() })
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file in one go.
    ///
    /// # Errors
    /// The file system.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        fs::create_dir_all(&self.path).map_err(|error| file_failure(&self.path, &error))?;
        replace(&self.path.join(name), content)
    }
}

/// The record of a study: JSON with a version.
fn is_record(path: &Path) -> bool {
    let read = fs::read(path).ok().and_then(|text| serde_json::from_slice(&text).ok());
    read.is_some_and(|record: Value| record["schema"].is_u64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_study_of_the_same_kind_is_replaced() {
        let place = tempfile::tempdir().unwrap();
        let out = place.path().join("out");
        let check = || StudyFolder::check(&out, "cost.json");
        let folder = check().unwrap();
        assert!(!out.exists(), "nothing is made before there is something to write");
        folder.write("cost.json", b"{\"schema\":1}").unwrap();
        check().unwrap();
        let other = StudyFolder::check(&out, "ablate.json").unwrap_err().to_string();
        assert!(other.contains("holds files but no ablate.json"), "{other}");
        fs::write(out.join("cost.json"), "mine").unwrap();
        assert!(check().is_err());
        let file = StudyFolder::check(&out.join("cost.json/below"), "cost.json").unwrap_err();
        assert!(file.to_string().contains("a file; give a folder"), "{file}");
    }
}
