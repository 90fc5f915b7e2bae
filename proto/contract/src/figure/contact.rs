//! Keys of figures that one participant supplies and another reads, in estimates and advice.
//!
//! A figure that only its own participant uses has its key in that participant.

/// Number of patches.
pub const PATCHES: &str = "contact.patches";
/// Normal force [N].
pub const NORMAL_FORCE: &str = "contact.normal_force_n";
/// Semi-axis along the rolling direction [m].
pub const SEMI_AXIS_A: &str = "contact.semi_axis_a_m";
/// Semi-axis across the rolling direction [m].
pub const SEMI_AXIS_B: &str = "contact.semi_axis_b_m";
/// Largest pressure [Pa].
pub const MAX_PRESSURE: &str = "contact.max_pressure_pa";
/// Approach of the bodies [m].
pub const APPROACH: &str = "contact.approach_m";
/// Longitudinal creepage [-].
pub const CREEPAGE_XI: &str = "contact.creepage_xi";
/// Friction power [W].
pub const FRICTION_POWER: &str = "contact.friction_power_w";
/// Share of the contact that slips [-].
pub const SLIP_AREA_RATIO: &str = "contact.slip_area_ratio";
/// Width of the slip zone along x, in elements [-].
pub const SLIP_ZONE_ELEMENTS: &str = "contact.slip_zone_elements";

/// Key of the largest temperature rise of a body [K], by the name that the case gives it.
#[must_use]
pub fn max_rise(body: &str) -> String {
    format!("temperature.{body}.max_rise_k")
}

/// Returns true for the key of the largest temperature rise of some body.
#[must_use]
pub fn is_max_rise(key: &str) -> bool {
    let body = key.strip_prefix("temperature.").and_then(|key| key.strip_suffix(".max_rise_k"));
    body.is_some_and(|body| !body.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_is_recognised() {
        assert!(is_max_rise(&max_rise("rail")));
        assert!(!is_max_rise("temperature.rail.x_m") && !is_max_rise(FRICTION_POWER));
    }
}
