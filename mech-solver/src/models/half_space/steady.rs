//! Steady rolling, or sliding without partial slip: a contact without history.
//!
//! The contact is solved in the first window and its answer is kept. If friction or the surfaces
//! depend on inputs, it is solved in every iteration from the same starting point, so that it
//! depends on the inputs only. If values vary, every window is solved, starting from the accepted
//! solution of an earlier one.

use super::answer::ContactFields;
use super::balance::Balance;
use super::case::Case;
use super::contact::{ContactError, ContactSolver};
use crate::case::scene::GivenPatch;
use crate::models::contact_model::{CarriedLoad, Contact};
use crate::models::shortfall::Shortfall;
use crate::models::varying::{Varying, no_answer};
use crate::terms::Terms;
use half_space::grid_continuation::{Motion, Solution};
use proto::field::FieldSpec;
use proto::model::{Inputs, Outputs, StateError, Step, StepError, StepReport};
use serde_json::Value;
use std::io::{self, Read, Write};

/// Maximum size of a saved state: 4 GiB, which also fits a 32-bit `usize`.
pub(super) const MOST_BYTES: usize = u32::MAX as usize;

/// Values that vary from window to window, and how a solve starts.
pub(super) struct Following {
    pub(super) varying: Varying,
    /// Ellipse given by the case.
    pub(super) patch: Option<GivenPatch>,
    /// True if a row starts from the solution of the previous row.
    pub(super) warm: bool,
}

/// A contact without history.
pub(super) struct Steady {
    case: Case,
    following: Option<Following>,
    contact: Option<ContactSolver>,
}

/// A solved time window.
pub(super) struct Window {
    answer: ContactFields,
    report: StepReport,
    step: Step,
    /// For varying values: solution of the last row that has one, from which the next row starts.
    near: Near,
    /// Set if the prescribed force was not reached.
    shortfall: Option<Shortfall>,
}

/// A solution with its pressure.
type Near = Option<(Solution, Vec<f64>)>;

/// An answer, its cost, and the solution with partial slip, if any.
type Solved = (ContactFields, StepReport, Option<Solution>);

impl Steady {
    pub(super) fn new(case: Case, following: Option<Following>) -> Self {
        Self { case, following, contact: None }
    }

    /// Solves a row, starting from the accepted solution of an earlier row.
    fn row(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        accepted: Option<&Window>,
    ) -> Result<Window, StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        if let Some(following) = &self.following {
            following.varying.refuse_more(step)?;
        }
        // Build the operators from the case as configured, whichever row comes first.
        let mut contact = match self.contact.take() {
            Some(contact) => contact,
            None => ContactSolver::new(&self.case, Motion::SteadyRolling).map_err(no_solution)?,
        };
        let Some(following) = &self.following else { unreachable!("rows are of what varies") };
        let before = accepted.and_then(|window| window.near.as_ref());
        let row = following.varying.configuration(step);
        let taken = match &mut self.case.terms.removal {
            Some(removal) => removal.follow(&row),
            None => Ok(()),
        };
        if let Err(refusal) = taken.and_then(|()| self.case.follow(&row, following.patch)) {
            self.contact = Some(contact);
            return Err(no_answer(refusal));
        }
        let lost = following.varying.has_axle_load() && self.case.rest_if_lost();
        let start = before.filter(|_| following.warm && !lost).map(|(solution, pressure)| {
            contact.pressure.clone_from(pressure);
            Solution::new(solution.state.clone())
        });
        let solved = self.solve_row(&mut contact, start, inputs);
        let window = solved.map(|(answer, report, found)| {
            let near = found.map(|found| (found, contact.pressure.clone()));
            Window { answer, report, step: *step, near, shortfall: contact.shortfall }
        });
        self.contact = Some(contact);
        window
    }

    fn solve_row(
        &mut self,
        contact: &mut ContactSolver,
        near: Option<Solution>,
        inputs: &dyn Inputs,
    ) -> Result<Solved, StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        self.case.expand(inputs)?;
        contact.follow(&self.case, near.is_some(), None).map_err(no_solution)?;
        self.settled(contact, near, inputs)
    }

    /// Returns the solver, reset to the frictionless pressure.
    fn contact(&mut self) -> Result<ContactSolver, ContactError> {
        match self.contact.take() {
            Some(mut contact) => {
                contact.reset();
                Ok(contact)
            }
            None => ContactSolver::new(&self.case, Motion::SteadyRolling),
        }
    }

    /// Solves the contact, starting from a nearby solution if one is given.
    fn settled(
        &mut self,
        contact: &mut ContactSolver,
        near: Option<Solution>,
        inputs: &dyn Inputs,
    ) -> Result<Solved, StepError> {
        let creepage = self.case.driven.at(0.0).creepage;
        contact.set_friction(&self.case, inputs, creepage)?;
        let (answer, mut report, solution) = self.compute(contact, near, inputs)?;
        // Counted since the contact was reset.
        report.inner_iterations += contact.normal_iterations as u32;
        Ok((answer, report, solution))
    }

    fn compute(
        &mut self,
        contact: &mut ContactSolver,
        near: Option<Solution>,
        inputs: &dyn Inputs,
    ) -> Result<Solved, StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        let driven = self.case.driven;
        let case = &mut self.case;
        let mut report = StepReport { substeps: 1, ..StepReport::default() };
        let mut found: Option<Solution> = None;
        let mut answer = match case.terms.adhesion {
            false => ContactFields::sliding(case, contact),
            true => {
                let solution = contact.solve(case, inputs, &driven, near, None)?;
                report.inner_iterations = solution.newton_steps as u32;
                report.work = solution.operator_applications as u64;
                let mut answer = ContactFields::partial(case, contact, &solution, None);
                if let Some(power) = contact.numerical_dissipation(case, &solution.state) {
                    answer.add_numerical_dissipation(case, &power);
                }
                answer.leave_rows(case, contact, &solution.state);
                found = Some(solution);
                answer
            }
        };
        let traction = found.as_ref().map(|solution| solution.state.traction.each_ref());
        let traction = traction.map(|of| of.map(Vec::as_slice));
        let pressure = contact.pressure_power(case, traction);
        let hysteresis = contact.hysteresis(case, traction);
        let balance = Balance::steady(case, &answer, pressure, hysteresis);
        answer.balance = Some(balance.check().map_err(|error| no_solution(error.into()))?);
        Ok((answer, report, found))
    }
}

impl Contact for Steady {
    type Window = Window;

    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        accepted: Option<&Window>,
        _spent: Option<Window>,
    ) -> Result<Window, StepError> {
        if self.following.is_some() {
            return self.row(step, inputs, accepted);
        }
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        let raised = self.case.expand(inputs)?;
        let mut contact = self.contact().map_err(no_solution)?;
        if raised {
            contact.follow(&self.case, false, None).map_err(no_solution)?;
        }
        let (answer, report, _) = self.settled(&mut contact, None, inputs)?;
        let shortfall = contact.shortfall;
        self.contact = Some(contact);
        Ok(Window { answer, report, step: *step, near: None, shortfall })
    }

    fn solves(&self, _: &Window, _: &Step) -> bool {
        !self.case.terms.follow_inputs() && self.following.is_none()
    }

    fn loads(&self, window: &Window) -> Vec<CarriedLoad> {
        window.answer.loads(&self.case)
    }

    fn first_speeds(&self) -> [f64; 2] {
        self.case.scene.speeds.of_surfaces(0.0)
    }

    fn report(&self, window: &Window) -> StepReport {
        window.report
    }

    fn write(&self, window: &Window, spec: &FieldSpec, values: &mut [f64]) {
        window.answer.write(&self.case, &window.answer.friction_power, spec, values);
    }

    fn acceptable(&self, window: &Window) -> Result<(), StepError> {
        let Case { terms, footprint, .. } = &self.case;
        Shortfall::refused(window.shortfall, terms)?;
        let mut removal = terms.removal.iter().filter(|_| self.following.is_some());
        let accepted = window.answer.accepted();
        removal.try_for_each(|removal| removal.refuse_too_much(&footprint.grid, &accepted))
    }

    fn accept(&mut self, window: &Window) {
        if let Some(removal) = &mut self.case.terms.removal {
            removal.take(&self.case.footprint.grid, &window.answer.accepted());
        }
    }

    fn observe(&mut self, window: &Window, outputs: &mut dyn Outputs) {
        self.case.observe(&window.answer, outputs);
    }

    fn summary(&self, window: &Window) -> Value {
        let mut summary = self.case.summary(&window.answer, &window.answer.powers(&self.case));
        if let Some(following) = &self.following {
            following.varying.add_to(&mut summary["contact"], &window.step);
        }
        summary
    }

    fn terms(&self) -> &Terms {
        &self.case.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.case.terms
    }

    /// Only varying values need a saved state: a row may start from the previous one.
    fn save(&self, accepted: Option<&Window>, mut into: &mut dyn Write) -> io::Result<()> {
        if self.following.is_none() {
            return Ok(());
        }
        let state = accepted.map(|Window { answer, step, near, .. }| {
            let Step { window, iteration, start, end } = step;
            (near, answer, (window, iteration, start, end))
        });
        let config = bincode::config::standard();
        let written = bincode::serde::encode_into_std_write(state, &mut into, config);
        written.map(|_| ()).map_err(io::Error::other)
    }

    fn restore(&mut self, mut from: &mut dyn Read) -> Result<Option<Window>, StateError> {
        if self.following.is_none() {
            return Ok(None);
        }
        let config = bincode::config::standard().with_limit::<MOST_BYTES>();
        let wrong = |reason: String| StateError(format!("half-space: {reason}"));
        type State = (Near, ContactFields, (u64, u32, f64, f64));
        let state: Option<State> = bincode::serde::decode_from_std_read(&mut from, config)
            .map_err(|error| wrong(error.to_string()))?;
        let Some((near, answer, (window, iteration, start, end))) = state else { return Ok(None) };
        let count = self.case.footprint.grid.points();
        let fits = near.as_ref().is_none_or(|(solution, pressure)| {
            solution.state.fits(count) && pressure.len() == count
        });
        if !fits || !answer.is_on(count) {
            return Err(wrong("the state belongs to another grid".to_owned()));
        }
        let (step, report) = (Step { window, iteration, start, end }, StepReport::default());
        Ok(Some(Window { answer, report, step, near, shortfall: None }))
    }
}
