//! The model that runs.

use super::case::Case;
use crate::terms::friction::{FrictionState, lateral};
use crate::terms::surface::raise;
use elastic::slip::RigidSlip;
use half_space::friction::ElementFriction;
use half_space::normal::{NormalContact, NormalSolver, Prescribed};
use proto::field::{self, FieldSpec};
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// A contact that slides everywhere.
pub(super) struct Sliding {
    case: Case,
    solver: NormalSolver,
    /// Heights of the effects [m].
    heights: Vec<f64>,
    /// The same, less what heat raises [m].
    distance: Vec<f64>,
    /// What heat raises [m].
    rises: Vec<f64>,
    pressure: Vec<f64>,
    friction: ElementFriction,
    solved: Option<NormalContact>,
}

impl Sliding {
    pub(super) fn new(case: Case) -> Self {
        let grid = case.grid;
        let spacing = [grid.dx(), grid.dy()];
        let mut solver = NormalSolver::repeating(grid.ni, grid.nj, spacing, case.compliance());
        solver.pressure_bound = case.terms.pressure_bound();
        let heights = case.distance();
        Self {
            solver,
            distance: heights.clone(),
            heights,
            rises: vec![0.0; if case.terms.expansion.is_some() { grid.points() } else { 0 }],
            pressure: vec![0.0; grid.points()],
            friction: ElementFriction::uniform(grid.points(), case.scene.friction_coefficient),
            solved: None,
            case,
        }
    }

    /// Takes by how much heat raises the surfaces from the distance.
    fn expand(&mut self, inputs: &dyn Inputs) -> Result<(), StepError> {
        let Some(coefficients) = self.case.terms.expansion else { return Ok(()) };
        let Case { scene, grid, .. } = &self.case;
        self.rises.fill(0.0);
        raise(inputs, &scene.bodies, coefficients, grid, &mut self.rises)?;
        let raised = self.heights.iter().zip(&self.rises).map(|(height, rise)| height - rise);
        self.distance.iter_mut().zip(raised).for_each(|(distance, raised)| *distance = raised);
        Ok(())
    }

    fn write(&self, outputs: &mut dyn Outputs) {
        let count = self.pressure.len();
        let [vx, vy] = self.case.slip_velocity();
        let speed = vx.hypot(vy);
        let against = if speed > 0.0 { [-vx / speed, -vy / speed] } else { [0.0; 2] };
        let bound = |at: usize| self.friction.bound(at, self.pressure[at]);
        let fill = |values: &mut [f64], of: &dyn Fn(usize) -> [f64; 2]| {
            for at in 0..count {
                [values[at], values[count + at]] = of(at);
            }
        };
        if let Some(values) = outputs.get(&field::PRESSURE) {
            values.copy_from_slice(&self.pressure);
        }
        if let Some(values) = outputs.get(&field::TRACTION) {
            fill(values, &|at| against.map(|part| part * bound(at)));
        }
        if let Some(values) = outputs.get(&field::SLIP_VELOCITY) {
            let touches = |at: usize| f64::from(u8::from(self.pressure[at] > 0.0));
            fill(values, &|at| [vx * touches(at), vy * touches(at)]);
        }
        if let Some(values) = outputs.get(&field::FRICTION_POWER) {
            values.iter_mut().enumerate().for_each(|(at, power)| *power = bound(at) * speed);
            self.case.terms.keep_heat(values);
        }
        self.write_speeds(outputs);
    }

    fn write_speeds(&self, outputs: &mut dyn Outputs) {
        if let Some(values) = outputs.get(&field::SURFACE_SPEED) {
            values.copy_from_slice(&self.case.scene.speeds.of_surfaces(self.case.creepage[0]));
        }
    }
}

impl Model for Sliding {
    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        self.expand(inputs)?;
        self.pressure.fill(self.case.mean_pressure());
        let load = Prescribed::Load(self.case.load);
        let solved = self.solver.solve(&self.distance, load, &mut self.pressure);
        let solved = solved.map_err(|error| StepError::NoSolution(error.to_string()))?;
        self.solved = Some(solved);
        let [xi, eta] = self.case.creepage;
        let slip = RigidSlip { creepage: [xi, eta, 0.0], speed: self.case.scene.speeds.rolling };
        let grid = &self.case.grid;
        let state = FrictionState {
            velocity: None,
            inputs: Some(inputs),
            speed: slip.speed,
            rigid_slip: &|index| slip.at(grid, index),
            grid,
            coordinate: &lateral(grid, 0.0),
            pressure: &self.pressure,
        };
        let coefficient = self.case.scene.friction_coefficient;
        self.friction = self.case.terms.friction.evaluate(coefficient, &state)?;
        self.write(outputs);
        Ok(StepReport {
            substeps: 1,
            inner_iterations: solved.iterations as u32,
            work: solved.convolutions as u64,
            ..StepReport::default()
        })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        for spec in field::TABLE.iter().filter(|spec: &&FieldSpec| **spec != field::SURFACE_SPEED) {
            if let Some(values) = outputs.get(spec) {
                values.fill(0.0);
            }
        }
        self.write_speeds(outputs);
    }

    fn accept(&mut self) {
        self.case.terms.accept();
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn summary(&self) -> Value {
        let Some(solved) = &self.solved else { return json!({}) };
        let (case, area) = (&self.case, self.case.grid.element_area());
        let mean = case.mean_pressure();
        let count = self.pressure.len() as f64;
        let square = self.pressure.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / count;
        let distances = self.distance.iter().zip(self.solver.displacement());
        let separation = match solved.contact_elements == self.pressure.len() {
            true => 0.0,
            false => distances.map(|(h, u)| h + u).sum::<f64>() / count - solved.approach,
        };
        let [vx, vy] = case.slip_velocity();
        let speed = vx.hypot(vy);
        let bounds = || self.friction.bounds(&self.pressure);
        let force = bounds().sum::<f64>() * area;
        let against = |part: f64| if speed > 0.0 { 0.0 - force * part / speed } else { 0.0 };
        json!({"contact": {
            "max_pressure_pa": self.pressure.iter().copied().fold(0.0, f64::max),
            "pressure_deviation_pa": square.sqrt(),
            "normal_force_n": solved.normal_force,
            "area_m2": solved.contact_elements as f64 * area,
            "area_ratio": solved.contact_elements as f64 / count,
            "separation_m": separation,
            "creep_force_x_n": against(vx),
            "creep_force_y_n": against(vy),
            "creepage_xi": case.creepage[0],
            "creepage_eta": case.creepage[1],
            "slip_area_ratio": f64::from(u8::from(speed > 0.0)),
            "max_slip_velocity_m_per_s": speed,
            "max_traction_pa": if speed > 0.0 { bounds().fold(0.0, f64::max) } else { 0.0 },
            "friction_power_w": if speed > 0.0 { force * speed } else { 0.0 },
        }})
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.case.terms.save(into)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.case.terms.restore(from)
    }
}
