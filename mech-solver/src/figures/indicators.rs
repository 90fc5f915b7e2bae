//! Quantities by which the material and the model of a contact are judged.

use crate::case::scene::Scene;
use elastic::shakedown;
use half_space::tangential::ElementState;
use proto::diagram::{Diagram, Line};
use proto::figure::FigureSpec;
use proto::figure::contact::CREEPAGE_XI;
use proto::grid::Structured;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Largest contact size, relative to the radius, for which a body counts as a half-space.
const HALF_SPACE: f64 = 0.2;
/// Number of elements across a patch below which the friction power is off by a tenth
/// (docs/theory/half-space.md, at a/5).
const ELEMENTS: f64 = 8.0;
/// Width of the slip zone in elements below which errors scatter from grid to grid
/// (docs/how-to/choose-accuracy.md).
const SLIPPING: f64 = 6.0;

/// Share of the load below which the friction power of a patch does not matter.
const LEAST_SHARE: f64 = 0.01;

/// Key of the ratio of tangential to normal force.
pub(crate) const TRACTION_RATIO: &str = "contact.traction_ratio";

/// Keys of the creepages that are the same along a creep curve.
const CREEPAGE_ETA: &str = "contact.creepage_eta";
const SPIN: &str = "contact.creepage_phi_per_m";

const SHEAR_RATIO: &str = "pressure_over_shear_strength";
const SHAKEDOWN: &str = "shakedown_ratio";
const SIZE: &str = "size_over_radius";
const T_GAMMA: &str = "t_gamma_n";
const WORK: &str = "work_per_metre_n";
const ACROSS: &str = "elements_across";
const SLIP_ZONE: &str = "slip_zone_elements";

/// Reference values used by the assessment indicators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Indicators {
    /// Shear yield stress k of the softer body [Pa].
    shear_strength: Option<f64>,
    /// Smaller radius of the two bodies, along and across the motion [m].
    radii: [f64; 2],
}

impl Indicators {
    /// Reads the reference values from a scene.
    pub(crate) fn of(scene: &Scene) -> Self {
        let yields = scene.bodies.iter().filter_map(|body| body.yield_stress);
        let least = |one: f64, other: f64| one.abs().min(other.abs());
        let [upper, lower] = &scene.bodies;
        Self {
            shear_strength: yields.reduce(f64::min).map(|stress| stress / 3.0_f64.sqrt()),
            radii: [least(upper.radius_x, lower.radius_x), least(upper.radius_y, lower.radius_y)],
        }
    }

    /// Reads the reference values for bodies of finite elements, for which the contact may have any
    /// size.
    pub(crate) fn of_elements(scene: &Scene) -> Self {
        Self { radii: [f64::INFINITY; 2], ..Self::of(scene) }
    }

    /// Adds the indicators that follow from the pressure, the forces, the creepages and the size of
    /// a contact.
    pub(crate) fn add_to(&self, contact: &mut Value) {
        let figure = |name: &str| contact.get(name).and_then(Value::as_f64);
        let [pressure, load] = ["max_pressure_pa", "normal_force_n"].map(figure);
        let force = |name: &str| figure(name).unwrap_or(0.0);
        let tangential = force("creep_force_x_n").hypot(force("creep_force_y_n"));
        // Without slip it is 0, not −0.
        let t_gamma = figure("creepage_xi").zip(figure("creepage_eta")).map(|(xi, eta)| {
            0.0 - (force("creep_force_x_n") * xi + force("creep_force_y_n") * eta)
        });
        let spin = figure("creepage_phi_per_m").zip(figure("spin_moment_nm"));
        let work = t_gamma.zip(spin).map(|(t_gamma, (phi, moment))| t_gamma - phi * moment);
        let size = ["semi_axis_a_m", "semi_axis_b_m"]
            .map(figure)
            .iter()
            .zip(self.radii)
            .filter_map(|(axis, radius)| Some((*axis)? / radius))
            .fold(0.0, f64::max);
        if let Some(t_gamma) = t_gamma {
            contact[T_GAMMA] = t_gamma.into();
        }
        if let Some(work) = work {
            contact[WORK] = work.into();
        }
        if size > 0.0 {
            contact[SIZE] = size.into();
        }
        if let (Some(strength), Some(pressure), Some(load)) = (self.shear_strength, pressure, load)
            && load > 0.0
        {
            contact[SHEAR_RATIO] = (pressure / strength).into();
            contact[SHAKEDOWN] = (pressure / strength / shakedown::limit(tangential / load)).into();
        }
    }
}

/// Adds the number of elements across a contact, or across the smallest of its patches if all are
/// listed. Patches with less than [`LEAST_SHARE`] of the load do not count.
pub(crate) fn add_elements(contact: &mut Value, grid: &Structured) {
    let across = |patch: &Value| {
        let axis = |name: &str| patch.get(name).and_then(Value::as_f64);
        let along = 2.0 * axis("semi_axis_a_m")? / grid.dx();
        Some(match grid.nj {
            1 => along,
            _ => along.min(2.0 * axis("semi_axis_b_m")? / grid.dy()),
        })
    };
    let listed = contact.get("each_patch").and_then(Value::as_array);
    let all = listed.filter(|list| contact["patches"].as_u64() == Some(list.len() as u64));
    let least = match all {
        Some(list) => {
            let load = |patch: &&Value| patch.get("normal_force_n").and_then(Value::as_f64);
            let least = LEAST_SHARE * list.iter().filter_map(|patch| load(&patch)).sum::<f64>();
            let counts = |patch: &&Value| load(patch).is_none_or(|load| load >= least);
            list.iter().filter(counts).filter_map(across).reduce(f64::min)
        }
        None => across(contact),
    };
    if let Some(least) = least.filter(|least| *least > 0.0) {
        contact[ACROSS] = least.into();
    }
}

/// Adds the width of the slip zone, if it is known.
pub(crate) fn add_slip_zone(contact: &mut Value, zone: &SlipZone) {
    if let Some(elements) = zone.elements() {
        contact[SLIP_ZONE] = elements.into();
    }
}

/// Width of the slip zone along the rolling direction, in elements.
///
/// Every unbroken run of slipping elements in a row has a width and a friction power. The width of
/// the zone is the mean of these widths, weighted with the powers: runs that dissipate nothing do
/// not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SlipZone {
    /// Friction power of the slipping elements, in an arbitrary unit.
    power: f64,
    /// Sum of width times power over all runs.
    weighted_width: f64,
    /// True if an element sticks.
    sticks: bool,
}

impl SlipZone {
    /// Measures the slip zone on a grid with `count` elements in each row along x.
    pub(crate) fn new(count: usize, elements: &[ElementState], power: &[f64]) -> Self {
        let mut zone = Self::default();
        zone.add(count, elements, power);
        zone
    }

    /// Measures the slip zone of rows of a grid, whose zones at the trailing edges may be known to
    /// parts of an element.
    pub(crate) fn of_rows(
        grid: &Structured,
        elements: &[ElementState],
        power: &[f64],
        zones: &[Option<half_space::slip_zone::TrailingZone>],
    ) -> Self {
        let mut zone = Self::default();
        let rows = elements.chunks(grid.ni).zip(power.chunks(grid.ni)).zip(zones);
        for ((elements, power), known) in rows {
            let stick = elements.iter().position(|at| *at == ElementState::Adhesion);
            match (known, stick) {
                (Some(known), Some(stick)) => {
                    zone.add_run(known.width() / grid.dx(), known.power / grid.dx());
                    zone.add(grid.ni, &elements[stick..], &power[stick..]);
                }
                _ => zone.add(grid.ni, elements, power),
            }
        }
        zone
    }

    /// Adds the slip zone of a further patch whose elements have the same area.
    pub(crate) fn add(&mut self, count: usize, elements: &[ElementState], power: &[f64]) {
        let slips = |at: &ElementState| *at == ElementState::Slip;
        self.sticks |= elements.contains(&ElementState::Adhesion);
        for (row, power) in elements.chunks(count.max(1)).zip(power.chunks(count.max(1))) {
            let mut first = 0;
            for run in row.chunk_by(|one, next| slips(one) == slips(next)) {
                let own = power[first..first + run.len()].iter().sum::<f64>().max(0.0);
                if slips(&run[0]) {
                    self.add_run(run.len() as f64, own);
                }
                first += run.len();
            }
        }
    }

    /// Adds an unbroken run of slip with its width in elements and its friction power.
    pub(crate) fn add_run(&mut self, width: f64, power: f64) {
        self.power += power;
        self.weighted_width += power * width;
    }

    /// Notes that a part of the contact sticks.
    pub(crate) fn add_stick(&mut self) {
        self.sticks = true;
    }

    /// Takes an estimated width \[element\] where all elements stick: the zone is too narrow for
    /// the grid.
    pub(crate) fn or_estimated(self, width: impl Fn() -> Option<f64>) -> Self {
        match self.sticks && self.power == 0.0 {
            true => {
                width().map_or(self, |width| Self { power: 1.0, weighted_width: width, ..self })
            }
            false => self,
        }
    }

    /// Width in elements; `None` if nothing slips, or if everything slides and the zone has no
    /// edge inside the contact.
    fn elements(&self) -> Option<f64> {
        (self.sticks && self.power > 0.0).then(|| self.weighted_width / self.power)
    }
}

/// Descriptions of the indicators.
pub(crate) fn figures() -> Vec<FigureSpec> {
    let figure = |name: &str, words| FigureSpec::new(&format!("contact.{name}"), "1", words);
    vec![
        FigureSpec::new(
            &format!("contact.{T_GAMMA}"),
            "N",
            "T-gamma number: creep forces times creepages, without spin",
        )
        .on("friction", "Tγ")
        .digits(4),
        FigureSpec::new(
            &format!("contact.{WORK}"),
            "N",
            "work of creep forces and spin moment for each metre rolled",
        )
        .digits(4),
        figure(SHEAR_RATIO, "p0 over the yield stress in shear").on("material", "p0/k").digits(3),
        figure(SHAKEDOWN, "p0/k over the limit of elastic shakedown")
            .expected_below(
                1.0,
                "beyond elastic shakedown the material flows in every passage, until it hardens \
                 (line contact in full sliding; Johnson 1985, 9.2)",
            )
            .on("material", "of the shakedown limit")
            .digits(3),
        figure(SIZE, "semi-axis over the body's radius").expected_below(
            HALF_SPACE,
            "for a contact this large the bodies are not half-spaces (Johnson 1985, 4.1)",
        ),
        figure(ACROSS, "elements across the narrowest patch").expected_above(
            ELEMENTS,
            "with so few elements the friction power is off by a tenth, and on one or two the pressure by a factor; \
             raise mech.resolution along the motion, mech.lateral_resolution across it",
        ),
        figure(
            SLIP_ZONE,
            "elements across the slip zone along x, mean weighted with the friction power",
        )
        .expected_above(
            SLIPPING,
            "across so few elements friction power and temperatures scatter from grid to grid; \
             raise mech.resolution",
        ),
    ]
}

/// Diagram of the traction coefficient over the longitudinal creepage, the creep curve of a sweep
/// or a sequence.
pub(crate) fn creep_curve() -> Diagram {
    let curve = Diagram::new(
        "Creep curve",
        [CREEPAGE_XI, TRACTION_RATIO],
        "Negative creepage drives: the surface of the upper body is faster than that of the lower one. The curve \
         ends at the friction coefficient.",
    );
    Diagram { constant: [CREEPAGE_ETA, SPIN].map(str::to_owned).to_vec(), ..curve }
}

/// Diagram of p₀/k over the traction coefficient, with the limits of a line contact.
pub(crate) fn shakedown_diagram() -> Diagram {
    const TRACTIONS: [f64; 12] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.36, 0.42, 0.5, 0.6, 0.8];
    let line = |name: &str, limit: fn(f64) -> f64| Line {
        name: name.to_owned(),
        points: TRACTIONS.map(|traction| [traction, limit(traction)]).to_vec(),
    };
    let pressure = format!("contact.{SHEAR_RATIO}");
    let diagram = Diagram::new(
        "Shakedown",
        [TRACTION_RATIO, &pressure],
        "Between the lines the material flows until residual stresses hold it; above the upper one in every \
         passage, until it hardens. Limits of a line contact in full sliding, ideally plastic (Johnson 1985, 9.2).",
    );
    let lines = vec![
        line("elastic from the first passage on", shakedown::elastic_limit),
        line("elastic after the first passages", shakedown::limit),
    ];
    Diagram { lines, ..diagram }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Tγ is the product of forces and creepages with the sign reversed. The work also contains
    /// moment times spin if both are known.
    #[test]
    fn the_work_for_each_metre() {
        let indicators = Indicators { shear_strength: None, radii: [f64::INFINITY; 2] };
        let mut contact = json!({"creep_force_x_n": 2e4, "creep_force_y_n": -1e4, "spin_moment_nm": -10.0,
            "creepage_xi": -2e-3, "creepage_eta": 1e-3, "creepage_phi_per_m": 0.3});
        indicators.add_to(&mut contact);
        assert!((contact[T_GAMMA].as_f64().unwrap() - 50.0).abs() < 1e-12, "{contact}");
        assert!((contact[WORK].as_f64().unwrap() - 53.0).abs() < 1e-12, "{contact}");
        let mut shifted = json!({"creep_force_x_n": 2e4, "shift_x_m": 1e-6});
        indicators.add_to(&mut shifted);
        assert_eq!(shifted.get(T_GAMMA), None);
        let mut strips = json!({"creep_force_x_n": 2e4, "creepage_xi": -1e-3, "creepage_eta": 0.0});
        indicators.add_to(&mut strips);
        assert_eq!((&strips[T_GAMMA], strips.get(WORK)), (&json!(20.0), None));
    }

    /// p₀/k and its ratio to the limit use the strength of the softer body; the size uses the
    /// smaller radius in either direction.
    #[test]
    fn a_contact_is_held_against_its_limits() {
        let indicators = Indicators { shear_strength: Some(300e6), radii: [0.5, f64::INFINITY] };
        let mut contact = json!({"max_pressure_pa": 1.2e9, "normal_force_n": 1e5, "creep_force_x_n": -5e4,
            "semi_axis_a_m": 5e-3, "semi_axis_b_m": 8e-3});
        indicators.add_to(&mut contact);
        assert_eq!(contact[SHEAR_RATIO], 4.0);
        assert_eq!(contact[SHAKEDOWN], 2.0, "1/0.5 is the limit");
        assert_eq!(contact[SIZE], 0.01);
        let grid = Structured::contact_plane(0.0, 0.0, 1e-3, 2e-3, 20, 20);
        add_elements(&mut contact, &grid);
        assert_eq!(contact[ACROSS], 8.0);
        contact["each_patch"] = json!([{"semi_axis_a_m": 1e-3, "semi_axis_b_m": 8e-3}, {"semi_axis_a_m": 5e-3, "semi_axis_b_m": 8e-3}]);
        contact["patches"] = json!(2);
        add_elements(&mut contact, &grid);
        assert_eq!(contact[ACROSS], 2.0);
        let soft = Indicators { shear_strength: None, ..indicators };
        let mut other = json!({"max_pressure_pa": 1e9, "normal_force_n": 0.0});
        soft.add_to(&mut other);
        assert_eq!(other.get(SHAKEDOWN), None);
    }

    /// Runs of slipping elements count by their friction power. A contact that slides everywhere
    /// and one that sticks everywhere have no slip zone.
    #[test]
    fn the_slip_zone_is_weighted_with_its_power() {
        use ElementState::{Adhesion as A, Exterior as E, Slip as S};
        let elements = [E, S, S, A, S, E, S, S, S, A, A, S];
        let power = [0.0, 1.0, 1.0, 9.0, 2.0, 0.0, 3.0, 3.0, 3.0, 0.0, 0.0, -1.0];
        let zone = SlipZone::new(6, &elements, &power);
        // Widths 2, 1 and 3 with powers 2, 2 and 9.
        assert_eq!(zone.elements(), Some((2.0 * 2.0 + 1.0 * 2.0 + 3.0 * 9.0) / 13.0));
        assert_eq!(SlipZone::new(2, &[S, S], &[1.0, 1.0]).elements(), None);
        assert_eq!(SlipZone::new(2, &[A, A], &[0.0, 0.0]).elements(), None);
        let mut patches = SlipZone::new(2, &[S, A], &[1.0, 0.0]);
        patches.add(3, &[S, S, S], &[1.0, 1.0, 1.0]);
        assert_eq!(patches.elements(), Some((1.0 + 3.0 * 3.0) / 4.0));
    }
}
