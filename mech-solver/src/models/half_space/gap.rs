//! The undeformed distance of wheel and rail.
//!
//! h(x, y) = x²/(2R(y)) + z_w(y − s) − z_r(y) + roughness, less the smallest value of the part
//! without roughness; z_w and z_r are the lateral shapes of wheel and rail, s the lateral shift of
//! the wheel. A measured wheel has the rolling radius R(y) = R + z_w(0) − z_w(y − s). The distance
//! is taken along z, which is the contact normal for small contact angles only; a steeper contact
//! is refused.

use crate::effects::roughness::{self, Roughness};
use crate::half_space::curve::Curve;
use crate::half_space::extent::Fitted;
use crate::half_space::patches::patches;
use crate::half_space::profile::Profile;
use crate::keys::CheckedParams;
use crate::scene::{CROWN_RADIUS, RAIL_SHAPE, Scene};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::grid::Structured;
use std::path::Path;

/// Points at which the lateral distance is searched for its smallest value.
const SAMPLES: usize = 2000;
/// Steepest contact that is treated as plane [rad].
const STEEPEST: f64 = 0.2;
/// How much higher than the lowest place another one may be to count as touching at once, over the
/// range of heights: rounding.
const TIE: f64 = 1e-9;

pub(super) const RAIL_PROFILE: &str = "rail.profile";
const WHEEL_PROFILE: &str = "wheel.profile";
const RAIL_TOLERANCE: &str = "rail.profile_tolerance";
const WHEEL_TOLERANCE: &str = "wheel.profile_tolerance";
const LATERAL_SHIFT: &str = "wheel.lateral_shift";

/// The keys that the shapes are read from besides the scene's.
pub(super) fn keys() -> Vec<KeySpec> {
    let tolerance = |key: &str| {
        let help = "how far smoothing may move a point of the profile; absent: through all points";
        KeySpec::quantity(key, "m", help).at_least(0.0)
    };
    vec![
        KeySpec::file(RAIL_PROFILE, "measured lateral profile of the rail: y and z, z up")
            .one_of(RAIL_SHAPE),
        KeySpec::file(WHEEL_PROFILE, "measured lateral profile of the wheel as it stands: y and z"),
        tolerance(RAIL_TOLERANCE),
        tolerance(WHEEL_TOLERANCE),
        KeySpec::quantity(LATERAL_SHIFT, "m", "lateral shift of a measured wheel, to the left")
            .default_value(0.0),
    ]
}

/// Lateral shape of a body.
#[derive(Clone, Debug)]
enum Shape {
    /// z = ½ κ y².
    Curvature(f64),
    Profile(Profile),
}

impl Shape {
    fn height(&self, y: f64) -> f64 {
        match self {
            Self::Curvature(curvature) => 0.5 * curvature * y * y,
            Self::Profile(profile) => profile.height(y),
        }
    }

    fn slope(&self, y: f64) -> f64 {
        match self {
            Self::Curvature(curvature) => curvature * y,
            Self::Profile(profile) => profile.slope(y),
        }
    }

    fn range(&self, shift: f64) -> [f64; 2] {
        match self {
            Self::Curvature(_) => [f64::NEG_INFINITY, f64::INFINITY],
            Self::Profile(profile) => profile.range().map(|end| end + shift),
        }
    }
}

/// The undeformed distance.
#[derive(Clone, Debug)]
pub(super) struct Gap {
    wheel: Shape,
    rail: Shape,
    wheel_radius: f64,
    shift: f64,
    /// Smallest lateral distance [m].
    closest: f64,
    /// Lateral coordinate of the origin [m].
    pub(super) origin: f64,
    roughness: Option<Roughness>,
}

impl Gap {
    /// There is roughness on the surfaces.
    pub(super) fn is_rough(&self) -> bool {
        self.roughness.is_some()
    }

    /// Reads the shapes.
    pub(super) fn read(configuration: &Configuration, scene: &Scene) -> Result<Self, Refusal> {
        let case = CheckedParams::new(&configuration.case, keys());
        let measured = |key: &str, tolerance: &str| -> Result<Option<Shape>, Refusal> {
            let within = case.maybe_number(tolerance)?;
            if !case.has(key) {
                return match within {
                    Some(_) => Err(Refusal::new(
                        tolerance,
                        "smooths a measured profile, and there is none",
                        format!("add `{key}`, or remove the key"),
                    )),
                    None => Ok(None),
                };
            }
            let path = case.text(key)?;
            let wrong = |error| {
                Refusal::new(
                    key,
                    format!("`{path}`: {error}"),
                    "see docs/theory/half-space.md for the format",
                )
            };
            Profile::read(Path::new(path), within.unwrap_or(0.0))
                .map(|p| Some(Shape::Profile(p)))
                .map_err(wrong)
        };
        let rail = match (measured(RAIL_PROFILE, RAIL_TOLERANCE)?, scene.rail_crown_radius) {
            (Some(profile), None) => profile,
            (None, Some(radius)) => Shape::Curvature(-1.0 / radius),
            (None, None) => {
                return Err(Refusal::new(
                    CROWN_RADIUS,
                    "missing",
                    format!("add `{CROWN_RADIUS}` or `{RAIL_PROFILE}`"),
                ));
            }
            (Some(_), Some(_)) => {
                return Err(Refusal::new(
                    RAIL_PROFILE,
                    format!("excludes `{CROWN_RADIUS}`"),
                    "keep one of them",
                ));
            }
        };
        let wheel = match measured(WHEEL_PROFILE, WHEEL_TOLERANCE)? {
            Some(_) if scene.tread_curvature != 0.0 => {
                return Err(Refusal::new(
                    WHEEL_PROFILE,
                    "excludes `wheel.tread_radius`",
                    "keep one of them",
                ));
            }
            Some(profile) => profile,
            None => Shape::Curvature(scene.tread_curvature),
        };
        let shift = case.number(LATERAL_SHIFT)?;
        if shift != 0.0 && matches!(wheel, Shape::Curvature(_)) {
            return Err(Refusal::new(
                LATERAL_SHIFT,
                "shifts a measured wheel, and this one has no profile",
                format!("add `{WHEEL_PROFILE}`, or remove the key"),
            ));
        }
        Ok(Self {
            wheel,
            rail,
            wheel_radius: scene.wheel_radius,
            shift,
            closest: 0.0,
            origin: 0.0,
            roughness: roughness::read(configuration)?,
        })
    }

    /// Both bodies have curvatures, so that without roughness the contact is Hertz's.
    pub(super) fn is_quadric(&self) -> bool {
        matches!((&self.wheel, &self.rail), (Shape::Curvature(_), Shape::Curvature(_)))
    }

    fn lateral(&self, y: f64) -> f64 {
        self.wheel.height(y - self.shift) - self.rail.height(y)
    }

    pub(super) fn smooth(&self, x: f64, y: f64) -> f64 {
        let y = y + self.origin;
        let radius = match &self.wheel {
            Shape::Curvature(_) => self.wheel_radius,
            Shape::Profile(profile) => {
                self.wheel_radius + profile.height(0.0) - profile.height(y - self.shift)
            }
        };
        0.5 * x * x / radius + self.lateral(y) - self.closest
    }

    /// Undeformed distance at (x, y) from the origin [m].
    pub(super) fn distance(&self, x: f64, y: f64) -> f64 {
        let rough = self.roughness.as_ref().map_or(0.0, |roughness| roughness.height(x, y));
        self.smooth(x, y) + rough
    }

    /// The lateral range in which both shapes are known.
    pub(super) fn range(&self) -> [f64; 2] {
        let ([w0, w1], [r0, r1]) = (self.wheel.range(self.shift), self.rail.range(0.0));
        [w0.max(r0), w1.min(r1)]
    }

    /// Kinks of both shapes where they face each other: the key of the profile, the place in its file
    /// and that in the frame of the rail [m].
    fn kinks(&self) -> impl Iterator<Item = (&'static str, f64, f64)> + '_ {
        let of = |key, shape: &Shape, shift: f64| {
            let places: Vec<f64> = match shape {
                Shape::Curvature(_) => Vec::new(),
                Shape::Profile(profile) => profile.curve().kinks().collect(),
            };
            places.into_iter().map(move |y| (key, y, y + shift))
        };
        let both =
            of(RAIL_PROFILE, &self.rail, 0.0).chain(of(WHEEL_PROFILE, &self.wheel, self.shift));
        let [first, last] = self.range();
        both.filter(move |(_, _, y)| (first..=last).contains(y))
    }

    /// Lateral places of kinks under a pressure, from the origin [m].
    pub(super) fn kinks_under(&self, grid: &Structured, pressure: &[f64]) -> Vec<f64> {
        let places: Vec<f64> = self.kinks().map(|(_, _, y)| y - self.origin).collect();
        if places.is_empty() {
            return places;
        }
        let patches = patches(grid, pressure);
        let inside = |y: &f64| {
            patches.iter().any(|patch| {
                let [low, high] = patch.sides(grid);
                (low..=high).contains(y)
            })
        };
        places.into_iter().filter(inside).collect()
    }

    /// Moves zero to the first touch and the origin to its place, or to the middle where several places
    /// touch at once, so that mirrored bodies have mirrored grids; the lowest of these places from the
    /// origin [m].
    pub(super) fn settle(&mut self) -> Result<f64, Refusal> {
        let [first, last] = self.range();
        if first >= last {
            return Err(Refusal::new(
                WHEEL_PROFILE,
                "wheel and rail do not face each other anywhere",
                "check the lateral coordinates of both profiles and wheel.lateral_shift",
            ));
        }
        let at = |k: usize| first + (last - first) * k as f64 / SAMPLES as f64;
        let places = (0..=SAMPLES).map(at).chain(self.kinks().map(|(_, _, y)| y));
        let heights: Vec<(f64, f64)> = places.map(|y| (y, self.lateral(y))).collect();
        let highest = heights.iter().map(|(_, z)| *z).fold(f64::NEG_INFINITY, f64::max);
        let lowest = heights.iter().map(|(_, z)| *z).fold(f64::INFINITY, f64::min);
        let level = lowest + TIE * (highest - lowest);
        let touching = || heights.iter().filter(|(_, z)| *z <= level).map(|(y, _)| *y);
        let low = touching().fold(f64::INFINITY, f64::min);
        let high = touching().fold(f64::NEG_INFINITY, f64::max);
        (self.origin, self.closest) = (0.5 * (low + high), lowest);
        Ok(low - self.origin)
    }

    /// What was done to the shapes, and where the contact depends on it.
    pub(super) fn remarks(&self, fitted: &Fitted) -> Vec<String> {
        let shapes = [(RAIL_PROFILE, &self.rail), (WHEEL_PROFILE, &self.wheel)];
        let profiles = shapes.into_iter().filter_map(|(key, shape)| match shape {
            Shape::Curvature(_) => None,
            Shape::Profile(profile) => Some((key, profile.curve())),
        });
        let mut remarks: Vec<String> =
            profiles.filter_map(|(key, curve)| treatment(key, curve)).collect();
        let under = self.kinks_under(&fitted.grid, &fitted.pressure);
        if !under.is_empty() {
            let places = millimetres(under.iter().map(|y| y + self.origin));
            remarks.push(format!(
                "the contact reaches kinks at y = {places}: the pressure there grows with the \
                 resolution"
            ));
        }
        remarks
    }

    /// Refuses a contact that is steep anywhere.
    pub(super) fn refuse_steep(&self, fitted: &Fitted) -> Result<(), Refusal> {
        let rows = fitted.pressure.chunks_exact(fitted.grid.ni).enumerate();
        for (row, _) in rows.filter(|(_, row)| row.iter().any(|p| *p > 0.0)) {
            let y = fitted.grid.y(row) + self.origin;
            let slope = self.rail.slope(y).abs().max(self.wheel.slope(y - self.shift).abs());
            if slope.atan() > STEEPEST {
                let angle = slope.atan();
                return Err(Refusal::new(
                    RAIL_PROFILE,
                    format!("the bodies touch at y = {y:.4} m under {angle:.2} rad to the plane"),
                    format!("shift or turn the profiles until all contact is below {STEEPEST} rad"),
                ));
            }
        }
        Ok(())
    }
}

/// What was done to a measured profile, if anything was.
fn treatment(key: &str, curve: &Curve) -> Option<String> {
    let mut done = Vec::new();
    let kinks = curve.kinks().count();
    if kinks > 0 {
        let ends = if kinks == 1 { "splines end at the kink" } else { "splines end at the kinks" };
        done.push(format!("{ends} at y = {}", millimetres(curve.kinks())));
    }
    if curve.moved() > 0.0 {
        done.push(format!("smoothed, by {:.3} µm at most", 1e6 * curve.moved()));
    }
    (!done.is_empty()).then(|| format!("`{key}`: {} points, {}", curve.points(), done.join(", ")))
}

/// Some places in millimetres, the first few of many.
fn millimetres(places: impl Iterator<Item = f64>) -> String {
    const SHOWN: usize = 6;
    let places: Vec<String> = places.map(|y| format!("{:.3}", 1e3 * y)).collect();
    let more = match places.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{} mm{more}", places[..places.len().min(SHOWN)].join(", "))
}
