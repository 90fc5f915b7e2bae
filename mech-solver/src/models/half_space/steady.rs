//! Steady rolling, or sliding without partial slip: no memory.
//!
//! Solved in the first window; the answer is kept, since nothing that it depends on changes. Under the
//! effect `temperature_friction` it is solved in every iteration, from scratch, so that it depends on
//! the temperatures that come in and on nothing else.

use super::answer::Answer;
use super::balance::Balance;
use super::case::Case;
use super::contact::{ContactError, ContactSolver};
use crate::effects::temperature_friction::Shortfall;
use crate::half_space::levels::Motion;
use crate::models::names::HALF_SPACE;
use crate::models::stateless::restore_nothing;
use proto::model::{Inputs, Model, Outputs, StateBlob, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};

/// The model that runs.
pub(super) struct Steady {
    case: Case,
    contact: Option<ContactSolver>,
    answer: Option<(Answer, StepReport)>,
}

impl Steady {
    pub(super) fn new(case: Case) -> Self {
        Self { case, contact: None, answer: None }
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

    fn compute(&self, contact: &mut ContactSolver) -> Result<(Answer, StepReport), ContactError> {
        let case = &self.case;
        let mut report = StepReport { substeps: 1, ..StepReport::default() };
        let mut pressure_power = None;
        let mut answer = match case.partial {
            false => Answer::sliding(case, contact),
            true => {
                let solution = contact.solve(&case.driven, None, None)?;
                report.inner_iterations = solution.newton_steps as u32;
                report.work = solution.operator_applications as u64;
                pressure_power = contact.pressure_power(case, &solution.state);
                Answer::partial(case, contact, &solution, None)
            }
        };
        answer.balance = Some(Balance::steady(case, &answer, pressure_power).check()?);
        report.inner_iterations += contact.normal_iterations as u32;
        Ok((answer, report))
    }
}

impl Model for Steady {
    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let known = self.answer.take().filter(|_| self.case.friction_law.is_none());
        let (answer, report) = match known {
            Some(known) => known,
            None => {
                let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
                let mut contact = self.contact().map_err(no_solution)?;
                if let Some(law) = &self.case.friction_law {
                    contact.set_friction(&self.case, law, inputs)?;
                }
                let found = self.compute(&mut contact).map_err(no_solution)?;
                self.contact = Some(contact);
                found
            }
        };
        answer.write(&answer.friction_power, outputs);
        self.answer = Some((answer, report));
        Ok(report)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.case.first_outputs(outputs);
    }

    fn acceptable(&self) -> Result<(), StepError> {
        Shortfall::refused(self.contact.as_ref().and_then(|contact| contact.shortfall))
    }

    fn accept(&mut self) {}

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        if let Some((answer, _)) = &self.answer {
            self.case.observe(answer, &answer.friction_power, outputs);
        }
    }

    fn summary(&self) -> Value {
        match &self.answer {
            Some((answer, _)) => self.case.summary(answer),
            None => json!({}),
        }
    }

    fn save(&self, into: &mut StateBlob) {
        into.0.clear();
    }

    fn restore(&mut self, from: &StateBlob) -> Result<(), StateError> {
        restore_nothing(HALF_SPACE, from)
    }
}
