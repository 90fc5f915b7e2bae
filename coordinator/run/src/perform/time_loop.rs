//! Loop over the windows of a run: each is solved, judged, accepted, written and checkpointed.

use super::tables::{Inputs, Tables};
use crate::checkpoint::{Checkpoint, Checkpoints, CoordinatorState, Origin};
use crate::error::{Failure, RunError};
use crate::plan::Plan;
use crate::progress::Progress;
use crate::record::{Compression, Recorder};
use crate::results::counts::Counts;
use crate::results::history::HistoryRecord;
use crate::results::iterations::IterationRecord;
use crate::results::summary::Status;
use crate::results::vtk::{FieldOutput, FieldWriter};
use crate::session::{Balance, FieldSubscription, Observed, Receipt, Session};
use crate::warnings::Warning;
use crate::watching::Watcher;
use contract::bodies::Bodies;
use contract::step::Step;
use coupling::StateReader;
use coupling::converge::Verdict;
use coupling::windows::{self, Controller, WindowState, Windows};
use coupling::{Coupling, WindowOutcome};
use proto::recording::{Event, Iteration};
use std::path::Path;
use std::time::Instant;

/// Largest relative difference between the power sent and received in a window: rounding only.
const LARGEST_IMBALANCE: f64 = 1e-6;

/// Settings of the checkpoints that a run writes: interval, folder and origin.
#[derive(Debug)]
pub(super) struct Writing {
    /// Number of windows between two checkpoints.
    pub(super) every: u64,
    pub(super) into: Checkpoints,
    pub(super) origin: Origin,
    /// Compression of the recording, if the run is recorded.
    pub(super) recorded: Option<Compression>,
}

/// The loop over the windows of a run.
pub(super) struct TimeLoop<'a> {
    pub(super) plan: &'a Plan,
    pub(super) session: &'a mut Session,
    pub(super) tables: &'a mut Tables,
    pub(super) fields: &'a mut FieldWriter,
    pub(super) counts: &'a mut Counts,
    inputs: Inputs<'a>,
    checkpoints: Option<Writing>,
    recorder: Option<&'a Recorder>,
    watcher: Watcher,
    pub(super) coupling: Coupling,
    pub(super) time: Controller,
}

/// An accepted window.
#[derive(Clone, Copy, Debug)]
pub(super) struct AcceptedWindow {
    /// Status of the window.
    pub(super) status: &'static str,
    pub(super) iterations: u32,
}

/// A rejected window.
#[derive(Debug)]
pub(super) struct RejectedWindow {
    pub(super) error: RunError,
    /// Whether the run has ended.
    pub(super) ended: bool,
    /// Some participants have accepted the window, others have not. Only restoring an earlier state
    /// can continue.
    pub(super) torn: bool,
}

impl RejectedWindow {
    fn of(error: RunError, ended: bool) -> Self {
        Self { error, ended, torn: false }
    }
}

impl<'a> TimeLoop<'a> {
    pub(super) fn new(
        plan: &'a Plan,
        session: &'a mut Session,
        tables: &'a mut Tables,
        fields: &'a mut FieldWriter,
        counts: &'a mut Counts,
        checkpoints: Option<Writing>,
        watcher: Watcher,
    ) -> Self {
        let coupling = coupling(plan, session);
        let time = Controller::new(plan.windows.clone());
        let (inputs, recorder) = (Inputs::of(plan), None);
        Self {
            plan,
            session,
            tables,
            fields,
            counts,
            inputs,
            checkpoints,
            recorder,
            watcher,
            coupling,
            time,
        }
    }

    /// Reports every iteration to a recorder.
    pub(super) fn record(&mut self, recorder: Option<&'a Recorder>) {
        self.recorder = recorder;
    }

    /// Returns the whole run to a checkpoint.
    pub(super) fn resume(&mut self, checkpoint: &Checkpoint) -> Result<(), RunError> {
        let CoordinatorState { step, time, counts, coupling, iterate, series, .. } =
            &checkpoint.state;
        let (window, iteration, start, end) = *step;
        let step = Step { window, iteration, start, end };
        self.go_to(&step, &checkpoint.folder, iterate, coupling, time)?;
        self.session.continue_counting(counts.bytes_exchanged);
        self.fields.resume(series.clone());
        tracing::info!(window = window + 1, time = end, "resumed");
        Ok(())
    }

    /// Returns participants and coupling to the state after a step.
    pub(super) fn go_to(
        &mut self,
        step: &Step,
        folder: &Path,
        iterate: &[f64],
        coupling: &[u8],
        time: &WindowState,
    ) -> Result<(), RunError> {
        self.session.restore(step, folder, iterate)?;
        self.coupling.restore(&mut StateReader(coupling)).map_err(|error| {
            RunError::Usage(format!("{error}; the checkpoint is that of another plan"))
        })?;
        self.time = Controller::resume(self.plan.windows.clone(), time.clone());
        Ok(())
    }

    /// Solves a requested window once, and accepts it.
    pub(super) fn attempt(
        &mut self,
        step: &Step,
        observe: bool,
    ) -> Result<AcceptedWindow, RejectedWindow> {
        let _span = tracing::debug_span!("window", step.window, step.start, step.end).entered();
        let outcome = match self.solve(step) {
            Ok(outcome) => outcome,
            Err(error) => {
                let ended = !self.session.take_unanswered();
                return Err(RejectedWindow::of(error, ended));
            }
        };
        let (converged, iterations) = (outcome.not_converged.is_none(), outcome.iterations);
        let wanted = self.session.wanted_window();
        self.report(outcome, wanted, step).map_err(|error| RejectedWindow::of(error, false))?;
        self.time.judge(step, converged, wanted, self.session.exchanged());
        let status = self.status(converged);
        let due = observe || self.is_due(step);
        match self.accept(step, due, status, iterations) {
            Ok(()) => Ok(AcceptedWindow { status, iterations }),
            Err(error) => {
                let torn = self.session.take_unanswered();
                Err(RejectedWindow { error, ended: !torn, torn })
            }
        }
    }

    /// Solves all windows up to the end.
    pub(super) fn all(&mut self, progress: &dyn Progress) -> Result<(), RunError> {
        while let Some(step) = self.time.window() {
            let _span = tracing::debug_span!("window", step.window, step.start, step.end).entered();
            let outcome = match self.solve(&step) {
                Err(error) => {
                    self.pass_over(&step, error)?;
                    continue;
                }
                Ok(WindowOutcome { not_converged: Some(why), .. }) if self.plan.skips => {
                    self.session.no_answer();
                    self.pass_over(&step, why.into())?;
                    continue;
                }
                Ok(outcome) => outcome,
            };
            let writing = Instant::now();
            let converged = outcome.not_converged.is_none();
            let wanted = self.session.wanted_window();
            match self.time.judge(&step, converged, wanted, self.session.exchanged()) {
                windows::Acceptance::Repeat(cause) => {
                    tracing::debug!(step.window, end = step.end, %cause, "solved again");
                    if let Some(recorder) = self.recorder {
                        let (window, cause) = (step.window, cause.to_string());
                        recorder.event(Event::Repeated { window, cause });
                    }
                }
                windows::Acceptance::Accept => {
                    let iterations = outcome.iterations;
                    self.report(outcome, wanted, &step)?;
                    let status = self.status(converged);
                    let due = self.time.window().is_none() || self.is_due(&step);
                    match self.accept(&step, due, status, iterations) {
                        Err(error) => self.unanswered(&step, error)?,
                        Ok(()) => self.checkpoint()?,
                    }
                    progress.window(self.counts.windows, step.end);
                }
            }
            self.counts.output_seconds += writing.elapsed().as_secs_f64();
        }
        // Fixed windows were judged by the plan.
        if self.time.is_adaptive() {
            let missed = self.inputs.missed_peaks(self.plan);
            missed.into_iter().for_each(|warning| self.session.warn(warning));
        }
        Ok(())
    }

    /// Continues after a window without an answer, if the case allows skipping windows.
    ///
    /// # Errors
    /// The error itself, if the case does not allow it.
    fn pass_over(&mut self, step: &Step, error: RunError) -> Result<(), RunError> {
        self.unanswered(step, error)?;
        self.time.pass_over(step);
        Ok(())
    }

    fn unanswered(&mut self, step: &Step, error: RunError) -> Result<(), RunError> {
        if !self.session.take_unanswered() {
            return Err(error);
        }
        if !self.plan.skips {
            return Err(self.session.cause(error));
        }
        tracing::warn!(row = step.window, "no answer, passed over: {error}");
        self.counts.skipped += 1;
        let (status, iterations) = ("no-answer", self.coupling.step().iteration);
        let inputs = &self.inputs.values(self.session, step);
        self.tables.history.row(&HistoryRecord {
            step,
            status,
            iterations,
            inputs,
            given: None,
        })?;
        // A sequence without a single answer is an error: it has no results.
        let over = Some(step.window + 1) == self.plan.windows.count();
        if over && self.counts.windows == 0 { Err(error) } else { Ok(()) }
    }

    /// Reports that a window is accepted although it has not converged, or although a participant
    /// asked for a shorter one. A strict case returns the error instead.
    fn report(
        &mut self,
        outcome: WindowOutcome,
        wanted: Option<f64>,
        step: &Step,
    ) -> Result<(), RunError> {
        if let Some(not_converged) = outcome.not_converged {
            let error = RunError::from(not_converged);
            if self.plan.implicit.strict {
                return Err(error);
            }
            tracing::warn!("{error}");
            self.counts.not_converged += 1;
        }
        if let Some(wanted) = wanted.filter(|wanted| *wanted < step.duration() * (1.0 - 1e-9)) {
            tracing::info!(step.window, wanted, "a participant asks for a shorter window");
        }
        Ok(())
    }

    /// Returns whether the case wants the fields of this window.
    fn is_due(&self, step: &Step) -> bool {
        self.plan.output_every.is_some_and(|every| (step.window + 1).is_multiple_of(every))
    }

    /// Accepts a window of this status, and writes its fields if they are due.
    fn accept(
        &mut self,
        step: &Step,
        due: bool,
        status: &str,
        iterations: u32,
    ) -> Result<(), RunError> {
        let roles: Vec<&str> = self.plan.participants.iter().map(|p| p.role.as_str()).collect();
        let balance = self.session.balance();
        for warning in unreported(&balance, &roles, self.counts) {
            self.session.warn(warning);
        }
        audit(&balance, &roles, step.window, self.counts)?;
        self.coupling.accept_window();
        // A recording shows more than the newest fields to somebody who watches.
        let watched = !due && self.recorder.is_none() && self.watcher.is_due();
        let observed = match (due || watched, self.recorder) {
            (true, _) => Observed::Everybody,
            // While recording, every participant is observed, so that a replay can compare every
            // window.
            (false, Some(_)) => Observed::Unconsumed,
            (false, None) => Observed::Nobody,
        };
        self.session.accept(self.coupling.step(), observed)?;
        let given = Some(self.session.figures());
        let inputs = &self.inputs.values(self.session, step);
        self.inputs.keep(step, inputs);
        self.tables.history.row(&HistoryRecord { step, status, iterations, inputs, given })?;
        if due || watched {
            let wanted = self.session.fields().iter().filter(|field| field.wanted());
            let bodies = self.plan.bodies.as_ref();
            let shown: Vec<FieldOutput> = wanted.filter_map(|field| shown(field, bodies)).collect();
            if due {
                self.fields.write(&shown, step.window, step.end)?;
            } else if let Err(error) = self.fields.show(&shown, step.window, step.end) {
                // Nobody's look may end a run.
                self.watcher.stop(&error);
            }
            self.tables.flush()?;
        }
        self.counts.windows += 1;
        if self.time.is_adaptive() {
            self.counts.repeated_windows = Some(self.time.state().repeated);
            self.counts.window_lengths = self.time.state().lengths;
        }
        Ok(())
    }

    /// Returns the status of an accepted window.
    fn status(&self, converged: bool) -> &'static str {
        match converged {
            _ if !self.plan.scheme.scheme.is_implicit() => Status::Completed.word(),
            true => Status::Converged.word(),
            false => "not-converged",
        }
    }

    /// Writes a checkpoint, if one is due and another window follows.
    fn checkpoint(&mut self) -> Result<(), RunError> {
        let done = self.counts.windows;
        let due = |writing: &&Writing| done.is_multiple_of(writing.every);
        let Some(writing) = self.checkpoints.as_ref().filter(due) else { return Ok(()) };
        if self.time.window().is_none() {
            return Ok(());
        }
        let step = *self.coupling.step();
        let draft = writing.into.begin(done)?;
        let parts = self.session.save(&step, &draft)?;
        let mut coupling = Vec::new();
        self.coupling.save(&mut coupling);
        let bytes_exchanged = self.session.bytes_exchanged();
        let state = CoordinatorState {
            origin: writing.origin.clone(),
            step: (step.window, step.iteration, step.start, step.end),
            time: self.time.state().clone(),
            counts: Counts { bytes_exchanged, ..*self.counts },
            coupling,
            iterate: self.coupling.sent().to_vec(),
            table_bytes: self.tables.iterations.rows.seal()?,
            history_bytes: self.tables.history.rows.seal()?,
            series: self.fields.series().to_vec(),
            recorded: writing.recorded,
        };
        writing.into.complete(&draft, &parts, &state)?;
        tracing::info!(window = done, "checkpoint written");
        Ok(())
    }

    /// Iterates one window, reports every iteration, and counts its cost.
    fn solve(&mut self, window: &Step) -> Result<WindowOutcome, RunError> {
        self.coupling.begin_window(window);
        loop {
            let (solving, computed) = (Instant::now(), self.session.computed_seconds());
            let verdict = self.coupling.iterate(self.session)?;
            let models = self.session.computed_seconds() - computed;
            let coupling_seconds = beside_the_models(solving.elapsed().as_secs_f64(), models);
            self.counts.coupling_seconds += coupling_seconds;
            self.counts.iterations += 1;
            let writing = Instant::now();
            self.tables.iterations.row(&IterationRecord {
                step: self.coupling.step(),
                residual: self.coupling.residual(),
                residuals: self.coupling.residuals(),
                taken: self.coupling.taken(),
                coupling_seconds,
                balance: &self.session.balance(),
                solved: &self.session.solved().raw,
            })?;
            if let Some(recorder) = self.recorder {
                recorder.event(Event::Iteration(self.iteration(coupling_seconds)));
            }
            self.counts.output_seconds += writing.elapsed().as_secs_f64();
            if verdict != Verdict::Continue {
                let outcome = self.coupling.outcome(verdict);
                self.counts.final_residual = outcome.residual;
                self.counts.loop_gain = self.coupling.gain();
                let most = self.counts.max_iterations_in_window.max(outcome.iterations);
                self.counts.max_iterations_in_window = most;
                return Ok(outcome);
            }
        }
    }

    /// Returns the record of the last iteration.
    fn iteration(&self, coupling_seconds: f64) -> Iteration {
        let (step, taken) = (self.coupling.step(), self.coupling.taken());
        let balance = self.session.balance();
        let names = self.coupling.parts().iter().map(|part| part.name.clone());
        Iteration {
            window: step.window,
            iteration: step.iteration,
            start: step.start,
            end: step.end,
            residual: self.coupling.residual(),
            residuals: names.zip(self.coupling.residuals().iter().copied()).collect(),
            relaxation: taken.relaxation,
            columns: taken.columns.map(|columns| columns as u64),
            sent: balance.sent,
            received: balance.received,
            coupling_seconds,
            model_seconds: self.session.solved().iter().map(|s| s.model_seconds).collect(),
        }
    }
}

/// Returns the field for writing; `None` before its first sample.
fn shown<'a>(field: &'a FieldSubscription, bodies: Option<&Bodies>) -> Option<FieldOutput<'a>> {
    Some(FieldOutput::new(
        field.producer_role(),
        field.grid(),
        field.kind(),
        field.values()?,
        bodies,
    ))
}

/// Returns the coupling that the plan has chosen.
fn coupling(plan: &Plan, session: &Session) -> Coupling {
    let scheme = plan.scheme.scheme;
    match (scheme.is_implicit(), scheme.is_parallel()) {
        (true, parallel) => {
            let coupling = Coupling::implicit(&plan.implicit, parallel, session);
            // The gain is only useful in a steady case: in time it describes one window, not a
            // state.
            if plan.windows == Windows::Steady { coupling.with_gain() } else { coupling }
        }
        (false, true) => Coupling::explicit_parallel(),
        (false, false) => Coupling::explicit(),
    }
}

/// Returns the part of `wall` seconds in which no model computed. Only rounding can make the
/// difference negative.
fn beside_the_models(wall: f64, models: f64) -> f64 {
    (wall - models).max(0.0)
}

/// Returns a warning for each participant that does not report the power it receives, once.
fn unreported(balance: &Balance, roles: &[&str], counts: &mut Counts) -> Vec<Warning> {
    let unreported = balance.unreported & !counts.unreported;
    counts.unreported |= unreported;
    let silent = roles.iter().enumerate().filter(|(index, _)| unreported >> index & 1 == 1);
    let warning = |(_, role): (usize, &&str)| {
        let reason = "does not report the power it receives, and is excluded from the energy audit";
        Warning::remark(role, reason, "let its solver report received_power")
    };
    silent.map(warning).collect()
}

/// Audits the conservative fields: heat that is not conserved between participants ends the run. A
/// participant that does not report the heat it receives is excluded.
fn audit(
    balance: &Balance,
    roles: &[&str],
    window: u64,
    counts: &mut Counts,
) -> Result<(), RunError> {
    let Some(imbalance) = balance.imbalance() else { return Ok(()) };
    let worst = counts.energy_imbalance.get_or_insert(0.0);
    *worst = worst.max(imbalance);
    if imbalance <= LARGEST_IMBALANCE {
        return Ok(());
    }
    let receipt = balance
        .worst
        .filter(|receipt| receipt.imbalance().is_nan() || receipt.imbalance() >= imbalance);
    let (what, fix) = match receipt {
        Some(receipt) => {
            let Receipt { participant, sent, received } = receipt;
            let role = roles[usize::from(participant)];
            let what = format!("{sent:e} W sent to {role}, which reports {received:e} W received");
            (what, "heat is not conserved: see iterations.csv")
        }
        None => {
            let what = format!(
                "heat is not conserved by a mapping, by {imbalance:e} of the heat it transfers"
            );
            (what, "see its coverage in log.jsonl; choose another [mapping] method")
        }
    };
    Err(RunError::Failed(Failure {
        who: "the energy audit".to_owned(),
        when: format!("in window {window}"),
        what,
        fix: fix.to_owned(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::SolveRecord;
    use typed_index_collections::TiSlice;

    /// Returns the balance of a second participant.
    fn balance(sent: f64, received: Option<f64>) -> Balance {
        let sent = Some(sent);
        let consumer = SolveRecord { sent, received, ..SolveRecord::default() };
        Balance::of(TiSlice::from_ref(&[SolveRecord::default(), consumer]))
    }

    fn audited(sent: f64, received: f64) -> (Result<(), String>, Option<f64>) {
        let mut counts = Counts::default();
        let judged = audit(&balance(sent, Some(received)), &["mech", "thermal"], 7, &mut counts);
        let judged = judged.map_err(|error| error.to_string());
        (judged, counts.energy_imbalance)
    }

    #[test]
    fn rounding_passes_the_audit_and_is_recorded() {
        assert_eq!(audited(0.0, 0.0), (Ok(()), Some(0.0)));
        let (judged, worst) = audited(1e3, 1e3 * (1.0 + 1e-9));
        assert_eq!(judged, Ok(()));
        assert!(worst.unwrap() > 0.9e-9);
        let mut counts = Counts::default();
        let (silent, roles) = (balance(1.0, None), ["mech", "thermal"]);
        assert!(audit(&silent, &roles, 0, &mut counts).is_ok());
        let told = unreported(&silent, &roles, &mut counts);
        assert_eq!(told.iter().map(Warning::key).collect::<Vec<_>>(), ["thermal"]);
        assert_eq!(unreported(&silent, &roles, &mut counts), [], "it is told once");
        assert_eq!((counts.unreported, counts.energy_imbalance), (0b10, None));
    }

    #[test]
    fn heat_that_is_lost_or_no_number_ends_the_run() {
        let (judged, worst) = audited(1000.0, 999.0);
        let message = "the energy audit failed in window 7: 1e3 W sent to thermal, which reports \
                    9.99e2 W received; heat is not conserved: see iterations.csv";
        assert_eq!(judged, Err(message.to_owned()));
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
        let mapped = Balance { mapping: Some(0.5), ..balance(1.0, Some(1.0)) };
        let judged = audit(&mapped, &["mech", "thermal"], 7, &mut Counts::default());
        assert!(
            judged.unwrap_err().to_string().contains("heat is not conserved by a mapping, by 5e-1")
        );
    }

    #[test]
    fn coupling_is_what_the_models_leave() {
        assert_eq!(beside_the_models(1.0, 0.75), 0.25);
        assert_eq!(beside_the_models(1.0, 1.0 + 1e-12), 0.0);
    }
}
