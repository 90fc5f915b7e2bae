//! Keys of track, wheelset and elements.

use super::shape;
use crate::case::difference;
use crate::case::resolution::RESOLUTION;
use crate::case::scene::SPEED;
use crate::models::springs;
use proto::accuracy::Refinement;
use proto::description::KeySpec;

/// Default number of elements per centimetre, 0.2 mm each.
const RESOLUTION_OF_CONTACT: i64 = 50;

pub(super) const VERTICAL_FORCE: &str = "load.vertical_force";
pub(super) const AXLE_LOAD: &str = "load.axle_load";
pub(super) const LEFT_SHARE: &str = "load.left_share";
pub(super) const HEIGHT: &str = "wheelset.z";
/// Key group of the vertical prescription.
const VERTICAL: &str = "wheelset.vertical";
/// Key group of the rotation of the axle.
const TURNING: &str = "wheelset.turning";

pub(super) const SIDE: &str = "wheelset.side";
pub(super) const GAUGE: &str = "track.gauge";
pub(super) const GAUGE_HEIGHT: &str = "track.gauge_height";
pub(super) const CANT: &str = "track.cant";
pub(super) const CURVATURE: &str = "track.curvature";
pub(super) const FLANGE_BACK_DISTANCE: &str = "wheelset.flange_back_distance";
pub(super) const FLANGE_BACK_POSITION: &str = "wheelset.flange_back_position";
pub(super) const NOMINAL_RADIUS: &str = "wheelset.nominal_radius";
pub(super) const ANGULAR_VELOCITY: &str = "wheelset.angular_velocity";
pub(super) const TORQUE: &str = "wheelset.torque";
pub(super) const ROLL: &str = "wheelset.roll";
pub(super) const FRICTION: &str = "friction.coefficient";
pub(super) const LATERAL_RESOLUTION: &str = "mech.lateral_resolution";
pub(super) const JOINING: &str = "mech.joining_distance";
pub(super) const RIGID_SLIP: &str = "mech.rigid_slip";
pub(super) const PATCH_INFLUENCE: &str = "mech.patch_influence";
pub(super) const PATCH_SURFACE: &str = "mech.patch_surface";
pub(super) const NORMAL: &str = "mech.normal";
pub(super) const TANGENTIAL: &str = "mech.tangential";

/// Keys of the model, in addition to those of the bodies.
pub(super) fn keys() -> Vec<KeySpec> {
    [shape::keys(), track(), wheelset(), load(), elements()].concat()
}

/// Largest plausible shift [m], rotation [rad] or rate of a body on a track.
fn of_unit(unit: &str) -> f64 {
    match unit {
        "m" => 0.1,
        "1" => 0.2,
        _ => 10.0,
    }
}

fn track() -> Vec<KeySpec> {
    let deviation = |name: &str, unit: &str, help: &str| {
        KeySpec::quantity(&format!("track.deviation.{name}"), unit, help)
            .default_value(0.0)
            .expected(
                0.0..=of_unit(unit),
                "a larger displacement would break the rail; check the unit",
            )
            .varies()
    };
    vec![
        KeySpec::quantity(GAUGE, "m", "distance of the gauge points of both rails")
            .expected(0.5..=3.0, "from mine railways to the broadest gauge; check the unit")
            .default_value(1.435)
            .above(0.0),
        KeySpec::quantity(GAUGE_HEIGHT, "m", "depth below the top of the rail at which the gauge is measured")
            .expected(1e-3..=0.05, "from 10 to 16 mm on railways; check the unit")
            .default_value(0.014)
            .above(0.0),
        KeySpec::number(
            CANT,
            "inclination of the rails to the middle of the track [rad], 0.05 for 1:20; 0 if profiles are measured inclined",
        )
        .expected(0.0..=0.2, "rails are inclined by 1:40 to 1:20; check the unit, which is rad")
        .default_value(0.0),
        KeySpec::quantity(CURVATURE, "1/m", "curvature of the line, positive to the left")
            .expected(1e-6..=0.1, "the tightest curves of trams have 15 m; this is 1/R, not R")
            .default_value(0.0),
        deviation("y", "m", "displacement of the rail to the left"),
        deviation("z", "m", "the same, up"),
        deviation("roll", "1", "turn of the rail about the origin of its profile, from y to z [rad]"),
        deviation("y_rate", "m/s", "rate of the shift to the left"),
        deviation("z_rate", "m/s", "rate of the shift up"),
        deviation("roll_rate", "1/s", "rate of the turn [rad/s]"),
    ]
}

fn wheelset() -> Vec<KeySpec> {
    let varying = |name: &str, unit: &str, help: &str| {
        KeySpec::quantity(&format!("wheelset.{name}"), unit, help).default_value(0.0).varies()
    };
    let small = |name: &str, unit: &str, help: &str| {
        let why = "a wheelset on the track deviates by less; check the unit";
        varying(name, unit, help).expected(0.0..=of_unit(unit), why)
    };
    vec![
        KeySpec::choice(SIDE, &["left", "right", "both"], "side of wheel and rail, or both")
            .default_value("left"),
        KeySpec::quantity(FLANGE_BACK_DISTANCE, "m", "distance of the flange backs of the wheels")
            .expected(0.4..=3.0, "somewhat less than the gauge; check the unit")
            .default_value(1.36)
            .above(0.0),
        KeySpec::quantity(
            FLANGE_BACK_POSITION,
            "m",
            "y of the flange back in the axes of the profile, to the field side",
        )
        .default_value(-0.07),
        KeySpec::quantity(NOMINAL_RADIUS, "m", "radius at z = 0 of the profile")
            .required()
            .expected(0.05..=2.0, "from trolleys to the largest locomotives; check the unit")
            .above(0.0),
        varying(
            "way",
            "m",
            "distance of the wheelset along the track, over which the rail and friction may vary",
        ),
        varying(
            "pitch",
            "1",
            "angle by which the wheelset has turned, rolling forward [rad]; matters for wheels that are not round",
        ),
        small("y", "m", "shift of the wheelset to the left"),
        small("roll", "1", "roll, from y to z [rad]; computed for both wheels under an axle load"),
        small("yaw", "1", "yaw, from x to y [rad]"),
        small("lateral_velocity", "m/s", "velocity to the left"),
        small("vertical_velocity", "m/s", "velocity up"),
        small("roll_rate", "1/s", "rate of roll [rad/s]"),
        small("yaw_rate", "1/s", "rate of yaw [rad/s]"),
        KeySpec::quantity(
            ANGULAR_VELOCITY,
            "1/s",
            "angular velocity about the axle [rad/s]; absent: motion.speed over the nominal radius",
        )
        .one_of_or_none(TURNING)
        .above(0.0)
        .varies(),
        KeySpec::quantity(
            TORQUE,
            "N m",
            "torque that drives the axle forward, in balance with the contact forces; 0: free rolling; the angular velocity is computed",
        )
        .one_of_or_none(TURNING)
        .varies(),
    ]
}

fn load() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(VERTICAL_FORCE, "N", "vertical force on the wheel, pressures and tractions together")
            .expected(1e-6..=5e6, "heavy axles press with 2e5 N; check the unit")
            .one_of(VERTICAL)
            .above(0.0)
            .varies(),
        KeySpec::quantity(
            AXLE_LOAD,
            "N",
            "vertical force on both wheels together; height and roll of the wheelset are computed",
        )
        .expected(1e-6..=1e7, "heavy axles press with 4e5 N; check the unit")
        .one_of(VERTICAL)
        .above(0.0)
        .varies(),
        KeySpec::number(LEFT_SHARE, "share of the axle load that the left wheel carries")
            .default_value(0.5)
            .at_least(1e-3)
            .at_most(0.999)
            .varies(),
        KeySpec::quantity(
            HEIGHT,
            "m",
            "height of the wheelset above the position in which circles of the nominal radius touch the tops of the rails",
        )
        .one_of(VERTICAL)
        .varies(),
        KeySpec::quantity(SPEED, "m/s", "speed of the wheelset along the track")
            .expected(0.0..=200.0, "the fastest trains reach 160 m/s; km/h is accepted too")
            .required()
            .above(0.0)
            .varies(),
        KeySpec::number(FRICTION, "friction coefficient")
            .expected(0.0..=1.0, "dry steel has 0.3 to 0.6")
            .required()
            .above(0.0)
            .varies(),
    ]
}

fn elements() -> Vec<KeySpec> {
    let count =
        |path: &str, help: &str| KeySpec::integer(path, help).at_least(2.0).at_most(10_000.0);
    vec![
        count(RESOLUTION, "elements along a centimetre: dx = 10 mm/resolution")
            .default_value(RESOLUTION_OF_CONTACT),
        difference::key(),
        count(LATERAL_RESOLUTION, "elements across a centimetre of the tape; absent: as along"),
        KeySpec::quantity(
            JOINING,
            "m",
            "distance below which two regions form one patch",
        )
        .default_value(4e-3)
        .at_least(0.0),
        KeySpec::choice(
            RIGID_SLIP,
            &["surfaces", "plane"],
            "location of the rigid slip: the surfaces, whose rolling radius varies across a patch, or the plane of the patch",
        )
        .default_value("surfaces"),
        KeySpec::choice(
            PATCH_INFLUENCE,
            &["none", "elastic"],
            "mutual influence of patches: none, or the pressure of each displaces the surfaces under the others",
        )
        .default_value("none"),
        KeySpec::choice(
            PATCH_SURFACE,
            &["plane", "curved"],
            "surface of a patch: a plane between half-spaces, or a surface that follows the profiles (conformal \
             contact) between bodies that are prisms along the track",
        )
        .default_value("plane"),
        KeySpec::choice(
            NORMAL,
            &["half-space", "kpec", "analyn"],
            "theory of the pressure: half-spaces, or as an approximation virtual penetration with an equivalent ellipse \
             (KPEC), or Hertz row by row (ANALYN)",
        )
        .default_value("half-space"),
        KeySpec::choice(
            TANGENTIAL,
            &["half-space", "fastsim", "fastrip"],
            "theory of the tractions where surfaces may stick: half-spaces, or as an approximation springs under the bound \
             of the pressure (FASTSIM), or strip theory where they stick (FASTRIP)",
        )
        .default_value("half-space"),
        springs::flexibility_key(),
    ]
}

/// Convergence of the error with the resolution: as in model `half-space`, for a contact with
/// semi-axes of about 6 mm.
pub(super) fn refinement() -> Refinement {
    Refinement {
        key: RESOLUTION.to_owned(),
        levels: vec![10, 20, 40, 80, 160],
        order: 1.0,
        error: 0.02,
        source: "the tests of model `half-space`, and wheel-on-track at these resolutions"
            .to_owned(),
    }
}
