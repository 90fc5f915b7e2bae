//! Lateral shapes of the bodies: heights z(y) above the plane of the contact.
//!
//! The shape of a body is the parabola of its `radius_y`, or a shape of another kind with keys of
//! its own. Models that solve for any shape (`half-space`, `explicit-fe`) read it here. A kind is a
//! file of this folder with its [`LateralShape`](lateral::LateralShape), and one line in [`KINDS`].

pub(crate) mod lateral;
pub(crate) mod measured;

use crate::case::keys::CheckedParams;
use crate::case::scene::{Body, Scene};
use lateral::{Kind, LateralShape};
use proto::bodies::UPPER;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use std::sync::Arc;

const LATERAL_SHIFT: &str = "lateral_shift";

/// Kinds of shapes other than the parabola.
const KINDS: &[Kind] = &[measured::KIND];

/// Returns the keys of shapes, in addition to those of the scene.
pub(crate) fn keys() -> Vec<KeySpec> {
    let mut keys: Vec<KeySpec> = KINDS.iter().flat_map(|kind| (kind.keys)()).collect();
    keys.push(
        KeySpec::quantity(
            &format!("bodies.*.{LATERAL_SHIFT}"),
            "m",
            "lateral shift of a measured body, to the left",
        )
        .default_value(0.0),
    );
    keys
}

/// Surface of one body.
#[derive(Clone, Debug)]
pub(crate) struct BodyShape {
    /// Key that gives the shape, or would give it.
    pub(crate) key: String,
    /// Shape of the body; `None` for the parabola.
    shape: Option<Arc<dyn LateralShape>>,
    /// Curvature of the parabola, d²z/dy² [1/m].
    curvature: f64,
    /// Radius along x at y = 0 [m].
    radius: f64,
    /// Lateral shift [m].
    shift: f64,
    /// 1 for a body above the contact, −1 for one below.
    pub(crate) up: f64,
}

impl BodyShape {
    /// Reads the shape of a body.
    ///
    /// # Errors
    /// A file that is not a profile; two shapes at once; a shift of a parabola.
    pub(crate) fn read(
        case: &CheckedParams<'_>,
        scene: &Scene,
        body: usize,
    ) -> Result<Self, Refusal> {
        let mut found = None;
        let mut key = scene.names.key(body, KINDS[0].key);
        for kind in KINDS {
            let own = scene.names.key(body, kind.key);
            let Some(shape) = (kind.read)(case, scene, body)? else { continue };
            let other = match &found {
                Some(_) => Some(key.clone()),
                None if scene.bodies[body].radius_y.is_finite() => {
                    Some(scene.names.key(body, "radius_y"))
                }
                None => None,
            };
            if let Some(other) = other {
                let reason = format!("excludes `{other}`");
                return Err(Refusal::new(&own, reason, "keep one of them"));
            }
            (found, key) = (Some(shape), own);
        }
        let shift_key = scene.names.key(body, LATERAL_SHIFT);
        let shift = case.number(&shift_key)?;
        if found.is_none() && shift != 0.0 {
            return Err(Refusal::new(
                &shift_key,
                "shifts a measured profile, but this body has none",
                format!("add `{key}`, or remove the key"),
            ));
        }
        let up = if body == UPPER { 1.0 } else { -1.0 };
        let mut shape = Self { key, shape: found, curvature: 0.0, radius: 0.0, shift, up };
        shape.follow(&scene.bodies[body]);
        Ok(shape)
    }

    /// Updates the radii from a body whose values vary; other shapes stay the same.
    pub(crate) fn follow(&mut self, body: &Body) {
        (self.radius, self.curvature) = (body.radius_x, self.up / body.radius_y);
    }

    /// Returns true if the shape is the parabola of the body's radius.
    pub(crate) fn is_parabola(&self) -> bool {
        self.shape.is_none()
    }

    /// Height at y [m].
    pub(crate) fn height(&self, y: f64) -> f64 {
        let y = y - self.shift;
        match &self.shape {
            None => 0.5 * self.curvature * y * y,
            Some(shape) => shape.height(y),
        }
    }

    /// Slope dz/dy at y [-].
    pub(crate) fn slope(&self, y: f64) -> f64 {
        let y = y - self.shift;
        self.shape.as_ref().map_or(self.curvature * y, |shape| shape.slope(y))
    }

    /// Radius along x at y [m].
    pub(crate) fn radius(&self, y: f64) -> f64 {
        match &self.shape {
            None => self.radius,
            Some(shape) => {
                let middle = self.radius + self.up * shape.height(0.0);
                middle - self.up * shape.height(y - self.shift)
            }
        }
    }

    /// First and last lateral coordinate at which the shape is known [m].
    pub(crate) fn range(&self) -> [f64; 2] {
        let known = self.shape.as_ref().map(|shape| shape.range());
        known.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]).map(|end| end + self.shift)
    }

    /// Lateral coordinates at which the slope jumps [m].
    pub(crate) fn kinks(&self) -> impl Iterator<Item = f64> + '_ {
        let own = self.shape.as_ref().map(|shape| shape.kinks()).unwrap_or_default();
        own.into_iter().map(|y| y + self.shift)
    }

    /// Returns a remark on the processing of the data, if there is anything to report.
    pub(crate) fn remark(&self) -> Option<String> {
        let remark = self.shape.as_ref()?.remark()?;
        Some(format!("`{}`: {remark}", self.key))
    }

    /// Returns a warning if the shape is implausible.
    pub(crate) fn warning(&self, scene: &Scene, body: usize) -> Option<Refusal> {
        self.shape.as_ref()?.warning(scene, body, scene.contact_compliance().recip())
    }
}
