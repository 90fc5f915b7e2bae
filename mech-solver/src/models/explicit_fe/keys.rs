//! Keys of the case, and default sizes.

use super::surfaces::Surfaces;
use crate::case::keys::CheckedParams;
use crate::case::scene::Scene;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;
use proto::readable::quantity;

/// Default number of elements per semi-axis; 0.6 mm in the contact of a wheel.
pub(super) const RESOLUTION: usize = 13;
/// Default half length of the blocks, in semi-axes of the contact.
const WHOLE: f64 = 6.0;
/// Space beside a wide contact, in semi-axes.
const ROOM: f64 = 4.5;
/// Depth of the fine zone, in semi-axes.
const FINE_DEPTH: f64 = 0.75;
/// Largest half width and depth of a curved body, relative to its radii.
const CURVED: f64 = 0.95;
/// Density of steel [kg/m³].
const STEEL: f64 = 7850.0;
/// Largest mass scaling for which creepage and temperature were compared with unscaled results.
const VERIFIED_SCALING: f64 = 25.0;

/// Key: density of a material.
pub(super) const DENSITY: &str = "density";
const LENGTH: &str = "mech.length";
const WIDTH: &str = "mech.width";
/// Key: depth of the elements.
pub(super) const DEPTH: &str = "mech.depth";
/// Key: stiffness of a penalty contact.
pub(super) const PENALTY: &str = "mech.penalty_stiffness";
/// Key: mass scaling of the elements.
pub(super) const MASS_SCALING: &str = "mech.mass_scaling";

/// Keys that are specific to this model.
pub(super) fn own_keys() -> Vec<KeySpec> {
    let size = |key: &str, of: &str| {
        let help =
            format!("{of} of the elements of a body; absent: twelve semi-axes of the contact");
        KeySpec::quantity(key, "m", &help).above(0.0)
    };
    vec![
        KeySpec::quantity(
            &format!("materials.*.{DENSITY}"),
            "kg/m^3",
            "density; steady rolling hardly depends on it",
        )
        .above(0.0)
        .default_value(STEEL),
        size(LENGTH, "length"),
        size(WIDTH, "width"),
        KeySpec::quantity(
            PENALTY,
            "Pa/m",
            "stiffness of a penalty contact, for overlap and for sticking; absent: Lagrange multipliers \
             without overlap",
        )
        .above(0.0),
        KeySpec::number(
            MASS_SCALING,
            "density of the elements over that of their material: steps grow with its square root, and inertia matters more",
        )
        .at_least(1.0)
        .at_most(VERIFIED_SCALING)
        .default_value(1.0),
        KeySpec::quantity(
            DEPTH,
            "m",
            "depth of the elements of a body; absent: half of their length",
        )
        .above(0.0),
    ]
}

/// Sizes of the blocks of elements [m].
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Length along the motion.
    pub(super) length: f64,
    /// Half the width and the depth of the blocks.
    pub(super) whole: [f64; 2],
    /// Half the width and the depth of the fine zone.
    pub(super) fine: [f64; 2],
    /// Half the length and half the width of the region searched for contact.
    pub(super) watched: [f64; 2],
}

impl Extent {
    /// Reads the sizes of a case. The contact may become `growth` times as long and wide as under
    /// the load.
    ///
    /// # Errors
    /// Sizes that leave no room for the contact, or exceed a radius of a body.
    pub(super) fn read(
        case: &Params,
        scene: &Scene,
        surfaces: &Surfaces,
        growth: f64,
    ) -> Result<Self, Refusal> {
        let [a, b] = [surfaces.ellipse.semi_axis_a, surfaces.ellipse.semi_axis_b];
        let watched = surfaces.watched.map(|half| growth * half);
        let own = CheckedParams::new(case, own_keys());
        let size = |key: &str| own.maybe_number(key);
        let room = (WHOLE * a.max(b)).max(watched[1] + ROOM * a);
        let length = size(LENGTH)?.unwrap_or(2.0 * WHOLE * a);
        let width = size(WIDTH)?.unwrap_or(2.0 * room);
        let depth = size(DEPTH)?.unwrap_or(0.5 * length.max(width));
        let fine = [watched[1], FINE_DEPTH * a.min(b)];
        for (key, given, least) in [
            (LENGTH, length, 2.0 * watched[0]),
            (WIDTH, width, 4.0 * fine[0]),
            (DEPTH, depth, 4.0 * fine[1]),
        ] {
            if given < least {
                let reason = format!(
                    "{given} leave no room round the contact",
                    given = quantity(given, "m", 5)
                );
                let fix = format!(
                    "write more than {least}, or leave it out",
                    least = quantity(least, "m", 5)
                );
                return Err(Refusal::new(key, reason, fix));
            }
        }
        for (key, size, of) in [(WIDTH, 0.5 * width, 0), (DEPTH, depth, 1)] {
            for body in &scene.bodies {
                let most = CURVED * [body.radius_y, body.radius_x][of].abs();
                if size > most {
                    let reason = format!(
                        "with {size} elements reach the centre of curvature of a body",
                        size = quantity(size, "m", 5)
                    );
                    let fix = format!(
                        "write less than {}, or leave it out",
                        quantity([2.0, 1.0][of] * most, "m", 5)
                    );
                    return Err(Refusal::new(key, reason, fix));
                }
            }
        }
        Ok(Self { length, whole: [0.5 * width, depth], fine, watched })
    }
}
