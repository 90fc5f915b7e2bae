//! The undeformed distance of the smooth bodies.
//!
//! h(x, y) = x²/(2R₁(y)) + x²/(2R₂(y)) + z₁(y − s₁) − z₂(y − s₂), less its smallest value; z₁ and z₂
//! are the lateral shapes of the upper and the lower body, s
//! their lateral shifts. A round body with a measured profile has the radius R₁(y) = R + z₁(0) −
//! z₁(y − s₁), and R₂(y) = R + z₂(y − s₂) − z₂(0). The distance is taken along z, which is the contact
//! normal for small contact angles only; a steeper contact is refused.

use crate::case::keys::CheckedParams;
use crate::case::noise;
use crate::case::scene::Scene;
use half_space::extent::Fitted;
use half_space::patches::patches;
use proto::bodies::{LOWER, UPPER};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::grid::Structured;
use std::path::Path;
use wheel_rail::curve::Curve;
use wheel_rail::profile::heights::{Profile, ProfileError};
use wheel_rail::profile::orientation::Body;

/// Points at which the lateral distance is searched for its smallest value.
const SAMPLES: usize = 2000;
/// Steepest contact that is treated as plane [rad].
const STEEPEST: f64 = 0.2;
/// How much higher than the lowest place another one may be to count as touching at once, over the
/// range of heights: rounding.
const TIE: f64 = 1e-9;

const PROFILE: &str = "profile";
const TOLERANCE: &str = "profile_tolerance";
const LATERAL_SHIFT: &str = "lateral_shift";

/// The keys that the shapes are read from besides the scene's.
pub(in crate::models) fn keys() -> Vec<KeySpec> {
    let of = |name: &str| format!("bodies.*.{name}");
    let smoothing = "how far smoothing may move a point of the profile; absent: through all points";
    vec![
        KeySpec::file(
            &of(PROFILE),
            "measured lateral profile of the body: a table of `y [mm]` and `z [mm]` as it stands, y to the left and z up, or a file of SIMPACK (.prw, .prr) or Miniprof (.whl, .ban)",
        ),
        KeySpec::quantity(&of(TOLERANCE), "m", smoothing).at_least(0.0),
        KeySpec::quantity(&of(LATERAL_SHIFT), "m", "lateral shift of a measured body, to the left")
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

/// One of the bodies.
#[derive(Clone, Debug)]
struct Side {
    /// The key of its profile.
    key: String,
    shape: Shape,
    /// Radius along x at y = 0 [m].
    radius: f64,
    /// Lateral shift [m].
    shift: f64,
    /// 1 for a body above the contact, −1 for one below.
    up: f64,
}

impl Side {
    fn read(case: &CheckedParams<'_>, scene: &Scene, body: usize) -> Result<Self, Refusal> {
        let key = |name: &str| scene.names.key(body, name);
        let scene_body = &scene.bodies[body];
        let up = if body == UPPER { 1.0 } else { -1.0 };
        let (profile, shift) = (key(PROFILE), case.number(&key(LATERAL_SHIFT))?);
        let of = if body == UPPER { Body::Wheel } else { Body::Rail };
        let shape = match measured(case, &profile, &key(TOLERANCE), of)? {
            Some(_) if scene_body.radius_y.is_finite() => {
                let reason = format!("excludes `{}`", key("radius_y"));
                return Err(Refusal::new(&profile, reason, "keep one of them"));
            }
            Some(profile) => Shape::Profile(profile),
            None if shift != 0.0 => {
                return Err(Refusal::new(
                    &key(LATERAL_SHIFT),
                    "shifts a measured body, and this one has no profile",
                    format!("add `{profile}`, or remove the key"),
                ));
            }
            None => Shape::Curvature(up / scene_body.radius_y),
        };
        Ok(Self { key: profile, shape, radius: scene_body.radius_x, shift, up })
    }

    fn height(&self, y: f64) -> f64 {
        self.shape.height(y - self.shift)
    }

    /// Radius along x [m].
    fn radius(&self, y: f64) -> f64 {
        match &self.shape {
            Shape::Curvature(_) => self.radius,
            Shape::Profile(profile) => {
                let middle = self.radius + self.up * profile.height(0.0);
                middle - self.up * profile.height(y - self.shift)
            }
        }
    }

    fn range(&self) -> [f64; 2] {
        self.shape.range(self.shift)
    }
}

/// The profile of a body, if it has one.
fn measured(
    case: &CheckedParams<'_>,
    key: &str,
    tolerance: &str,
    body: Body,
) -> Result<Option<Profile>, Refusal> {
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
    let wrong = |error: ProfileError| {
        let fix = "give a table of `y [mm]` and `z [mm]`, or a file of SIMPACK or Miniprof; docs/how-to/use-a-table.md has the format";
        Refusal::new(key, format!("`{path}` {error}"), fix)
    };
    Profile::read(Path::new(path), body, within.unwrap_or(0.0)).map(Some).map_err(wrong)
}

/// The undeformed distance.
#[derive(Clone, Debug)]
pub(in crate::models) struct Gap {
    /// The upper and the lower body.
    sides: [Side; 2],
    /// Smallest lateral distance [m].
    closest: f64,
    /// Lateral coordinate of the origin [m].
    pub(in crate::models) origin: f64,
}

impl Gap {
    /// Reads the shapes.
    pub(super) fn read(configuration: &Configuration, scene: &Scene) -> Result<Self, Refusal> {
        let case = CheckedParams::new(&configuration.case, keys());
        Ok(Self {
            sides: [Side::read(&case, scene, UPPER)?, Side::read(&case, scene, LOWER)?],
            closest: 0.0,
            origin: 0.0,
        })
    }

    /// Takes the radii of another row; profiles stay.
    pub(super) fn follow(&mut self, scene: &Scene) {
        for (side, body) in self.sides.iter_mut().zip(&scene.bodies) {
            side.radius = body.radius_x;
            if let Shape::Curvature(curvature) = &mut side.shape {
                *curvature = side.up / body.radius_y;
            }
        }
    }

    /// The key of the first profile, which errors of shapes name.
    pub(super) fn profile_key(&self) -> &str {
        let measured = self.sides.iter().rev();
        let mut measured = measured.filter(|side| matches!(side.shape, Shape::Profile(_)));
        &measured.next().unwrap_or(&self.sides[LOWER]).key
    }

    /// Both bodies have curvatures, so that without terms of the gap the contact is Hertz's.
    pub(super) fn is_quadric(&self) -> bool {
        self.sides.iter().all(|side| matches!(side.shape, Shape::Curvature(_)))
    }

    /// The body has a measured profile.
    pub(in crate::models) fn is_measured(&self, body: usize) -> bool {
        matches!(self.sides[body].shape, Shape::Profile(_))
    }

    /// How far the surface of a body at a place from the origin is within the body [m], counted from the height of the lower body at
    /// the origin, where the bodies touch.
    pub(in crate::models) fn drop(&self, body: usize, y: f64) -> f64 {
        let level = self.sides[LOWER].height(self.origin);
        let Side { up, .. } = self.sides[body];
        let closest = if body == UPPER { self.closest } else { 0.0 };
        up * (self.sides[body].height(y + self.origin) - level - closest)
    }

    /// Radius of rolling of a body at the height from which [`Gap::drop`] counts [m].
    pub(in crate::models) fn radius(&self, body: usize) -> f64 {
        self.sides[body].radius(self.origin) + self.drop(body, 0.0)
    }

    fn lateral(&self, y: f64) -> f64 {
        self.sides[UPPER].height(y) - self.sides[LOWER].height(y)
    }

    /// Undeformed distance at (x, y) from the origin [m].
    pub(super) fn distance(&self, x: f64, y: f64) -> f64 {
        let y = y + self.origin;
        let [upper, lower] = self.sides.each_ref().map(|side| 0.5 * x * x / side.radius(y));
        upper + lower + self.lateral(y) - self.closest
    }

    /// The lateral range in which both shapes are known.
    pub(super) fn range(&self) -> [f64; 2] {
        let [[u0, u1], [l0, l1]] = self.sides.each_ref().map(Side::range);
        [u0.max(l0), u1.min(l1)]
    }

    /// Kinks of both shapes where they face each other, in the frame of the contact [m].
    fn kinks(&self) -> impl Iterator<Item = f64> + '_ {
        let of = |side: &Side| -> Vec<f64> {
            match &side.shape {
                Shape::Curvature(_) => Vec::new(),
                Shape::Profile(profile) => {
                    profile.curve().kinks().map(|y| y + side.shift).collect()
                }
            }
        };
        let [first, last] = self.range();
        let both = self.sides.iter().rev().flat_map(of);
        both.filter(move |y| (first..=last).contains(y))
    }

    /// Lateral places of kinks under a pressure, from the origin [m].
    pub(super) fn kinks_under(&self, grid: &Structured, pressure: &[f64]) -> Vec<f64> {
        let places: Vec<f64> = self.kinks().map(|y| y - self.origin).collect();
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
                self.profile_key(),
                "the bodies do not face each other anywhere",
                "check the lateral coordinates of both profiles and their lateral_shift",
            ));
        }
        let at = |k: usize| first + (last - first) * k as f64 / SAMPLES as f64;
        let places = (0..=SAMPLES).map(at).chain(self.kinks());
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
        let sides = self.sides.iter().rev();
        let profiles = sides.filter_map(|side| match &side.shape {
            Shape::Curvature(_) => None,
            Shape::Profile(profile) => Some((side.key.as_str(), profile.curve())),
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

    /// Warnings of profiles whose noise the pressure shows.
    pub(in crate::models) fn warnings(&self, scene: &Scene) -> Vec<Refusal> {
        let modulus = scene.contact_compliance().recip();
        let of = |(body, side): (usize, &Side)| match &side.shape {
            Shape::Curvature(_) => None,
            Shape::Profile(profile) => {
                let tolerance = scene.names.key(body, TOLERANCE);
                noise::warning(&side.key, &tolerance, &profile.curve().passed(), modulus)
            }
        };
        self.sides.iter().enumerate().filter_map(of).collect()
    }

    /// Refuses a contact that is steep anywhere.
    pub(super) fn refuse_steep(&self, fitted: &Fitted) -> Result<(), Refusal> {
        let rows = fitted.pressure.chunks_exact(fitted.grid.ni).enumerate();
        for (row, _) in rows.filter(|(_, row)| row.iter().any(|p| *p > 0.0)) {
            let y = fitted.grid.y(row) + self.origin;
            let slopes = self.sides.each_ref().map(|side| side.shape.slope(y - side.shift).abs());
            let slope = slopes[LOWER].max(slopes[UPPER]);
            if slope.atan() > STEEPEST {
                let angle = slope.atan();
                return Err(Refusal::new(
                    self.profile_key(),
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
