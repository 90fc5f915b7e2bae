//! `coordinator reproduce`: a published study run again, and laid beside what was printed.
//!
//! A [`study::Study`] is data: cases and what is changed in them, printed values, and how tables and
//! figures are made of both; the text is a template ([`text`]). Every run is a run like any other,
//! processes and shared memory included. Nothing here knows what a study is about: a further level of
//! fidelity is one more `[[run]]` in its file.
//!
//! ```text
//! study.toml + text ─ check, rehearse ─▶ runs/*, reproduce.json ─ render ─▶ paper.md, img/*.svg, report.html
//! ```
//!
//! A rehearsal fills every template with stand-ins before anything runs, so that a mistake in the text
//! is reported at once. Rendering needs the folder alone: `coordinator report FOLDER` does it
//! again.

mod check;
mod cli;
mod drawing;
mod perform;
mod render;
pub mod stale;
pub mod study;
mod table;
mod text;
mod values;

pub use cli::{Arguments, main};
pub use perform::FILE;
pub use render::page;

use crate::study::folder::{StudyFolder, Wanted, says_incomplete};
use render::Rendered;
use run::error::{RunError, file_failure};
use run::results::write::replace;
use std::fs;
use std::path::{Path, PathBuf};
use study::Study;

/// What the command is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// The study's file.
    pub study: PathBuf,
    /// Where runs, text and plots go, if the user names it.
    pub out: Option<PathBuf>,
    /// An earlier reproduction that is there is replaced.
    pub replace: bool,
    /// A further place for the text; its plots go into `img/NAME` beside it.
    pub write: Option<PathBuf>,
    /// A text that is kept, with its plots, to be compared.
    pub check: Option<PathBuf>,
}

/// Runs a study, and writes or compares what is asked for; `say` is called for each run.
///
/// # Errors
/// [`RunError::Usage`] for a study that is wrong, before anything has run; those of its runs;
/// [`RunError::Stale`] if a text that is kept says something else.
pub fn reproduce(request: &Request, say: &mut dyn FnMut(&str)) -> Result<(), RunError> {
    let file = &request.study;
    let study = Study::read(file)?;
    check::check(&study, file)?;
    render::rehearse(&study, file)?;
    let runs = perform::rehearse(&study, file)?;
    let folder = StudyFolder::choose(&Wanted {
        command: "reproduce",
        name: &study.name,
        out: request.out.as_deref(),
        replace: request.replace,
        goes_on: &|folder| says_incomplete(&folder.join(FILE)),
    })?;
    let out = folder.open()?;
    perform::perform(&study, file, &runs, &out, say)?;
    let rendered = Rendered::of(&out)?;
    rendered.write(&out.join(render::TEXT), "img")?;
    crate::report::write(&out)?;
    if let Some(path) = &request.write {
        rendered.write(path, &images_beside(path))?;
    }
    request.check.as_ref().map_or(Ok(()), |kept| compare(&rendered, kept))?;
    say(&format!("{}\n", folder.path().display()));
    Ok(())
}

/// The folder of a text's plots, as seen from the text.
fn images_beside(path: &Path) -> String {
    format!("img/{}", path.file_stem().unwrap_or_default().to_string_lossy())
}

/// Compares a text that is kept, and its plots, with what was rendered.
fn compare(rendered: &Rendered, kept: &Path) -> Result<(), RunError> {
    let images = images_beside(kept);
    let folder = kept.parent().unwrap_or(Path::new(""));
    same(kept, &rendered.text(&images)?)?;
    for (name, svg) in &rendered.images {
        same(&folder.join(&images).join(name), svg)?;
    }
    Ok(())
}

fn same(kept: &Path, new: &str) -> Result<(), RunError> {
    let text = fs::read_to_string(kept).map_err(|error| file_failure(kept, &error))?;
    match stale::difference(&text, new) {
        None => Ok(()),
        Some(stale::Difference { line, kept: old, new }) => Err(RunError::Stale(format!(
            "{}:{line}: it says\n  {old}\nand would say now\n  {new}",
            kept.display()
        ))),
    }
}

/// Writes a file and the folder that it lies in.
fn write(path: &Path, content: &str) -> Result<(), RunError> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    }
    replace(path, content.as_bytes())
}
