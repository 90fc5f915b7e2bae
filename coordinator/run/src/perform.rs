//! `coordinator run`: from a plan to a result directory.

mod driven;
mod origin;
mod tables;
mod time_loop;

pub use driven::{Accepted, Driven, Driver, DriverError};
pub use origin::{check_origin, origin};

use crate::checkpoint::{Checkpoint, Checkpoints};
use crate::error::RunError;
use crate::fleet::Fleet;
use crate::format::counted;
use crate::plan::{Plan, Planned};
use crate::plan_file;
use crate::progress::{Progress, silent};
use crate::record::{Compression, Recorder};
use crate::results::derived;
use crate::results::dir::shown;
use crate::results::history::{self, Survey};
use crate::results::summary::{Counts, Sections, Status, SummaryInput, build};
use crate::results::vtk::FieldWriter;
use crate::results::{ResultFolder, show};
use crate::session::{PendingExits, Session};
use crate::warnings::Warning;
use crate::watching::Watcher;
use case::Case;
use contract::message::Finished;
use serde_json::Value;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;
use tables::Tables;
use time_loop::TimeLoop;

/// End of a run: its summary, and the error if there was one.
#[derive(Debug)]
pub struct Outcome {
    /// The content of `summary.json`.
    pub summary: Value,
    /// Error that ended the run.
    pub error: Option<RunError>,
}

impl Outcome {
    /// Turns this outcome into a failure, because a file could not be written at the end.
    #[must_use]
    pub fn fail(self, error: RunError, folder: &ResultFolder) -> Self {
        let Self { mut summary, error: before } = self;
        if let Some(before) = before {
            return Self { summary, error: Some(before.and(Err(error))) };
        }
        summary["status"] = Status::Failed.word().into();
        summary["reason"] = error.to_string().into();
        let error = error.and(folder.write_summary(&json(&summary)));
        Self { summary, error: Some(error) }
    }
}

/// Way to run a case: from the start, from a checkpoint, or driven from outside.
pub struct RunOptions<'a> {
    /// Display of the progress.
    pub progress: Rc<dyn Progress>,
    /// Start of the program, from which the time of the run is measured.
    pub since: Instant,
    /// Duration of planning [s].
    pub plan_seconds: f64,
    /// Checkpoint from which to continue.
    pub from: Option<&'a Checkpoint>,
    /// Compression of the recording; `None`: no recording, unless the run before the checkpoint was
    /// recorded.
    pub record: Option<Compression>,
    /// Driver that requests the windows one by one; `None`: the windows of the case.
    pub driver: Option<&'a mut dyn Driver>,
}

impl RunOptions<'_> {
    /// Returns the options of a run whose planning began at this instant, without progress and
    /// recording.
    #[must_use]
    pub fn planned_since(since: Instant) -> Self {
        Self { since, plan_seconds: since.elapsed().as_secs_f64(), ..Self::default() }
    }
}

impl Default for RunOptions<'_> {
    fn default() -> Self {
        Self {
            progress: silent(),
            since: Instant::now(),
            plan_seconds: 0.0,
            from: None,
            record: None,
            driver: None,
        }
    }
}

/// Runs a plan with the participants of a fleet, and writes its results. The summary of a failed
/// run states the failure.
pub fn run(
    planned: &Planned,
    fleet: &mut Fleet,
    folder: &ResultFolder,
    options: RunOptions<'_>,
) -> Outcome {
    let RunOptions { progress, since, plan_seconds, from, record, driver } = options;
    let Planned { case, plan } = planned;
    let record = record.or_else(|| from.and_then(|checkpoint| checkpoint.state.recorded));
    let mut counts = match from {
        Some(checkpoint) => checkpoint.state.counts.resumed(plan_seconds),
        None => Counts { plan_seconds, ..Counts::default() },
    };
    let mut warnings = match from {
        Some(_) => {
            let mut warnings = plan_file::first_warnings(folder);
            add(&mut warnings, &plan.warnings);
            warnings
        }
        None => plan.warnings.clone(),
    };
    add(&mut warnings, folder.warning().map_or(&[], std::slice::from_ref));
    let (ended, recorder) = match set_out(planned, folder, from, record) {
        Ok(recorder) => {
            let found = (&mut counts, &mut warnings);
            let ended = perform(
                (planned, fleet),
                folder,
                &progress,
                found,
                (from, driver),
                recorder.clone(),
            );
            (ended, recorder)
        }
        Err(error) => (Err(error), None),
    };
    progress.finish();
    let ended = finish_recording(ended, recorder.as_deref());
    // The participants end while the summary is written.
    let (finished, _leaving, error) = match ended {
        Ok((finished, leaving)) => (finished, leaving, None),
        Err(error) => (Vec::new(), None, Some(place(case, error))),
    };
    let roles = plan.participants.iter().map(|p| p.role.as_str());
    let mut sections = Sections::gather(roles.zip(finished.iter().map(|f| &f.summary)));
    derived::complete(&mut sections.merged, &plan.figures);
    let not_finite = sections.not_finite.clone();
    let error = error.or(not_finite.map(|(role, key)| RunError::NotFinite { role, key }));
    let table = folder.file(history::FILE);
    let (error, survey) = match error {
        None => match Survey::read(&table, &plan.figures) {
            Ok(survey) => (None, Some(survey)),
            Err(error) => (Some(error), None),
        },
        error => (error, None),
    };
    let (status, reason) = match &error {
        None => success(plan, &counts),
        Some(error) if error.is_interrupt() => (Status::Interrupted, error.to_string()),
        Some(error) => (Status::Failed, error.to_string()),
    };
    let wall_seconds = since.elapsed().as_secs_f64();
    let (finished, sections, warnings) = (&finished, &sections, &warnings);
    let extremes = survey.as_ref().map(|survey| &survey.extremes);
    let summary = build(&SummaryInput {
        plan,
        status,
        reason,
        counts,
        finished,
        sections,
        warnings,
        extremes,
        wall_seconds,
    });
    let error = first(error, folder.write_summary(&json(&summary)));
    let outcome = Outcome { summary, error };
    // The summary of a complete run exists: its table is not needed to resume it any more.
    match survey.filter(|_| outcome.error.is_none()).map(|survey| survey.trim(&table)) {
        Some(Err(error)) => outcome.fail(error, folder),
        _ => outcome,
    }
}

/// Writes the files that are known before a run, and starts its recording if requested.
fn set_out(
    planned: &Planned,
    folder: &ResultFolder,
    from: Option<&Checkpoint>,
    record: Option<Compression>,
) -> Result<Option<Arc<Recorder>>, RunError> {
    match from {
        Some(_) => folder.reopen()?,
        None if !folder.is_kept() => {}
        None => {
            folder.write("case.toml", planned.case.text().as_bytes())?;
            plan_file::write(&planned.plan, folder)?;
        }
    }
    let start = |compression| recorder(planned, folder, from, compression).map(Arc::new);
    record.map(start).transpose()
}

/// Adds the warnings that are new.
fn add(warnings: &mut Vec<Warning>, more: &[Warning]) {
    let known = |one: &&Warning| warnings.iter().any(|other| other.says_the_same(one));
    let new: Vec<Warning> = more.iter().filter(|one| !known(one)).cloned().collect();
    warnings.extend(new);
}

/// Formats a summary as the content of its file.
#[must_use]
pub fn json(summary: &Value) -> Vec<u8> {
    serde_json::to_vec_pretty(summary).expect("a summary is plain data")
}

/// Returns the status of a run without an error, and its reason.
fn success(plan: &Plan, counts: &Counts) -> (Status, String) {
    let reason = &plan.scheme.reason;
    match counts.not_converged {
        _ if !plan.scheme.scheme.is_implicit() => (Status::Completed, reason.clone()),
        0 => (Status::Converged, format!("every window is within its tolerances; {reason}")),
        few => {
            let have = if few == 1 { "has" } else { "have" };
            let windows = counted(few, "window");
            (Status::Completed, format!("{windows} {have} not converged; {reason}"))
        }
    }
}

/// Joins two errors into one that names the earlier first.
fn first(error: Option<RunError>, then: Result<(), RunError>) -> Option<RunError> {
    match error {
        Some(error) => Some(error.and(then)),
        None => then.err(),
    }
}

/// Starts a recording. A resumed run has its own recording, named after its first window.
fn recorder(
    planned: &Planned,
    folder: &ResultFolder,
    from: Option<&Checkpoint>,
    compression: Compression,
) -> Result<Recorder, RunError> {
    let name = match from {
        Some(checkpoint) => format!("recording-{:06}.mcap", checkpoint.state.step.0 + 1),
        None => "recording.mcap".to_owned(),
    };
    Recorder::start(&folder.file(&name), compression, &planned.plan, &planned.case.text())
}

/// Completes the recording at the end of the run.
fn finish_recording<T>(
    ended: Result<T, RunError>,
    recorder: Option<&Recorder>,
) -> Result<T, RunError> {
    let Some(recorder) = recorder else { return ended };
    let written = recorder.finish(ended.as_ref().err().map(ToString::to_string).as_deref());
    if let Ok(bytes) = &written {
        tracing::info!(bytes, path = %shown(recorder.path()).display(), "recording complete");
    }
    match ended {
        Ok(finished) => written.map(|_| finished),
        // An error that the recording itself caused is reported already.
        Err(error) if recorder.has_reported() => Err(error),
        Err(error) => Err(error.and(written.map(drop))),
    }
}

/// Returns the report for the terminal.
#[must_use]
pub fn report(outcome: &Outcome, plan: &Plan, folder: &ResultFolder) -> String {
    let text = show::text(&outcome.summary, plan.title.as_deref(), &plan.figures);
    format!("{text}  results   {}\n", folder.shown().display())
}

/// Adds the place in the case to an error about a value of the case.
pub fn place(case: &Case, error: RunError) -> RunError {
    match error {
        RunError::Refused { refusal, .. } => {
            let problem = case.problem_at(&refusal.key, refusal.reason, refusal.fix);
            case.fail(problem).into()
        }
        other => other,
    }
}

fn perform(
    (planned, fleet): (&Planned, &mut Fleet),
    folder: &ResultFolder,
    progress: &Rc<dyn Progress>,
    (counts, warnings): (&mut Counts, &mut Vec<Warning>),
    (from, driver): (Option<&Checkpoint>, Option<&mut dyn Driver>),
    recorder: Option<Arc<Recorder>>,
) -> Result<(Vec<Finished>, Option<PendingExits>), RunError> {
    let plan = &planned.plan;
    let mut tables = Tables::open(plan, folder, from)?;
    let mut fields = FieldWriter::within(folder.dir().clone(), "fields");
    let starting = Instant::now();
    let session = || Session::start(plan, fleet, recorder.clone(), progress);
    let started = tracing::info_span!("start").in_scope(session);
    counts.start_seconds = starting.elapsed().as_secs_f64();
    let mut session = started?;
    let windows = || {
        let writing = |every| {
            let (into, origin) = (Checkpoints::of(&folder.path()), origin(planned)?);
            let recorded = recorder.as_ref().map(|recorder| recorder.compression());
            Ok::<_, RunError>(time_loop::Writing { every, into, origin, recorded })
        };
        let checkpoints = plan.checkpoint_every.map(writing).transpose()?;
        let watcher = Watcher::of(&folder.path());
        let mut windows = TimeLoop::new(
            plan,
            &mut session,
            &mut tables,
            &mut fields,
            counts,
            checkpoints,
            watcher,
        );
        windows.record(recorder.as_deref());
        if let Some(checkpoint) = from {
            windows.resume(checkpoint)?;
        }
        match driver {
            None => windows.all(&**progress),
            Some(driver) => {
                let mut driven = Driven::new(&mut windows);
                driver.drive(&mut driven)?;
                // The final output belongs to the state to which the driver returned last.
                driven.settle().map_err(DriverError::into_error)
            }
        }
    };
    let looped = tracing::info_span!("windows").in_scope(windows);
    let looped = looped.map_err(|error| match &recorder {
        Some(recorder) => recorder.cause(error),
        None => error,
    });
    counts.bytes_exchanged = session.bytes_exchanged();
    add(warnings, session.warnings());
    add(warnings, &counts.warnings());
    // The results written so far stay readable after any error.
    if let Some(error) = first(looped.err(), tables.flush()) {
        return Err(error);
    }
    let finishing = Instant::now();
    let finished = tracing::info_span!("finish").in_scope(|| session.finish(fleet));
    counts.finish_seconds = finishing.elapsed().as_secs_f64();
    finished
}
