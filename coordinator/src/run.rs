//! `coordinator run`: from a plan to a result directory.

use crate::case::Case;
use crate::couple::Coupling;
use crate::error::RunError;
use crate::plan::{Plan, Planned};
use crate::progress::Progress;
use crate::results::iterations::IterationTable;
use crate::results::summary::{Counts, Ingredients, Status, build};
use crate::results::vtk::FieldWriter;
use crate::results::{ResultFolder, show};
use crate::session::Session;
use proto::message::Finished;
use proto::model::Step;
use serde_json::Value;
use std::time::Instant;

/// How a run ended: its summary, and the error if there was one.
#[derive(Debug)]
pub struct Outcome {
    /// The content of `summary.json`.
    pub summary: Value,
    /// What went wrong.
    pub error: Option<RunError>,
}

/// Runs a plan and writes its results; a failed run leaves a summary that says so.
pub fn run(
    planned: &Planned,
    folder: &ResultFolder,
    progress: &mut Progress,
    since: Instant,
) -> Result<Outcome, RunError> {
    let Planned { case, plan } = planned;
    folder.write("case.toml", case.text().as_bytes())?;
    let mut counts = Counts::default();
    let ended = perform(plan, folder, progress, &mut counts);
    progress.finish();
    let (status, reason, finished, error) = match ended {
        Ok(finished) => (Status::Completed, plan.scheme.reason.clone(), finished, None),
        Err(error) => {
            let error = place(case, error);
            (Status::Failed, error.to_string(), Vec::new(), Some(error))
        }
    };
    let wall_seconds = since.elapsed().as_secs_f64();
    let summary =
        build(&Ingredients { plan, status, reason, counts, finished: &finished, wall_seconds });
    let text = serde_json::to_vec_pretty(&summary).expect("a summary is plain data");
    folder.write("summary.json", &text)?;
    Ok(Outcome { summary, error })
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
    let mut table = IterationTable::create(&folder.file("iterations.csv"), &roles)?;
    let mut fields = FieldWriter::new(folder.file("fields"));
    let mut session = tracing::info_span!("start").in_scope(|| Session::start(plan))?;
    let started = Instant::now();
    let looped = tracing::info_span!("windows")
        .in_scope(|| windows(plan, &mut session, &mut table, &mut fields, progress, counts));
    let looping = started.elapsed().as_secs_f64();
    counts.coupling_seconds = (looping - session.model_seconds() - counts.output_seconds).max(0.0);
    counts.bytes_exchanged = session.bytes_exchanged();
    // Whatever happened, what was written so far stays readable.
    table.finish()?;
    fields.finish()?;
    looped?;
    tracing::info_span!("finish").in_scope(|| session.finish())
}

fn windows(
    plan: &Plan,
    session: &mut Session,
    table: &mut IterationTable,
    fields: &mut FieldWriter,
    progress: &mut Progress,
    counts: &mut Counts,
) -> Result<(), RunError> {
    let mut coupling = Coupling::explicit();
    let total = plan.windows.count();
    for window in 0..total {
        let (start, end) = plan.windows.interval(window);
        let mut step = Step { window, iteration: 1, start, end };
        let _span = tracing::debug_span!("window", window, start, end).entered();
        let outcome = coupling.solve_window(session, &step)?;
        step.iteration = outcome.iterations;
        let heat = session.heat_balance();
        let writing = Instant::now();
        table.row(&step, outcome.residual, &heat, session.solved())?;
        counts.output_seconds += writing.elapsed().as_secs_f64();
        let last = window + 1 == total;
        let observe = last || plan.output_every.is_some_and(|n| (window + 1) % n == 0);
        session.accept(&step, observe)?;
        if observe {
            let writing = Instant::now();
            fields.write(session.taps(), window, end)?;
            counts.output_seconds += writing.elapsed().as_secs_f64();
        }
        counts.windows += 1;
        counts.iterations += u64::from(outcome.iterations);
        counts.max_iterations_in_window = counts.max_iterations_in_window.max(outcome.iterations);
        counts.final_residual = outcome.residual;
        if let Some(imbalance) = heat.imbalance() {
            let worst = counts.energy_imbalance.get_or_insert(0.0);
            *worst = worst.max(imbalance);
        }
        progress.window(window + 1, end);
    }
    Ok(())
}
