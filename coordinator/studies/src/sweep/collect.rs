//! Points that other sweeps have found: other folders, and parts that a scheduler has run.

use super::design::Part;
use super::rows::{FILE, Growing};
use super::study::{Row, Study};
use crate::study::folder::{StudyFolder, Wanted};
use crate::study::output::Kept;
use contract::input_file;
use run::error::{RunError, input_failure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Larger files of a sweep are refused [byte].
const MOST_BYTES: u64 = 1 << 30;

/// Takes the points of a sweep in another folder, finished or not.
///
/// # Errors
/// It cannot be read, or is of other points.
pub(super) fn folder(sweep: &mut Growing, other: &Path) -> Result<(), RunError> {
    let path = other.join(Study::FILE);
    let text = input_file::read(&path, MOST_BYTES).map_err(|error| input_failure(&path, &error))?;
    let wrong = |why: String| RunError::Usage(format!("--collect {}: {why}", other.display()));
    let found: Study = serde_json::from_slice(&text).map_err(|error| wrong(error.to_string()))?;
    if !sweep.study.is_of_the_same_points(&found) {
        let fix = "give the values that it was made with";
        return Err(wrong(format!("is of other points; {fix}")));
    }
    let fix = "give the case, options and programs that it was made with, or run its points again";
    let place = format!("--collect {}", other.display());
    sweep.study.require_same_case(&found, &place, fix)?;
    sweep.collect(found, other)
}

/// The same for a part that a task has run, or has not come to.
///
/// # Errors
/// Those of [`folder`].
pub(super) fn part(sweep: &mut Growing, part: &Path) -> Result<(), RunError> {
    if part.join(FILE).exists() { folder(sweep, part) } else { Ok(()) }
}

/// Gives the points that have been run to the parts that they are in and that have not begun, so that no task runs
/// them again.
///
/// # Errors
/// The file system.
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
        let wanted = Wanted { command, name: "", out, replace: false, goes_on: &|_| false };
        let folder = StudyFolder::choose(&wanted)?;
        let part = sweep.part(Part { one, of });
        part.write(&folder)?;
        let mut part = Growing::begin(part, &folder)?;
        rows.into_iter().try_for_each(|row| part.add(row.clone()))?;
    }
    Ok(())
}

/// A sweep of this folder that was stopped, or one that is complete too, without its points.
pub(super) fn earlier(folder: &Path, complete: bool) -> Option<Study> {
    let text = input_file::read(&folder.join(Study::FILE), MOST_BYTES).ok()?;
    serde_json::from_slice(&text).ok().filter(|study: &Study| complete || !study.complete)
}
