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
use crate::results::cost::Cost;
use crate::results::counts::Counts;
use crate::results::derived;
use crate::results::dir::shown;
use crate::results::history::{self, Survey};
use crate::results::summary::{CouplingSummary, Effects, Sections, Status, Summary};
use crate::results::vtk::FieldWriter;
use crate::results::{ResultFolder, show};
use crate::session::{PendingExits, Session};
use crate::warnings::{self, Warning};
use crate::watching::Watcher;
use case::Case;
use contract::message::Finished;
use coupling::windows::Windows;
use serde_json::Value;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;
use tables::Tables;
use time_loop::TimeLoop;

/// End of a run: its summary, and the error if there was one.
#[derive(Debug)]
pub struct Outcome {
    /// Summary of the run, also in `summary.json`.
    pub summary: Summary,
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
        (summary.status, summary.reason) = (Status::Failed, error.to_string());
        let error = error.and(folder.write_summary(&summary));
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
    let mut run = Run::new(planned, folder, from, plan_seconds);
    let ended = run.set_out(record).and_then(|()| run.execute(fleet, &progress, driver));
    progress.finish();
    let ended = finish_recording(ended, run.recorder.as_deref());
    // The participants end while the summary is written.
    let (finished, _leaving, error) = match ended {
        Ok((finished, leaving)) => (finished, leaving, None),
        Err(error) => (Vec::new(), None, Some(place(&planned.case, error))),
    };
    run.conclude(&finished, error, since)
}

/// A run, from its plan to its summary.
struct Run<'a> {
    planned: &'a Planned,
    folder: &'a ResultFolder,
    /// Checkpoint from which the run continues.
    from: Option<&'a Checkpoint>,
    recorder: Option<Arc<Recorder>>,
    counts: Counts,
    warnings: Vec<Warning>,
}

impl<'a> Run<'a> {
    fn new(
        planned: &'a Planned,
        folder: &'a ResultFolder,
        from: Option<&'a Checkpoint>,
        plan_seconds: f64,
    ) -> Self {
        let own = &planned.plan.warnings;
        let (counts, warnings) = match from {
            Some(checkpoint) => {
                let mut warnings = plan_file::first_warnings(folder);
                add(&mut warnings, own);
                (checkpoint.state.counts.resumed(plan_seconds), warnings)
            }
            None => (Counts { plan_seconds, ..Counts::default() }, own.clone()),
        };
        let mut run = Self { planned, folder, from, recorder: None, counts, warnings };
        add(&mut run.warnings, folder.warning().map_or(&[], std::slice::from_ref));
        run
    }

    /// Writes the files that are known before a run, and starts its recording: if requested, or if
    /// the run before the checkpoint was recorded.
    fn set_out(&mut self, record: Option<Compression>) -> Result<(), RunError> {
        let Self { planned, folder, from, .. } = self;
        match from {
            Some(_) => folder.reopen()?,
            None if !folder.is_kept() => {}
            None => {
                folder.write("case.toml", planned.case.text().as_bytes())?;
                plan_file::write(&planned.plan, folder)?;
            }
        }
        let record = record.or_else(|| from.and_then(|checkpoint| checkpoint.state.recorded));
        let start = |compression| recorder(planned, folder, *from, compression).map(Arc::new);
        self.recorder = record.map(start).transpose()?;
        Ok(())
    }

    /// Starts the participants, computes all windows, and finishes the participants.
    fn execute(
        &mut self,
        fleet: &mut Fleet,
        progress: &Rc<dyn Progress>,
        driver: Option<&mut dyn Driver>,
    ) -> Result<(Vec<Finished>, Option<PendingExits>), RunError> {
        let plan = &self.planned.plan;
        let mut tables = Tables::open(plan, self.folder, self.from)?;
        let starting = Instant::now();
        let session = || Session::start(plan, fleet, self.recorder.clone(), progress);
        let started = tracing::info_span!("start").in_scope(session);
        self.counts.start_seconds = starting.elapsed().as_secs_f64();
        let mut session = started?;
        let windows = || self.windows(&mut session, &mut tables, &**progress, driver);
        let looped = tracing::info_span!("windows").in_scope(windows);
        let looped = looped.map_err(|error| match &self.recorder {
            Some(recorder) => recorder.cause(error),
            None => error,
        });
        self.counts.bytes_exchanged = session.bytes_exchanged();
        add(&mut self.warnings, session.warnings());
        add(&mut self.warnings, &self.counts.warnings());
        // The results written so far stay readable after any error.
        if let Some(error) = first(looped.err(), tables.flush()) {
            return Err(error);
        }
        let finishing = Instant::now();
        let finished = tracing::info_span!("finish").in_scope(|| session.finish(fleet));
        self.counts.finish_seconds = finishing.elapsed().as_secs_f64();
        finished
    }

    /// Computes the windows of the case, or those that the driver requests.
    fn windows(
        &mut self,
        session: &mut Session,
        tables: &mut Tables,
        progress: &dyn Progress,
        driver: Option<&mut dyn Driver>,
    ) -> Result<(), RunError> {
        let Self { planned, folder, from, recorder, counts, .. } = self;
        let recorder = recorder.as_deref();
        let writing = |every| {
            let (into, origin) = (Checkpoints::of(&folder.path()), origin(planned)?);
            let recorded = recorder.map(Recorder::compression);
            Ok::<_, RunError>(time_loop::Writing { every, into, origin, recorded })
        };
        let checkpoints = planned.plan.checkpoint_every.map(writing).transpose()?;
        let mut fields = FieldWriter::within(folder.dir().clone(), "fields");
        let watcher = Watcher::of(&folder.path());
        let mut windows = TimeLoop::new(
            &planned.plan,
            session,
            tables,
            &mut fields,
            counts,
            checkpoints,
            watcher,
        );
        windows.record(recorder);
        if let Some(checkpoint) = from {
            windows.resume(checkpoint)?;
        }
        match driver {
            None => windows.all(progress),
            Some(driver) => {
                let mut driven = Driven::new(&mut windows);
                driver.drive(&mut driven)?;
                // The final output belongs to the state to which the driver returned last.
                driven.settle().map_err(DriverError::into_error)
            }
        }
    }

    /// Writes the summary of a run that has ended, and removes what was needed to resume it.
    fn conclude(self, finished: &[Finished], error: Option<RunError>, since: Instant) -> Outcome {
        let Self { planned: Planned { plan, .. }, folder, counts, warnings, .. } = self;
        let roles = plan.participants.iter().map(|participant| participant.role.as_str());
        let mut sections = Sections::gather(roles.zip(finished.iter().map(|one| &one.summary)));
        derived::complete(&mut sections.merged, &plan.figures);
        let not_finite = sections.not_finite.map(|(role, key)| RunError::NotFinite { role, key });
        let table = folder.file(history::FILE);
        let (error, survey) = match error.or(not_finite) {
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
        let ranges = survey.as_ref().map(|survey| &survey.ranges);
        let rows = matches!(plan.windows, Windows::Sequence(_));
        let sent = Value::Object(sections.merged);
        let figures = warnings::of_figures(&sent, &plan.figures, ranges, rows);
        let summary = Summary {
            case: plan.name.clone(),
            status,
            reason,
            sections: sent,
            warnings: [warnings, sections.warnings, figures].concat(),
            extremes: ranges.and_then(|ranges| ranges.section(rows)),
            coupling: CouplingSummary::of(plan, &counts),
            cost: Cost::of(plan, &counts, finished, since.elapsed().as_secs_f64()),
            effects: Effects::of(plan),
            ..Summary::default()
        };
        let error = first(error, folder.write_summary(&summary));
        let outcome = Outcome { summary, error };
        // The summary of a complete run exists: its table is not needed to resume it any more.
        match survey.filter(|_| outcome.error.is_none()).map(|survey| survey.trim(&table)) {
            Some(Err(error)) => outcome.fail(error, folder),
            _ => outcome,
        }
    }
}

/// Adds the warnings that are new.
fn add(warnings: &mut Vec<Warning>, more: &[Warning]) {
    let known = |one: &&Warning| warnings.iter().any(|other| other.says_the_same(one));
    let new: Vec<Warning> = more.iter().filter(|one| !known(one)).cloned().collect();
    warnings.extend(new);
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
