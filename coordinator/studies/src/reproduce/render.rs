//! Renders the text, tables and figures of a study.

use super::drawing::{Drawing, Sources, file_name};
use super::measurement::{Fit, Measurement};
use super::perform::{Record, STUDY, TEMPLATE};
use super::study::{Column, FigureSpec, RowSpec, Study, TableSpec};
use super::values::Values;
use crate::study::output::{StudyFile, StudyPage};
use minijinja::{Environment, Error, ErrorKind, UndefinedBehavior, Value};
use pages::page::{Block, Page, RunStatus, Section};
use pages::table::Table;
use run::error::{RunError, file_failure};
use run::format::number;
use run::results::write::replace;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the text in the folder of a reproduction.
pub(super) const TEXT: &str = "paper.md";

/// A rendered study.
pub(super) struct Rendered {
    study: Study,
    template: String,
    values: Arc<Values>,
    tables: Vec<Table>,
    figures: Vec<Vec<Drawing>>,
    /// Plot files: name and content.
    pub(super) images: Vec<(PathBuf, String)>,
}

/// Fills every template with placeholder values.
///
/// # Errors
/// [`RunError::Usage`] with the template, the line and the reason.
pub(super) fn rehearse(study: &Study, file: &Path) -> Result<(), RunError> {
    let path = file.with_file_name(&study.text);
    let template = read(&path)?;
    let values = Arc::new(Values::new(study, None));
    let mut parts = Parts::default();
    for spec in &study.tables {
        table(study, spec, &values)?;
        parts.tables.insert(spec.id.clone(), String::new());
    }
    parts.figures.extend(study.figures.iter().map(|figure| (figure.id.clone(), String::new())));
    let measured = measured(study, &values);
    page(&path.display().to_string(), &template, &values, parts, measured).map(drop)
}

impl Rendered {
    /// Renders the record in the folder of a reproduction.
    ///
    /// # Errors
    /// [`RunError::Usage`] if a table, a figure or the text refers to something missing.
    pub(super) fn of(record: &Record, folder: &Path) -> Result<Self, RunError> {
        let study = Study::read(&folder.join(STUDY))?;
        let template = read(&folder.join(TEMPLATE))?;
        let values = Values::new(&study, Some(record.outcomes(folder)));
        let values = values.with_measurements(&study, folder).map_err(RunError::Usage)?;
        let values = Arc::new(values);
        let folders = record.folders(folder);
        let of_run = |run: &str| folders.get(run).cloned().unwrap_or_default();
        let sources = Sources { study: &study, values: &values, folder: &of_run };
        let tables = study.tables.iter().map(|spec| table(&study, spec, &values));
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

    /// Returns the text, with its plots in the folder `images`.
    ///
    /// # Errors
    /// [`RunError::Usage`] with the line and the reason.
    pub(super) fn text(&self, images: &str) -> Result<String, RunError> {
        let tables = self.study.tables.iter().zip(&self.tables);
        let tables = tables.map(|(spec, filled)| {
            (spec.id.clone(), format!("**{}**\n\n{}", spec.title, filled.markdown()))
        });
        let figures = self.study.figures.iter().zip(&self.figures);
        let figures = figures.map(|(spec, all)| (spec.id.clone(), markdown(spec, all, images)));
        let parts = Parts { tables: tables.collect(), figures: figures.collect() };
        let name = self.study.text.display().to_string();
        let measured = measured(&self.study, &self.values);
        let text = page(&name, &self.template, &self.values, parts, measured)?;
        Ok(text.trim_end().to_owned() + "\n")
    }

    /// Writes the text to `path` and its plots to `images`, relative to the text.
    ///
    /// # Errors
    /// The files cannot be written; same as [`Rendered::text`].
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
            mood: RunStatus::Good,
            reason: format!(
                "the text with explanations is in `{TEXT}`, all summaries in `{}`",
                Record::FILE
            ),
            sections,
        })
    }
}

impl StudyPage for Record {
    fn page(&self, folder: &Path) -> Result<Page, RunError> {
        Rendered::of(self, folder)?.page()
    }
}

/// Formats a figure in Markdown: its title and its plots.
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

/// Writes a file, creating its folder if necessary.
fn write(path: &Path, content: &str) -> Result<(), RunError> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    }
    replace(path, content.as_bytes())
}

/// A row, with its name and the family that the row shows.
struct TableRow<'a> {
    name: String,
    family: Option<&'a str>,
    spec: &'a RowSpec,
}

/// A column, for one value of its axis.
struct Place<'a> {
    head: String,
    value: Option<String>,
    spec: &'a Column,
}

/// Fills a table.
///
/// # Errors
/// [`RunError::Usage`] if a template cannot be filled or the number of cells is wrong.
pub(super) fn table(
    study: &Study,
    spec: &TableSpec,
    values: &Arc<Values>,
) -> Result<Table, RunError> {
    let places: Vec<Place<'_>> =
        spec.columns.iter().flat_map(|column| columns(study, column)).collect();
    let head = std::iter::once(spec.head.clone());
    let head = head.chain(places.iter().map(|place| place.head.clone())).collect();
    let mut table = Table { head, rows: Vec::new(), figures_from: 1 };
    for row in spec.rows.iter().flat_map(|row| rows(study, row)) {
        let mut cells = vec![row.name.clone()];
        match &row.spec.cells {
            Some(printed) => cells.extend(printed.iter().cloned()),
            None => {
                for place in &places {
                    cells.push(filled(spec, &row, place, values)?);
                }
            }
        }
        if cells.len() != table.head.len() {
            let [wanted, found] = [table.head.len() - 1, cells.len() - 1];
            let place = format!("table `{}`, row `{}`", spec.id, row.name);
            return Err(RunError::Usage(format!("{place}: {found} cells for {wanted} columns")));
        }
        table.rows.push(cells);
    }
    Ok(table)
}

fn rows<'a>(study: &'a Study, spec: &'a RowSpec) -> Vec<TableRow<'a>> {
    let titles = match (&spec.group, &spec.run) {
        (Some(group), _) => study.titles(Some(group)).collect(),
        (None, Some(run)) => study.titles(None).filter(|(name, _)| name == run).collect(),
        (None, None) => Vec::new(),
    };
    if titles.is_empty() {
        // A single run of a family, or a row without runs.
        let name = spec.name.clone().unwrap_or_default();
        return vec![TableRow { name, family: spec.run.as_deref(), spec }];
    }
    let row = |(name, title): (&'a str, &'a str)| TableRow {
        name: spec.name.clone().unwrap_or_else(|| title.to_owned()),
        family: Some(name),
        spec,
    };
    titles.into_iter().map(row).collect()
}

fn columns<'a>(study: &Study, spec: &'a Column) -> Vec<Place<'a>> {
    let Some(axis) = &spec.over else {
        return vec![Place { head: spec.head.clone(), value: spec.at.clone(), spec }];
    };
    let place = |value: &String| Place {
        head: spec.head.replace(&format!("{{{axis}}}"), value),
        value: Some(value.clone()),
        spec,
    };
    study.axes.get(axis).into_iter().flatten().map(place).collect()
}

fn filled(
    table: &TableSpec,
    row: &TableRow<'_>,
    column: &Place<'_>,
    values: &Arc<Values>,
) -> Result<String, RunError> {
    let run = row.family.map(|family| match &column.value {
        Some(value) => format!("{family}/{value}"),
        None => family.to_owned(),
    });
    let place = format!("table `{}`, column `{}`", table.id, column.head);
    let text = cell(&place, &column.spec.cell, run, &row.spec.printed, values)?;
    // Several dashes stand for a single missing value.
    let has_digits = text.chars().any(|c| c.is_ascii_digit());
    Ok(if has_digits || !text.contains(ABSENT) { text } else { ABSENT.to_owned() })
}

/// Text for a missing value.
pub(super) const ABSENT: &str = "–";

/// Tables and figures in Markdown, by their names.
#[derive(Clone, Debug, Default)]
pub(super) struct Parts {
    pub(super) tables: BTreeMap<String, String>,
    pub(super) figures: BTreeMap<String, String>,
}

/// A fit as a value of a template.
fn fit_entry(fit: &Fit) -> Value {
    let second = fit.second.as_ref();
    Value::from_pairs([
        ("label", Value::from(&*fit.label)),
        ("second", Value::from(second.map(|second| second.label.clone()))),
        ("second_unit", Value::from(second.map(|second| second.unit.clone()))),
    ])
}

/// Measurements as values of a template, those with the largest relative deviation first.
fn measured(study: &Study, values: &Values) -> Vec<Value> {
    let deviation = |of: &Measurement| values.find(&of.name, "relative.deviation").unwrap_or(0.0);
    let mut all: Vec<&Measurement> = study.measurements.iter().collect();
    all.sort_by(|one, other| deviation(other).total_cmp(&deviation(one)));
    let entry = |of: &Measurement| {
        Value::from_pairs([
            ("name", Value::from(of.name.clone())),
            ("title", Value::from(of.title.clone())),
            ("kind", Value::from(of.kind.clone())),
            ("source", Value::from(of.source.trim())),
            ("note", Value::from(of.note.trim())),
            ("case", Value::from(of.case.display().to_string())),
            ("table", Value::from(of.table.display().to_string())),
            ("figure", Value::from(of.figure.clone())),
            ("unit", Value::from(of.unit.clone())),
            ("fits", Value::from_iter(of.fits.iter().map(fit_entry))),
            ("inputs", Value::from(of.inputs.clone())),
        ])
    };
    all.into_iter().map(entry).collect()
}

/// Fills the template `text`; messages call it `name`.
///
/// # Errors
/// [`RunError::Usage`] with the name of the template and the line.
pub(super) fn page(
    name: &str,
    text: &str,
    values: &Arc<Values>,
    parts: Parts,
    measured: Vec<Value>,
) -> Result<String, RunError> {
    let mut templates = templates();
    let present = Arc::clone(values);
    templates.add_function("find", move |run: String, key: String| present.find(&run, &key));
    let figures = Arc::clone(values);
    templates.add_function("value", move |run: String, key: String| {
        figures.get(&run, &key).map_err(wrong)
    });
    let inputs = Arc::clone(values);
    templates.add_function("input", move |run: String, key: String| {
        inputs.input(&run, &key).map_err(wrong)
    });
    let Parts { tables, figures } = parts;
    templates.add_function("table", move |id: String| part("table", &tables, &id));
    templates.add_function("figure", move |id: String| part("figure", &figures, &id));
    let context = Value::from_pairs([("measurements", Value::from(measured))]);
    templates.render_named_str(name, text, context).map_err(|error| refusal(&error))
}

/// Fills the cell of a table.
///
/// # Errors
/// [`RunError::Usage`] with `place` and the reason.
pub(super) fn cell(
    place: &str,
    text: &str,
    run: Option<String>,
    printed: &[String],
    values: &Arc<Values>,
) -> Result<String, RunError> {
    let mut templates = templates();
    let values = Arc::clone(values);
    templates.add_function("get", move |key: String| match &run {
        Some(run) => Value::from(values.find(run, &key)),
        None => Value::from(()),
    });
    let context = Value::from_pairs([("printed", Value::from(printed.to_vec()))]);
    templates.render_named_str(place, text, context).map_err(|error| refusal(&error))
}

fn templates() -> Environment<'static> {
    let mut templates = Environment::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.add_filter("digits", |value: Value, digits: usize| {
        shown(&value, |value| number(value, digits))
    });
    templates.add_filter("fixed", |value: Value, decimals: usize| {
        shown(&value, |value| format!("{value:.decimals$}").replace('-', "−"))
    });
    templates.add_filter("per", |value: Value, unit: f64| over(&value, |value| value / unit));
    templates.add_filter("under", |value: Value, whole: f64| over(&value, |value| whole / value));
    templates
}

/// Applies a function to a value, unless the value is missing.
fn over(value: &Value, of: impl Fn(f64) -> f64) -> Result<Option<f64>, Error> {
    if value.is_none() {
        return Ok(None);
    }
    f64::try_from(value.clone()).map(|value| Some(of(value)))
}

fn shown(value: &Value, write: impl Fn(f64) -> String) -> Result<String, Error> {
    if value.is_none() {
        return Ok(ABSENT.to_owned());
    }
    f64::try_from(value.clone()).map(write)
}

fn part(what: &str, all: &BTreeMap<String, String>, id: &str) -> Result<String, Error> {
    all.get(id).cloned().ok_or_else(|| {
        let known: Vec<&str> = all.keys().map(String::as_str).collect();
        wrong(format!("there is no {what} `{id}`; known: {}", known.join(", ")))
    })
}

fn wrong(reason: String) -> Error {
    Error::new(ErrorKind::InvalidOperation, reason)
}

fn refusal(error: &Error) -> RunError {
    let place = match (error.name(), error.line()) {
        (Some(name), Some(line)) => format!("{name}:{line}"),
        (name, _) => name.unwrap_or("text").to_owned(),
    };
    let reason = error.detail().map_or_else(|| error.kind().to_string(), str::to_owned);
    RunError::Usage(format!("{place}: {reason}"))
}
