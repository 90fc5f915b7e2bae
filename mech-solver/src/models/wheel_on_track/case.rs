//! A checked case, and the position of a window.

use super::keys::{
    ANGULAR_VELOCITY, CANT, CURVATURE, FLANGE_BACK_DISTANCE, FLANGE_BACK_POSITION, FRICTION, GAUGE,
    GAUGE_HEIGHT, HEIGHT, JOINING, LATERAL_RESOLUTION, NOMINAL_RADIUS, NORMAL, PATCH_INFLUENCE,
    RIGID_SLIP, SIDE, TANGENTIAL, VERTICAL_FORCE, keys,
};
use crate::half_space::influence::Elasticity;
use crate::keys::CheckedParams;
use crate::resolution::RESOLUTION;
use crate::scene::{Material, SPEED, body_keys};
use crate::simplified::flexibility::{self, Kind};
use crate::terms::Terms;
use crate::track::contact::WheelOnRail;
use crate::track::outline::Outline;
use crate::track::profile::orientation::Body;
use crate::track::profile::{Format, Reading, read};
use crate::track::rail::{Deviation, Placing, Side, Track};
use crate::track::settings::{Normal, RigidSlip, Settings, Tangential, Vertical};
use crate::track::wheelset::{Motion, Wheelset};
use proto::bodies::{Bodies, LOWER, UPPER};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::params::Params;
use std::path::Path;
use std::sync::LazyLock;

/// Larger files are refused.
const MOST_BYTES: u64 = 64 << 20;

/// Length that elements are counted over [m].
const CENTIMETRE: f64 = 1e-2;

/// The keys, made once: a history has a position in every row.
static KEYS: LazyLock<Vec<KeySpec>> = LazyLock::new(|| [body_keys(), keys()].concat());

/// A checked case.
pub(super) struct Case {
    pub(super) terms: Terms,
    wheel: Outline,
    rail: Outline,
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
        settings.normal = match case.text(NORMAL)? {
            "kpec" => Normal::Kpec,
            "analyn" => Normal::Analyn,
            _ => Normal::HalfSpace,
        };
        settings.mutual = case.text(PATCH_INFLUENCE)? == "elastic";
        settings.tangential = tangential(&case)?;
        if settings.tangential != Tangential::HalfSpace {
            refuse_on_springs(&settings, upper.poisson_ratio, &names)?;
        }
        let side = if case.text(SIDE)? == "right" { Side::Right } else { Side::Left };
        let placing =
            Placing::Gauge { width: case.number(GAUGE)?, height: case.number(GAUGE_HEIGHT)? };
        let mut remarks = Vec::new();
        let mut profile = |body: usize, of| profile(&case, &names, body, of, &mut remarks);
        Ok(Self {
            wheel: profile(UPPER, Body::Wheel)?,
            rail: profile(LOWER, Body::Rail)?,
            rail_key: names.key(LOWER, "profile"),
            terms,
            side,
            track: Track { placing, cant: case.number(CANT)?, curvature: case.number(CURVATURE)? },
            wheelset: Wheelset {
                flange_back_distance: case.number(FLANGE_BACK_DISTANCE)?,
                flange_back_position: case.number(FLANGE_BACK_POSITION)?,
                nominal_radius: case.number(NOMINAL_RADIUS)?,
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
        WheelOnRail::new(
            [&self.wheel, &self.rail],
            self.side,
            &self.track,
            &self.wheelset,
            settings,
        )
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

/// What gives the tractions.
fn tangential(case: &CheckedParams<'_>) -> Result<Tangential, Refusal> {
    let kind = Kind::of(case.text(flexibility::KEY)?);
    Ok(match case.text(TANGENTIAL)? {
        "fastsim" => Tangential::Fastsim(kind),
        "fastrip" => Tangential::Fastrip(kind),
        _ => Tangential::HalfSpace,
    })
}

/// Refuses what springs do not have.
fn refuse_on_springs(
    settings: &Settings,
    poisson_ratio: f64,
    names: &Bodies,
) -> Result<(), Refusal> {
    if settings.layer > 0.0 {
        let reason = "asks for springs, and a layer between the bodies is on half-spaces alone";
        let fix = "write \"half-space\" here, or leave the layer out";
        return Err(Refusal::new(TANGENTIAL, reason, fix));
    }
    if poisson_ratio < 0.0 {
        let reason =
            format!("has a Poisson's ratio of {poisson_ratio}, and Kalker's table begins at 0");
        let fix =
            format!("name a material whose ratio is 0 or more, or {TANGENTIAL} = \"half-space\"");
        return Err(Refusal::new(&names.key(UPPER, "material"), reason, fix));
    }
    Ok(())
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

/// The profile of a body, from its file.
fn profile(
    case: &CheckedParams<'_>,
    names: &Bodies,
    body: usize,
    of: Body,
    remarks: &mut Vec<String>,
) -> Result<Outline, Refusal> {
    let key = names.key(body, "profile");
    let path = Path::new(case.text(&key)?);
    let refused = |reason: String| {
        let reason = format!("{} {reason}", path.display());
        Refusal::new(&key, reason, "give the profile of a wheel or a rail, in one of its formats")
    };
    let bytes = std::fs::metadata(path).map_err(|error| refused(error.to_string()))?.len();
    if bytes > MOST_BYTES {
        return Err(refused(format!("has {bytes} bytes, and no profile has")));
    }
    let text = std::fs::read(path).map_err(|error| refused(error.to_string()))?;
    let tolerance = case.maybe_number(&names.key(body, "profile_tolerance"))?.unwrap_or(0.0);
    let reading = Reading { tolerance, ..Reading::usual(Format::of(path), of) };
    let outline = read(&text, &reading).map_err(|error| refused(error.to_string()))?;
    let kinks = outline.kinks().count();
    remarks.push(format!(
        "profile of `{}`: {} points, {kinks} kinks, smoothing moves none by more than {:.2} µm",
        names.0[body],
        outline.points().len(),
        1e6 * outline.moved()
    ));
    Ok(outline)
}
