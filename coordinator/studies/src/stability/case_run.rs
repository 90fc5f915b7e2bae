//! Performs one run, and collects its outcome, quantities and recorded fields.

use crate::study;
use crate::study::bench::Bench;
use conformance::inspect::{self, ListFilter, RecordingSummary};
use conformance::recording_file;
use console::case_arguments::Changes;
use run::error::RunError;
use run::perform::{self, RunOptions};
use run::plan::{Plan, Planned};
use run::record::Compression;
use run::results::summary::CouplingSummary;
use run::results::{Existing, ResultFolder};
use serde_json::{Map, Value, json};
use std::path::Path;
use std::time::Instant;

/// Topic of the recorded iterates, whose fields are not results.
const ITERATES: &str = "field/coordinator/";

/// A run that has ended.
#[derive(Debug)]
pub(super) struct CaseRun {
    /// Exit code and message, if the run failed.
    pub(super) error: Option<(u8, String)>,
    /// Summary, with the ranges of the fields under `field`, the values of the case under `case`,
    /// and the final coupling time under `time`.
    pub(super) quantities: Value,
    /// Counts of the coupling.
    pub(super) coupling: CouplingSummary,
    /// Contents of the recording; `None` if the run was refused before it began.
    pub(super) recorded: Option<RecordingSummary>,
    /// Time from reading the case to the end of the last process \[s\].
    pub(super) seconds: f64,
}

impl CaseRun {
    /// Runs a case with the changes of a variant into a folder.
    ///
    /// # Errors
    /// The folder cannot be used, or the user interrupts. A failure of the run is part of the
    /// outcome.
    pub(super) fn run(
        case: &Path,
        variant: &Changes,
        folder: &Path,
        bench: &mut Bench,
    ) -> Result<Self, RunError> {
        let since = Instant::now();
        let planned = match bench.planned(case, variant) {
            Ok(planned) => planned,
            Err(error) if study::ends_study(&error) => return Err(error),
            Err(error) => return Ok(Self::refused(&error, since)),
        };
        let folder = ResultFolder::prepare(folder, case, Existing::Replace)?;
        Self::run_recorded(&planned, &folder, since, bench)
    }

    fn refused(error: &RunError, since: Instant) -> Self {
        Self {
            error: Some((error.exit_code(), message(error))),
            coupling: CouplingSummary::default(),
            quantities: Value::Null,
            recorded: None,
            seconds: since.elapsed().as_secs_f64(),
        }
    }

    fn run_recorded(
        planned: &Planned,
        folder: &ResultFolder,
        since: Instant,
        bench: &mut Bench,
    ) -> Result<Self, RunError> {
        let record = Some(Compression::None);
        let options = RunOptions { record, ..RunOptions::planned_since(since) };
        let outcome = perform::run(planned, &mut bench.fleet, folder, options);
        let seconds = since.elapsed().as_secs_f64();
        let error = match outcome.error {
            Some(error) if study::ends_study(&error) => return Err(error),
            other => other.map(|error| (error.exit_code(), message(&error))),
        };
        let mut recording = recording_file::open(&folder.file("recording.mcap"))?;
        let survey = inspect::survey(&mut recording, &ListFilter::default());
        let mut quantities = outcome.summary.to_value();
        quantities["field"] = ranges(&survey);
        quantities["time"] = json!({ "end_s": survey.end_s });
        quantities["case"] = values(&planned.plan);
        Ok(Self {
            error,
            coupling: outcome.summary.coupling,
            quantities,
            recorded: Some(survey),
            seconds,
        })
    }

    /// Fields sent by participants, without iterates.
    pub(super) fn fields(&self) -> impl Iterator<Item = &inspect::FieldSurvey> {
        let all = self.recorded.iter().flat_map(|survey| &survey.fields);
        all.filter(|field| !field.topic.starts_with(ITERATES))
    }
}

/// Message shown to the user.
fn message(error: &RunError) -> String {
    match error {
        RunError::Case(problems) => problems.render(false),
        other => other.to_string(),
    }
}

/// Smallest, largest and mean value of every field sent by a participant.
fn ranges(survey: &RecordingSummary) -> Value {
    let of = |field: &inspect::FieldSurvey| {
        let name = field.topic.rsplit('/').next().unwrap_or_default().to_owned();
        let range = &field.range;
        (name, json!({ "min": range.min, "max": range.max, "mean": range.mean }))
    };
    let sent = survey.fields.iter().filter(|field| !field.topic.starts_with(ITERATES));
    Value::Object(sent.map(of).collect())
}

/// Values given to the participants [SI].
fn values(plan: &Plan) -> Value {
    let mut all = Map::new();
    for participant in &plan.participants {
        if let Value::Object(tables) = &participant.configuration.case.0 {
            for (name, table) in tables {
                merge(all.entry(name).or_insert_with(|| json!({})), table);
            }
        }
    }
    Value::Object(all)
}

fn merge(into: &mut Value, from: &Value) {
    match (into, from) {
        (Value::Object(into), Value::Object(from)) => {
            for (key, value) in from {
                merge(into.entry(key).or_insert(Value::Null), value);
            }
        }
        (into, from) => *into = from.clone(),
    }
}
