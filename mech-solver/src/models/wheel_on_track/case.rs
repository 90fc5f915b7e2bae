//! A checked case, and the position of a window.

use super::keys::{
    ANGULAR_VELOCITY, CANT, CURVATURE, FLANGE_BACK_DISTANCE, FLANGE_BACK_POSITION, FRICTION, GAUGE,
    GAUGE_HEIGHT, HEIGHT, JOINING, LATERAL_RESOLUTION, NOMINAL_RADIUS, RIGID_SLIP, SIDE,
    VERTICAL_FORCE, keys,
};
use super::shape::surface;
use crate::half_space::influence::Elasticity;
use crate::keys::CheckedParams;
use crate::resolution::RESOLUTION;
use crate::scene::{Material, SPEED, body_keys};
use crate::terms::Terms;
use crate::track::contact::WheelOnRail;
use crate::track::profile::orientation::Body;
use crate::track::rail::{Deviation, Placing, Side, Track};
use crate::track::settings::{RigidSlip, Settings, Vertical};
use crate::track::surface::Surface;
use crate::track::wheelset::{Motion, Wheelset};
use proto::bodies::{Bodies, LOWER, UPPER};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::params::Params;
use std::sync::LazyLock;

/// Length that elements are counted over [m].
const CENTIMETRE: f64 = 1e-2;

/// The keys, made once: a history has a position in every row.
static KEYS: LazyLock<Vec<KeySpec>> = LazyLock::new(|| [body_keys(), keys()].concat());

/// A checked case.
pub(super) struct Case {
    pub(super) terms: Terms,
    /// Wheel and rail.
    surfaces: [Surface; 2],
    rail_key: String,
    side: Side,
    track: Track,
    wheelset: Wheelset,
    pub(super) settings: Settings,
    pub(super) remarks: Vec<String>,
}

/// What a window prescribes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Position {
    pub(super) motion: Motion,
    pub(super) deviation: Deviation,
    pub(super) vertical: Vertical,
    pub(super) friction: f64,
}

impl Case {
    /// Reads a case, and the files of its profiles.
    ///
    /// # Errors
    /// What is missing or out of range, a file that is no profile, bodies of different materials.
    pub(super) fn read(configuration: &Configuration, terms: Terms) -> Result<Self, Refusal> {
        let params = &configuration.case;
        let case = CheckedParams::new(params, &KEYS[..]);
        let names = Bodies::read(params)?;
        refuse_radii(&case, &names)?;
        let material = |body| Material::read(params, &names, body);
        let (upper, lower) = (material(UPPER)?, material(LOWER)?);
        let bodies = Elasticity::of_pair(&upper, &lower);
        if bodies.is_coupled() {
            return Err(Refusal::new(
                &names.key(UPPER, "material"),
                "wheel and rail of different elastic constants act on each other by pressures and tractions, which \
                 this model leaves out",
                "give both bodies the same material, or write [mech] model = \"half-space\"",
            ));
        }
        let along = case.integer(RESOLUTION)?;
        let across = match case.has(LATERAL_RESOLUTION) {
            true => case.integer(LATERAL_RESOLUTION)?,
            false => along,
        };
        let sides = [along, across].map(|count| CENTIMETRE / count as f64);
        let mut settings = Settings::new(sides, bodies);
        settings.joining.distance = case.number(JOINING)?;
        if case.text(RIGID_SLIP)? == "surfaces" {
            settings.rigid_slip = RigidSlip::Surfaces;
        }
        (settings.adhesion, settings.layer) = (terms.adhesion, terms.layer());
        let side = if case.text(SIDE)? == "right" { Side::Right } else { Side::Left };
        let placing =
            Placing::Gauge { width: case.number(GAUGE)?, height: case.number(GAUGE_HEIGHT)? };
        let nominal_radius = case.number(NOMINAL_RADIUS)?;
        let mut remarks = Vec::new();
        let mut surface =
            |body: usize, of| surface(&case, &names, (body, of), nominal_radius, &mut remarks);
        Ok(Self {
            surfaces: [surface(UPPER, Body::Wheel)?, surface(LOWER, Body::Rail)?],
            rail_key: names.key(LOWER, "profile"),
            terms,
            side,
            track: Track { placing, cant: case.number(CANT)?, curvature: case.number(CURVATURE)? },
            wheelset: Wheelset {
                flange_back_distance: case.number(FLANGE_BACK_DISTANCE)?,
                flange_back_position: case.number(FLANGE_BACK_POSITION)?,
                nominal_radius,
            },
            settings,
            remarks,
        })
    }

    /// Wheel and rail in their places, with elements so many times larger.
    ///
    /// # Errors
    /// The profile of the rail has no gauge point.
    pub(super) fn wheel_on_rail(&self, coarser: f64) -> Result<WheelOnRail, Refusal> {
        let mut settings = self.settings;
        settings.sides = settings.sides.map(|side| coarser * side);
        WheelOnRail::of_surfaces(&self.surfaces, self.side, &self.track, &self.wheelset, settings)
            .map_err(|error| {
                let fix = format!("give more of the profile, or write another {GAUGE_HEIGHT}");
                Refusal::new(&self.rail_key, error.to_string(), fix)
            })
    }

    /// The position of a window with these values.
    ///
    /// # Errors
    /// One is missing or out of range.
    pub(super) fn position(&self, params: &Params) -> Result<Position, Refusal> {
        let case = CheckedParams::new(params, &KEYS[..]);
        let of = |name: &str| case.number(&format!("wheelset.{name}"));
        let off = |name: &str| case.number(&format!("track.deviation.{name}"));
        let speed = case.number(SPEED)?;
        let rolling = speed / self.wheelset.nominal_radius;
        let height = case.maybe_number(HEIGHT)?;
        let vertical = match (case.maybe_number(VERTICAL_FORCE)?, height) {
            (Some(force), None) => Vertical::Force(force),
            (None, Some(_)) => Vertical::Height,
            _ => {
                let fix = format!("write {VERTICAL_FORCE} or {HEIGHT}");
                return Err(Refusal::new(VERTICAL_FORCE, "one of force and height is needed", fix));
            }
        };
        Ok(Position {
            motion: Motion {
                way: of("way")?,
                pitch: of("pitch")?,
                y: of("y")?,
                z: height.unwrap_or(0.0),
                roll: of("roll")?,
                yaw: of("yaw")?,
                velocity: [speed, of("lateral_velocity")?, of("vertical_velocity")?],
                roll_rate: of("roll_rate")?,
                yaw_rate: of("yaw_rate")?,
                angular_velocity: case.maybe_number(ANGULAR_VELOCITY)?.unwrap_or(rolling),
            },
            deviation: Deviation {
                y: off("y")?,
                z: off("z")?,
                roll: off("roll")?,
                rates: [off("y_rate")?, off("z_rate")?, off("roll_rate")?],
            },
            vertical,
            friction: case.number(FRICTION)?,
        })
    }
}

/// Refuses what would say the shape of a body twice.
fn refuse_radii(case: &CheckedParams<'_>, names: &Bodies) -> Result<(), Refusal> {
    for (body, name) in [UPPER, LOWER]
        .into_iter()
        .flat_map(|body| ["radius_x", "radius_y"].map(|name| (body, name)))
    {
        let key = names.key(body, name);
        if case.has(&key) {
            let reason = "a wheel on a track has a profile and a nominal radius";
            let fix = format!("remove the key; {NOMINAL_RADIUS} is that of the wheel");
            return Err(Refusal::new(&key, reason, fix));
        }
    }
    Ok(())
}
