//! Results of a run, as the report needs them.
//!
//! All parts are optional: a killed run has no summary, and a run that failed at its start has no
//! fields. Unreadable files are listed in [`Results::troubles`].

mod image;

use contract::figure::FigureSpec;
use contract::input_file::InputFileError;
pub use image::{Field, Image};
use run::error::{RunError, file_failure, input_failure};
use run::plan_file::{self, PlanFile};
use run::results::history;
use run::results::last::{self, LastFields};
use run::results::read_file;
use run::results::summary::Summary;
use run::warnings::Warning;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Contents of a result directory.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// Contents of `summary.json`, if present.
    pub summary: Option<Summary>,
    /// Word of the coupling scheme; empty if unknown.
    pub scheme: String,
    /// Contents of `iterations.csv`; empty if missing.
    pub iterations: Columns,
    /// Contents of `history.csv`; empty if missing.
    pub history: Columns,
    /// Fields, one series for each written grid.
    pub series: Vec<GridSeries>,
    /// Text of the case as run.
    pub case: String,
    /// Contents of `plan.json`, if present.
    pub plan: Option<PlanFile>,
    /// Warnings and errors of `log.jsonl`: level, source, message.
    pub log: Vec<[String; 3]>,
    /// Recordings: name and size \[byte\].
    pub recordings: Vec<(String, u64)>,
    /// Files that could not be read, with the reason.
    pub troubles: Vec<String>,
}

/// One grid of one participant over time.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSeries {
    /// Participant and grid.
    pub name: String,
    /// Time \[s\] and file of every instant.
    pub instants: Vec<(f64, PathBuf)>,
    /// Newest fields, if the grid is structured.
    pub image: Option<Image>,
    /// Newest fields along the line through the largest value.
    pub line: Option<Columns>,
}

impl GridSeries {
    /// Returns whether the grid is a surface rather than a section below one.
    pub(crate) fn is_surface(&self) -> bool {
        self.image.as_ref().and_then(Image::plane) == Some([0, 1])
    }

    /// Fields at an instant along the line through the largest value.
    #[must_use]
    pub fn line_at(&self, instant: usize) -> Option<Columns> {
        let (_, path) = self.instants.get(instant)?;
        let table = read_file(&path.with_extension("csv")).ok()?;
        Some(Columns::parse(&String::from_utf8_lossy(&table)))
    }
}

impl Results {
    /// Reads a result directory.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the directory holds no results; a file failure if a file cannot be
    /// read.
    pub fn read(folder: &Path) -> Result<Self, RunError> {
        if !["summary.json", "log.jsonl"].iter().any(|name| folder.join(name).is_file()) {
            let shown = folder.display();
            return Err(RunError::Usage(format!("{shown} holds no results of a run")));
        }
        let mut results = Self::default();
        results.summary = results.json::<Summary>(folder, "summary.json")?;
        results.scheme =
            results.summary.as_ref().map(|of| of.coupling.scheme.clone()).unwrap_or_default();
        results.iterations = Columns::parse(&results.text(&folder.join("iterations.csv"))?);
        results.history = Columns::parse(&results.text(&folder.join(history::FILE))?);
        results.case = results.text(&folder.join("case.toml"))?;
        results.plan = results.json(folder, plan_file::FILE)?;
        results.log = log(&results.text(&folder.join("log.jsonl"))?);
        results.recordings = recordings(folder).map_err(|error| file_failure(folder, &error))?;
        results.read_fields(&folder.join("fields"));
        Ok(results)
    }

    /// Sections of the participants in the summary; null if it is missing.
    #[must_use]
    pub fn sections(&self) -> &Value {
        self.summary.as_ref().map_or(&Value::Null, |summary| &summary.sections)
    }

    /// Figures that the participants describe.
    #[must_use]
    pub fn figures(&self) -> &[FigureSpec] {
        self.plan.as_ref().map_or(&[], |plan| &plan.figures)
    }

    /// Name of the case in the summary; empty if missing.
    #[must_use]
    pub fn name(&self) -> &str {
        self.summary.as_ref().map(|summary| summary.case.as_str()).unwrap_or_default()
    }

    /// Warnings in the summary.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        self.summary.as_ref().map_or(&[], |summary| &summary.warnings)
    }

    /// Returns whether the run failed or was stopped.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.summary.as_ref().is_some_and(|summary| summary.status.ended_early())
    }

    /// Reads a text file; empty if missing.
    fn text(&mut self, path: &Path) -> Result<String, RunError> {
        match read_file(path) {
            Ok(bytes) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
            Err(InputFileError::System(error)) if error.kind() == ErrorKind::NotFound => {
                Ok(String::new())
            }
            Err(error) => Err(input_failure(path, &error)),
        }
    }

    /// Reads a JSON file; `None` if missing or invalid.
    fn json<T: DeserializeOwned>(
        &mut self,
        folder: &Path,
        name: &str,
    ) -> Result<Option<T>, RunError> {
        let text = self.text(&folder.join(name))?;
        if text.is_empty() {
            return Ok(None);
        }
        let read = serde_json::from_str(&text);
        Ok(read.map_err(|error| self.troubles.push(format!("{name}: {error}"))).ok())
    }

    /// Reads the list of field files of all grids, and the newest fields.
    fn read_fields(&mut self, folder: &Path) {
        let last = match LastFields::read(folder) {
            Ok(Some(last)) => last,
            Ok(None) => return self.troubles.extend(unkept(folder)),
            Err(why) => return self.troubles.push(why),
        };
        let mut all = last.series;
        all.sort();
        for name in all {
            let files = last::files_of(folder, &name).unwrap_or_else(|why| {
                self.troubles.push(why);
                Vec::new()
            });
            let path = |(time, file): (f64, String)| (time, folder.join(file));
            let instants: Vec<_> = files.into_iter().map(path).collect();
            let image = Image::of(last.fields.iter().filter(|field| field.series == name));
            if image.is_none() {
                let trouble = format!("{name}: unstructured grid, not drawn here; use ParaView");
                self.troubles.push(trouble);
            }
            let mut series = GridSeries { name, instants, image, line: None };
            series.line = series.line_at(series.instants.len().saturating_sub(1));
            self.series.push(series);
        }
    }
}

/// Remark about fields written by an earlier version.
fn unkept(folder: &Path) -> Option<String> {
    let mut entries = fs::read_dir(folder).ok()?.flatten();
    let series = |entry: fs::DirEntry| entry.path().extension().is_some_and(|end| end == "pvd");
    entries.any(series).then(|| {
        let file = last::FILE;
        format!(
            "{file}: not written by the version that ran this case; run it again to draw fields"
        )
    })
}

fn log(text: &str) -> Vec<[String; 3]> {
    let event = |line: &str| {
        let event: Value = serde_json::from_str(line).ok()?;
        let of = |pointer: &str| event.pointer(pointer).and_then(Value::as_str).map(str::to_owned);
        let level = of("/level")?;
        let source = of("/fields/role").or(of("/target")).unwrap_or_default();
        let what = of("/fields/message").unwrap_or_default();
        ["WARN", "ERROR"].contains(&level.as_str()).then(|| [level.to_lowercase(), source, what])
    };
    text.lines().filter_map(event).collect()
}

fn recordings(folder: &Path) -> std::io::Result<Vec<(String, u64)>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)?.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with("recording") && name.ends_with(".mcap") {
            found.push((name, entry.metadata()?.len()));
        }
    }
    found.sort();
    Ok(found)
}

/// Columns of numbers; an empty or invalid cell is NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Columns {
    /// Parses a table. An incomplete last line is dropped.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let mut lines = text.lines();
        let head = lines.next().unwrap_or_default();
        let names = history::names(head);
        let numbers = |line: &str| -> Vec<f64> {
            line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
        };
        let rows = lines.map(numbers).filter(|row| row.len() == names.len()).collect();
        Self { names, rows }
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Returns whether the table has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Names of the columns.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// Values of a column.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let at = self.names.iter().position(|other| other == name)?;
        Some(self.rows.iter().map(|row| row[at]).collect())
    }

    /// Names of the columns with this ending, without the ending.
    pub fn ending<'a>(&'a self, ending: &'a str) -> impl Iterator<Item = &'a str> {
        self.names().filter_map(move |name| name.strip_suffix(ending))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder from elsewhere may hold a device or a pipe in the place of any file.
    #[test]
    fn only_regular_files_are_read() {
        let names = [
            "summary.json",
            "iterations.csv",
            "history.csv",
            "case.toml",
            "plan.json",
            "log.jsonl",
        ];
        for name in names {
            let folder = tempfile::tempdir().unwrap();
            for other in ["summary.json", "log.jsonl"] {
                fs::write(folder.path().join(other), "").unwrap();
            }
            let _ = fs::remove_file(folder.path().join(name));
            std::os::unix::fs::symlink("/dev/zero", folder.path().join(name)).unwrap();
            let refused = Results::read(folder.path()).unwrap_err().to_string();
            assert!(refused.contains(name) && refused.contains("is a device"), "{refused}");
        }
    }

    #[test]
    fn a_cut_line_is_left_out_and_an_empty_cell_is_no_number() {
        let table = Columns::parse("a,b_s\n1,2e-3\n,4\n5");
        assert_eq!(table.len(), 2);
        assert_eq!(table.column("b_s").unwrap(), [2e-3, 4.0]);
        assert!(table.column("a").unwrap()[1].is_nan());
        assert_eq!(table.ending("_s").collect::<Vec<_>>(), ["b"]);
        assert!(Columns::parse("").is_empty());
    }
}
