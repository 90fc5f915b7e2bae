//! The model that runs: every window is solved by itself.

use super::case::{Case, Footprint};
use super::summary::summary;
use super::window::Window;
use crate::conformal::contact::ConformalSolver;
use crate::models::varying::no_answer;
use crate::terms::Terms;
use proto::configuration::Configuration;
use proto::field;
use proto::grid::Structured;
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// The bodies, and what their contact was last.
pub(super) struct Running {
    case: Case,
    grid: Structured,
    terms: Terms,
    configuration: Configuration,
    solver: ConformalSolver,
    trial: Option<Window>,
    accepted: Option<Window>,
}

impl Running {
    pub(super) fn new(
        case: Case,
        footprint: &Footprint,
        terms: Terms,
        configuration: Configuration,
    ) -> Self {
        let Footprint { grid, semi_axes } = *footprint;
        let solver = ConformalSolver::new(&case.materials, case.arcs, case.turn, &grid, semi_axes);
        Self { case, grid, terms, configuration, solver, trial: None, accepted: None }
    }

    /// A window, solved from nothing: it depends on its own values alone, and the last one of the same values is it.
    fn window(&mut self, step: &Step) -> Result<Window, StepError> {
        let params = self.configuration.case_at(step);
        let row = self.case.row(&params, self.terms.adhesion).map_err(no_answer)?;
        if let Some(same) = self.trial.take().filter(|last| last.row == row) {
            return Ok(same);
        }
        let contact = self.solver.solve(&row.prescription);
        let contact = contact.map_err(|error| StepError::NoSolution(error.to_string()))?;
        let power = self.solver.friction_power(&contact, row.speed);
        let slip_velocity = self.solver.slip_velocity(&contact, row.speed);
        Ok(Window { row, contact, slip_velocity, power })
    }

    fn write(&self, window: &Window, outputs: &mut dyn Outputs) {
        let Window { row, contact, slip_velocity, power } = window;
        let pair = |values: &mut [f64], [x, y]: &[Vec<f64>; 2]| {
            let (first, second) = values.split_at_mut(x.len());
            first.copy_from_slice(x);
            second.copy_from_slice(y);
        };
        if let Some(values) = outputs.get(&field::PRESSURE) {
            values.copy_from_slice(&contact.pressure);
        }
        if let Some(values) = outputs.get(&field::TRACTION) {
            pair(values, &contact.state.traction);
        }
        if let Some(values) = outputs.get(&field::SLIP_VELOCITY) {
            pair(values, slip_velocity);
        }
        if let Some(values) = outputs.get(&field::FRICTION_POWER) {
            values.copy_from_slice(power);
            self.terms.keep_heat(values);
        }
        if let Some(values) = outputs.get(&field::SURFACE_SPEED) {
            values.copy_from_slice(&row.surface_speeds);
        }
    }
}

impl Model for Running {
    fn solve(
        &mut self,
        step: &Step,
        _inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let window = self.window(step)?;
        self.write(&window, outputs);
        let (iterations, steps) = (window.contact.normal_iterations, window.contact.newton_steps);
        self.trial = Some(window);
        Ok(StepReport {
            substeps: 1,
            inner_iterations: iterations as u32,
            work: steps as u64,
            ..StepReport::default()
        })
    }

    /// The fields of the first window, if it has an answer; zero if not.
    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        match self.window(&Step::STEADY) {
            Ok(window) => {
                self.write(&window, outputs);
                self.trial = Some(window);
            }
            Err(_) => {
                for spec in field::TABLE {
                    if let Some(values) = outputs.get(spec) {
                        values.fill(0.0);
                    }
                }
            }
        }
    }

    fn accept(&mut self) {
        if let Some(window) = self.trial.take() {
            self.accepted = Some(window);
        }
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        if let Some(window) = &self.accepted {
            self.write(window, outputs);
        }
    }

    fn summary(&self) -> Value {
        self.accepted.as_ref().map_or_else(|| json!({}), |window| summary(window, &self.grid))
    }

    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}
