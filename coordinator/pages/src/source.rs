//! What a run has written, as the report needs it.
//!
//! Everything is optional: a run that was killed has no summary, one that failed at its start no
//! fields. A file that cannot be read is reported among the [`Results::troubles`].

mod image;
mod table;

pub use image::{Field, Image};
pub use table::Table;

use contract::figure::FigureSpec;
use run::error::{RunError, file_failure};
use run::plan_file::{self, PlanFile};
use run::results::history;
use run::results::last::{self, LastFields};
use run::results::summary::Status;
use run::results::vtk::FileSeries;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A result directory.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// Content of `summary.json`; null without one.
    pub summary: Value,
    /// Content of `iterations.csv`; empty without one.
    pub iterations: Table,
    /// Content of `history.csv`; empty without one.
    pub history: Table,
    /// One for each grid that has been written out.
    pub series: Vec<GridSeries>,
    /// The case as run.
    pub case: String,
    /// Content of `plan.json`, if there is one.
    pub plan: Option<PlanFile>,
    /// Warnings and errors of `log.jsonl`: level, source, message.
    pub log: Vec<[String; 3]>,
    /// Recordings: name and size \[byte\].
    pub recordings: Vec<(String, u64)>,
    /// What could not be read, and why.
    pub troubles: Vec<String>,
}

/// One grid of one participant through time.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSeries {
    /// Participant and grid.
    pub name: String,
    /// Time \[s\] and file of every instant.
    pub instants: Vec<(f64, PathBuf)>,
    /// The newest fields, if they lie on an image.
    pub image: Option<Image>,
    /// Their line through the largest value.
    pub line: Option<Table>,
}

impl GridSeries {
    /// That line at an instant.
    #[must_use]
    pub fn line_at(&self, instant: usize) -> Option<Table> {
        let (_, path) = self.instants.get(instant)?;
        fs::read_to_string(path.with_extension("csv")).ok().map(|text| Table::parse(&text))
    }
}

impl Results {
    /// Reads a result directory.
    ///
    /// # Errors
    /// [`RunError::Usage`] if no run has written into it.
    pub fn read(folder: &Path) -> Result<Self, RunError> {
        if !["summary.json", "log.jsonl"].iter().any(|name| folder.join(name).is_file()) {
            let shown = folder.display();
            return Err(RunError::Usage(format!("{shown} holds no results of a run")));
        }
        let mut results = Self::default();
        results.summary = results.json(folder, "summary.json")?.unwrap_or_default();
        results.iterations = Table::parse(&results.text(&folder.join("iterations.csv"))?);
        results.history = Table::parse(&results.text(&folder.join(history::FILE))?);
        results.case = results.text(&folder.join("case.toml"))?;
        results.plan = results.json(folder, plan_file::FILE)?;
        results.log = log(&results.text(&folder.join("log.jsonl"))?);
        results.recordings = recordings(folder).map_err(|error| file_failure(folder, &error))?;
        results.read_fields(&folder.join("fields"));
        Ok(results)
    }

    /// A figure of the summary.
    #[must_use]
    pub fn quantity(&self, pointer: &str) -> Option<f64> {
        self.summary.pointer(pointer).and_then(Value::as_f64)
    }

    /// The figures that the participants have described.
    #[must_use]
    pub fn figures(&self) -> &[FigureSpec] {
        self.plan.as_ref().map_or(&[], |plan| &plan.figures)
    }

    /// A word of the summary, empty without one.
    #[must_use]
    pub fn word(&self, pointer: &str) -> &str {
        self.summary.pointer(pointer).and_then(Value::as_str).unwrap_or_default()
    }

    /// The run has failed, or was stopped.
    #[must_use]
    pub fn failed(&self) -> bool {
        Status::ENDED_EARLY.map(Status::word).contains(&self.word("/status"))
    }

    /// A text file, empty without one.
    fn text(&mut self, path: &Path) -> Result<String, RunError> {
        match fs::read(path) {
            Ok(bytes) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(String::new()),
            Err(error) => Err(file_failure(path, &error)),
        }
    }

    /// The content of a JSON file, if there is one that can be read.
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

    /// The files of all grids, and the newest fields on them.
    fn read_fields(&mut self, folder: &Path) {
        let last = match LastFields::read(folder) {
            Ok(Some(last)) => last,
            Ok(None) => return self.troubles.extend(unkept(folder)),
            Err(why) => return self.troubles.push(why),
        };
        let mut all = last.series.into_owned();
        all.sort_by(|a, b| a.name.cmp(&b.name));
        for FileSeries { name, files } in all {
            let path = |(time, file): (f64, String)| (time, folder.join(file));
            let instants: Vec<_> = files.into_iter().map(path).collect();
            let image = Image::of(last.fields.iter().filter(|field| field.series == name));
            if image.is_none() {
                let trouble = format!("{name}: an unstructured grid, not drawn here; see ParaView");
                self.troubles.push(trouble);
            }
            let mut series = GridSeries { name, instants, image, line: None };
            series.line = series.line_at(series.instants.len().saturating_sub(1));
            self.series.push(series);
        }
    }
}

/// What there is to say of fields that an earlier version has written.
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
