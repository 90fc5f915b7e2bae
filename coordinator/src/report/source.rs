//! What a run has written, as the report needs it.
//!
//! Everything is optional: a run that was killed has no summary, one that failed at its start no
//! fields. A file that cannot be read is reported among the [`Results::troubles`].

mod image;
mod table;
mod xml;

pub(crate) use image::{Field, Image};
pub(crate) use table::Table;

use run::error::{RunError, file_failure};
use run::plan_file::{self, PlanFile};
use run::results::summary::Status;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use xml::attribute;

/// A result directory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Results {
    /// Content of `summary.json`; null without one.
    pub summary: Value,
    /// Content of `iterations.csv`; empty without one.
    pub iterations: Table,
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
pub(crate) struct GridSeries {
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
    pub(crate) fn line_at(&self, instant: usize) -> Option<Table> {
        let (_, path) = self.instants.get(instant)?;
        fs::read_to_string(path.with_extension("csv")).ok().map(|text| Table::parse(&text))
    }
}

impl Results {
    /// Reads a result directory.
    ///
    /// # Errors
    /// [`RunError::Usage`] if no run has written into it.
    pub(crate) fn read(folder: &Path) -> Result<Self, RunError> {
        if !["summary.json", "log.jsonl"].iter().any(|name| folder.join(name).is_file()) {
            let shown = folder.display();
            return Err(RunError::Usage(format!("{shown} holds no results of a run")));
        }
        let mut results = Self::default();
        results.summary = results.json(folder, "summary.json")?.unwrap_or_default();
        results.iterations = Table::parse(&results.text(&folder.join("iterations.csv"))?);
        results.case = results.text(&folder.join("case.toml"))?;
        results.plan = results.json(folder, plan_file::FILE)?;
        results.log = log(&results.text(&folder.join("log.jsonl"))?);
        results.recordings = recordings(folder).map_err(|error| file_failure(folder, &error))?;
        results.read_series(&folder.join("fields"))?;
        Ok(results)
    }

    /// A figure of the summary.
    #[must_use]
    pub(crate) fn quantity(&self, pointer: &str) -> Option<f64> {
        self.summary.pointer(pointer).and_then(Value::as_f64)
    }

    /// A word of the summary, empty without one.
    #[must_use]
    pub(crate) fn word(&self, pointer: &str) -> &str {
        self.summary.pointer(pointer).and_then(Value::as_str).unwrap_or_default()
    }

    /// The run has failed, or was stopped.
    #[must_use]
    pub(crate) fn failed(&self) -> bool {
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

    fn read_series(&mut self, folder: &Path) -> Result<(), RunError> {
        let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.retain(|path| path.extension().is_some_and(|ending| ending == "pvd"));
        paths.sort();
        for path in paths {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let instants = instants(&self.text(&path)?, folder);
            let Some((_, newest)) = instants.last() else { continue };
            let image = match newest.extension().is_some_and(|ending| ending == "vti") {
                true => Image::read(newest).map_err(|why| self.troubles.push(why)).ok(),
                false => {
                    let trouble =
                        format!("{name}: an unstructured grid, not drawn here; see ParaView");
                    self.troubles.push(trouble);
                    None
                }
            };
            let mut series = GridSeries { name, instants, image, line: None };
            series.line = series.line_at(series.instants.len() - 1);
            self.series.push(series);
        }
        Ok(())
    }
}

/// Time and file of every data set of a ParaView collection.
fn instants(text: &str, folder: &Path) -> Vec<(f64, PathBuf)> {
    let one = |line: &str| {
        let time = attribute(line, "timestep")?.parse().ok()?;
        Some((time, folder.join(attribute(line, "file")?)))
    };
    text.lines().filter(|line| line.contains("<DataSet")).filter_map(one).collect()
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
