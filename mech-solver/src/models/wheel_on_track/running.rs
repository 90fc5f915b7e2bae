//! The model that runs: every window is solved by itself.

use super::case::{Case, Position};
use super::plane::Plane;
use super::summary::summary;
use crate::models::varying::no_answer;
use crate::track::contact::WheelOnRail;
use crate::track::developed::Developed;
use crate::track::patch::{Patch, Solved};
use proto::configuration::{Configuration, Refusal};
use proto::field;
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// A window that is solved.
struct Window {
    position: Position,
    solved: Solved,
    fields: Developed,
}

/// The wheel, and what it was last.
pub(super) struct Running {
    case: Case,
    plane: Plane,
    configuration: Configuration,
    wheel: WheelOnRail,
    trial: Option<Window>,
    accepted: Option<Window>,
}

impl Running {
    pub(super) fn new(
        case: Case,
        plane: Plane,
        configuration: Configuration,
    ) -> Result<Self, Refusal> {
        let wheel = case.wheel_on_rail(1.0)?;
        Ok(Self { case, plane, configuration, wheel, trial: None, accepted: None })
    }

    /// A window, solved from nothing: it depends on its own values alone, and the last one of the same values is it.
    fn window(&mut self, step: &Step) -> Result<Window, StepError> {
        let params = self.configuration.case_at(step);
        let position = self.case.position(&params).map_err(no_answer)?;
        if let Some(same) = self.trial.take().filter(|last| last.position == position) {
            return Ok(same);
        }
        let Position { motion, deviation, vertical, friction } = &position;
        self.wheel.forget();
        let solved = self.wheel.solve(motion, deviation, *vertical, &|_| *friction);
        let solved = solved.map_err(|error| StepError::NoSolution(error.to_string()))?;
        let fields = self.plane.fields(&solved.patches)?;
        Ok(Window { position, solved, fields })
    }

    fn write(&self, window: &Window, outputs: &mut dyn Outputs) {
        let Developed { pressure, traction, slip_velocity, friction_power, .. } = &window.fields;
        let pair = |values: &mut [f64], [x, y]: &[Vec<f64>; 2]| {
            let (first, second) = values.split_at_mut(x.len());
            first.copy_from_slice(x);
            second.copy_from_slice(y);
        };
        if let Some(values) = outputs.get(&field::PRESSURE) {
            values.copy_from_slice(pressure);
        }
        if let Some(values) = outputs.get(&field::TRACTION) {
            pair(values, traction);
        }
        if let Some(values) = outputs.get(&field::SLIP_VELOCITY) {
            pair(values, slip_velocity);
        }
        if let Some(values) = outputs.get(&field::FRICTION_POWER) {
            values.copy_from_slice(friction_power);
            self.case.terms.keep_heat(values);
        }
        if let Some(values) = outputs.get(&field::SURFACE_SPEED) {
            values.copy_from_slice(&window.surface_speeds());
        }
    }
}

impl Window {
    /// Speeds of the wheel's and the rail's surface through the patch that carries most [m/s].
    fn surface_speeds(&self) -> [f64; 2] {
        let most = |a: &&Patch, b: &&Patch| a.load.force[2].total_cmp(&b.load.force[2]);
        match self.solved.patches.iter().max_by(most) {
            Some(patch) => {
                let [xi, ..] = patch.rolling.creepage;
                [patch.rolling.speed * (1.0 - xi), patch.rolling.speed]
            }
            None => [self.position.motion.velocity[0]; 2],
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
        let work = window.solved.work;
        self.trial = Some(window);
        Ok(StepReport {
            substeps: 1,
            inner_iterations: work.normal_iterations as u32,
            work: work.newton_steps as u64,
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
        self.accepted.as_ref().map_or_else(|| json!({}), |window| summary(&window.solved))
    }

    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}
