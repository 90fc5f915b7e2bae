//! The windows of a run, one after the other: solved, judged, accepted, written, checkpointed.

use super::tables::{Inputs, Tables};
use crate::checkpoint::{Checkpoint, Checkpoints, CoordinatorState, Origin};
use crate::error::{Failure, RunError};
use crate::plan::Plan;
use crate::progress::Progress;
use crate::record::Recorder;
use crate::results::history::HistoryRecord;
use crate::results::iterations::IterationRecord;
use crate::results::summary::{Counts, Status};
use crate::results::vtk::{FieldWriter, Shown};
use crate::session::{HeatBalance, Observed, Receipt, Session, Tap};
use contract::bodies::Bodies;
use contract::step::Step;
use coupling::Exchange as _;
use coupling::converge::Verdict;
use coupling::state::Reader;
use coupling::windows::{self, Controller, WindowState, Windows};
use coupling::{Coupling, WindowOutcome};
use proto::recording::{Event, Iteration};
use std::path::Path;
use std::time::Instant;

/// Largest relative difference between the heat sent and received in a window: rounding only.
const LARGEST_IMBALANCE: f64 = 1e-6;

/// Checkpoints that a run writes.
#[derive(Debug)]
pub(super) struct Writing {
    /// Windows between them.
    pub(super) every: u64,
    pub(super) into: Checkpoints,
    pub(super) origin: Origin,
}

/// A run on its way through time.
pub(super) struct March<'a> {
    pub(super) plan: &'a Plan,
    pub(super) session: &'a mut Session,
    pub(super) tables: &'a mut Tables,
    pub(super) fields: &'a mut FieldWriter,
    pub(super) counts: &'a mut Counts,
    inputs: Inputs<'a>,
    checkpoints: Option<Writing>,
    recorder: Option<&'a Recorder>,
    pub(super) coupling: Coupling,
    pub(super) time: Controller,
}

/// A window that was solved once, and accepted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attempt {
    /// How it has ended.
    pub(super) status: &'static str,
    pub(super) iterations: u32,
}

/// A window that was not accepted.
#[derive(Debug)]
pub(super) struct Missed {
    pub(super) error: RunError,
    /// The run is over.
    pub(super) ended: bool,
    /// Some participants have accepted it, and one has not.
    pub(super) torn: bool,
}

impl Missed {
    fn of(error: RunError, ended: bool) -> Self {
        Self { error, ended, torn: false }
    }
}

impl<'a> March<'a> {
    pub(super) fn new(
        plan: &'a Plan,
        session: &'a mut Session,
        tables: &'a mut Tables,
        fields: &'a mut FieldWriter,
        counts: &'a mut Counts,
        checkpoints: Option<Writing>,
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
            coupling,
            time,
        }
    }

    /// Tells a recorder what the coordinator makes of each iteration.
    pub(super) fn record(&mut self, recorder: Option<&'a Recorder>) {
        self.recorder = recorder;
    }

    /// Returns everything to where it was at a checkpoint.
    pub(super) fn resume(&mut self, checkpoint: &Checkpoint) -> Result<(), RunError> {
        let CoordinatorState { step, time, counts, coupling, iterate, series, .. } =
            &checkpoint.state;
        let (window, iteration, start, end) = *step;
        let step = Step { window, iteration, start, end };
        self.go_to(&step, &checkpoint.folder, (iterate, coupling, time))?;
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
        (iterate, coupling, time): (&[f64], &[u8], &WindowState),
    ) -> Result<(), RunError> {
        self.session.restore(step, folder, iterate)?;
        self.coupling.restore(&mut Reader(coupling)).map_err(|error| {
            RunError::Usage(format!("{error}; the checkpoint is that of another plan"))
        })?;
        self.time = Controller::resume(self.plan.windows.clone(), time.clone());
        Ok(())
    }

    /// Solves a window that is asked for, once, and accepts it.
    pub(super) fn attempt(&mut self, step: &Step, observe: bool) -> Result<Attempt, Missed> {
        let _span = tracing::debug_span!("window", step.window, step.start, step.end).entered();
        let outcome = match self.solve(step) {
            Ok(outcome) => outcome,
            Err(error) => {
                let ended = !self.session.take_unanswered();
                return Err(Missed::of(error, ended));
            }
        };
        let (converged, iterations) = (outcome.not_converged.is_none(), outcome.iterations);
        let wanted = self.session.wanted_window();
        self.tell(outcome, wanted, step).map_err(|error| Missed::of(error, false))?;
        self.time.judge(step, converged, wanted, self.session.exchanged());
        let status = self.status(converged);
        let due = observe || self.is_due(step);
        match self.accept(step, due, status, iterations) {
            Ok(()) => Ok(Attempt { status, iterations }),
            Err(error) => {
                let torn = self.session.take_unanswered();
                Err(Missed { error, ended: !torn, torn })
            }
        }
    }

    /// Goes on to the end.
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
                    self.tell(outcome, wanted, &step)?;
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
        Ok(())
    }

    /// Goes on after a window without an answer, in a case that passes over such.
    ///
    /// # Errors
    /// The error itself, in any other case.
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
        // Of a sequence without any answer there are no results.
        let over = Some(step.window + 1) == self.plan.windows.count();
        if over && self.counts.windows == 0 { Err(error) } else { Ok(()) }
    }

    /// A window that is accepted although it has not converged, or although a participant wants a
    /// shorter one.
    fn tell(
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
            tracing::info!(step.window, wanted, "a participant wants a shorter window");
        }
        Ok(())
    }

    /// The case wants the fields of this window.
    fn is_due(&self, step: &Step) -> bool {
        self.plan.output_every.is_some_and(|every| (step.window + 1).is_multiple_of(every))
    }

    /// Accepts a window that has ended so; writes its fields if that is due.
    fn accept(
        &mut self,
        step: &Step,
        due: bool,
        status: &str,
        iterations: u32,
    ) -> Result<(), RunError> {
        let roles: Vec<&str> = self.plan.participants.iter().map(|p| p.role.as_str()).collect();
        audit(&self.session.heat_balance(), &roles, step.window, self.counts)?;
        self.coupling.accept_window();
        let observed = match (due, self.recorder) {
            (true, _) => Observed::Everybody,
            // So that a replay compares every window of everybody.
            (false, Some(_)) => Observed::Unconsumed,
            (false, None) => Observed::Nobody,
        };
        self.session.accept(self.coupling.step(), observed)?;
        let given = Some(self.session.figures());
        let inputs = &self.inputs.values(self.session, step);
        self.tables.history.row(&HistoryRecord { step, status, iterations, inputs, given })?;
        if due {
            let wanted = self.session.taps().iter().filter(|tap| tap.wanted());
            let bodies = self.plan.bodies.as_ref();
            let shown: Vec<Shown> = wanted.filter_map(|tap| shown(tap, bodies)).collect();
            self.fields.write(&shown, step.window, step.end)?;
            self.tables.flush()?;
        }
        self.counts.windows += 1;
        if self.time.is_adaptive() {
            self.counts.repeated_windows = Some(self.time.state().repeated);
            self.counts.window_lengths = self.time.state().lengths;
        }
        Ok(())
    }

    /// How an accepted window has ended.
    fn status(&self, converged: bool) -> &'static str {
        match converged {
            _ if !self.plan.scheme.scheme.is_implicit() => Status::Completed.word(),
            true => Status::Converged.word(),
            false => "not-converged",
        }
    }

    /// Writes a checkpoint, if it is time for one and another window follows.
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
            table_bytes: self.tables.iterations.seal()?,
            history_bytes: self.tables.history.seal()?,
            series: self.fields.series().to_vec(),
        };
        writing.into.complete(&draft, &parts, &state)?;
        tracing::info!(window = done, "checkpoint written");
        Ok(())
    }

    /// Iterates one window, tells of every iteration, and counts what that took.
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
                heat: &self.session.heat_balance(),
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
}

impl March<'_> {
    /// What there is to record of the last iteration.
    fn iteration(&self, coupling_seconds: f64) -> Iteration {
        let (step, taken) = (self.coupling.step(), self.coupling.taken());
        let heat = self.session.heat_balance();
        let names = self.session.coupling_data().iter().map(|part| part.name.clone());
        Iteration {
            window: step.window,
            iteration: step.iteration,
            start: step.start,
            end: step.end,
            residual: self.coupling.residual(),
            residuals: names.zip(self.coupling.residuals().iter().copied()).collect(),
            relaxation: taken.relaxation,
            columns: taken.columns.map(|columns| columns as u64),
            heat_sent: heat.sent,
            heat_received: heat.received,
            coupling_seconds,
            model_seconds: self.session.solved().iter().map(|s| s.model_seconds).collect(),
        }
    }
}

/// What is written of a field, once it has a sample.
fn shown<'a>(tap: &'a Tap, bodies: Option<&Bodies>) -> Option<Shown<'a>> {
    Some(Shown::new(tap.producer_role(), tap.grid(), tap.kind(), tap.values()?, bodies))
}

/// The coupling that the plan has chosen.
fn coupling(plan: &Plan, session: &Session) -> Coupling {
    let scheme = plan.scheme.scheme;
    match (scheme.is_implicit(), scheme.is_parallel()) {
        (true, parallel) => {
            let coupling = Coupling::implicit(&plan.implicit, parallel, session);
            // In time it is that of a window, which says nothing of a state.
            if plan.windows == Windows::Steady { coupling.with_gain() } else { coupling }
        }
        (false, true) => Coupling::explicit_parallel(),
        (false, false) => Coupling::explicit(),
    }
}

/// The part of `wall` seconds in which no model computed; only rounding can make it negative.
fn beside_the_models(wall: f64, models: f64) -> f64 {
    (wall - models).max(0.0)
}

/// Heat that is not conserved between the participants ends the run. A participant that reports
/// none of what it consumes is named, once, and left out.
fn audit(
    heat: &HeatBalance,
    roles: &[&str],
    window: u64,
    counts: &mut Counts,
) -> Result<(), RunError> {
    let unreported = heat.unreported & !counts.heat_unreported;
    counts.heat_unreported |= unreported;
    for (_, role) in roles.iter().enumerate().filter(|(one, _)| unreported >> one & 1 == 1) {
        tracing::warn!(
            "{role} does not report the heat it receives and is excluded from the audit"
        );
    }
    let Some(imbalance) = heat.imbalance() else { return Ok(()) };
    let worst = counts.energy_imbalance.get_or_insert(0.0);
    *worst = worst.max(imbalance);
    if imbalance <= LARGEST_IMBALANCE {
        return Ok(());
    }
    let receipt = heat
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
            let what =
                format!("heat is not conserved by a mapping, by {imbalance:e} of what it carries");
            (what, "see what log.jsonl says of its coverage; choose another [mapping] method")
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

    /// Of the second participant.
    fn heat(heat_sent: f64, heat_received: Option<f64>) -> HeatBalance {
        let heat_sent = Some(heat_sent);
        let consumer = SolveRecord { heat_sent, heat_received, ..SolveRecord::default() };
        HeatBalance::of(TiSlice::from_ref(&[SolveRecord::default(), consumer]))
    }

    fn audited(sent: f64, received: f64) -> (Result<(), String>, Option<f64>) {
        let mut counts = Counts::default();
        let judged = audit(&heat(sent, Some(received)), &["mech", "thermal"], 7, &mut counts);
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
        assert!(audit(&heat(1.0, None), &["mech", "thermal"], 0, &mut counts).is_ok());
        assert_eq!((counts.heat_unreported, counts.energy_imbalance), (0b10, None));
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
        let mapped = HeatBalance { mapping: Some(0.5), ..heat(1.0, Some(1.0)) };
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
