//! Figures of a wheel on a track: sections `contact` and `wheelset` of `summary.json`.

use super::case::Position;
use super::wheels::{of_wheel, wheel_figures};
use crate::figures::indicators::{SlipZone, add_slip_zone};
use proto::diagram::{Curve, Diagram};
use proto::figure::{FigureSpec, Style};
use serde_json::{Value, json};
use wheel_rail::balance::{WheelsetLoads, WheelsetOnTrack, WheelsetSolution};
use wheel_rail::patch::{Patch, Solved};
use wheel_rail::rail::Side;
use wheel_rail::settings::Vertical;

/// Figures that are specific to this model.
pub(in crate::models) fn figures() -> Vec<FigureSpec> {
    let wheelset = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("wheelset.{name}"), unit, words).on("wheelset", short)
    };
    let turned =
        |name: &str, unit, words| FigureSpec::new(&format!("wheelset.axes.{name}"), unit, words);
    let patch = |name: &str, unit, words| {
        FigureSpec::new(&format!("contact.each_patch.#.{name}"), unit, words)
    };
    let own = vec![
        wheelset("z_m", "m", "height of the wheelset", "z").style(Style::Place).headline(),
        wheelset("roll_rad", "rad", "roll under the loads of both wheels", "roll"),
        wheelset(
            "angular_velocity_rad_per_s",
            "rad/s",
            "angular velocity about the axle under the torque",
            "Ω",
        )
        .digits(8)
        .headline(),
        wheelset("force_x_n", "N", "force on the wheel along the track", "F_x"),
        wheelset("force_y_n", "N", "force on the wheel to the left", "F_y").headline(),
        wheelset("force_z_n", "N", "force on the wheel up", "F_z").headline(),
        wheelset(
            "moment_x_nm",
            "Nm",
            "moment on the wheel about the track's x through the middle of the axle",
            "M_x",
        ),
        wheelset("moment_y_nm", "Nm", "moment on the wheel about the track's y", "M_y"),
        wheelset("moment_z_nm", "Nm", "moment on the wheel about the track's z", "M_z"),
        turned(
            "force_x_n",
            "N",
            "force on the wheel across the axle, forward, in the wheelset's axes",
        ),
        turned("force_y_n", "N", "force on the wheel along the axle, to the left"),
        turned("force_z_n", "N", "force on the wheel across the axle, up"),
        turned("moment_x_nm", "Nm", "moment on the wheel about the wheelset's x"),
        turned("moment_y_nm", "Nm", "moment on the wheel about the axle"),
        turned("moment_z_nm", "Nm", "moment on the wheel about the wheelset's z"),
        patch("angle_rad", "rad", "contact angle, from the track's y to the patch's")
            .on("patch", "angle")
            .digits(4),
        patch("track_y_m", "m", "position in track axes, y")
            .on("patch", "track y")
            .style(Style::Place),
        patch("track_z_m", "m", "position in track axes, z"),
        patch("rail_y_m", "m", "position on the rail's profile, y to the left"),
        patch("wheel_y_m", "m", "position on the wheel's profile, y to the left"),
        patch("approach_m", "m", "approach"),
        patch("area_m2", "m2", "area"),
        patch("creep_force_x_n", "N", "creep force x"),
        patch("creep_force_y_n", "N", "creep force along the tape"),
        patch("spin_moment_nm", "Nm", "spin moment"),
        patch("creepage_xi", "1", "creepage along x"),
        patch("creepage_eta", "1", "creepage along the tape"),
        patch("creepage_phi_per_m", "rad/m", "spin"),
        patch("friction_power_w", "W", "friction power"),
    ];
    [own, wheel_figures()].concat()
}

/// Profiles of wheel and rail with their patches, one diagram per side.
pub(in crate::models) fn diagrams() -> Vec<Diagram> {
    let curve = |side: &str, body: &str| Curve {
        name: body.to_owned(),
        key: format!("wheelset.{side}.profiles_m.{body}"),
    };
    let of = |side| {
        let note = "Profiles in track axes, y to the left, the wheel cut through its axle; marks are patches.";
        let axes = ["contact.each_patch.#.track_y_m", "contact.each_patch.#.track_z_m"];
        let diagram = Diagram::new(&format!("Wheel on rail, {side}"), axes, note);
        let curves = ["rail", "wheel"].map(|body| curve(side, body)).to_vec();
        Diagram { curves, true_shape: true, ..diagram }
    };
    ["left", "right"].map(of).to_vec()
}

/// Number of points of a profile in the summary.
const POINTS: usize = 120;

/// Summary of a solution; `shift` is the difference between y on the grid and the tape distance of
/// a rail [m].
pub(super) fn summary(
    balanced: &WheelsetSolution,
    position: &Position,
    wheelset: &WheelsetOnTrack,
    shift: &dyn Fn(Side) -> f64,
) -> Value {
    // Sorted from right to left, as on the grid.
    let patches: Vec<(&Patch, Side)> = balanced
        .wheels
        .iter()
        .rev()
        .flat_map(|(side, solved)| solved.patches.iter().map(|patch| (patch, *side)))
        .collect();
    let sum = |of: &dyn Fn(&Patch) -> f64| patches.iter().map(|(patch, _)| of(patch)).sum::<f64>();
    let largest =
        |of: &dyn Fn(&Patch) -> f64| patches.iter().map(|(patch, _)| of(patch)).fold(0.0, f64::max);
    let figures = |(patch, side): &(&Patch, Side)| {
        let mut figures = of_patch(patch, shift(*side));
        if balanced.wheels.len() > 1 {
            figures["name"] = format!("{} wheel", side_name(*side)).into();
        }
        figures
    };
    let area = sum(&|patch| patch.area);
    let mut contact = json!({
        "patches": patches.len(),
        "max_pressure_pa": largest(&|patch| patch.max_pressure),
        "normal_force_n": sum(&|patch| patch.load.force[2]),
        "area_m2": area,
        "friction_power_w": sum(&|patch| patch.friction_power),
        "max_slip_velocity_m_per_s": largest(&largest_slip),
        "max_traction_pa": largest(&largest_traction),
    });
    if area > 0.0 {
        let slips = sum(&|patch| patch.slip_area_ratio * patch.area);
        contact["slip_area_ratio"] = (slips / area).into();
    }
    let mut zone = SlipZone::default();
    for (Patch { fields, .. }, _) in &patches {
        zone.add(fields.counts[0], &fields.element, &fields.friction_power);
    }
    add_slip_zone(&mut contact, &zone);
    match patches.as_slice() {
        [] => {}
        [one] => {
            let keys = [
                "approach_m",
                "creep_force_x_n",
                "creep_force_y_n",
                "spin_moment_nm",
                "creepage_xi",
                "creepage_eta",
                "creepage_phi_per_m",
            ];
            let figures = figures(one);
            keys.iter().for_each(|key| contact[*key] = figures[*key].clone());
            contact["each_patch"] = json!([figures]);
        }
        _ => {
            contact["each_patch"] = patches.iter().map(figures).collect();
        }
    }
    let mut own = of_wheelset(balanced, &position.given);
    for (side, [rail, wheel]) in wheelset.outlines(&balanced.motion, &position.deviation, POINTS) {
        own[side_name(side)]["profiles_m"] = json!({ "rail": rail, "wheel": wheel });
    }
    json!({ "contact": contact, "wheelset": own })
}

/// Figures of the wheelset.
fn of_wheelset(balanced: &WheelsetSolution, given: &WheelsetLoads) -> Value {
    let sum = |of: fn(&Solved) -> [f64; 3]| balanced.sum(of);
    let ([fx, fy, fz], [mx, my, mz]) = (sum(|solved| solved.force), sum(|solved| solved.moment));
    let [ax, ay, az] = sum(|solved| solved.force_wheelset);
    let [bx, by, bz] = sum(|solved| solved.moment_wheelset);
    let mut wheelset = json!({
        "z_m": balanced.motion.z,
        "force_x_n": fx, "force_y_n": fy, "force_z_n": fz,
        "moment_x_nm": mx, "moment_y_nm": my, "moment_z_nm": mz,
        "axes": {
            "force_x_n": ax, "force_y_n": ay, "force_z_n": az,
            "moment_x_nm": bx, "moment_y_nm": by, "moment_z_nm": bz,
        },
    });
    if given.torque.is_some() {
        wheelset["angular_velocity_rad_per_s"] = balanced.motion.angular_velocity.into();
    }
    if let [left, right] = balanced.wheels.as_slice() {
        for (side, solved) in [left, right] {
            wheelset[side_name(*side)] = of_wheel(solved);
        }
        if given.vertical[0] != Vertical::Height {
            wheelset["roll_rad"] = balanced.motion.roll.into();
        }
    }
    wheelset
}

fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

/// Creepages below this value are rounding errors, since they are differences of speeds divided by
/// a speed.
const ROUNDING: f64 = 1e-15;

/// Figures of a patch; `shift` is the difference between y on the grid and the tape distance [m].
/// Moment and creepages refer to the reference point of the patch, which, unlike the origin of its
/// fields, does not jump from element to element.
fn of_patch(patch: &Patch, shift: f64) -> Value {
    let [fx, fy, n] = patch.load.force;
    let [along, tangent, _] = patch.frame.axes();
    let from_origin = patch.frame.reference - patch.frame.origin;
    let [x, y] = [along, tangent].map(|axis| axis.dot(&from_origin));
    let [xi, eta, phi] = patch.rolling.creepage;
    let known = |creepage: f64| if creepage.abs() < ROUNDING { 0.0 } else { creepage };
    let [xi, eta] = [xi - phi * y, eta + phi * x].map(known);
    let moment = patch.load.moment[2] - (x * fy - y * fx);
    json!({
        "y_m": patch.tape + shift,
        "angle_rad": patch.frame.angle,
        "track_y_m": patch.frame.reference.y,
        "track_z_m": patch.frame.reference.z,
        "rail_y_m": patch.in_rail[0],
        "wheel_y_m": patch.in_wheel[1],
        "approach_m": patch.approach,
        "area_m2": patch.area,
        "max_pressure_pa": patch.max_pressure,
        "normal_force_n": n,
        "creep_force_x_n": fx,
        "creep_force_y_n": fy,
        "spin_moment_nm": moment,
        "creepage_xi": xi,
        "creepage_eta": eta,
        "creepage_phi_per_m": phi,
        "friction_power_w": patch.friction_power,
    })
}

fn largest_slip(patch: &Patch) -> f64 {
    size(&patch.fields.slip_velocity)
}

fn largest_traction(patch: &Patch) -> f64 {
    size(&patch.fields.traction)
}

/// Largest magnitude of a vector field.
fn size([x, y]: &[Vec<f64>; 2]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max)
}
