//! `coordinator run`: from a plan to a result directory.

use crate::case::Case;
use crate::couple::converge::Verdict;
use crate::couple::{Coupling, WindowOutcome};
use crate::error::{Failure, RunError};
use crate::plan::{Plan, Planned};
use crate::progress::Progress;
use crate::results::iterations::{IterationTable, Row};
use crate::results::summary::{Counts, Ingredients, Sections, Status, build};
use crate::results::vtk::FieldWriter;
use crate::results::{ResultFolder, show};
use crate::session::{HeatBalance, Session};
use proto::message::Finished;
use proto::model::Step;
use serde_json::Value;
use std::time::Instant;

/// Largest relative difference between the heat sent and received in a window: rounding only.
const LARGEST_IMBALANCE: f64 = 1e-6;

/// How a run ended: its summary, and the error if there was one.
#[derive(Debug)]
pub struct Outcome {
    /// The content of `summary.json`.
    pub summary: Value,
    /// What went wrong.
    pub error: Option<RunError>,
}

/// What a run is measured by before it begins.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// When the program started.
    pub since: Instant,
    /// Seconds of planning.
    pub plan_seconds: f64,
}

/// Runs a plan and writes its results; a failed run leaves a summary that says so.
pub fn run(
    planned: &Planned,
    folder: &ResultFolder,
    progress: &mut Progress,
    clock: Clock,
) -> Result<Outcome, RunError> {
    let Planned { case, plan } = planned;
    folder.write("case.toml", case.text().as_bytes())?;
    let mut counts = Counts { plan_seconds: clock.plan_seconds, ..Counts::default() };
    let ended = perform(plan, folder, progress, &mut counts);
    progress.finish();
    let (finished, error) = match ended {
        Ok(finished) => (finished, None),
        Err(error) => (Vec::new(), Some(place(case, error))),
    };
    let roles = plan.participants.iter().map(|p| p.role.as_str());
    let sections = Sections::gather(roles.zip(finished.iter().map(|f| &f.summary)));
    let not_finite = sections.not_finite.clone();
    let error = error.or(not_finite.map(|(role, key)| RunError::NotFinite { role, key }));
    let (status, reason) = match &error {
        None => success(plan, &counts),
        Some(error) => (Status::Failed, error.to_string()),
    };
    let wall_seconds = clock.since.elapsed().as_secs_f64();
    let (finished, sections) = (&finished, &sections);
    let summary =
        build(&Ingredients { plan, status, reason, counts, finished, sections, wall_seconds });
    let text = serde_json::to_vec_pretty(&summary).expect("a summary is plain data");
    let error = first(error, folder.write("summary.json", &text));
    Ok(Outcome { summary, error })
}

/// The status of a run without an error, and its reason.
fn success(plan: &Plan, counts: &Counts) -> (Status, String) {
    let reason = &plan.scheme.reason;
    match counts.not_converged {
        _ if !plan.scheme.scheme.is_implicit() => (Status::Completed, reason.clone()),
        0 => (Status::Converged, format!("every window is within its tolerances; {reason}")),
        few => (Status::Completed, format!("{few} window(s) have not converged; {reason}")),
    }
}

/// The first of two errors, with the second one added.
fn first(error: Option<RunError>, then: Result<(), RunError>) -> Option<RunError> {
    match error {
        Some(error) => Some(error.and(then)),
        None => then.err(),
    }
}

/// The text for a person.
#[must_use]
pub fn report(outcome: &Outcome, plan: &Plan, folder: &ResultFolder) -> String {
    let text = show::text(&outcome.summary, plan.title.as_deref());
    format!("{text}  results   {}\n", folder.path().display())
}

/// An error about a value of the case gets its place in the case.
pub fn place(case: &Case, error: RunError) -> RunError {
    match error {
        RunError::Refused { refusal, .. } => {
            let problem = case.problem_at(&refusal.key, refusal.reason, refusal.fix);
            case.report(vec![problem]).expect("there is a problem").into()
        }
        other => other,
    }
}

fn perform(
    plan: &Plan,
    folder: &ResultFolder,
    progress: &mut Progress,
    counts: &mut Counts,
) -> Result<Vec<Finished>, RunError> {
    let roles: Vec<&str> = plan.participants.iter().map(|p| p.role.as_str()).collect();
    let fed_back = plan.fields.iter().filter(|field| !field.fed_back.is_empty());
    let fields: Vec<&str> = fed_back.map(|field| field.kind.name.as_str()).collect();
    let mut table = IterationTable::create(&folder.file("iterations.csv"), &roles, &fields)?;
    let mut fields = FieldWriter::new(folder.file("fields"));
    let starting = Instant::now();
    let started = tracing::info_span!("start").in_scope(|| Session::start(plan));
    counts.start_seconds = starting.elapsed().as_secs_f64();
    let mut session = started?;
    let looped = tracing::info_span!("windows")
        .in_scope(|| windows(plan, &mut session, &mut table, &mut fields, progress, counts));
    counts.bytes_exchanged = session.bytes_exchanged();
    // Whatever happened, what was written so far stays readable.
    if let Some(error) = first(looped.err(), table.flush()) {
        return Err(error);
    }
    let finishing = Instant::now();
    let finished = tracing::info_span!("finish").in_scope(|| session.finish());
    counts.finish_seconds = finishing.elapsed().as_secs_f64();
    finished
}

fn windows(
    plan: &Plan,
    session: &mut Session,
    table: &mut IterationTable,
    fields: &mut FieldWriter,
    progress: &mut Progress,
    counts: &mut Counts,
) -> Result<(), RunError> {
    let mut coupling = coupling(plan, session);
    let total = plan.windows.count();
    for window in 0..total {
        let (start, end) = plan.windows.interval(window);
        let _span = tracing::debug_span!("window", window, start, end).entered();
        let step = Step { window, iteration: 0, start, end };
        let outcome = solve(&mut coupling, session, &step, table, counts)?;
        if let Some(not_converged) = outcome.not_converged {
            if plan.implicit.strict {
                return Err(not_converged.into());
            }
            tracing::warn!("{not_converged}");
            counts.not_converged += 1;
        }
        let writing = Instant::now();
        audit(&session.heat_balance(), window, counts)?;
        let last = window + 1 == total;
        let observe = last || plan.output_every.is_some_and(|n| (window + 1) % n == 0);
        coupling.accept_window();
        session.accept(coupling.step(), observe)?;
        if observe {
            fields.write(session.taps(), window, end)?;
            table.flush()?;
        }
        counts.output_seconds += writing.elapsed().as_secs_f64();
        counts.windows += 1;
        progress.window(window + 1, end);
    }
    Ok(())
}

/// The coupling that the plan has chosen.
fn coupling(plan: &Plan, session: &Session) -> Coupling {
    let scheme = plan.scheme.scheme;
    match (scheme.is_implicit(), scheme.is_parallel()) {
        (true, parallel) => Coupling::implicit(&plan.implicit, parallel, session),
        (false, true) => Coupling::explicit_parallel(),
        (false, false) => Coupling::explicit(),
    }
}

/// Iterates one window, tells of every iteration, and counts what that took.
fn solve(
    coupling: &mut Coupling,
    session: &mut Session,
    window: &Step,
    table: &mut IterationTable,
    counts: &mut Counts,
) -> Result<WindowOutcome, RunError> {
    coupling.begin_window(window);
    loop {
        let (solving, computed) = (Instant::now(), session.computed_seconds());
        let verdict = coupling.iterate(session)?;
        let models = session.computed_seconds() - computed;
        let coupling_seconds = beside_the_models(solving.elapsed().as_secs_f64(), models);
        counts.coupling_seconds += coupling_seconds;
        counts.iterations += 1;
        let writing = Instant::now();
        table.row(&Row {
            step: coupling.step(),
            residual: coupling.residual(),
            residuals: coupling.residuals(),
            taken: coupling.taken(),
            coupling_seconds,
            heat: &session.heat_balance(),
            solved: session.solved(),
        })?;
        counts.output_seconds += writing.elapsed().as_secs_f64();
        if verdict != Verdict::Continue {
            let outcome = coupling.outcome(verdict);
            counts.final_residual = outcome.residual;
            let most = counts.max_iterations_in_window.max(outcome.iterations);
            counts.max_iterations_in_window = most;
            return Ok(outcome);
        }
    }
}

/// The part of `wall` seconds in which no model computed; only rounding can make it negative.
fn beside_the_models(wall: f64, models: f64) -> f64 {
    (wall - models).max(0.0)
}

/// Heat that is lost or made between the participants ends the run.
fn audit(heat: &HeatBalance, window: u64, counts: &mut Counts) -> Result<(), RunError> {
    let Some(imbalance) = heat.imbalance() else { return Ok(()) };
    let worst = counts.energy_imbalance.get_or_insert(0.0);
    *worst = worst.max(imbalance);
    if imbalance <= LARGEST_IMBALANCE {
        return Ok(());
    }
    let watts = |heat: Option<f64>| heat.map_or_else(|| "?".to_owned(), |heat| format!("{heat:e}"));
    Err(RunError::Failed(Failure {
        who: "the energy audit".to_owned(),
        when: format!("in window {window}"),
        what: format!("{} W sent, {} W received", watts(heat.sent), watts(heat.received)),
        fix: "a participant loses or makes heat; see iterations.csv".to_owned(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn audited(sent: f64, received: f64) -> (Result<(), String>, Option<f64>) {
        let mut counts = Counts::default();
        let heat = HeatBalance { sent: Some(sent), received: Some(received), mapping: None };
        let judged = audit(&heat, 7, &mut counts).map_err(|error| error.to_string());
        (judged, counts.energy_imbalance)
    }

    #[test]
    fn rounding_passes_the_audit_and_is_recorded() {
        assert_eq!(audited(0.0, 0.0), (Ok(()), Some(0.0)));
        let (judged, worst) = audited(1e3, 1e3 * (1.0 + 1e-9));
        assert_eq!(judged, Ok(()));
        assert!(worst.unwrap() > 0.9e-9);
        let unknown = HeatBalance { sent: Some(1.0), received: None, mapping: None };
        assert!(audit(&unknown, 0, &mut Counts::default()).is_ok());
    }

    #[test]
    fn heat_that_is_lost_or_no_number_ends_the_run() {
        let (judged, worst) = audited(1000.0, 999.0);
        let told = "the energy audit failed in window 7: 1e3 W sent, 9.99e2 W received; a \
                    participant loses or makes heat; see iterations.csv";
        assert_eq!(judged, Err(told.to_owned()));
        assert_eq!(worst, Some(0.001));
        for (sent, received) in [
            (f64::NAN, 1.0),
            (1.0, f64::NAN),
            (f64::NAN, f64::NAN),
            (f64::INFINITY, f64::INFINITY),
            (1.0, f64::INFINITY),
            (1.0, -1.0),
        ] {
            assert!(audited(sent, received).0.is_err(), "{sent} W, {received} W");
        }
    }

    #[test]
    fn coupling_is_what_the_models_leave() {
        assert_eq!(beside_the_models(1.0, 0.75), 0.25);
        assert_eq!(beside_the_models(1.0, 1.0 + 1e-12), 0.0);
    }
}
