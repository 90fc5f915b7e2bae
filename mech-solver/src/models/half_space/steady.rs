//! Steady rolling, or sliding without partial slip: no memory.
//!
//! Solved in the first window; the answer is kept, since nothing that it depends on changes. Where
//! friction or the surfaces depend on what comes in it is solved in every iteration, from scratch, so that it depends
//! on that and on nothing else. Of a case whose values vary every window is solved,
//! from the accepted solution of an earlier one.

use super::answer::Answer;
use super::balance::Balance;
use super::case::Case;
use super::contact::{ContactError, ContactSolver};
use crate::case::scene::GivenPatch;
use crate::models::settled_creepage::SettledCreepage;
use crate::models::shortfall::Shortfall;
use crate::models::varying::{Varying, no_answer};
use crate::terms::removal::Removal;
use half_space::levels::{Motion, Solution};
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// Most bytes of a state of this model: 4 GiB, which a `usize` of 32 bits holds too.
pub(super) const MOST_BYTES: usize = u32::MAX as usize;

/// How a model follows values that vary.
pub(super) struct Following {
    pub(super) varying: Varying,
    /// The ellipse that the case gives.
    pub(super) patch: Option<GivenPatch>,
    /// A row starts from the solution of the one before.
    pub(super) warm: bool,
}

/// The model that runs.
pub(super) struct Steady {
    case: Case,
    following: Option<Following>,
    contact: Option<ContactSolver>,
    answer: Option<(Answer, StepReport)>,
    /// The window of the answer.
    window: Step,
    /// The last row that was accepted, and its answer.
    shown: Option<(Answer, Step)>,
    /// The solution of the last row that has one, and its pressure: where the next one starts.
    near: Near,
    accepted: Near,
}

/// A solution, and the pressure under it.
type Near = Option<(Solution, Vec<f64>)>;

impl Steady {
    pub(super) fn new(case: Case, following: Option<Following>) -> Self {
        let window = Step::STEADY;
        let (contact, answer, shown) = (None, None, None);
        Self { case, following, contact, answer, window, shown, near: None, accepted: None }
    }

    /// The answer of a row, from the accepted solution of an earlier one.
    fn row(&mut self, step: &Step, inputs: &dyn Inputs) -> Result<(Answer, StepReport), StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        if let Some(following) = &self.following {
            following.varying.refuse_more(step)?;
        }
        // Its operators are those of the case as configured, whichever row comes first.
        let mut contact = match self.contact.take() {
            Some(contact) => contact,
            None => ContactSolver::new(&self.case, Motion::SteadyRolling).map_err(no_solution)?,
        };
        let Some(following) = &self.following else { unreachable!("rows are of what varies") };
        let near = self.accepted.clone().filter(|_| following.warm);
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
        let near = near.filter(|_| !lost).map(|(solution, pressure)| {
            contact.pressure = pressure;
            Solution::new(solution.state)
        });
        let solved = self.solve_row(&mut contact, near, inputs);
        self.contact = Some(contact);
        solved
    }

    fn solve_row(
        &mut self,
        contact: &mut ContactSolver,
        near: Option<Solution>,
        inputs: &dyn Inputs,
    ) -> Result<(Answer, StepReport), StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        self.case.expand(inputs)?;
        contact.follow(&self.case, near.is_some(), None).map_err(no_solution)?;
        let (answer, report, solution) = self.settled(contact, near, inputs)?;
        self.near = solution.map(|found| (found, contact.pressure.clone()));
        Ok((answer, report))
    }

    /// The solver, with the pressure of no friction.
    fn contact(&mut self) -> Result<ContactSolver, ContactError> {
        match self.contact.take() {
            Some(mut contact) => {
                contact.reset();
                Ok(contact)
            }
            None => ContactSolver::new(&self.case, Motion::SteadyRolling),
        }
    }

    /// The contact with the friction that it leaves itself, where that depends on its slip.
    fn settled(
        &mut self,
        contact: &mut ContactSolver,
        mut near: Option<Solution>,
        inputs: &dyn Inputs,
    ) -> Result<(Answer, StepReport, Option<Solution>), StepError> {
        let Case { driven, terms, footprint, .. } = &self.case;
        let searched = driven.has_force() && terms.friction.follows_slip();
        let first = near.as_ref().filter(|_| searched).map(|near| near.state.creepage);
        let first = first.unwrap_or(driven.at(0.0).creepage);
        let mut search = SettledCreepage::new(first, footprint.semi_axes[0]);
        let mut spent = StepReport { substeps: 1, ..StepReport::default() };
        loop {
            contact.set_friction(&mut self.case, inputs, search.at())?;
            let (answer, report, solution) = self.compute(contact, near, inputs)?;
            spent.inner_iterations += report.inner_iterations;
            spent.work += report.work;
            if !searched || search.take(answer.creepage)? {
                return Ok((answer, spent, solution));
            }
            near = solution.map(|solution| Solution::new(solution.state));
        }
    }

    fn compute(
        &mut self,
        contact: &mut ContactSolver,
        near: Option<Solution>,
        inputs: &dyn Inputs,
    ) -> Result<(Answer, StepReport, Option<Solution>), StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        let driven = self.case.driven;
        let case = &mut self.case;
        let mut report = StepReport { substeps: 1, ..StepReport::default() };
        let mut found: Option<Solution> = None;
        let mut answer = match case.terms.adhesion {
            false => Answer::sliding(case, contact),
            true => {
                let solution = contact.solve_settled(case, inputs, &driven, near, None)?;
                report.inner_iterations = solution.newton_steps as u32;
                report.work = solution.operator_applications as u64;
                let mut answer = Answer::partial(case, contact, &solution, None);
                if let Some(power) = contact.numerical_dissipation(case, &solution.state) {
                    answer.add_numerical_dissipation(case, &power);
                }
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
        report.inner_iterations += contact.normal_iterations as u32;
        Ok((answer, report, found))
    }
}

impl Model for Steady {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let fixed = !self.case.terms.follow_inputs() && self.following.is_none();
        // What a row without an answer leaves is the answer of an earlier one.
        let known = if fixed { self.answer.take() } else { None };
        let (answer, report) = match known {
            Some(known) => known,
            None if self.following.is_some() => self.row(step, inputs)?,
            None => {
                let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
                let raised = self.case.expand(inputs)?;
                let mut contact = self.contact().map_err(no_solution)?;
                if raised {
                    contact.follow(&self.case, false, None).map_err(no_solution)?;
                }
                let (answer, report, _) = self.settled(&mut contact, None, inputs)?;
                self.contact = Some(contact);
                (answer, report)
            }
        };
        answer.write(&self.case, &answer.friction_power, outputs);
        if let Some(removal) = &mut self.case.terms.removal {
            removal.take(&self.case.footprint.grid, &answer.accepted());
        }
        self.answer = Some((answer, report));
        self.window = *step;
        Ok(report)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.case.first_outputs(outputs);
    }

    fn acceptable(&self) -> Result<(), StepError> {
        let shortfall = self.contact.as_ref().and_then(|contact| contact.shortfall);
        Shortfall::refused(shortfall, &self.case.terms)?;
        let mut removal = self.case.terms.removal.iter().filter(|_| self.following.is_some());
        removal.try_for_each(Removal::refuse_too_much)
    }

    fn accept(&mut self) {
        if self.following.is_some() {
            self.accepted.clone_from(&self.near);
            self.shown = self.answer.take().map(|(answer, _)| (answer, self.window));
        }
        self.case.terms.accept();
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        let own = self.answer.as_ref().map(|(answer, _)| answer);
        if let Some(answer) = self.shown.as_ref().map(|(answer, _)| answer).or(own) {
            self.case.observe(answer, &answer.friction_power, outputs);
        }
    }

    fn summary(&self) -> Value {
        let Some(following) = &self.following else {
            return self.answer.as_ref().map_or(json!({}), |(answer, _)| self.case.summary(answer));
        };
        let Some((answer, window)) = &self.shown else { return json!({}) };
        let mut summary = self.case.summary(answer);
        following.varying.add_to(&mut summary["contact"], window);
        summary
    }

    fn save(&self, mut into: &mut dyn Write) -> io::Result<()> {
        self.case.terms.save(into)?;
        if self.following.is_none() {
            return Ok(());
        }
        let config = bincode::config::standard();
        let shown = self.shown.as_ref().map(|(answer, Step { window, iteration, start, end })| {
            (answer, (window, iteration, start, end))
        });
        let state = (&self.accepted, shown);
        let written = bincode::serde::encode_into_std_write(state, &mut into, config);
        written.map(|_| ()).map_err(io::Error::other)
    }

    fn restore(&mut self, mut from: &mut dyn Read) -> Result<(), StateError> {
        self.case.terms.restore(from)?;
        if self.following.is_none() {
            return Ok(());
        }
        let config = bincode::config::standard().with_limit::<MOST_BYTES>();
        let wrong = |reason: String| StateError(format!("half-space: {reason}"));
        type Shown = Option<(Answer, (u64, u32, f64, f64))>;
        let (near, shown): (Near, Shown) = bincode::serde::decode_from_std_read(&mut from, config)
            .map_err(|error| wrong(error.to_string()))?;
        let count = self.case.footprint.grid.points();
        let fits = |(solution, pressure): &(Solution, Vec<f64>)| {
            solution.state.fits(count) && pressure.len() == count
        };
        let of_grid = |(answer, _): &(Answer, _)| answer.is_on(count);
        if near.as_ref().is_some_and(|near| !fits(near)) || !shown.as_ref().is_none_or(of_grid) {
            return Err(wrong("it is a state on another grid".to_owned()));
        }
        self.accepted = near;
        self.shown = shown.map(|(answer, (window, iteration, start, end))| {
            (answer, Step { window, iteration, start, end })
        });
        Ok(())
    }
}
