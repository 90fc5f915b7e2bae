//! What solves the windows.

use super::case::{Case, Footprint, Row};
use super::summary::summary;
use super::window::Window;
use crate::models::each_window::{Windows, write_pair};
use crate::models::varying::no_answer;
use crate::terms::Terms;
use half_space::conformal::contact::ConformalSolver;
use proto::configuration::Configuration;
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::{Inputs, Step, StepError};
use serde_json::Value;

/// The bodies.
pub(super) struct Running {
    case: Case,
    grid: Structured,
    terms: Terms,
    configuration: Configuration,
    solver: ConformalSolver,
}

impl Running {
    pub(super) fn new(
        case: Case,
        footprint: &Footprint,
        terms: Terms,
        configuration: &Configuration,
    ) -> Self {
        let Footprint { grid, semi_axes } = *footprint;
        let solver = {
            let surfaces = (case.arcs, case.turn);
            ConformalSolver::new(&case.materials, surfaces, &grid, semi_axes, case.difference)
        };
        Self { case, grid, terms, configuration: configuration.clone(), solver }
    }
}

impl Windows for Running {
    type Row = Row;
    type Window = Window;

    fn row(&self, step: &Step) -> Result<Row, StepError> {
        let params = self.configuration.case_at(step);
        self.case.row(&params, self.terms.adhesion).map_err(no_answer)
    }

    fn solve(&mut self, row: &Row, _inputs: &dyn Inputs) -> Result<Window, StepError> {
        let contact = self.solver.solve(&row.prescription);
        let contact = contact.map_err(|error| StepError::NoSolution(error.to_string()))?;
        let power = self.solver.friction_power(&contact, row.speed);
        let slip_velocity = self.solver.slip_velocity(&contact, row.speed);
        Ok(Window { row: *row, contact, slip_velocity, power })
    }

    fn write(&self, window: &Window, spec: &FieldSpec, values: &mut [f64]) {
        let Window { row, contact, slip_velocity, power } = window;
        match *spec {
            field::PRESSURE => values.copy_from_slice(&contact.pressure),
            field::TRACTION => write_pair(values, &contact.state.traction),
            field::SLIP_VELOCITY => write_pair(values, slip_velocity),
            field::FRICTION_POWER => {
                values.copy_from_slice(power);
                self.terms.keep_heat(values);
            }
            field::SURFACE_SPEED => values.copy_from_slice(&row.surface_speeds),
            _ => {}
        }
    }

    fn summary(&self, window: &Window) -> Value {
        summary(window, &self.grid)
    }

    fn speed(&self, row: &Row) -> f64 {
        row.speed
    }

    fn effort(&self, window: &Window) -> [usize; 2] {
        [window.contact.normal_iterations, window.contact.newton_steps]
    }
}
