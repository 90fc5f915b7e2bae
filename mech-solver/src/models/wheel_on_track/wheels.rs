//! Figures of each wheel of a wheelset on both rails: sections `wheelset.left` and
//! `wheelset.right` of `summary.json`.

use proto::figure::FigureSpec;
use serde_json::{Value, json};
use wheel_rail::patch::{Patch, Solved};

/// Figures of the left and the right wheel.
pub(super) fn wheel_figures() -> Vec<FigureSpec> {
    let of = |side: &str| {
        let figure = |name: &str, unit, words: &str| {
            let words = format!("{words}, {side} wheel");
            FigureSpec::new(&format!("wheelset.{side}.{name}"), unit, &words)
        };
        let shown = |name: &str, words: &str, short| figure(name, "N", words).on(side, short);
        [
            shown("force_x_n", "force along the track", "F_x"),
            shown("force_y_n", "force to the left", "F_y"),
            shown("force_z_n", "force up", "F_z").headline(),
            figure("normal_force_n", "N", "normal force"),
            figure("axle_moment_nm", "Nm", "moment about the axle"),
            figure("friction_power_w", "W", "friction power"),
            figure("patches", "1", "number of patches"),
        ]
    };
    ["left", "right"].into_iter().flat_map(of).collect()
}

/// Figures of one wheel.
pub(super) fn of_wheel(solved: &Solved) -> Value {
    let sum = |of: &dyn Fn(&Patch) -> f64| solved.patches.iter().map(of).sum::<f64>();
    let [fx, fy, fz] = solved.force;
    json!({
        "force_x_n": fx,
        "force_y_n": fy,
        "force_z_n": fz,
        "normal_force_n": sum(&|patch| patch.load.force[2]),
        "axle_moment_nm": solved.moment_wheelset[1],
        "friction_power_w": sum(&|patch| patch.friction_power),
        "patches": solved.patches.len(),
    })
}
