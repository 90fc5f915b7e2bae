//! Names of the files that a run writes into its folder, and their removal. No other file is
//! removed.

use super::claim::{A_RUN, MARKER, holds_results};
use super::dir::{Dir, shown};
use super::last;
use super::vtk::{SCENE, is_scene};
use super::write::{UNFINISHED, remove};
use crate::checkpoint::{self, Checkpoints};
use crate::error::{RunError, file_failure};
use crate::watching::LOOK;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;

/// The log.
pub(super) const LOG: &str = "log.jsonl";
/// The summary.
pub(super) const SUMMARY: &str = "summary.json";
/// File that reserves space for the summary.
pub(super) const RESERVE: &str = ".summary";
/// Folder of the field files.
const FIELDS: &str = "fields";
/// Folder of a refined result while it is computed.
pub(super) const REFINED: &str = "refined";

/// Files that a run writes besides fields and numbered recordings. The summary comes first, because
/// a run without one counts as unfinished.
pub(super) const FILES: [&str; 11] = [
    SUMMARY,
    RESERVE,
    LOG,
    "iterations.csv",
    "history.csv",
    "case.toml",
    "plan.txt",
    "plan.json",
    "recording.mcap",
    "report.html",
    LOOK,
];

/// Removes the results of an earlier run.
pub(super) fn clear(dir: &Dir) -> Result<(), RunError> {
    clear_answer(dir)?;
    remove_refined(dir)
}

/// Removes the results of an earlier run, but not a refined result in progress.
fn clear_answer(dir: &Dir) -> Result<(), RunError> {
    let path = dir.path();
    for name in FILES {
        remove(&path.join(name))?;
        remove(&path.join(format!("{name}{UNFINISHED}")))?;
    }
    let names = dir.names().map_err(|error| file_failure(&path, &error))?;
    for name in names.iter().filter_map(|name| name.to_str()).filter(|name| is_recording(name)) {
        remove(&path.join(name))?;
    }
    Checkpoints::of(&path).clear()?;
    clear_fields(&path.join(FIELDS))
}

/// Replaces the results by the refined ones; the summary is moved last.
pub(super) fn take_over_refined(dir: &Dir) -> Result<(), RunError> {
    let (from, to) = (dir.path().join(REFINED), dir.path());
    clear_answer(dir)?;
    let summary = [from.join(SUMMARY), to.join(SUMMARY)];
    move_all(&from, &to, &[SUMMARY, MARKER])
        .and_then(|()| fs::rename(&summary[0], &summary[1]))
        .map_err(|error| file_failure(&from, &error))?;
    remove_refined(dir)
}

/// Moves the content of a folder into another one. A file whose name is taken there stays: the file
/// in its place was not written by a run.
fn move_all(from: &Path, to: &Path, but: &[&str]) -> io::Result<()> {
    for entry in fs::read_dir(from)? {
        let (path, name, kind) =
            entry.and_then(|e| Ok((e.path(), e.file_name(), e.file_type()?)))?;
        let target = to.join(&name);
        match target.symlink_metadata() {
            _ if but.iter().any(|but| name == *but) => {}
            Err(_) => fs::rename(path, target)?,
            Ok(there) if there.is_dir() && kind.is_dir() => move_all(&path, &target, &[])?,
            Ok(_) => tracing::warn!(
                "{} was not written by a run and is not replaced",
                shown(&target).display()
            ),
        }
    }
    Ok(())
}

/// Checks that the folders into which a run writes are no links.
pub(super) fn refuse_links(dir: &Dir) -> Result<(), RunError> {
    let linked = [FIELDS, checkpoint::FOLDER, REFINED]
        .into_iter()
        .find(|name| dir.path().join(name).is_symlink());
    linked.map_or(Ok(()), |name| {
        let path = dir.shown().join(name);
        let fix = "remove the link, or give another folder with --out";
        Err(RunError::Usage(format!("{} is a link, which is not followed; {fix}", path.display())))
    })
}

/// Removes the remainder of an unfinished refined result.
pub(super) fn remove_refined(dir: &Dir) -> Result<(), RunError> {
    let path = dir.path().join(REFINED);
    if path.is_symlink() || !holds_results(&path, A_RUN) {
        return Ok(());
    }
    let refined = dir.inner(REFINED).map_err(|error| file_failure(&path, &error))?;
    clear(&refined)?;
    remove(&refined.path().join(MARKER))?;
    // A folder with other files in it stays.
    let _ = fs::remove_dir(path);
    Ok(())
}

/// Recognises `recording-000120.mcap`, the recording of a resumed run.
fn is_recording(name: &str) -> bool {
    let number = name.strip_prefix("recording-").and_then(|rest| rest.strip_suffix(".mcap"));
    number.is_some_and(is_number)
}

/// Removes the numbered images, their series, the stored last fields and the scene, and the folder
/// if it is then empty.
fn clear_fields(folder: &Path) -> Result<(), RunError> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(|error| file_failure(folder, &error))?,
    };
    let names: Vec<String> =
        entries.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect();
    let ended = |name: &str| name.strip_suffix(UNFINISHED).unwrap_or(name).to_owned();
    let series: BTreeSet<String> =
        names.iter().filter_map(|name| series_of_image(&ended(name)).map(str::to_owned)).collect();
    let is_ours = |name: &str| {
        let ended = ended(name);
        let is_series = ended.strip_suffix(".pvd").is_some_and(|name| series.contains(name));
        let is_line = numbered(&ended, ".csv").is_some_and(|name| series.contains(name));
        let is_state = || ended == SCENE && is_scene(&folder.join(name));
        let is_last = ended == last::FILE;
        series_of_image(&ended).is_some() || is_series || is_line || is_last || is_state()
    };
    for name in names.iter().filter(|name| is_ours(name)) {
        remove(&folder.join(name))?;
    }
    // A folder with other files in it stays.
    let _ = fs::remove_dir(folder);
    Ok(())
}

/// Returns `rail_contact` for `rail_contact_000012.vti`.
fn series_of_image(name: &str) -> Option<&str> {
    [".vti", ".vtr", ".vts", ".vtu"].into_iter().find_map(|end| numbered(name, end))
}

/// Returns the name of a file with this ending, up to its number.
fn numbered<'a>(name: &'a str, ending: &str) -> Option<&'a str> {
    let (series, number) = name.strip_suffix(ending)?.rsplit_once('_')?;
    is_number(number).then_some(series)
}

fn is_number(text: &str) -> bool {
    text.len() >= 6 && text.bytes().all(|byte| byte.is_ascii_digit())
}
