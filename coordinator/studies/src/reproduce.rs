//! `coordinator reproduce`: repeats a published study and compares the results with the printed
//! values.
//!
//! A [`study::Study`] is data: cases with their changes, printed or measured values, and the tables
//! and figures to make from both. The text is a template ([`text`]). Every run is an ordinary run,
//! in the same processes and with the same shared memory. The code does not depend on the subject
//! of a study: a further level of fidelity is one more `[[run]]` in its file.
//!
//! ```text
//! study.toml + text ─ check, rehearse ─▶ runs/*, reproduce.json ─ render ─▶ paper.md, img/*.svg, report.html
//! ```
//!
//! Before anything runs, a rehearsal fills every template with placeholder values, so that mistakes
//! in the text are reported at once. Rendering needs only the folder: `coordinator report FOLDER`
//! repeats it.

mod check;
mod drawing;
mod measurement;
mod perform;
mod render;
pub(crate) mod study;
mod values;

pub(crate) use perform::Record;

use crate::study::arguments::{JobsArguments, StudyArguments};
use crate::study::output::{StudyFile, StudyPage};
use clap::Args;
use console::command::{Command, Context, Group};
use console::output::Speaker;
use perform::Request;
use render::Rendered;
use run::error::{RunError, file_failure};
use std::fs;
use std::path::{Path, PathBuf};
use study::Study;

/// Options of `coordinator reproduce`.
#[derive(Debug, Args)]
pub struct ReproduceCommand {
    /// File of the study: its cases, tables, figures and text.
    #[arg(default_value = "cases/paper/study.toml")]
    study: PathBuf,
    #[command(flatten)]
    jobs: JobsArguments,
    #[command(flatten)]
    folder: StudyArguments,
    /// Also write the text to this file, with its plots in img/NAME beside it.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Compare this earlier text with the new one; exit with 4 if the earlier text is outdated.
    #[arg(long, value_name = "FILE")]
    check: Option<PathBuf>,
}

impl Command for ReproduceCommand {
    const NAME: &'static str = "reproduce";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str = "Run a published study, and compare tables and figures";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator reproduce", "coordinator reproduce cases/paper/elements.toml"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let request = Request {
            study: &self.study,
            folder: &self.folder,
            jobs: self.jobs.jobs.into(),
            write: self.write.as_deref(),
            check: self.check.as_deref(),
        };
        let mut speaker = Speaker::new(context.quiet);
        let outcome = reproduce(&request, &mut speaker);
        speaker.end(outcome)
    }
}

/// Runs a study and writes or compares the text as requested.
///
/// # Errors
/// [`RunError::Usage`] if the study is invalid, before anything runs; an error of a run;
/// [`RunError::Stale`] if the earlier text differs from the new one.
pub(crate) fn reproduce(request: &Request, speaker: &mut Speaker) -> Result<(), RunError> {
    let file = request.study;
    let study = Study::read(file)?;
    check::check(&study, file)?;
    render::rehearse(&study, file)?;
    let mut bench = request.folder.bench();
    let runs = perform::rehearse(&study, file, &mut bench)?;
    let folder = request.folder.choose(Record::COMMAND, &study.name, &Record::is_unfinished)?;
    let record = perform::run_all(request, &study, &runs, &folder, bench, speaker)?;
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

/// Folder of a text's plots, relative to the text.
fn images_beside(path: &Path) -> String {
    format!("img/{}", path.file_stem().unwrap_or_default().to_string_lossy())
}

/// Compares an earlier text and its plots with the new ones.
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
    match check::difference(&text, new) {
        None => Ok(()),
        Some(check::Difference { line, kept: old, new }) => Err(RunError::Stale(format!(
            "{}:{line}: the file is outdated; it says\n  {old}\nbut should say\n  {new}",
            kept.display()
        ))),
    }
}
