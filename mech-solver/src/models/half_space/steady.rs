//! Steady rolling, or sliding without partial slip: no memory.
//!
//! Solved in the first window; the answer is kept, since nothing that it depends on changes.

use super::answer::Answer;
use super::contact::{ContactError, ContactSolver};
use super::{Case, NAME};
use crate::half_space::levels::Motion;
use proto::model::{Inputs, Model, Outputs, StateBlob, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};

/// The model that runs.
pub(super) struct Steady {
    case: Case,
    answer: Option<(Answer, StepReport)>,
}

impl Steady {
    pub(super) fn new(case: Case) -> Self {
        Self { case, answer: None }
    }

    fn compute(&self) -> Result<(Answer, StepReport), ContactError> {
        let case = &self.case;
        let mut contact = ContactSolver::new(case, Motion::SteadyRolling)?;
        let mut report = StepReport { substeps: 1, ..StepReport::default() };
        let answer = match case.partial {
            false => Answer::sliding(case, &contact),
            true => {
                let solution = contact.solve(&case.driven, None, None)?;
                report.inner_iterations = solution.newton_steps as u32;
                report.work = solution.operator_applications as u64;
                Answer::partial(case, &contact, &solution, None)
            }
        };
        report.inner_iterations += contact.normal_iterations as u32;
        Ok((answer, report))
    }
}

impl Model for Steady {
    fn solve(
        &mut self,
        _step: &Step,
        _inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let (answer, report) = match self.answer.take() {
            Some(known) => known,
            None => self.compute().map_err(|error| StepError::NoSolution(error.to_string()))?,
        };
        answer.write(&answer.friction_power, outputs);
        self.answer = Some((answer, report));
        Ok(report)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.case.first_outputs(outputs);
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
        match from.0.len() {
            0 => Ok(()),
            bytes => {
                Err(StateError(format!("steady {NAME} has none, but there are {bytes} bytes")))
            }
        }
    }
}
