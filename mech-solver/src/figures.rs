//! Quantities of the section `contact` of the summary.

pub(crate) mod indicators;

use proto::figure::contact::{
    APPROACH, MAX_PRESSURE, NORMAL_FORCE, PATCHES, SEMI_AXIS_A, SEMI_AXIS_B,
};
use proto::figure::{FigureSpec, Style};

/// Returns all quantities of a contact in reading order. A model omits those that it does not
/// compute.
pub(crate) fn figures() -> Vec<FigureSpec> {
    [extent(), patches(), forces(), motion(), slip(), indicators::figures()].concat()
}

/// Size, pressure and load. With several patches, the sizes are listed for each patch instead.
fn extent() -> Vec<FigureSpec> {
    let figure = |key, unit, words, short| FigureSpec::new(key, unit, words).on("contact", short);
    vec![
        figure(PATCHES, "1", "number of patches", "patch").style(Style::Count),
        figure(SEMI_AXIS_A, "m", "semi-axis along x", "a").unless_several(PATCHES).headline(),
        figure(SEMI_AXIS_B, "m", "semi-axis along y", "b").unless_several(PATCHES),
        figure(MAX_PRESSURE, "Pa", "maximum pressure", "p0")
            .expected_below(
                4e9,
                "rail and bearing steels have a hardness of 3 to 7 GPa, and yield before",
            )
            .rank(4)
            .headline(),
        figure(NORMAL_FORCE, "N", "normal force", "N").headline(),
        figure(APPROACH, "m", "approach", "approach").rank(9).headline(),
        FigureSpec::new("contact.area_m2", "m2", "contact area"),
        figure("contact.area_ratio", "1", "share of the surface in contact", "contact")
            .style(Style::Percent),
        figure("contact.gap_m", "m", "distance of the ends", "gap").headline(),
        figure("contact.separation_m", "m", "mean distance of the surfaces", "separation"),
        FigureSpec::new(
            "contact.pressure_deviation_pa",
            "Pa",
            "root mean square deviation from the mean pressure",
        ),
    ]
}

/// Quantities of each patch, if there are several.
fn patches() -> Vec<FigureSpec> {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("contact.each_patch.#.{name}"), unit, words).on("patch", short)
    };
    vec![
        figure("y_m", "m", "place", "y").style(Style::Place),
        figure("semi_axis_a_m", "m", "semi-axis along x", "a"),
        figure("semi_axis_b_m", "m", "semi-axis along y", "b"),
        figure("max_pressure_pa", "Pa", "maximum pressure", "p0"),
        figure("normal_force_n", "N", "load", "N").headline(),
    ]
}

/// Forces on the upper body. A force within rounding of the load is not printed.
fn forces() -> Vec<FigureSpec> {
    const FORCES: [&str; 2] = ["contact.creep_force_x_n", "contact.creep_force_y_n"];
    const MOMENT: &str = "contact.spin_moment_nm";
    let figure = |key, unit, words, short| FigureSpec::new(key, unit, words).on("friction", short);
    vec![
        figure(indicators::TRACTION_RATIO, "1", "traction coefficient |F|/N", "|F|/N")
            .ratio(&FORCES, NORMAL_FORCE)
            .digits(4)
            .absolute()
            .headline(),
        figure(FORCES[0], "N", "creep force x", "F_x").unless_below(&[NORMAL_FORCE]).rank(7),
        figure(FORCES[1], "N", "creep force y", "F_y").unless_below(&[NORMAL_FORCE]),
        figure(MOMENT, "Nm", "spin moment", "M_z").unless_below(&[NORMAL_FORCE, SEMI_AXIS_A]),
    ]
}

/// Creepages, or the shift of bodies that do not roll.
fn motion() -> Vec<FigureSpec> {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("contact.{name}"), unit, words).on("friction", short).digits(4)
    };
    let percent = Style::Percent;
    vec![
        figure("creepage_xi", "1", "creepage along x", "creepage ξ")
            .style(percent)
            .expected_below(0.05, "beyond that bodies slide rather than roll")
            .rank(5)
            .headline(),
        figure("creepage_eta", "1", "creepage along y", "creepage η").style(percent).unless_zero(),
        figure("creepage_phi_per_m", "rad/m", "spin", "spin φ").unless_zero(),
        figure("shift_x_m", "m", "shift along x", "shift x").headline(),
        figure("shift_y_m", "m", "shift along y", "shift y").unless_zero(),
        figure("turn_rad", "rad", "turn about z", "turn").unless_zero(),
    ]
}

/// Slip and friction power.
fn slip() -> Vec<FigureSpec> {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("contact.{name}"), unit, words).on("friction", short)
    };
    vec![
        figure("slip_area_ratio", "1", "slip area", "slip area")
            .style(Style::Percent)
            .digits(3)
            .absolute()
            .rank(8),
        figure("max_slip_velocity_m_per_s", "m/s", "largest slip velocity", "slip").digits(4),
        figure("friction_power_w", "W", "friction power", "power")
            .expected_below(1.6e6, "a locomotive's axle has 1.6 MW in total")
            .rank(6)
            .headline(),
        figure(
            "layer_area_ratio",
            "1",
            "area in which the layer flows plastically",
            "plastic area",
        )
        .style(Style::Percent)
        .digits(3)
        .absolute(),
        figure("layer_power_w", "W", "part of the friction power in the layer", "in the layer"),
        figure("layer_plastic_shift_m", "m", "largest plastic shift of the layer", "plastic shift"),
        FigureSpec::new("contact.max_traction_pa", "Pa", "largest traction"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::figure::contact::{
        CREEPAGE_XI, FRICTION_POWER, SLIP_AREA_RATIO, SLIP_ZONE_ELEMENTS,
    };

    #[test]
    fn what_is_referred_to_is_described() {
        let all = figures();
        for key in [
            NORMAL_FORCE,
            PATCHES,
            SEMI_AXIS_A,
            SEMI_AXIS_B,
            MAX_PRESSURE,
            APPROACH,
            CREEPAGE_XI,
            FRICTION_POWER,
            SLIP_AREA_RATIO,
            SLIP_ZONE_ELEMENTS,
        ] {
            assert!(all.iter().any(|figure| figure.key == key), "{key}");
        }
    }
}
