//! Fields and figures of an instant.

use super::balance::{Balance, Powers};
use super::case::Case;
use super::contact::ContactSolver;
use crate::case::scene::Load;
use crate::figures::indicators::{Indicators, SlipZone, add_elements, add_slip_zone};
use crate::models::contact_model::CarriedLoad;
use crate::models::summary::{add_limited_area, add_patches};
use crate::terms::Accepted;
use crate::terms::surface::KeptSurface;
use half_space::area::contact_area;
use half_space::dissipation::without_negative;
use half_space::extent::Moments;
use half_space::grid_continuation::Solution;
use half_space::tangential::{Creepage, ElementState, TangentialState};
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::Outputs;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Fields on the grid of the case; components x and y one after the other.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct ContactFields {
    pub(super) pressure: Vec<f64>,
    /// Pressure that bounds the tractions: that of displaced rows, brought onto the grid.
    pub(super) bounding_pressure: Vec<f64>,
    pub(super) traction: Vec<f64>,
    pub(super) slip_velocity: Vec<f64>,
    pub(super) friction_power: Vec<f64>,
    /// Largest traction [Pa] and slip velocity [m/s] of an element.
    largest: [f64; 2],
    pub(super) surface_speed: [f64; 2],
    pub(super) creepage: Creepage,
    slip_area_ratio: f64,
    slip_zone: SlipZone,
    approach: Option<f64>,
    /// Position along x about which the moment does the work of the spin: the distance between the
    /// middle of a step and the point where its rigid slip is taken [m].
    pub(super) pivot: f64,
    /// Numerical dissipation of the difference along x, a part of the friction power [W].
    pub(super) numerical_dissipation: Option<f64>,
    /// Power balance, if it is known.
    pub(super) balance: Option<Balance>,
    /// Power dissipated inside creeping bodies in a step, by pressure and tractions [W].
    dissipated: Option<f64>,
    /// Plastic flow of a layer between the surfaces.
    flowed: Option<LayerFlow>,
    /// Thermal inputs of both bodies, if they expand and are observed.
    heated: Option<[KeptSurface; 2]>,
}

/// Plastic flow of a layer.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct LayerFlow {
    /// Largest plastic shift accumulated by a particle in the contact [m].
    largest_shift: f64,
    /// Share of the contact area that flows plastically [-].
    area_ratio: f64,
    /// Share of the friction power due to plastic flow [W].
    power: f64,
}

impl LayerFlow {
    /// Evaluates a state with its friction power [W/m²] on elements of this area [m²]; `None`
    /// without a yielding layer.
    fn of(state: &TangentialState, power: &[f64], area: f64) -> Option<Self> {
        if state.yielded.is_empty() {
            return None;
        }
        let mut found = Self { largest_shift: 0.0, area_ratio: 0.0, power: 0.0 };
        let mut touching = 0.0;
        let [sx, sy] = &state.slip;
        for (index, element) in state.element.iter().enumerate() {
            if *element == ElementState::Exterior {
                continue;
            }
            touching += 1.0;
            found.largest_shift = found.largest_shift.max(state.plastic[index]);
            let (shift, slip) = (state.yielded[index], sx[index].hypot(sy[index]));
            if shift > 0.0 && slip > 0.0 {
                found.area_ratio += 1.0;
                found.power += (shift / slip).min(1.0) * power[index] * area;
            }
        }
        found.area_ratio /= f64::max(touching, 1.0);
        Some(found)
    }
}

impl ContactFields {
    /// Answer of a contact that slides everywhere, against the rigid slip.
    pub(super) fn sliding(case: &Case, contact: &ContactSolver) -> Self {
        let creepage = case.driven.at(0.0).creepage;
        let [xi, eta, phi] = creepage;
        let grid = &case.footprint.grid;
        let count = grid.points();
        let (mut traction, mut slip) = (vec![0.0; 2 * count], vec![0.0; 2 * count]);
        let passage = case.passage();
        for index in 0..count {
            let (x, y) = (grid.x(index % grid.ni), grid.y(index / grid.ni));
            let rigid = [xi - phi * y, eta + phi * x];
            let size = rigid[0].hypot(rigid[1]);
            let middle = [rigid[0], rigid[1] + phi * passage.middle];
            for component in 0..2 {
                slip[component * count + index] = middle[component] * passage.distance;
                if size > 0.0 {
                    traction[component * count + index] =
                        -contact.bound()[index] * rigid[component] / size;
                }
            }
        }
        let mut answer = Self::new(case, contact, creepage);
        answer.slip_area_ratio = if creepage == [0.0; 3] { 0.0 } else { 1.0 };
        answer.set(case, contact, [traction, slip], None);
        answer.largest = [&answer.traction, &answer.slip_velocity].map(|field| largest(field));
        answer
    }

    /// Answer of a solution with partial slip, in the rows of the contact; `before` are the
    /// tractions of the previous instant, `None` in steady rolling.
    pub(super) fn partial(
        case: &Case,
        contact: &ContactSolver,
        solution: &Solution,
        before: Option<&[Vec<f64>; 2]>,
    ) -> Self {
        let state = &solution.state;
        let mut answer = Self::new(case, contact, state.creepage);
        let count_of =
            |which: ElementState| state.element.iter().filter(|e| **e == which).count() as f64;
        let (slip, stick) = (count_of(ElementState::Slip), count_of(ElementState::Adhesion));
        answer.slip_area_ratio = if slip + stick > 0.0 { slip / (slip + stick) } else { 0.0 };
        let passage = case.passage();
        answer.pivot = passage.middle - passage.ahead;
        let before = before.map(|before| before.concat());
        let fields = [state.traction.concat(), state.slip.concat()];
        answer.set(case, contact, fields, before.as_deref());
        answer.flowed =
            LayerFlow::of(state, &answer.friction_power, case.footprint.grid.element_area());
        answer.largest = [&answer.traction, &answer.slip_velocity].map(|field| largest(field));
        answer
    }

    /// Takes the fields from the rows of the contact to the grid of the case, once the friction
    /// power is complete, and measures the slip zone.
    pub(super) fn leave_rows(
        &mut self,
        case: &Case,
        contact: &ContactSolver,
        state: &TangentialState,
    ) {
        let grid = &case.footprint.grid;
        let rows = contact.slipping_rows(state, case.scene.speeds.rolling);
        let (zones, power) = rows.power_on_grid(&self.friction_power);
        self.slip_zone = SlipZone::of_rows(grid, &state.element, &self.friction_power, &zones);
        self.friction_power = power;
        let onto_grid = |values: &[f64]| contact.rows.onto_grid(values);
        for field in [&mut self.traction, &mut self.slip_velocity] {
            *field = field.chunks_exact(self.pressure.len()).flat_map(onto_grid).collect();
        }
    }

    /// Adds the numerical dissipation of the difference along x to the friction power [W/m²], of
    /// which no element loses any.
    pub(super) fn add_numerical_dissipation(&mut self, case: &Case, power: &[f64]) {
        self.friction_power.iter_mut().zip(power).for_each(|(sum, power)| *sum += power);
        without_negative(&mut self.friction_power);
        let added = power.iter().sum::<f64>() * case.footprint.grid.element_area();
        self.numerical_dissipation = Some(self.numerical_dissipation.unwrap_or(0.0) + added);
    }

    /// Sets the energy dissipated by creeping bodies in a step, given per element area [Pa m].
    pub(super) fn dissipate(&mut self, case: &Case, taken: f64) {
        let (area, duration) = (case.footprint.grid.element_area(), case.passage().duration);
        self.dissipated = Some(taken * area / duration);
    }

    /// Answer of bodies pressed together without tractions.
    pub(super) fn at_rest(case: &Case, contact: &ContactSolver) -> Self {
        let mut answer = Self::new(case, contact, [0.0; 3]);
        let count = case.footprint.grid.points();
        answer.traction = vec![0.0; 2 * count];
        answer.slip_velocity = vec![0.0; 2 * count];
        answer.friction_power = vec![0.0; count];
        answer
    }

    fn new(case: &Case, contact: &ContactSolver, creepage: Creepage) -> Self {
        let speeds = case.scene.speeds;
        let rolls = speeds.rolling > 0.0;
        let along = if rolls { creepage[0] } else { 0.0 };
        Self {
            pressure: contact.pressure.clone(),
            bounding_pressure: contact.rows.onto_grid(contact.row_pressure()),
            surface_speed: speeds.of_surfaces(along),
            creepage,
            approach: contact.approach,
            heated: case.heated.clone(),
            ..Self::default()
        }
    }

    /// Sets traction and slip in the rows of a contact, and the power from the tractions `before`.
    fn set(
        &mut self,
        case: &Case,
        contact: &ContactSolver,
        [traction, slip]: [Vec<f64>; 2],
        before: Option<&[f64]>,
    ) {
        let passage = case.passage();
        let start = before.unwrap_or(&traction);
        self.friction_power = passage.power(&case.footprint.grid, start, &traction, &slip);
        let pressure = contact.row_pressure();
        let touching = pressure.iter().chain(pressure).map(|p| *p > 0.0);
        let velocity = |(slip, touches): (&f64, bool)| match touches {
            true => slip / passage.duration,
            false => 0.0,
        };
        self.slip_velocity = slip.iter().zip(touching).map(velocity).collect();
        self.traction = traction;
    }

    /// Returns whether all fields have this number of elements.
    pub(super) fn is_on(&self, count: usize) -> bool {
        let fields = [&self.traction, &self.slip_velocity].map(|field| field.len() == 2 * count);
        let scalars = [&self.pressure, &self.bounding_pressure, &self.friction_power]
            .map(|field| field.len() == count);
        let heated = self.heated.iter().flatten().all(KeptSurface::is_whole);
        fields.into_iter().chain(scalars).all(|fits| fits) && heated
    }

    /// Fields that the terms receive once the window is accepted.
    pub(super) fn accepted(&self) -> Accepted<'_> {
        Accepted {
            pressure: &self.bounding_pressure,
            normal_pressure: &self.pressure,
            traction: &self.traction,
            slip_velocity: &self.slip_velocity,
            friction_power: &self.friction_power,
            surface_speed: self.surface_speed,
            heated: self.heated.as_ref().map(|bodies| bodies.each_ref().map(KeptSurface::seen)),
        }
    }

    /// Powers of the instant or step [W].
    pub(super) fn powers(&self, case: &Case) -> Powers {
        Powers {
            friction: self.friction_power.iter().sum::<f64>() * case.footprint.grid.element_area(),
            balance: self.balance,
            dissipated: self.dissipated,
            layer: self.flowed.map(|flowed| flowed.power),
        }
    }

    /// Section `contact` of `summary.json`, with powers that are means over the window.
    pub(super) fn figures(&self, case: &Case, powers: &Powers) -> Value {
        let grid = &case.footprint.grid;
        let area = grid.element_area();
        let [normal, force_x, force_y, moment] = self.sums(grid).map(|sum| sum * area);
        let [a, b] = match case.footprint.gap {
            Some(_) => Moments::of(grid, &self.pressure).semi_axes,
            None => case.footprint.semi_axes,
        };
        let max_pressure = self.pressure.iter().copied().fold(0.0, f64::max);
        let mut figures = json!({
            "semi_axis_a_m": a,
            "semi_axis_b_m": b,
            "area_m2": contact_area(grid, &self.pressure),
            "max_pressure_pa": max_pressure,
            "normal_force_n": normal,
            "creep_force_x_n": force_x,
            "creep_force_y_n": force_y,
            "spin_moment_nm": moment,
            "traction_coefficient": force_x / normal,
            "slip_area_ratio": self.slip_area_ratio,
            "max_slip_velocity_m_per_s": self.largest[1],
            "max_traction_pa": self.largest[0],
        });
        powers.add_to(&mut figures);
        add_patches(&mut figures, grid, &self.pressure);
        add_elements(&mut figures, grid);
        let estimated = || Some(case.estimated_slip_zone(normal, max_pressure)? / grid.dx());
        add_slip_zone(&mut figures, &self.slip_zone.or_estimated(estimated));
        let names = match case.scene.speeds.rolling > 0.0 {
            true => ["creepage_xi", "creepage_eta", "creepage_phi_per_m"],
            false => ["shift_x_m", "shift_y_m", "turn_rad"],
        };
        for (name, value) in names.into_iter().zip(self.creepage) {
            // Adding zero turns −0 into 0.
            figures[name] = (value + 0.0).into();
        }
        Indicators::of(&case.scene).add_to(&mut figures);
        if let Some(LayerFlow { largest_shift, area_ratio, .. }) = self.flowed {
            figures["layer_plastic_shift_m"] = largest_shift.into();
            figures["layer_area_ratio"] = area_ratio.into();
        }
        if let Some(approach) = self.approach {
            figures["approach_m"] = approach.into();
        }
        if case.bodies.remember() {
            let centre = Moments::of(grid, &self.pressure).centre[0];
            let power = self.balance.and_then(|balance| balance.pressure);
            let speed = case.scene.speeds.rolling;
            figures["pressure_centre_x_m"] = centre.into();
            figures["rolling_resistance_n"] =
                power.map(|power| power.rolling_resistance / speed).into();
        }
        add_limited_area(&mut figures, case.terms.pressure_bound(), &self.pressure);
        let origin = case.footprint.gap.as_ref().map_or(0.0, |gap| gap.origin);
        if origin != 0.0 {
            figures["origin_y_m"] = origin.into();
        }
        let gap = case.footprint.gap.as_ref();
        let kinks = gap.map(|gap| gap.kinks_under(grid, &self.pressure)).unwrap_or_default();
        if !kinks.is_empty() {
            figures["kinks_in_contact_y_m"] = kinks.into();
        }
        figures
    }

    /// Sums of pressure, traction along x and y, and moment about z over the elements.
    pub(super) fn sums(&self, grid: &Structured) -> [f64; 4] {
        let (px, py) = self.traction.split_at(grid.points());
        let mut sums = [0.0; 4];
        for index in 0..grid.points() {
            let (x, y) = (grid.x(index % grid.ni), grid.y(index / grid.ni));
            sums[0] += self.pressure[index];
            sums[1] += px[index];
            sums[2] += py[index];
            sums[3] += x * py[index] - y * px[index];
        }
        sums
    }

    /// Prescribed and carried normal force; empty where an approach is prescribed.
    pub(super) fn loads(&self, case: &Case) -> Vec<CarriedLoad> {
        let prescribed = match (&case.footprint.gap, &case.footprint.ellipse, case.scene.load) {
            (None, Some(ellipse), _) => ellipse.normal_force,
            (_, _, Load::NormalForce(force)) => force,
            (_, _, Load::Approach(_)) => return Vec::new(),
        };
        let carried = self.pressure.iter().sum::<f64>() * case.footprint.grid.element_area();
        vec![CarriedLoad { prescribed, carried }]
    }

    /// Writes a field. The friction power is the mean over the window, reduced to the share that
    /// becomes heat.
    pub(super) fn write(
        &self,
        case: &Case,
        friction_power: &[f64],
        spec: &FieldSpec,
        values: &mut [f64],
    ) {
        match *spec {
            field::PRESSURE => values.copy_from_slice(&self.bounding_pressure),
            field::TRACTION => values.copy_from_slice(&self.traction),
            field::SLIP_VELOCITY => values.copy_from_slice(&self.slip_velocity),
            field::FRICTION_POWER => {
                values.copy_from_slice(friction_power);
                case.terms.keep_heat(values);
            }
            field::SURFACE_SPEED => values.copy_from_slice(&self.surface_speed),
            field::CONTACT_FORCE => {
                let grid = &case.footprint.grid;
                let [normal, x, y, _] = self.sums(grid).map(|sum| sum * grid.element_area());
                values.copy_from_slice(&[x, y, normal]);
            }
            _ => {}
        }
    }
}

impl Case {
    /// Writes the observations of an accepted window.
    pub(super) fn observe(&mut self, answer: &ContactFields, outputs: &mut dyn Outputs) {
        let accepted = answer.accepted();
        self.terms.removal.iter().for_each(|removal| removal.write(outputs));
        for term in &mut self.terms.observations {
            term.observe(&accepted);
            term.write(outputs);
        }
    }

    /// Sections of `summary.json`, with powers that are means over the window.
    pub(super) fn summary(&self, answer: &ContactFields, powers: &Powers) -> Value {
        let mut summary = json!({ "contact": answer.figures(self, powers) });
        let removed = self.terms.removal.iter().map(|removal| removal.summary());
        let observed = self.terms.observations.iter().filter_map(|term| term.summary());
        for (section, figures) in removed.chain(observed) {
            summary[section] = figures;
        }
        summary
    }
}

/// Largest magnitude of a vector field.
fn largest(vectors: &[f64]) -> f64 {
    let (x, y) = vectors.split_at(vectors.len() / 2);
    x.iter().zip(y).map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max)
}
