//! Text, plots and page of a study that has been run.

use super::drawing::{Drawing, Sources, file_name};
use super::record::{Record, STUDY, TEMPLATE};
use super::study::{FigureSpec, Study};
use super::table;
use super::text::{self, Parts};
use super::values::Values;
use crate::study::output::{Kept, Shown};
use pages::page::{Block, Mood, Page, Section};
use pages::table::Table;
use run::error::{RunError, file_failure};
use run::results::write::replace;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the text in the folder of a reproduction.
pub(super) const TEXT: &str = "paper.md";

/// What a study has come to.
pub(super) struct Rendered {
    study: Study,
    template: String,
    values: Arc<Values>,
    tables: Vec<Table>,
    figures: Vec<Vec<Drawing>>,
    /// Files of the plots: name and content.
    pub(super) images: Vec<(PathBuf, String)>,
}

/// Fills every template with stand-ins.
///
/// # Errors
/// [`RunError::Usage`] with template, line and reason.
pub(super) fn rehearse(study: &Study, file: &Path) -> Result<(), RunError> {
    let path = file.with_file_name(&study.text);
    let template = read(&path)?;
    let values = Arc::new(Values::new(study, None));
    let mut parts = Parts::default();
    for spec in &study.tables {
        table::table(study, spec, &values)?;
        parts.tables.insert(spec.id.clone(), String::new());
    }
    parts.figures.extend(study.figures.iter().map(|figure| (figure.id.clone(), String::new())));
    text::page(&path.display().to_string(), &template, &values, parts).map(drop)
}

impl Rendered {
    /// From the record and the folder of a reproduction.
    ///
    /// # Errors
    /// [`RunError::Usage`] with what a table, a figure or the text lacks.
    pub(super) fn of(record: &Record, folder: &Path) -> Result<Self, RunError> {
        let study = Study::read(&folder.join(STUDY))?;
        let template = read(&folder.join(TEMPLATE))?;
        let values = Arc::new(Values::new(&study, Some(record.outcomes(folder))));
        let folders = record.folders(folder);
        let of_run = |run: &str| folders.get(run).cloned().unwrap_or_default();
        let sources = Sources { study: &study, values: &values, folder: &of_run };
        let tables = study.tables.iter().map(|spec| table::table(&study, spec, &values));
        let tables = tables.collect::<Result<Vec<Table>, RunError>>()?;
        let figures = study.figures.iter().map(|figure| sources.drawings(figure));
        let figures = figures.collect::<Result<Vec<Vec<Drawing>>, RunError>>()?;
        let images = study.figures.iter().zip(&figures).flat_map(|(figure, drawings)| {
            let file =
                |(n, drawing): (usize, &Drawing)| (file_name(figure, n), drawing.standalone());
            drawings.iter().enumerate().map(file).collect::<Vec<_>>()
        });
        let images = images.collect();
        Ok(Self { study, template, values, tables, figures, images })
    }

    /// The text, with its plots in `images`.
    ///
    /// # Errors
    /// [`RunError::Usage`] with line and reason.
    pub(super) fn text(&self, images: &str) -> Result<String, RunError> {
        let tables = self.study.tables.iter().zip(&self.tables);
        let tables = tables.map(|(spec, filled)| {
            (spec.id.clone(), format!("**{}**\n\n{}", spec.title, filled.markdown()))
        });
        let figures = self.study.figures.iter().zip(&self.figures);
        let figures = figures.map(|(spec, all)| (spec.id.clone(), markdown(spec, all, images)));
        let parts = Parts { tables: tables.collect(), figures: figures.collect() };
        let name = self.study.text.display().to_string();
        let text = text::page(&name, &self.template, &self.values, parts)?;
        Ok(text.trim_end().to_owned() + "\n")
    }

    /// Writes text and plots, the plots into `images` as seen from the text.
    ///
    /// # Errors
    /// The file system; those of [`Rendered::text`].
    pub(super) fn write(&self, path: &Path, images: &str) -> Result<(), RunError> {
        let folder = path.parent().unwrap_or(Path::new("")).join(images);
        for (name, svg) in &self.images {
            write(&folder.join(name), svg)?;
        }
        write(path, &self.text(images)?)
    }

    fn page(&self) -> Result<Page, RunError> {
        let tables = self.study.tables.iter().zip(&self.tables).map(|(spec, filled)| Section {
            title: spec.title.clone(),
            blocks: vec![Block::Table(filled.clone())],
        });
        let figures = self.study.figures.iter().zip(&self.figures).map(|(spec, all)| Section {
            title: spec.title.clone(),
            blocks: all.iter().map(Drawing::block).collect(),
        });
        let mut sections: Vec<Section> = tables.chain(figures).collect();
        let text = self.text("img")?;
        sections.push(Section {
            title: "Text".to_owned(),
            blocks: vec![Block::Verbatim(TEXT.to_owned(), text)],
        });
        Ok(Page {
            name: self.study.name.clone(),
            title: self.study.title.clone(),
            status: "reproduced".to_owned(),
            mood: Mood::Good,
            reason: format!(
                "the text with its reasons is `{TEXT}`; all summaries are in `{}`",
                Record::FILE
            ),
            sections,
        })
    }
}

impl Shown for Record {
    fn page(&self, folder: &Path) -> Result<Page, RunError> {
        Rendered::of(self, folder)?.page()
    }
}

/// A figure in Markdown: its title and its plots.
fn markdown(spec: &FigureSpec, drawings: &[Drawing], images: &str) -> String {
    let image = |(n, drawing): (usize, &Drawing)| {
        format!("![{}]({images}/{})", drawing.title(), file_name(spec, n).display())
    };
    let all: Vec<String> = drawings.iter().enumerate().map(image).collect();
    format!("**{}**\n\n{}", spec.title, all.join("\n"))
}

fn read(path: &Path) -> Result<String, RunError> {
    fs::read_to_string(path).map_err(|error| file_failure(path, &error))
}

/// Writes a file and the folder that it lies in.
fn write(path: &Path, content: &str) -> Result<(), RunError> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    }
    replace(path, content.as_bytes())
}
