//! Solver of the windows.

use super::case::{Case, Position};
use super::interface::FrictionInterface;
use super::plane::Plane;
use super::summary::summary;
use crate::models::contact_model::{CarriedLoad, Contact, Nothing, write_pair};
use crate::models::varying::no_answer;
use crate::terms::{Accepted, Terms};
use numerics::team::{self, Team};
use proto::configuration::{Configuration, Refusal};
use proto::field::{self, FieldSpec};
use proto::model::{Inputs, Outputs, Step, StepError, StepReport};
use serde_json::Value;
use std::iter;
use wheel_rail::balance::{WheelsetOnTrack, WheelsetSolution};
use wheel_rail::developed::Developed;
use wheel_rail::patch::{Patch, Solved};
use wheel_rail::rail::Side;
use wheel_rail::settings::Vertical;

/// Number of history rows per thread in one batch, chosen so that no thread waits long for another.
const ROWS_OF_A_THREAD: usize = 4;

/// A solved time window.
pub(super) struct Window {
    position: Position,
    balanced: WheelsetSolution,
    fields: Developed,
}

/// Wheels on their rails, solved window by window.
pub(super) struct Running {
    case: Case,
    plane: Plane,
    configuration: Configuration,
    /// Solvers, one per thread.
    solvers: Team<WheelsetOnTrack>,
    /// Number of windows in a batch.
    at_once: u64,
    /// Number of rows of a history; 0 without a history of rows.
    rows: u64,
    /// Windows solved in advance, the next one last.
    ahead: Vec<(Position, Result<Window, StepError>)>,
}

impl Running {
    pub(super) fn new(
        case: Case,
        plane: Plane,
        configuration: &Configuration,
    ) -> Result<Self, Refusal> {
        let history = configuration.histories.as_ref();
        let threads = match history {
            Some(_) if !case.terms.follow_inputs() => team::threads(),
            _ => 1,
        };
        let rows = history.filter(|of| of.rows && of.live.is_none()).map_or(0, |of| of.times.len());
        let solver = |_| case.wheelset_on_track(1.0, case.settings.patch_surface);
        let solvers = (0..threads).map(solver).collect::<Result<Vec<_>, _>>()?;
        let at_once = if threads > 1 { ROWS_OF_A_THREAD * threads } else { 1 };
        let configuration = configuration.clone();
        let (solvers, ahead) = (solvers.into(), Vec::new());
        let (at_once, rows) = (at_once as u64, rows as u64);
        Ok(Self { case, plane, configuration, solvers, at_once, rows, ahead })
    }

    /// Position prescribed in a window.
    fn position(&self, step: &Step) -> Result<Position, StepError> {
        self.case.position(&self.configuration.case_at(step)).map_err(no_answer)
    }

    /// Solves a window and the following windows in one batch.
    fn solve_from(&mut self, position: Position, step: &Step) {
        let last = self.rows.min(step.window + self.at_once);
        let behind = (step.window + 1..last)
            .map_while(|window| self.position(&Step { window, ..*step }).ok());
        let positions: Vec<Position> = iter::once(position).chain(behind).collect();
        let mut solved: Vec<_> = positions.iter().map(|_| None).collect();
        let of = (&self.case, &self.plane);
        let places = positions.iter().zip(&mut solved);
        let operations = team::WORTH * positions.len() as u64;
        self.solvers.sweep(operations, places, |solver, (position, place)| {
            *place = Some(Self::solved(of, solver, position, &Nothing));
            1
        });
        self.ahead = positions.into_iter().zip(solved.into_iter().flatten()).collect();
        self.ahead.reverse();
    }

    /// Solves a window without an initial guess, on a thread with its own solver.
    fn solved(
        (case, plane): (&Case, &Plane),
        solver: &mut WheelsetOnTrack,
        position: &Position,
        inputs: &dyn Inputs,
    ) -> Result<Window, StepError> {
        let Position { motion, deviation, given, .. } = position;
        let shifts = [Side::Left, Side::Right].map(|side| plane.shift(side));
        let between = FrictionInterface { case, position, solving: Some((inputs, shifts)) };
        solver.forget();
        let balanced = solver.solve(motion, deviation, given, &between);
        let balanced = balanced.map_err(|error| StepError::NoSolution(error.to_string()))?;
        let fields = plane.fields(&balanced)?;
        Ok(Window { position: *position, balanced, fields })
    }
}

impl Contact for Running {
    type Window = Window;

    /// Rows of a history without inputs are solved in batches, each row by one thread.
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        _accepted: Option<&Window>,
        _spent: Option<Window>,
    ) -> Result<Window, StepError> {
        let position = self.position(step)?;
        if self.case.terms.follow_inputs() {
            let of = (&self.case, &self.plane);
            return Self::solved(of, self.solvers.first(), &position, inputs);
        }
        match self.ahead.iter().rposition(|(solved, _)| *solved == position) {
            Some(place) => self.ahead.truncate(place + 1),
            None => self.solve_from(position, step),
        }
        self.ahead.pop().expect("at least the window asked for").1
    }

    fn solves(&self, window: &Window, step: &Step) -> bool {
        let same = |position| position == window.position;
        !self.case.terms.follow_inputs() && self.position(step).is_ok_and(same)
    }

    fn loads(&self, Window { position, balanced, .. }: &Window) -> Vec<CarriedLoad> {
        let of = |(side, solved): &(Side, Solved)| match position.given.vertical
            [usize::from(*side == Side::Right)]
        {
            Vertical::Force(prescribed) => {
                Some(CarriedLoad { prescribed, carried: solved.force[2] })
            }
            Vertical::Height => None,
        };
        balanced.wheels.iter().filter_map(of).collect()
    }

    fn first(&mut self) -> Option<Window> {
        if self.case.terms.follow_inputs() {
            return None;
        }
        self.solve(&Step::STEADY, &Nothing, None, None).ok()
    }

    fn first_speeds(&self) -> [f64; 2] {
        self.position(&Step::STEADY).map_or([0.0; 2], |position| [position.motion.velocity[0]; 2])
    }

    fn report(&self, window: &Window) -> StepReport {
        let work = window.balanced.work;
        StepReport {
            substeps: 1,
            inner_iterations: work.normal_iterations as u32,
            work: work.newton_steps as u64,
            ..StepReport::default()
        }
    }

    fn write(&self, window: &Window, spec: &FieldSpec, values: &mut [f64]) {
        let Developed { pressure, traction, slip_velocity, friction_power, .. } = &window.fields;
        match *spec {
            field::PRESSURE => values.copy_from_slice(pressure),
            field::TRACTION => write_pair(values, traction),
            field::SLIP_VELOCITY => write_pair(values, slip_velocity),
            field::FRICTION_POWER => {
                values.copy_from_slice(friction_power);
                self.case.terms.keep_heat(values);
            }
            field::SURFACE_SPEED => values.copy_from_slice(&window.surface_speeds()),
            // In track axes, summed over both wheels if there are two.
            field::CONTACT_FORCE => {
                values.copy_from_slice(&window.balanced.sum(|solved| solved.force));
            }
            _ => {}
        }
    }

    fn observe(&mut self, window: &Window, outputs: &mut dyn Outputs) {
        let Developed { pressure, traction, slip_velocity, friction_power, .. } = &window.fields;
        let (traction, slip_velocity) = (traction.concat(), slip_velocity.concat());
        let accepted = Accepted {
            pressure,
            normal_pressure: pressure,
            traction: &traction,
            slip_velocity: &slip_velocity,
            friction_power,
            surface_speed: window.surface_speeds(),
            heated: None,
        };
        for term in &mut self.case.terms.observations {
            term.observe(&accepted);
            term.write(outputs);
        }
    }

    fn summary(&self, window: &Window) -> Value {
        let shift = |side| self.plane.shift(side);
        let mut summary = summary(&window.balanced, &window.position, self.solvers.read(), &shift);
        for (section, figures) in self.case.terms.observations.iter().filter_map(|t| t.summary()) {
            summary[section] = figures;
        }
        summary
    }

    fn terms(&self) -> &Terms {
        &self.case.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.case.terms
    }
}

impl Window {
    /// Speeds of the surfaces of wheel and rail through the patch with the largest load [m/s].
    fn surface_speeds(&self) -> [f64; 2] {
        let most = |a: &&Patch, b: &&Patch| a.load.force[2].total_cmp(&b.load.force[2]);
        let patches = self.balanced.wheels.iter().flat_map(|(_, solved)| &solved.patches);
        match patches.max_by(most) {
            Some(patch) => {
                let [xi, ..] = patch.rolling.creepage;
                [patch.rolling.speed * (1.0 - xi), patch.rolling.speed]
            }
            None => [self.position.motion.velocity[0]; 2],
        }
    }
}
