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
mod drawing;
mod perform;
mod record;
mod render;
pub(crate) mod stale;
pub(crate) mod study;
mod table;
mod text;
mod values;

pub(crate) use record::Record;

use crate::study::arguments::StudyArguments;
use crate::study::output::{Kept, Shown};
use clap::Args;
use console::command::{Command, Context, Group};
use console::output::Speaker;
use render::Rendered;
use run::error::{RunError, file_failure};
use std::fs;
use std::path::{Path, PathBuf};
use study::Study;

/// Options of `coordinator reproduce`.
#[derive(Debug, Args)]
pub struct ReproduceCommand {
    /// The study: its cases, tables, figures and text.
    #[arg(default_value = "cases/paper/study.toml")]
    study: PathBuf,
    #[command(flatten)]
    folder: StudyArguments,
    /// Write the text here too, and its plots into img/NAME beside it.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Compare this text, which was written earlier, with the new one; exit 4 if it is stale.
    #[arg(long, value_name = "FILE")]
    check: Option<PathBuf>,
}

impl Command for ReproduceCommand {
    const NAME: &'static str = "reproduce";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str =
        "Run a published study again, and lay tables and figures beside what was printed";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _participants = self.folder.keep();
        let request = Request {
            study: &self.study,
            folder: &self.folder,
            write: self.write.as_deref(),
            check: self.check.as_deref(),
        };
        let mut speaker = Speaker::new(context.quiet);
        let outcome = reproduce(&request, &mut speaker);
        speaker.end(outcome)
    }
}

/// What the command is asked for.
#[derive(Debug)]
pub(crate) struct Request<'a> {
    /// The study's file.
    pub study: &'a Path,
    /// Where runs, text and plots go.
    pub folder: &'a StudyArguments,
    /// A further place for the text; its plots go into `img/NAME` beside it.
    pub write: Option<&'a Path>,
    /// A text that is kept, with its plots, to be compared.
    pub check: Option<&'a Path>,
}

/// Runs a study, and writes or compares what is asked for.
///
/// # Errors
/// [`RunError::Usage`] for a study that is wrong, before anything has run; those of its runs;
/// [`RunError::Stale`] if a text that is kept says something else.
pub(crate) fn reproduce(request: &Request, speaker: &mut Speaker) -> Result<(), RunError> {
    let file = request.study;
    let study = Study::read(file)?;
    check::check(&study, file)?;
    render::rehearse(&study, file)?;
    let runs = perform::rehearse(&study, file)?;
    let folder = request.folder.choose(Record::COMMAND, &study.name, &Record::is_unfinished)?;
    let record = perform::perform(&study, file, &runs, &folder, speaker)?;
    let out = folder.open()?;
    let rendered = Rendered::of(&record, &out)?;
    rendered.write(&out.join(render::TEXT), "img")?;
    record.publish(&folder)?;
    if let Some(path) = request.write {
        rendered.write(path, &images_beside(path))?;
    }
    request.check.map_or(Ok(()), |kept| compare(&rendered, kept))?;
    speaker.say(&format!("{}\n", folder.path().display()));
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
