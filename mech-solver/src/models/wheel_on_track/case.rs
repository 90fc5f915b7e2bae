//! A checked case, and the position of a window.

use super::keys::{
    ANGULAR_VELOCITY, AXLE_LOAD, CANT, CURVATURE, FLANGE_BACK_DISTANCE, FLANGE_BACK_POSITION,
    FRICTION, GAUGE, GAUGE_HEIGHT, HEIGHT, JOINING, LATERAL_RESOLUTION, LEFT_SHARE, NOMINAL_RADIUS,
    NORMAL, PATCH_INFLUENCE, PATCH_SURFACE, RIGID_SLIP, ROLL, SIDE, TANGENTIAL, TORQUE,
    VERTICAL_FORCE, keys,
};
use super::shape::{ReadSurface, surface};
use crate::case::difference;
use crate::case::keys::CheckedParams;
use crate::case::noise::Measured;
use crate::case::resolution::RESOLUTION;
use elastic::Elasticity;

use crate::case::scene::{SPEED, body_keys, read_material};
use crate::models::springs;
use crate::terms::Terms;
use proto::bodies::{Bodies, LOWER, UPPER};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::params::Params;
use std::sync::LazyLock;
use wheel_rail::balance::{WheelsetLoads, WheelsetOnTrack};
use wheel_rail::contact::WheelOnRail;
use wheel_rail::profile::orientation::Body;
use wheel_rail::rail::{Deviation, Placing, Side, Track};
use wheel_rail::settings::{Normal, PatchSurface, RigidSlip, Settings, Tangential, Vertical};
use wheel_rail::surface::Surface;
use wheel_rail::wheelset::{Motion, Wheelset};

/// Length along which the elements of the key `mech.resolution` are counted [m].
const CENTIMETRE: f64 = 1e-2;

/// Relative accuracy inside an outer iteration, well below its own tolerance.
const LOOP_TOLERANCE: f64 = 1e-8;

/// Keys, built once because a history reads a position in every row.
static KEYS: LazyLock<Vec<KeySpec>> = LazyLock::new(|| [body_keys(), keys()].concat());

/// A checked case.
pub(super) struct Case {
    pub(super) terms: Terms,
    /// Surfaces of wheel and rail.
    pub(super) surfaces: [Surface; 2],
    rail_key: String,
    sides: Vec<Side>,
    pub(super) track: Track,
    wheelset: Wheelset,
    pub(super) settings: Settings,
    pub(super) remarks: Vec<String>,
    /// Warnings about the profiles.
    pub(super) warnings: Vec<Refusal>,
}

/// Values prescribed in a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Position {
    pub(super) motion: Motion,
    pub(super) deviation: Deviation,
    pub(super) given: WheelsetLoads,
    pub(super) friction: f64,
}

impl Case {
    /// Reads a case, and the files of its profiles.
    ///
    /// # Errors
    /// Values that are missing or out of range; a file that is not a profile; bodies of different
    /// materials.
    pub(super) fn read(configuration: &Configuration, terms: Terms) -> Result<Self, Refusal> {
        let params = &configuration.case;
        let case = CheckedParams::new(params, &KEYS[..]);
        let names = Bodies::read(params)?;
        refuse_radii(&case, &names)?;
        let material = |body| read_material(params, &names, body);
        let (upper, lower) = (material(UPPER)?, material(LOWER)?);
        let bodies = Elasticity::of_pair(&upper, &lower);
        if bodies.is_coupled() {
            return Err(Refusal::new(
                &names.key(UPPER, "material"),
                "different elastic constants of wheel and rail couple pressures and tractions, which \
                 this model neglects",
                "give both bodies the same material, or write [mech] model = \"half-space\"",
            ));
        }
        let along = case.integer(RESOLUTION)?;
        let across = match case.has(LATERAL_RESOLUTION) {
            true => case.integer(LATERAL_RESOLUTION)?,
            false => along,
        };
        let sides = [along, across].map(|count| CENTIMETRE / count as f64);
        let mut settings = Settings::new(sides, [upper, lower]);
        settings.difference = difference::read(params)?;
        settings.joining.distance = case.number(JOINING)?;
        if case.text(RIGID_SLIP)? == "surfaces" {
            settings.rigid_slip = RigidSlip::Surfaces;
        }
        (settings.adhesion, settings.layer) = (terms.adhesion, terms.layer());
        if terms.follow_inputs() {
            settings.tolerance = LOOP_TOLERANCE;
        }
        settings.normal = match case.text(NORMAL)? {
            "kpec" => Normal::Kpec,
            "analyn" => Normal::Analyn,
            _ => Normal::HalfSpace,
        };
        settings.mutual = case.text(PATCH_INFLUENCE)? == "elastic";
        settings.tangential = tangential(&case)?;
        if settings.tangential != Tangential::HalfSpace {
            refuse_on_springs(&settings, &terms, upper.poisson_ratio, &names)?;
        }
        let sides = match case.text(SIDE)? {
            "right" => vec![Side::Right],
            "both" => vec![Side::Left, Side::Right],
            _ => vec![Side::Left],
        };
        refuse_stresses_of_both(&sides, &terms)?;
        let placing =
            Placing::Gauge { width: case.number(GAUGE)?, height: case.number(GAUGE_HEIGHT)? };
        let nominal_radius = case.number(NOMINAL_RADIUS)?;
        let mut remarks = Vec::new();
        let mut surface =
            |body: usize, of| surface(&case, &names, (body, of), nominal_radius, &mut remarks);
        let read = [surface(UPPER, Body::Wheel)?, surface(LOWER, Body::Rail)?];
        let modulus = (upper.compliance() + lower.compliance()).recip();
        let noisy = |(body, read): (usize, &ReadSurface)| {
            let [key, tolerance, wavelength] =
                ["profile", "profile_tolerance", "smoothing_wavelength"]
                    .map(|name| names.key(body, name));
            let measured = Measured {
                key: &key,
                tolerance: &tolerance,
                wavelength: &wavelength,
                points: &read.points,
                smoothing: read.smoothing,
            };
            measured.warning(modulus)
        };
        let warnings = [UPPER, LOWER].into_iter().zip(&read).filter_map(noisy).collect();
        let surfaces = read.map(|read| read.surface);
        refuse_approximate(&settings, &surfaces)?;
        refuse_rough(&settings, &terms)?;
        if case.text(PATCH_SURFACE)? == "curved" {
            settings.patch_surface = PatchSurface::Curved;
            refuse_curved(&settings, &terms, &surfaces)?;
        }
        Ok(Self {
            surfaces,
            rail_key: names.key(LOWER, "profile"),
            terms,
            sides,
            track: Track { placing, cant: case.number(CANT)?, curvature: case.number(CURVATURE)? },
            wheelset: Wheelset {
                flange_back_distance: case.number(FLANGE_BACK_DISTANCE)?,
                flange_back_position: case.number(FLANGE_BACK_POSITION)?,
                nominal_radius,
            },
            settings,
            remarks,
            warnings,
        })
    }

    /// Creates the wheels on their rails, with elements `coarser` times larger and this surface of
    /// the patches.
    ///
    /// # Errors
    /// A rail profile without a gauge point.
    pub(super) fn wheelset_on_track(
        &self,
        coarser: f64,
        patch_surface: PatchSurface,
    ) -> Result<WheelsetOnTrack, Refusal> {
        let mut settings = Settings { patch_surface, ..self.settings };
        settings.sides = settings.sides.map(|side| coarser * side);
        let wheelset = &self.wheelset;
        let wheel = |side: &Side| {
            let wheel =
                WheelOnRail::of_surfaces(&self.surfaces, *side, &self.track, wheelset, settings);
            let wheel = wheel.map_err(|error| {
                let fix = format!("extend the profile, or write another {GAUGE_HEIGHT}");
                Refusal::new(&self.rail_key, error.to_string(), fix)
            })?;
            Ok((*side, wheel))
        };
        let wheels = self.sides.iter().map(wheel).collect::<Result<_, Refusal>>()?;
        Ok(WheelsetOnTrack::new(wheels, settings.tolerance, wheelset))
    }

    /// Returns the position of a window with these values.
    ///
    /// # Errors
    /// A value that is missing or out of range.
    pub(super) fn position(&self, params: &Params) -> Result<Position, Refusal> {
        let case = CheckedParams::new(params, &KEYS[..]);
        let of = |name: &str| case.number(&format!("wheelset.{name}"));
        let off = |name: &str| case.number(&format!("track.deviation.{name}"));
        let speed = case.number(SPEED)?;
        let rolling = speed / self.wheelset.nominal_radius;
        let height = case.maybe_number(HEIGHT)?;
        let vertical = self.vertical(&case, height)?;
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
            given: WheelsetLoads { vertical, torque: case.maybe_number(TORQUE)? },
            friction: case.number(FRICTION)?,
        })
    }
}

impl Case {
    /// Prescribed vertical force or height of the left and the right wheel.
    fn vertical(
        &self,
        case: &CheckedParams<'_>,
        height: Option<f64>,
    ) -> Result<[Vertical; 2], Refusal> {
        let both = self.sides.len() > 1;
        let (wheel, axle) = (case.maybe_number(VERTICAL_FORCE)?, case.maybe_number(AXLE_LOAD)?);
        let refuse = |key: &str, reason: &str, fix: String| Err(Refusal::new(key, reason, fix));
        match (wheel, axle, height) {
            (None, None, Some(_)) => Ok([Vertical::Height; 2]),
            (Some(force), None, None) if !both => Ok([Vertical::Force(force); 2]),
            (None, Some(_), None) if both && case.number(ROLL)? != 0.0 => {
                let reason = "the roll of the wheelset follows from the loads of both wheels";
                refuse(ROLL, reason, format!("write 0, or {HEIGHT} in place of {AXLE_LOAD}"))
            }
            (None, Some(load), None) if both => {
                let share = case.number(LEFT_SHARE)?;
                Ok([share, 1.0 - share].map(|share| Vertical::Force(share * load)))
            }
            (Some(_), None, None) => {
                let reason = "both wheels need the load of the axle and its distribution";
                refuse(VERTICAL_FORCE, reason, format!("write {AXLE_LOAD}, with {LEFT_SHARE}"))
            }
            (None, Some(_), None) => {
                let reason = "a single wheel carries only a part of it";
                refuse(AXLE_LOAD, reason, format!("write {VERTICAL_FORCE}, or {SIDE} = \"both\""))
            }
            _ => {
                let force = if both { AXLE_LOAD } else { VERTICAL_FORCE };
                let reason = "a force or a height is needed";
                refuse(force, reason, format!("write {force} or {HEIGHT}"))
            }
        }
    }
}

/// Reads the theory of the tractions.
fn tangential(case: &CheckedParams<'_>) -> Result<Tangential, Refusal> {
    let kind = springs::flexibility(case)?;
    Ok(match case.text(TANGENTIAL)? {
        "fastsim" => Tangential::Fastsim(kind),
        "fastrip" => Tangential::Fastrip(kind),
        _ => Tangential::HalfSpace,
    })
}

/// Refuses features that are not available with springs.
fn refuse_on_springs(
    settings: &Settings,
    terms: &Terms,
    poisson_ratio: f64,
    names: &Bodies,
) -> Result<(), Refusal> {
    if settings.layer > 0.0 {
        let reason = "asks for springs, but a layer between the bodies needs half-spaces";
        let fix = "write \"half-space\" here, or remove the layer";
        return Err(Refusal::new(TANGENTIAL, reason, fix));
    }
    if terms.friction.follows_elements().is_some() {
        let reason = "asks for springs, but friction that depends on the slip of every element needs half-spaces";
        let fix = "write \"half-space\" here, or let friction depend on the slip of rigid bodies";
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

/// Refuses stresses below both rails: the patches of the other rail would act on them as if in the
/// same plane.
fn refuse_stresses_of_both(sides: &[Side], terms: &Terms) -> Result<(), Refusal> {
    match terms.effect_of(crate::terms::Kind::Observation) {
        Some(effect) if sides.len() > 1 => Err(Refusal::new(
            &format!("effects.{effect}"),
            "two rails lie side by side on one grid, so that the stresses of one would include the load of the other",
            format!("run one wheel at a time with {SIDE}, or remove the effect"),
        )),
        _ => Ok(()),
    }
}

/// Refuses rough surfaces for theories that assume smooth strips.
fn refuse_rough(settings: &Settings, terms: &Terms) -> Result<(), Refusal> {
    let exact = [NORMAL, TANGENTIAL]
        .into_iter()
        .zip([settings.normal == Normal::HalfSpace, settings.tangential == Tangential::HalfSpace]);
    match (terms.effect_of(crate::terms::Kind::Gap), exact.into_iter().find(|(_, exact)| !exact)) {
        (Some(effect), Some((key, _))) => {
            let reason =
                format!("asks for a theory of smooth strips, but effects.{effect} adds heights");
            Err(Refusal::new(key, reason, "write \"half-space\", or remove the effect"))
        }
        _ => Ok(()),
    }
}

/// Refuses features that are not available on curved surfaces.
fn refuse_curved(
    settings: &Settings,
    terms: &Terms,
    surfaces: &[Surface; 2],
) -> Result<(), Refusal> {
    let refuse = |key: &str, reason: &str, fix: &str| {
        let fix = format!("{fix}, or write {PATCH_SURFACE} = \"plane\"");
        Err(Refusal::new(key, reason, fix))
    };
    if let Some(effect) = terms.effect_of(crate::terms::Kind::Observation) {
        let reason = "the stresses are those below a plane, but patches lie on curved surfaces";
        return refuse(&format!("effects.{effect}"), reason, "remove the effect");
    }
    if surfaces.iter().any(|surface| surface.constant().is_none()) {
        let reason =
            "asks for prisms along the track, but these bodies vary along the rolling direction";
        return refuse(PATCH_SURFACE, reason, "remove slices and irregularities");
    }
    let theory = "asks for strips in a plane, but patches lie on curved surfaces";
    if settings.normal != Normal::HalfSpace {
        return refuse(NORMAL, theory, "write \"half-space\"");
    }
    if settings.springs().is_some() {
        return refuse(TANGENTIAL, theory, "write \"half-space\"");
    }
    if settings.mutual {
        let reason = "on curved surfaces only regions of the same patch act on each other";
        return refuse(
            PATCH_INFLUENCE,
            reason,
            "write \"none\" here, and a larger mech.joining_distance",
        );
    }
    Ok(())
}

/// Refuses approximate theories of the pressure on surfaces that vary along x: these theories
/// assume parabolas along x.
fn refuse_approximate(settings: &Settings, surfaces: &[Surface; 2]) -> Result<(), Refusal> {
    let varies = surfaces.iter().any(|surface| surface.constant().is_none());
    match settings.normal != Normal::HalfSpace && varies {
        false => Ok(()),
        true => Err(Refusal::new(
            NORMAL,
            "asks for a theory of bodies that are round along x, but these vary along the rolling direction",
            "write \"half-space\", or remove slices and irregularities",
        )),
    }
}

/// Refuses radii, since profiles and nominal radius already define the shape of the bodies.
fn refuse_radii(case: &CheckedParams<'_>, names: &Bodies) -> Result<(), Refusal> {
    for (body, name) in [UPPER, LOWER]
        .into_iter()
        .flat_map(|body| ["radius_x", "radius_y"].map(|name| (body, name)))
    {
        let key = names.key(body, name);
        if case.has(&key) {
            let reason = "a wheel on a track has a profile and a nominal radius";
            let fix = format!("remove the key; {NOMINAL_RADIUS} is the radius of the wheel");
            return Err(Refusal::new(&key, reason, fix));
        }
    }
    Ok(())
}
