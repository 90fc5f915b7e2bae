//! Extent, patches and friction of a contact.

use super::numbers::{digits, rise, with_unit};
use crate::format::counted;
use serde_json::Value;

/// Patches with a line of their own at most.
const MOST_PATCHES: usize = 8;
/// Forces below this share of the normal force are rounding.
const NOTHING: f64 = 1e-6;

/// Entries of a line; what is not known is absent.
type Entries = Vec<Option<String>>;

fn quantity(summary: &Value, key: &str) -> Option<f64> {
    summary.get("contact")?.get(key)?.as_f64()
}

/// Size, pressure and load. Of several patches the size is that of each.
pub(super) fn extent(summary: &Value) -> Entries {
    let of = |key: &str| quantity(summary, key);
    let several = of("patches").filter(|count| *count > 1.0);
    let size = |name: &str, key: &str| {
        let value = of(key).filter(|_| several.is_none())?;
        Some(format!("{name} {}", with_unit(value, "m", 5)))
    };
    vec![
        several.map(|count| counted(count as u64, "patch")),
        size("a", "semi_axis_a_m"),
        size("b", "semi_axis_b_m"),
        of("max_pressure_pa").map(|v| format!("p0 {}", with_unit(v, "Pa", 5))),
        of("approach_m").map(|v| format!("approach {}", with_unit(v, "m", 5))),
        of("normal_force_n").map(|v| format!("N {}", with_unit(v, "N", 5))),
    ]
}

/// A line for each patch, if there are several; of many, for those that carry most.
pub(super) fn patches(summary: &Value) -> Vec<(String, Entries)> {
    let listed = summary.pointer("/contact/each_patch").and_then(Value::as_array);
    let count = quantity(summary, "patches").unwrap_or(0.0) as usize;
    let load = |patch: &Value| patch.get("normal_force_n").and_then(Value::as_f64).unwrap_or(0.0);
    let mut shown: Vec<(usize, &Value)> = listed.into_iter().flatten().enumerate().collect();
    shown.sort_by(|a, b| load(b.1).total_cmp(&load(a.1)));
    shown.truncate(MOST_PATCHES);
    shown.sort_by_key(|(n, _)| *n);
    let mut lines: Vec<(String, Entries)> =
        shown.iter().map(|(n, patch)| (format!("patch {}", n + 1), one_patch(patch))).collect();
    let more = count.saturating_sub(lines.len());
    if more > 0 && !lines.is_empty() {
        let more = counted(more as u64, "smaller patch");
        lines.push((String::new(), vec![Some(format!("{more}: see summary.json"))]));
    }
    lines
}

fn one_patch(patch: &Value) -> Entries {
    let of = |key: &str| patch.get(key).and_then(Value::as_f64);
    let size = |name: &str, key: &str| of(key).map(|v| format!("{name} {}", with_unit(v, "m", 5)));
    let body = |body: &str| {
        of(&format!("{body}_max_rise_k")).map(|value| format!("{body} {}", rise(value)))
    };
    vec![
        of("y_m").map(|v| format!("y {:.3} mm", v * 1e3)),
        size("a", "semi_axis_a_m"),
        size("b", "semi_axis_b_m"),
        of("max_pressure_pa").map(|v| format!("p0 {}", with_unit(v, "Pa", 5))),
        of("normal_force_n").map(|v| format!("N {}", with_unit(v, "N", 5))),
        body("rail"),
        body("wheel"),
    ]
}

/// Forces, creepages, slip and power; forces and creepages that are zero are left out.
pub(super) fn friction(summary: &Value) -> Entries {
    let of = |key: &str| quantity(summary, key);
    let normal = of("normal_force_n").filter(|force| *force > 0.0);
    let ratio = match (of("creep_force_x_n"), normal) {
        (Some(x), Some(normal)) => Some(x.hypot(of("creep_force_y_n").unwrap_or(0.0)) / normal),
        _ => of("traction_coefficient").map(f64::abs),
    };
    let floor = NOTHING * normal.unwrap_or(0.0);
    let force = |name: &str, key: &str| {
        let value = of(key).filter(|value| value.abs() > floor)?;
        Some(format!("{name} {}", with_unit(value, "N", 5)))
    };
    let arm = of("semi_axis_a_m").unwrap_or(0.0).max(of("semi_axis_b_m").unwrap_or(0.0));
    let moment = of("spin_moment_nm").filter(|moment| moment.abs() > floor * arm);
    let mut entries = vec![
        ratio.map(|value| format!("|F|/N {value:.4}")),
        force("F_x", "creep_force_x_n"),
        force("F_y", "creep_force_y_n"),
        moment.map(|value| format!("M_z {}", with_unit(value, "Nm", 5))),
    ];
    entries.extend(motion(summary));
    entries.extend([
        of("slip_area_ratio").map(|v| format!("slip area {:.1} %", v * 100.0)),
        of("max_slip_velocity_m_per_s").map(|v| format!("slip {}", with_unit(v, "m/s", 4))),
        of("friction_power_w").map(|v| format!("power {}", with_unit(v, "W", 5))),
    ]);
    entries
}

/// Creepages, or the shift of bodies that do not roll.
fn motion(summary: &Value) -> Entries {
    let percent = |value: f64| format!("{} %", digits(100.0 * value, 4));
    let per_metre = |value: f64| format!("{} rad/m", digits(value, 4));
    let length = |value: f64| with_unit(value, "m", 4);
    let turn = |value: f64| format!("{} rad", digits(value, 4));
    type Written<'a> = &'a dyn Fn(f64) -> String;
    let known: [(&str, &str, Written); 6] = [
        ("creepage ξ", "creepage_xi", &percent),
        ("creepage η", "creepage_eta", &percent),
        ("spin φ", "creepage_phi_per_m", &per_metre),
        ("shift x", "shift_x_m", &length),
        ("shift y", "shift_y_m", &length),
        ("turn", "turn_rad", &turn),
    ];
    let there = known
        .iter()
        .filter_map(|(name, key, written)| Some((*name, quantity(summary, key)?, *written)));
    let there: Vec<(&str, f64, Written)> = there.collect();
    let entries: Entries = there
        .iter()
        .filter(|(_, value, _)| *value != 0.0)
        .map(|(name, value, written)| Some(format!("{name} {}", written(*value))))
        .collect();
    match (there.first(), entries.is_empty()) {
        (Some((name, ..)), true) => {
            let word = name.split(' ').next().unwrap_or(name);
            vec![Some(format!("{word} 0"))]
        }
        _ => entries,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn joined(entries: Entries) -> String {
        entries.into_iter().flatten().collect::<Vec<_>>().join("   ")
    }

    /// Lateral force and spin stand on the line, rounding does not, and power has a unit that fits.
    #[test]
    fn forces_and_creepages_that_are_not_zero() {
        let lateral = json!({"contact": {
            "normal_force_n": 134e3, "creep_force_x_n": -2e-9, "creep_force_y_n": -39642.9,
            "spin_moment_nm": 7.981, "semi_axis_a_m": 8e-3, "traction_coefficient": -1e-14,
            "creepage_xi": 0.0, "creepage_eta": 0.002, "creepage_phi_per_m": 0.3,
            "friction_power_w": 2.0,
        }});
        let expected = "|F|/N 0.2958   F_y -39.643 kN   M_z 7.9810 N·m   creepage η 0.2000 %   \
                        spin φ 0.3000 rad/m   power 2.0000 W";
        assert_eq!(joined(friction(&lateral)), expected);
        let nothing = json!({"contact": {
            "normal_force_n": 1e3, "creep_force_x_n": 0.0, "creepage_xi": 0.0, "creepage_eta": 0.0,
        }});
        assert_eq!(joined(friction(&nothing)), "|F|/N 0.0000   creepage 0");
        let shift = json!({"contact": {"shift_x_m": -3.2e-6, "shift_y_m": 0.0}});
        assert_eq!(joined(friction(&shift)), "shift x -3.200 µm");
    }

    #[test]
    fn several_patches_have_a_line_each() {
        let patch = |y: f64| {
            json!({
                "y_m": y, "normal_force_n": 25.0 - 1e3 * y, "semi_axis_a_m": 4.3e-4, "semi_axis_b_m": 3.4e-4,
                "max_pressure_pa": 77.96e6, "rail_max_rise_k": 0.5,
            })
        };
        let each: Vec<Value> = (0..9).map(|k| patch(1e-3 * f64::from(k))).collect();
        let summary = json!({"contact": {
            "patches": 12, "each_patch": each, "semi_axis_a_m": 1.0, "max_pressure_pa": 77.96e6,
        }});
        assert_eq!(joined(extent(&summary)), "12 patches   p0 77.960 MPa");
        let lines = patches(&summary);
        assert_eq!(lines.len(), 9);
        assert_eq!(lines[1].0, "patch 2");
        let second = "y 1.000 mm   a 430.00 µm   b 340.00 µm   p0 77.960 MPa   N 24.000 N   \
                      rail +0.50000 K";
        assert_eq!(joined(lines[1].1.clone()), second);
        assert_eq!(joined(lines[8].1.clone()), "4 smaller patches: see summary.json");
        assert!(patches(&json!({"contact": {"patches": 1}})).is_empty());
    }
}
