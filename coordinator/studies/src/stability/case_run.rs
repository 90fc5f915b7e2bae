//! One run: how it ended, its quantities, and what its recording holds.

use crate::study::{self, Variant};
use conformance::inspect::{self, Survey, Wanted};
use run::error::RunError;
use run::perform::{self, RunStart};
use run::plan::{Plan, Planned};
use run::progress::silent;
use run::record::Compression;
use run::results::{Existing, ResultFolder};
use serde_json::{Map, Value, json};
use std::path::Path;
use std::time::Instant;

/// The producer of iterates, whose fields are no answers.
const ITERATES: &str = "field/coordinator/";

/// A run that has come to its end.
#[derive(Debug)]
pub(super) struct CaseRun {
    /// Exit code and message, if it ended with an error.
    pub(super) error: Option<(u8, String)>,
    /// Its summary, with the ranges of its fields under `field`, the case's values under `case`, and
    /// the coupling time at its end under `time`.
    pub(super) quantities: Value,
    /// What its recording holds; `None` if it was refused before it began.
    pub(super) recorded: Option<Survey>,
    /// Seconds from reading the case to the last process's end.
    pub(super) seconds: f64,
}

impl CaseRun {
    /// Runs a case with a variant's changes into a folder.
    ///
    /// # Errors
    /// The folder cannot be used, or the user has stopped. An error of the run is its end.
    pub(super) fn run(case: &Path, variant: &Variant, folder: &Path) -> Result<Self, RunError> {
        let since = Instant::now();
        let planned = match study::planned(case, variant) {
            Ok(planned) => planned,
            Err(error) if study::ends_study(&error) => return Err(error),
            Err(error) => return Ok(Self::refused(&error, since)),
        };
        let folder = ResultFolder::prepare(folder, case, Existing::Replace)?;
        Self::perform(&planned, &folder, since)
    }

    fn refused(error: &RunError, since: Instant) -> Self {
        Self {
            error: Some((error.exit_code(), message(error))),
            quantities: Value::Null,
            recorded: None,
            seconds: since.elapsed().as_secs_f64(),
        }
    }

    fn perform(planned: &Planned, folder: &ResultFolder, since: Instant) -> Result<Self, RunError> {
        let start = RunStart { since, plan_seconds: since.elapsed().as_secs_f64() };
        let record = Some(Compression::None);
        let outcome = perform::run(planned, folder, &silent(), start, None, record);
        let seconds = since.elapsed().as_secs_f64();
        let error = match outcome.error {
            Some(error) if study::ends_study(&error) => return Err(error),
            other => other.map(|error| (error.exit_code(), message(&error))),
        };
        let mut recording = inspect::open(&folder.file("recording.mcap"))?;
        let survey = inspect::survey(&mut recording, &Wanted::default());
        let mut quantities = outcome.summary;
        quantities["field"] = ranges(&survey);
        quantities["time"] = json!({ "end_s": survey.end_s });
        quantities["case"] = values(&planned.plan);
        Ok(Self { error, quantities, recorded: Some(survey), seconds })
    }

    /// Fields that the participants have sent, without iterates.
    pub(super) fn fields(&self) -> impl Iterator<Item = &inspect::FieldSurvey> {
        let all = self.recorded.iter().flat_map(|survey| &survey.fields);
        all.filter(|field| !field.topic.starts_with(ITERATES))
    }
}

/// What a user reads.
fn message(error: &RunError) -> String {
    match error {
        RunError::Case(problems) => problems.render(false),
        other => other.to_string(),
    }
}

/// Smallest, largest and mean value of every field that a participant has sent.
fn ranges(survey: &Survey) -> Value {
    let of = |field: &inspect::FieldSurvey| {
        let name = field.topic.rsplit('/').next().unwrap_or_default().to_owned();
        let range = &field.range;
        (name, json!({ "min": range.min, "max": range.max, "mean": range.mean }))
    };
    let sent = survey.fields.iter().filter(|field| !field.topic.starts_with(ITERATES));
    Value::Object(sent.map(of).collect())
}

/// The values that the participants were given [SI].
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
