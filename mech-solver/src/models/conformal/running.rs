//! Solver of the windows.

use super::case::{Case, Footprint, Row};
use super::summary::summary;
use super::window::Window;
use crate::models::contact_model::{CarriedLoad, Contact, Nothing, write_pair};
use crate::models::varying::no_answer;
use crate::terms::Terms;
use half_space::conformal::contact::{Conformal, ConformalSolver};
use half_space::normal::Prescribed;
use proto::configuration::Configuration;
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::{Inputs, Step, StepError, StepReport};
use serde_json::Value;

/// A conformal contact with its solver.
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

    /// Values prescribed in a window.
    fn row(&self, step: &Step) -> Result<Row, StepError> {
        let params = self.configuration.case_at(step);
        self.case.row(&params, self.terms.adhesion).map_err(no_answer)
    }
}

impl Contact for Running {
    type Window = Window;

    fn solve(
        &mut self,
        step: &Step,
        _inputs: &dyn Inputs,
        _accepted: Option<&Window>,
        _spent: Option<Window>,
    ) -> Result<Window, StepError> {
        let row = self.row(step)?;
        let contact = self.solver.solve(&row.prescription);
        let contact = contact.map_err(|error| StepError::NoSolution(error.to_string()))?;
        let power = self.solver.friction_power(&contact, row.speed);
        let slip_velocity = self.solver.slip_velocity(&contact, row.speed);
        Ok(Window { row, contact, slip_velocity, power })
    }

    fn solves(&self, window: &Window, step: &Step) -> bool {
        self.row(step).is_ok_and(|row| row == window.row)
    }

    fn loads(&self, Window { row, contact, .. }: &Window) -> Vec<CarriedLoad> {
        match row.prescription.load {
            Prescribed::Load(prescribed) => {
                vec![CarriedLoad { prescribed, carried: contact.force[2] }]
            }
            Prescribed::Approach(_) => Vec::new(),
        }
    }

    fn first(&mut self) -> Option<Window> {
        self.solve(&Step::STEADY, &Nothing, None, None).ok()
    }

    fn first_speeds(&self) -> [f64; 2] {
        self.row(&Step::STEADY).map_or([0.0; 2], |row| [row.speed; 2])
    }

    fn report(&self, window: &Window) -> StepReport {
        let Conformal { normal_iterations, newton_steps, .. } = window.contact;
        StepReport {
            substeps: 1,
            inner_iterations: normal_iterations as u32,
            work: newton_steps as u64,
            ..StepReport::default()
        }
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

    fn terms(&self) -> &Terms {
        &self.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.terms
    }
}
