//! Collects points of other sweeps: from other folders, and from parts that a scheduler has run.

use super::design::Part;
use super::rows::{FILE, SweepInProgress};
use super::study::{Row, Study};
use crate::study::folder::{FolderRequest, MOST_BYTES, StudyFolder};
use crate::study::output::StudyFile;
use contract::input_file;
use run::error::{RunError, input_failure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Adds the points of a sweep in another folder, finished or not.
///
/// # Errors
/// The folder cannot be read, or its sweep has other points or another case.
pub(super) fn folder(sweep: &mut SweepInProgress, other: &Path) -> Result<(), RunError> {
    let path = other.join(Study::FILE);
    let text = input_file::read(&path, MOST_BYTES).map_err(|error| input_failure(&path, &error))?;
    let wrong = |why: String| RunError::Usage(format!("--collect {}: {why}", other.display()));
    let found: Study = serde_json::from_slice(&text).map_err(|error| wrong(error.to_string()))?;
    if !sweep.study.is_of_the_same_points(&found) {
        let fix = "use the values of that sweep";
        return Err(wrong(format!("has other points; {fix}")));
    }
    let fix = "use the case, options and programs of that sweep, or run its points again";
    let place = format!("--collect {}", other.display());
    sweep.study.require_same_case(&found, &place, fix)?;
    sweep.collect(found, other)
}

/// Adds the points of a part, if its task has begun.
///
/// # Errors
/// Same as [`folder`].
pub(super) fn part(sweep: &mut SweepInProgress, part: &Path) -> Result<(), RunError> {
    if part.join(FILE).exists() { folder(sweep, part) } else { Ok(()) }
}

/// Copies known points into the folders of parts that have not begun, so that no task repeats them.
///
/// # Errors
/// The files cannot be written.
pub(super) fn hand_out(
    sweep: &Study,
    of: usize,
    place: impl Fn(usize) -> PathBuf,
) -> Result<(), RunError> {
    let mut parts: BTreeMap<usize, Vec<&Row>> = BTreeMap::new();
    for row in &sweep.rows {
        let number = sweep.number(&row.at).map_err(RunError::Usage)?;
        parts.entry(Part::with(number, of)).or_default().push(row);
    }
    for (one, rows) in parts {
        let out = place(one);
        if out.exists() {
            continue;
        }
        let (command, out) = (Study::COMMAND, Some(&*out));
        let wanted = FolderRequest { command, name: "", out, replace: false, goes_on: &|_| false };
        let folder = StudyFolder::choose(&wanted)?;
        let part = sweep.part(Part { one, of });
        part.write(&folder)?;
        let mut part = SweepInProgress::begin(part, &folder)?;
        rows.into_iter().try_for_each(|row| part.add(row.clone()))?;
    }
    Ok(())
}

/// Reads the description of an interrupted sweep in a folder, without its points; with `complete`,
/// also of a finished one.
pub(super) fn earlier(folder: &Path, complete: bool) -> Option<Study> {
    let text = input_file::read(&folder.join(Study::FILE), MOST_BYTES).ok()?;
    serde_json::from_slice(&text).ok().filter(|study: &Study| complete || !study.complete)
}
