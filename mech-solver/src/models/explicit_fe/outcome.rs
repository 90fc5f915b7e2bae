//! Evaluation of a measurement: checks, fields, figures.

use crate::case::scene::Scene;
use crate::figures::indicators::{Indicators, add_elements};
use crate::models::contact_model::write_pair;
use crate::models::summary::add_patches;
use crate::terms::Terms;
use explicit_fe::block::Block;
use explicit_fe::rolling::{Means, Rolling};
use half_space::area::contact_area;
use half_space::extent::Moments;
use proto::configuration::Refusal;
use proto::field::{self, FieldSpec};
use proto::model::StepReport;
use serde_json::{Value, json};

/// Relative tolerance of the pressure on the plane; covers rounding.
const ROUNDING: f64 = 1e-9;
/// Distance behind the middle of the contact at which residual quantities are evaluated, in
/// semi-axes.
const PASSED: f64 = 1.8;

/// Refuses invalid means.
///
/// # Errors
/// Elements that are unstable; a contact that was not solved, or reaches beyond the plane.
pub(super) fn check(rolling: &Rolling, means: &Means) -> Result<(), Refusal> {
    if !(means.pressed.is_finite() && means.friction.is_finite() && means.approach.is_finite()) {
        return Err(Refusal::new(
            "mech.resolution",
            "the elements have become unstable",
            "write another resolution, and check materials and radii",
        ));
    }
    if means.unsettled > 0.0 {
        return Err(Refusal::new(
            "mech.resolution",
            format!("the contact was not solved in {:.2} % of the steps", 100.0 * means.unsettled),
            "write another resolution, and check the friction coefficient",
        ));
    }
    let deposited = rolling.plane.normal.iter().sum::<f64>();
    let whole = means.pressed * rolling.plane.time;
    if (deposited - whole).abs() > ROUNDING * whole {
        return Err(Refusal::new(
            "load.normal_force",
            "the contact reaches beyond the searched region, whose size follows from Hertz's contact",
            "check radii, load and irregularity, or write mech.model = \"half-space\"",
        ));
    }
    Ok(())
}

/// Refuses means that miss the prescribed force.
///
/// # Errors
/// A force that was not met.
pub(super) fn met_force(means: &Means, met: bool) -> Result<(), Refusal> {
    if met {
        return Ok(());
    }
    let ratio = means.force[0] / means.force[2];
    Err(Refusal::new(
        "motion.traction_coefficient",
        format!("no creepage was found: the force came to {ratio:.4} of the normal force"),
        "write motion.creepage",
    ))
}

/// Data needed to write fields.
pub(super) struct Fields {
    /// Scene of the case.
    pub(super) scene: Scene,
    /// Terms of the active effects.
    pub(super) terms: Terms,
}

impl Fields {
    /// Writes a field, component-major.
    pub(super) fn write(&self, spec: &FieldSpec, rolling: &Rolling, values: &mut [f64]) {
        let plane = &rolling.plane;
        let mut both = |of: &dyn Fn(usize) -> Vec<f64>| write_pair(values, &[of(0), of(1)]);
        match *spec {
            field::PRESSURE => values.copy_from_slice(&plane.mean(&plane.normal)),
            field::TRACTION => both(&|k| plane.mean(&plane.tangential[k])),
            field::SLIP_VELOCITY => both(&|k| plane.slip_velocity(k)),
            field::FRICTION_POWER => {
                values.copy_from_slice(&plane.mean(&plane.work));
                self.terms.keep_heat(values);
            }
            field::SURFACE_SPEED => {
                values.copy_from_slice(&self.scene.speeds.of_surfaces(rolling.motion.creepage));
            }
            _ => {}
        }
    }
}

/// Report of a solve with this number of steps.
pub(super) fn report(rolling: &Rolling, steps: u64) -> StepReport {
    let elements: u64 = rolling.bodies.iter().map(|body| body.elements() as u64).sum();
    let substeps = u32::try_from(steps).unwrap_or(u32::MAX);
    StepReport { substeps, work: steps * elements, ..StepReport::default() }
}

/// Sections of `summary.json`.
pub(super) fn summary(scene: &Scene, rolling: &Rolling, means: &Means) -> Value {
    let mut contact = figures(rolling, means);
    Indicators::of_elements(scene).add_to(&mut contact);
    json!({ "contact": contact })
}

/// Ratio of two values; 0 if the whole is 0.
fn ratio(part: f64, whole: f64) -> f64 {
    if whole == 0.0 { 0.0 } else { part / whole }
}

fn figures(rolling: &Rolling, means: &Means) -> Value {
    let [strain, hourglass] = rolling
        .bodies
        .each_ref()
        .map(Block::elastic_energy)
        .into_iter()
        .fold([0.0; 2], |[strain, hourglass], [more, of_modes]| {
            [strain + more, hourglass + of_modes]
        });
    let plane = &rolling.plane;
    let pressure = plane.mean(&plane.normal);
    let largest = |values: [Vec<f64>; 2]| {
        let [x, y] = values;
        x.iter().zip(&y).map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max)
    };
    let [semi_axis_a, semi_axis_b] = Moments::of(&plane.grid, &pressure).semi_axes;
    let [touching, sliding] = means.areas;
    let mut figures = json!({
        "semi_axis_a_m": semi_axis_a,
        "semi_axis_b_m": semi_axis_b,
        "area_m2": contact_area(&plane.grid, &pressure),
        "max_pressure_pa": pressure.iter().copied().fold(0.0, f64::max),
        "approach_m": means.approach,
        "normal_force_n": means.force[2],
        "creep_force_x_n": means.force[0],
        "creep_force_y_n": means.force[1],
        "traction_coefficient": ratio(means.force[0], means.force[2]),
        "slip_area_ratio": ratio(sliding, touching),
        "creepage_xi": rolling.motion.creepage,
        "creepage_eta": 0.0,
        "creepage_phi_per_m": 0.0,
        "max_slip_velocity_m_per_s": largest([0, 1].map(|k| plane.slip_velocity(k))),
        "max_traction_pa": largest([0, 1].map(|k| plane.mean(&plane.tangential[k]))),
        "friction_power_w": means.friction,
        "given_power_w": means.given,
        "elastic_energy_j": strain + hourglass,
        "hourglass_energy_ratio": ratio(hourglass, strain + hourglass),
        "steps": rolling.steps(),
        "step_s": rolling.step,
        "sweeps_per_step": means.sweeps,
        "elements": rolling.bodies.iter().map(Block::elements).sum::<usize>(),
    });
    add_patches(&mut figures, &plane.grid, &pressure);
    add_elements(&mut figures, &plane.grid);
    if rolling.bodies.iter().any(|body| body.solid.flow.is_some()) {
        let (plastic, grown) = plastic(rolling);
        figures["plastic_power_w"] = json!(plastic);
        figures["max_plastic_strain"] = json!(grown);
    }
    figures
}

/// Power of plastic flow carried away by the material behind the contact [W], and the largest
/// plastic strain there.
fn plastic(rolling: &Rolling) -> (f64, f64) {
    let mut all = (0.0, 0.0_f64);
    for (body, speed) in rolling.bodies.iter().zip(rolling.speeds()) {
        let back = (PASSED * rolling.asked.half_length / body.length).ceil() as usize;
        let [work, largest] = body.plastic_work(body.counts[0] / 2 - back);
        all = (all.0 + work * speed / body.length, all.1.max(largest));
    }
    all
}
