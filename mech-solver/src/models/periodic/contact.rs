//! Windows of the contact.

use super::case::Case;
use crate::models::contact_model::{CarriedLoad, Contact};
use crate::models::summary::add_limited_area;
use crate::terms::Terms;
use crate::terms::surface::raise;
use elastic::slip::RigidSlip;
use half_space::friction::ElementFriction;
use half_space::normal::{NormalContact, NormalSolver, Prescribed};
use proto::field::{self, FieldSpec};
use proto::model::{Inputs, Step, StepError, StepReport};
use serde_json::{Value, json};

/// A contact that slides everywhere.
pub(super) struct Sliding {
    case: Case,
    solver: NormalSolver,
    /// Heights of the effects [m].
    heights: Vec<f64>,
    /// Heights of the effects minus the thermal rise [m].
    distance: Vec<f64>,
    /// Thermal rise of the surfaces [m].
    rises: Vec<f64>,
}

/// A solved time window.
pub(super) struct Window {
    solved: NormalContact,
    /// Pressure of the elements [Pa].
    pressure: Vec<f64>,
    friction: ElementFriction,
    /// Mean distance of the deformed surfaces [m].
    separation: f64,
}

impl Sliding {
    pub(super) fn new(case: Case) -> Self {
        let grid = case.grid;
        let spacing = [grid.dx(), grid.dy()];
        let mut solver = NormalSolver::repeating(grid.ni, grid.nj, spacing, case.compliance());
        solver.pressure_bound = case.terms.pressure_bound();
        let heights = case.distance();
        let rises = vec![0.0; if case.terms.expansion.is_some() { grid.points() } else { 0 }];
        Self { solver, distance: heights.clone(), heights, rises, case }
    }

    /// Subtracts the thermal rise of the surfaces from the distance.
    fn expand(&mut self, inputs: &dyn Inputs) -> Result<(), StepError> {
        let Some(coefficients) = self.case.terms.expansion else { return Ok(()) };
        let Case { scene, grid, .. } = &self.case;
        self.rises.fill(0.0);
        raise(inputs, &scene.bodies, coefficients, grid, &mut self.rises)?;
        let raised = self.heights.iter().zip(&self.rises).map(|(height, rise)| height - rise);
        self.distance.iter_mut().zip(raised).for_each(|(distance, raised)| *distance = raised);
        Ok(())
    }

    /// Mean distance of the deformed surfaces [m]. The surfaces meet where there is pressure, also
    /// where they have yielded.
    fn separation(&self, solved: &NormalContact, pressure: &[f64]) -> f64 {
        let distances = self.distance.iter().zip(self.solver.displacement()).zip(pressure);
        let open = distances.filter(|(_, p)| **p == 0.0).map(|((h, u), _)| h + u - solved.approach);
        open.sum::<f64>() / pressure.len() as f64
    }
}

impl Contact for Sliding {
    type Window = Window;

    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        _accepted: Option<&Window>,
        spent: Option<Window>,
    ) -> Result<Window, StepError> {
        self.expand(inputs)?;
        let grid = &self.case.grid;
        let mut pressure = spent.map_or_else(|| vec![0.0; grid.points()], |spent| spent.pressure);
        pressure.fill(self.case.mean_pressure());
        let load = Prescribed::Load(self.case.load);
        let solved = self.solver.solve(&self.distance, load, &mut pressure);
        let solved = solved.map_err(|error| StepError::NoSolution(error.to_string()))?;
        let [xi, eta] = self.case.creepage;
        let slip = RigidSlip { creepage: [xi, eta, 0.0], speed: self.case.scene.speeds.rolling };
        let coefficient = self.case.scene.friction_coefficient;
        let law = &self.case.terms.friction;
        let friction = law.under_rigid_slip(coefficient, &slip, (grid, &pressure), inputs)?;
        let separation = self.separation(&solved, &pressure);
        Ok(Window { solved, pressure, friction, separation })
    }

    fn loads(&self, Window { pressure, .. }: &Window) -> Vec<CarriedLoad> {
        let carried = pressure.iter().sum::<f64>() * self.case.grid.element_area();
        vec![CarriedLoad { prescribed: self.case.load, carried }]
    }

    fn first_speeds(&self) -> [f64; 2] {
        self.case.surface_speeds()
    }

    fn report(&self, window: &Window) -> StepReport {
        StepReport {
            substeps: 1,
            inner_iterations: window.solved.iterations as u32,
            work: window.solved.convolutions as u64,
            ..StepReport::default()
        }
    }

    fn write(&self, window: &Window, spec: &FieldSpec, values: &mut [f64]) {
        let Window { pressure, friction, .. } = window;
        let [vx, vy] = self.case.slip_velocity();
        let speed = vx.hypot(vy);
        let bound = |at: usize| friction.bound(at, pressure[at]);
        let fill = |values: &mut [f64], of: &dyn Fn(usize) -> [f64; 2]| {
            for at in 0..pressure.len() {
                [values[at], values[pressure.len() + at]] = of(at);
            }
        };
        match *spec {
            field::PRESSURE => values.copy_from_slice(pressure),
            field::TRACTION => {
                let against = if speed > 0.0 { [-vx / speed, -vy / speed] } else { [0.0; 2] };
                fill(values, &|at| against.map(|part| part * bound(at)));
            }
            field::SLIP_VELOCITY => {
                let touches = |at: usize| f64::from(u8::from(pressure[at] > 0.0));
                fill(values, &|at| [vx * touches(at), vy * touches(at)]);
            }
            field::FRICTION_POWER => {
                values.iter_mut().enumerate().for_each(|(at, power)| *power = bound(at) * speed);
                self.case.terms.keep_heat(values);
            }
            field::SURFACE_SPEED => values.copy_from_slice(&self.case.surface_speeds()),
            _ => {}
        }
    }

    fn summary(&self, window: &Window) -> Value {
        let Window { solved, pressure, friction, separation } = window;
        let (case, area) = (&self.case, self.case.grid.element_area());
        let mean = case.mean_pressure();
        let count = pressure.len() as f64;
        let square = pressure.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / count;
        let [vx, vy] = case.slip_velocity();
        let speed = vx.hypot(vy);
        let bounds = || friction.bounds(pressure);
        let force = bounds().sum::<f64>() * area;
        let against = |part: f64| if speed > 0.0 { 0.0 - force * part / speed } else { 0.0 };
        let mut figures = json!({
            "max_pressure_pa": pressure.iter().copied().fold(0.0, f64::max),
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
        });
        add_limited_area(&mut figures, case.terms.pressure_bound(), pressure);
        json!({ "contact": figures })
    }

    fn terms(&self) -> &Terms {
        &self.case.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.case.terms
    }
}
