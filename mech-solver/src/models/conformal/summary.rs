//! Figures of a contact on a curved surface: section `contact` of `summary.json`.

use super::window::Window;
use crate::figures::indicators::{SlipZone, add_slip_zone};
use half_space::tangential::ElementState;
use proto::figure::FigureSpec;
use proto::grid::Structured;
use serde_json::{Value, json};

/// Figures that are specific to this model.
pub(in crate::models) fn figures() -> Vec<FigureSpec> {
    vec![
        FigureSpec::new(
            "contact.pressure_integral_n",
            "N",
            "integral of the pressure over a curved surface",
        ),
        FigureSpec::new(
            "contact.lateral_force_n",
            "N",
            "lateral force on the upper body, in the tangent plane at the middle of the curved surface",
        ),
    ]
}

/// Summary of a window.
pub(super) fn summary(window: &Window, grid: &Structured) -> Value {
    let Window { row, contact, slip_velocity, power } = window;
    let area = grid.element_area();
    let sum = |values: &[f64]| values.iter().sum::<f64>() * area;
    let largest =
        |[x, y]: &[Vec<f64>; 2]| x.iter().zip(y).map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max);
    let [along, across] = &contact.state.traction;
    let moment: f64 = (0..grid.points())
        .map(|at| grid.x(at % grid.ni) * across[at] - grid.y(at / grid.ni) * along[at])
        .sum();
    let count = |wanted: fn(&ElementState) -> bool| {
        contact.state.element.iter().filter(|element| wanted(element)).count() as f64
    };
    let slips = count(|element| *element == ElementState::Slip);
    let touches = count(|element| *element != ElementState::Exterior);
    let [xi, eta, phi] = row.prescription.creepage;
    let [_, lateral, normal] = contact.force;
    let mut summary = json!({
        "contact": {
            "max_pressure_pa": contact.pressure.iter().copied().fold(0.0, f64::max),
            "approach_m": contact.approach,
            "normal_force_n": normal,
            "lateral_force_n": lateral,
            "pressure_integral_n": sum(&contact.pressure),
            "area_m2": touches * area,
            "creep_force_x_n": sum(along),
            "creep_force_y_n": sum(across),
            "spin_moment_nm": moment * area,
            "creepage_xi": xi,
            "creepage_eta": eta,
            "creepage_phi_per_m": phi,
            "slip_area_ratio": slips / touches,
            "friction_power_w": sum(power),
            "max_slip_velocity_m_per_s": largest(slip_velocity),
            "max_traction_pa": largest(&contact.state.traction),
        },
    });
    let zone = SlipZone::new(grid.ni, &contact.state.element, power);
    add_slip_zone(&mut summary["contact"], &zone);
    summary
}
