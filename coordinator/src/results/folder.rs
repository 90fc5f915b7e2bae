//! The folder that a run writes into: whose it is, who may write now, and what is cleared.
//!
//! Nothing but the results of an earlier run is ever removed. A folder that is neither empty nor
//! known by its `summary.json` or `log.jsonl` as a result folder is refused, and so is one that
//! another run is writing into: a run holds a lock on its `log.jsonl` until its process ends.

use crate::checkpoint::Checkpoints;
use crate::error::{RunError, file_failure};
use crate::results::summary::Status;
use crate::results::vtk::{SCENE, is_scene};
use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The log, which also carries the lock.
const LOG: &str = "log.jsonl";

/// Files that a run writes besides the log and the fields.
const FILES: [&str; 7] = [
    "summary.json",
    "summary.json.new",
    "iterations.csv",
    "case.toml",
    "plan.txt",
    "recording.mcap",
    "report.html",
];

/// What every `log.jsonl` begins with.
const LOG_HEAD: &[u8] = b"{\"timestamp\"";

/// The folder that a run writes into, locked for it.
#[derive(Debug)]
pub struct ResultFolder {
    path: PathBuf,
    log: File,
}

impl ResultFolder {
    /// Creates the folder, or clears the results of an earlier run out of it, for a run of the
    /// case file `case`.
    ///
    /// # Errors
    /// [`RunError::Usage`] if it is a file, holds what no run has written, holds `case` itself
    /// under a name that the run would write, or is used by another run.
    pub fn prepare(path: &Path, case: &Path) -> Result<Self, RunError> {
        create(path)?;
        spare_case(path, case)?;
        if !is_free(path).map_err(|error| file_failure(path, &error))? {
            return Err(RunError::Usage(format!(
                "{} holds files but no results of a run; give a new folder with --out",
                path.display()
            )));
        }
        let log = lock(path)?;
        log.set_len(0).map_err(|error| file_failure(path, &error))?;
        clear(path)?;
        Ok(Self { path: path.to_owned(), log })
    }

    /// The folder of a run that is resumed; nothing is cleared.
    ///
    /// # Errors
    /// [`RunError::Usage`] if no run has written into it, or another run is doing so.
    pub fn resume(path: &Path) -> Result<Self, RunError> {
        if !path.is_dir() || !is_log(&path.join(LOG)) {
            let shown = path.display();
            return Err(RunError::Usage(format!("{shown} holds no results of a run")));
        }
        Ok(Self { path: path.to_owned(), log: lock(path)? })
    }

    /// The run in it has come to its end, with success.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        let text = fs::read(self.file("summary.json")).ok();
        let summary: Option<serde_json::Value> =
            text.and_then(|text| serde_json::from_slice(&text).ok());
        let status = summary.as_ref().and_then(|summary| summary["status"].as_str());
        status.is_some_and(|status| status != Status::Failed.word())
    }

    /// Removes the summary of the end that a resumed run has come to before.
    ///
    /// # Errors
    /// The file system.
    pub fn reopen(&self) -> Result<(), RunError> {
        remove(&self.file("summary.json"))
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

    /// Path of the log.
    #[must_use]
    pub fn log_path(&self) -> PathBuf {
        self.file(LOG)
    }

    /// The log, to be written into.
    pub fn log(&self) -> Result<File, RunError> {
        self.log.try_clone().map_err(|error| file_failure(&self.log_path(), &error))
    }

    /// Writes a small file in one go: it is there as a whole or not at all.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        replace(&self.file(name), content)
    }
}

/// Replaces a file as a whole: a reader, or who comes after a crash, sees the old or the new one.
pub(crate) fn replace(path: &Path, content: &[u8]) -> Result<(), RunError> {
    let new = beside(path);
    fs::write(&new, content)
        .and_then(|()| fs::rename(&new, path))
        .map_err(|error| file_failure(path, &error))
}

/// Where the new content of a file is before it takes its name.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    PathBuf::from(name)
}

fn create(path: &Path) -> Result<(), RunError> {
    match fs::create_dir_all(path) {
        Ok(()) => Ok(()),
        Err(error) => match error.kind() {
            io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => Err(RunError::Usage(
                format!("{} is, or lies in, a file; give a folder with --out", path.display()),
            )),
            _ => Err(file_failure(path, &error)),
        },
    }
}

/// The case file is not one of those that the run replaces.
fn spare_case(path: &Path, case: &Path) -> Result<(), RunError> {
    let Ok(case) = case.canonicalize() else { return Ok(()) };
    for name in FILES.into_iter().chain([LOG]) {
        if path.join(name).canonicalize().is_ok_and(|ours| ours == case) {
            return Err(RunError::Usage(format!(
                "the run would replace its own case file {}; give another folder with --out",
                case.display()
            )));
        }
    }
    Ok(())
}

/// The folder is empty, or an earlier run has written into it.
fn is_free(path: &Path) -> io::Result<bool> {
    for entry in fs::read_dir(path)? {
        if entry?.file_name() != LOG {
            return Ok(is_log(&path.join(LOG)) || is_summary(&path.join("summary.json")));
        }
    }
    // A log alone is what a run leaves that was killed at once.
    Ok(true)
}

fn is_log(path: &Path) -> bool {
    let mut head = [0; LOG_HEAD.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == LOG_HEAD
}

fn is_summary(path: &Path) -> bool {
    let summary = fs::read(path).ok().and_then(|text| serde_json::from_slice(&text).ok());
    summary.is_some_and(|summary: serde_json::Value| summary["schema"].is_u64())
}

/// Takes the log for this run.
fn lock(path: &Path) -> Result<File, RunError> {
    let log_path = path.join(LOG);
    let failed = |error: io::Error| file_failure(&log_path, &error);
    let log = OpenOptions::new().create(true).append(true).open(&log_path).map_err(failed)?;
    match flock(&log, FlockOperation::NonBlockingLockExclusive) {
        Err(Errno::WOULDBLOCK) => {
            return Err(RunError::Usage(format!(
                "{} is used by another run; wait for its end, or give another folder with --out",
                path.display()
            )));
        }
        // Some network file systems know no locks.
        Err(error) => tracing::warn!(%error, "the result folder cannot be locked"),
        Ok(()) => {}
    }
    Ok(log)
}

/// Removes the results of an earlier run.
fn clear(path: &Path) -> Result<(), RunError> {
    FILES.iter().try_for_each(|name| remove(&path.join(name)))?;
    Checkpoints::of(path).clear()?;
    clear_fields(&path.join("fields"))
}

fn remove(path: &Path) -> Result<(), RunError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(file_failure(path, &error)),
        _ => Ok(()),
    }
}

/// Removes the numbered images, their series and the state that opens them, and the folder if nothing
/// else is in it.
fn clear_fields(folder: &Path) -> Result<(), RunError> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(|error| file_failure(folder, &error))?,
    };
    let names: Vec<String> =
        entries.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect();
    let series: BTreeSet<&str> = names.iter().filter_map(|name| series_of_image(name)).collect();
    let is_series = |name: &str| {
        let name = name.strip_suffix(".new").unwrap_or(name);
        name.strip_suffix(".pvd").is_some_and(|name| series.contains(name))
    };
    let is_line = |name: &str| numbered(name, ".csv").is_some_and(|name| series.contains(name));
    let is_state = |name: &str| {
        name.strip_suffix(".new").unwrap_or(name) == SCENE && is_scene(&folder.join(name))
    };
    let is_ours = |name: &str| {
        series_of_image(name).is_some() || is_series(name) || is_line(name) || is_state(name)
    };
    for name in names.iter().filter(|name| is_ours(name)) {
        remove(&folder.join(name))?;
    }
    // What is not ours keeps the folder.
    let _ = fs::remove_dir(folder);
    Ok(())
}

/// `rail_contact` of `rail_contact_000012.vti`.
fn series_of_image(name: &str) -> Option<&str> {
    numbered(name, ".vti").or_else(|| numbered(name, ".vtu"))
}

/// What stands before the number of a file with this ending.
fn numbered<'a>(name: &'a str, ending: &str) -> Option<&'a str> {
    let (series, number) = name.strip_suffix(ending)?.rsplit_once('_')?;
    (number.len() >= 6 && number.bytes().all(|b| b.is_ascii_digit())).then_some(series)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with these files, and the case file beside it.
    fn folder(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf, PathBuf) {
        let place = tempfile::tempdir().unwrap();
        let (out, case) = (place.path().join("out"), place.path().join("mine.toml"));
        fs::create_dir_all(out.join("fields")).unwrap();
        fs::write(&case, "case").unwrap();
        for (name, content) in files {
            fs::write(out.join(name), content).unwrap();
        }
        (place, out, case)
    }

    fn refusal(out: &Path, case: &Path) -> String {
        match ResultFolder::prepare(out, case) {
            Err(RunError::Usage(what)) => what,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn old_results_go_and_foreign_files_stay() {
        let ours = [
            "fields/a_b_000001.vti",
            "fields/a_b_000001.csv",
            "fields/c_000000.vtu",
            "fields/a_b.pvd",
            "summary.json",
            "case.toml",
        ];
        let foreign = ["notes.txt", "fields/mine.vti", "fields/mine.pvd", "fields/mine_000001.csv"];
        let all: Vec<_> =
            ours.iter().chain(&foreign).map(|name| (*name, "{\"schema\":1}")).collect();
        let (_place, out, case) = folder(&all);
        ResultFolder::prepare(&out, &case).unwrap();
        assert!(ours.iter().all(|name| !out.join(name).exists()));
        assert!(foreign.iter().all(|name| out.join(name).exists()));
    }

    #[test]
    fn a_state_goes_and_a_foreign_file_of_its_name_stays() {
        let scene = include_str!("vtk/open.py");
        let state = format!("fields/{SCENE}");
        for (content, stays) in [(scene, false), ("# mine", true)] {
            let (_place, out, case) =
                folder(&[("log.jsonl", "{\"timestamp\":0}"), (&state, content)]);
            ResultFolder::prepare(&out, &case).unwrap();
            assert_eq!(out.join(&state).exists(), stays);
            assert_eq!(out.join("fields").exists(), stays);
        }
    }

    #[test]
    fn a_folder_of_fields_alone_goes() {
        let (_place, out, case) =
            folder(&[("log.jsonl", "{\"timestamp\":0}"), ("fields/a_000000.vti", "")]);
        let prepared = ResultFolder::prepare(&out, &case).unwrap();
        assert!(!out.join("fields").exists());
        assert_eq!(fs::read_to_string(prepared.log_path()).unwrap(), "");
    }

    #[test]
    fn a_folder_without_results_is_refused_and_left_alone() {
        let foreign = ["case.toml", "fields/mine_000001.vti", "summary.json", "log.jsonl"];
        let all: Vec<_> = foreign.iter().map(|name| (*name, "mine")).collect();
        let (_place, out, case) = folder(&all);
        assert!(refusal(&out, &case).contains("no results of a run"));
        for name in foreign {
            assert_eq!(fs::read_to_string(out.join(name)).unwrap(), "mine");
        }
    }

    #[test]
    fn the_case_file_is_never_replaced() {
        let (_place, out, _) = folder(&[("case.toml", "mine"), ("summary.json", "{\"schema\":1}")]);
        let roundabout = out.join("fields/../case.toml");
        assert!(refusal(&out, &roundabout).contains("its own case file"));
        assert_eq!(fs::read_to_string(out.join("case.toml")).unwrap(), "mine");
    }

    #[test]
    fn a_file_is_no_folder() {
        let (_place, out, case) = folder(&[("file", "mine")]);
        for path in [out.join("file"), out.join("file/below")] {
            assert!(refusal(&path, &case).contains("a file; give a folder"));
        }
        assert_eq!(fs::read_to_string(out.join("file")).unwrap(), "mine");
    }

    #[test]
    fn one_run_at_a_time() {
        let (_place, out, case) = folder(&[]);
        fs::remove_dir(out.join("fields")).unwrap();
        let first = ResultFolder::prepare(&out, &case).unwrap();
        first.write("summary.json", b"{\"schema\":1}").unwrap();
        assert!(refusal(&out, &case).contains("is used by another run"));
        assert!(out.join("summary.json").exists(), "the other run's results stay");
        drop(first);
        ResultFolder::prepare(&out, &case).unwrap();
    }
}
