//! What the model found: fields and figures.

use super::Prepared;
use crate::effects::friction_heat;
use crate::half_space::levels::{Prescribed, Solution};
use crate::half_space::normal_contact::NormalContact;
use crate::half_space::steady_rolling::ElementState;
use proto::field;
use proto::model::Outputs;
use serde_json::{Value, json};

/// The solution on the finest grid.
#[derive(Debug)]
pub(super) struct Answer {
    pressure: Vec<f64>,
    /// Components x and y, one after the other.
    traction: Vec<f64>,
    slip_velocity: Vec<f64>,
    friction_power: Vec<f64>,
    surface_speed: [f64; 2],
    contact: Value,
    /// Newton steps, over all grids.
    pub(super) iterations: u32,
    /// Products with the operators on the finest grid.
    pub(super) work: u64,
}

impl Answer {
    /// Everything slides, against the rigid slip.
    pub(super) fn sliding(case: &Prepared, normal: NormalContact) -> Self {
        let Prescribed::Creepage([xi, eta, phi]) = case.prescribed else {
            unreachable!("without partial slip the creepages are known")
        };
        let grid = &case.grid;
        let count = grid.points();
        let mut traction = vec![0.0; 2 * count];
        let mut slip = vec![0.0; 2 * count];
        let friction = case.scene.friction_coefficient;
        for index in 0..count {
            let (x, y) = (grid.x(index % grid.ni), grid.y(index / grid.ni));
            let rigid = [xi - phi * y, eta + phi * x];
            let size = rigid[0].hypot(rigid[1]);
            for component in 0..2 {
                // The rigid slip of a step is that in its middle.
                let middle = [rigid[0], rigid[1] + 0.5 * phi * grid.dx()];
                slip[component * count + index] = middle[component] * grid.dx();
                if size > 0.0 {
                    traction[component * count + index] =
                        -friction * normal.pressure[index] * rigid[component] / size;
                }
            }
        }
        let slipping = if [xi, eta, phi] == [0.0; 3] { 0.0 } else { 1.0 };
        Self::new(case, normal, traction, slip, [xi, eta, phi], slipping)
    }

    /// The solution of steady rolling.
    pub(super) fn rolling(case: &Prepared, normal: NormalContact, solution: Solution) -> Self {
        let state = &solution.state;
        let count_of =
            |which: ElementState| state.element.iter().filter(|e| **e == which).count() as f64;
        let (slip, stick) = (count_of(ElementState::Slip), count_of(ElementState::Adhesion));
        let ratio = if slip + stick > 0.0 { slip / (slip + stick) } else { 0.0 };
        let traction = state.traction.concat();
        let slips = state.slip.concat();
        let mut answer = Self::new(case, normal, traction, slips, state.creepage, ratio);
        answer.iterations = solution.newton_steps as u32;
        answer.work = solution.operator_applications as u64;
        answer
    }

    fn new(
        case: &Prepared,
        normal: NormalContact,
        traction: Vec<f64>,
        slip: Vec<f64>,
        creepage: [f64; 3],
        slip_area_ratio: f64,
    ) -> Self {
        let grid = &case.grid;
        let speed = case.scene.rolling_speed;
        let rate = speed / grid.dx();
        let passages = Passages { nx: grid.ni, traction: &traction, slip: &slip, rate };
        let friction_power = passages.power();
        let slip_velocity = passages.velocity(&normal.pressure);
        let mut answer = Self {
            surface_speed: friction_heat::surface_speeds(speed, creepage[0]),
            contact: Value::Null,
            iterations: normal.iterations,
            work: 0,
            pressure: normal.pressure,
            traction,
            slip_velocity,
            friction_power,
        };
        answer.contact = answer.figures(case, normal.approach, creepage, slip_area_ratio);
        answer
    }

    fn figures(
        &self,
        case: &Prepared,
        approach: Option<f64>,
        [xi, eta, phi]: [f64; 3],
        slip_area_ratio: f64,
    ) -> Value {
        let grid = &case.grid;
        let (area, count) = (grid.element_area(), grid.points());
        let (px, py) = self.traction.split_at(count);
        let mut sums = [0.0; 4];
        for index in 0..count {
            let (x, y) = (grid.x(index % grid.ni), grid.y(index / grid.ni));
            sums[0] += self.pressure[index];
            sums[1] += px[index];
            sums[2] += py[index];
            sums[3] += x * py[index] - y * px[index];
        }
        let [normal, force_x, force_y, moment] = sums.map(|sum| sum * area);
        let touching = self.pressure.iter().filter(|p| **p > 0.0).count() as f64;
        let largest =
            |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max);
        let (vx, vy) = self.slip_velocity.split_at(count);
        let mut figures = json!({
            "semi_axis_a_m": case.ellipse.semi_axis_a,
            "semi_axis_b_m": case.ellipse.semi_axis_b,
            "area_m2": touching * area,
            "max_pressure_pa": self.pressure.iter().copied().fold(0.0, f64::max),
            "normal_force_n": normal,
            "creep_force_x_n": force_x,
            "creep_force_y_n": force_y,
            "spin_moment_nm": moment,
            "traction_coefficient": force_x / normal,
            "creepage_xi": xi,
            "creepage_eta": eta,
            "creepage_phi_per_m": phi,
            "slip_area_ratio": slip_area_ratio,
            "max_slip_velocity_m_per_s": largest(vx, vy),
            "max_traction_pa": largest(px, py),
            "friction_power_w": self.friction_power.iter().sum::<f64>() * area,
        });
        if let Some(approach) = approach {
            figures["approach_m"] = approach.into();
        }
        figures
    }

    /// Writes the fields that are asked for.
    pub(super) fn write(&self, outputs: &mut dyn Outputs) {
        let fields: [(_, &[f64]); 5] = [
            (&field::PRESSURE, &self.pressure),
            (&field::TRACTION, &self.traction),
            (&field::SLIP_VELOCITY, &self.slip_velocity),
            (&field::FRICTION_POWER, &self.friction_power),
            (&field::SURFACE_SPEED, &self.surface_speed),
        ];
        for (spec, values) in fields {
            if let Some(place) = outputs.get(spec) {
                place.copy_from_slice(values);
            }
        }
    }

    /// The section `contact` of `summary.json`.
    pub(super) fn summary(&self) -> Value {
        json!({ "contact": self.contact })
    }
}

/// The steps of particles from one element's centre to the next one's downstream.
struct Passages<'a> {
    nx: usize,
    traction: &'a [f64],
    slip: &'a [f64],
    /// V/Δx [1/s].
    rate: f64,
}

impl Passages<'_> {
    /// −½(p_I + p_{I+e_x})·S_I V/Δx [W/m²]; adding zero turns −0 into 0.
    fn power(&self) -> Vec<f64> {
        let count = self.slip.len() / 2;
        let upstream = |index: usize, component: usize| {
            if (index + 1).is_multiple_of(self.nx) {
                return 0.0;
            }
            self.traction[component * count + index + 1]
        };
        let power = |index: usize| {
            let of = |component: usize| {
                let at = component * count + index;
                (self.traction[at] + upstream(index, component)) * self.slip[at]
            };
            -0.5 * self.rate * (of(0) + of(1)) + 0.0
        };
        (0..count).map(power).collect()
    }

    /// Slip velocity [m/s], zero outside the contact.
    fn velocity(&self, pressure: &[f64]) -> Vec<f64> {
        let touching = pressure.iter().chain(pressure).map(|p| *p > 0.0);
        let velocity = |(slip, touches): (&f64, bool)| if touches { slip * self.rate } else { 0.0 };
        self.slip.iter().zip(touching).map(velocity).collect()
    }
}
