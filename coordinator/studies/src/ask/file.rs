//! Reads the file of a surrogate.

use crate::fit::FILE;
use crate::study::folder::MOST_BYTES;
use crate::study::output::StudyFile as _;
use crate::sweep::Study;
use contract::input_file;
use run::error::{RunError, file_failure, input_failure};
use run::identity::Identity;
use serde::Deserialize;
use std::io::Read as _;
use std::path::Path;
use surrogate::{Document, LONGEST, Surrogate};

/// Reads a surrogate, restricted to `figures` unless the list is empty. A folder stands for the
/// surrogate of the sweep in the folder.
///
/// # Errors
/// [`RunError::Usage`] if the file is not a surrogate or lacks a figure; an input error if the file
/// cannot be read.
pub(super) fn read(path: &Path, figures: &[String]) -> Result<Surrogate, RunError> {
    let document = document(path)?;
    let document = match figures {
        [] => document,
        some => only(&document, some)?,
    };
    Surrogate::new(&document)
        .map_err(|fault| RunError::Usage(format!("{}: {fault}", path.display())))
}

/// Reads the contents of a surrogate file. A folder stands for the surrogate of the sweep in the
/// folder.
///
/// # Errors
/// [`RunError::Usage`] if the file is not a surrogate; an input error if the file cannot be read.
pub fn document(path: &Path) -> Result<Document, RunError> {
    let file = if path.is_dir() { path.join(FILE) } else { path.to_owned() };
    if path.is_dir() && !file.exists() {
        let folder = path.display();
        return Err(RunError::Usage(format!(
            "{folder}: this sweep has no surrogate; run: coordinator fit {folder}"
        )));
    }
    let fix = "create it again with `coordinator fit DIR`";
    let refuse = |why: &str| RunError::Usage(format!("{}: {why}; {fix}", file.display()));
    let document = Document::read(&bytes(&file)?).map_err(|fault| refuse(&fault.to_string()))?;
    match path.is_dir() && is_of_another_sweep(&document, path) {
        true => Err(refuse("belongs to another sweep than the one in this folder")),
        false => Ok(document),
    }
}

/// Returns whether the sweep in a folder and the surrogate there have different identities.
fn is_of_another_sweep(document: &Document, folder: &Path) -> bool {
    #[derive(Deserialize)]
    struct Head {
        identity: Identity,
    }
    let text = input_file::read(&folder.join(Study::FILE), MOST_BYTES).ok();
    let head = text.and_then(|text| serde_json::from_slice::<Head>(&text).ok());
    head.is_some_and(|head| head.identity.digest() != document.origin.identity)
}

/// Reads at most one byte more than the longest surrogate, so that a longer file is recognised.
fn bytes(file: &Path) -> Result<Vec<u8>, RunError> {
    let mut text = Vec::new();
    let open = input_file::open(file).map_err(|error| input_failure(file, &error))?;
    let read = open.take(LONGEST as u64 + 1).read_to_end(&mut text);
    read.map(|_| text).map_err(|error| file_failure(file, &error))
}

fn only(document: &Document, wanted: &[String]) -> Result<Document, RunError> {
    let keys: Vec<&str> = wanted.iter().map(String::as_str).collect();
    document.only(&keys).map_err(|missing| {
        let known = || document.figures.iter().map(|one| one.key.as_str());
        RunError::Usage(format!("--figure {missing}: {}", unknown(missing, known)))
    })
}

/// Lists known names, with a suggestion for an unknown one.
fn unknown<'a, I>(name: &str, known: impl Fn() -> I) -> String
where
    I: Iterator<Item = &'a str>,
{
    let near = known().min_by_key(|one| strsim::damerau_levenshtein(one, name));
    let all: Vec<&str> = known().take(SHOWN).collect();
    let more = if known().count() > SHOWN { ", …" } else { "" };
    let near = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
    format!("the surrogate has {}{more}{near}", all.join(", "))
}

/// Number of names that a message lists.
const SHOWN: usize = 8;

/// Index of a key in the surrogate.
pub(super) fn place(surrogate: &Surrogate, key: &str) -> Result<usize, RunError> {
    let known = || surrogate.keys().iter().map(|one| one.key.as_str());
    known()
        .position(|one| one == key)
        .ok_or_else(|| RunError::Usage(format!("{key} did not vary: {}", unknown(key, known))))
}
