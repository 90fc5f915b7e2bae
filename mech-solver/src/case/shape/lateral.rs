//! A kind of shape, and a shape of it.

use crate::case::keys::CheckedParams;
use crate::case::scene::Scene;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use std::fmt::Debug;
use std::sync::Arc;

/// A kind of shape.
pub(super) struct Kind {
    /// The key of a body that gives it such a shape.
    pub(super) key: &'static str,
    pub(super) keys: fn() -> Vec<KeySpec>,
    pub(super) read: Read,
}

/// Reads a body's shape, if the case gives it one of this kind.
type Read = fn(
    case: &CheckedParams<'_>,
    scene: &Scene,
    body: usize,
) -> Result<Option<Arc<dyn LateralShape>>, Refusal>;

/// Heights of a body's surface over its lateral coordinate.
pub(crate) trait LateralShape: Debug + Send + Sync {
    /// Height at y [m].
    fn height(&self, y: f64) -> f64;

    /// Slope dz/dy at y [-].
    fn slope(&self, y: f64) -> f64;

    /// The first and the last lateral coordinate at which it is known [m].
    fn range(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    /// Places where the slope jumps [m].
    fn kinks(&self) -> Vec<f64> {
        Vec::new()
    }

    /// How it was made from what the case gives, if that needs saying.
    fn remark(&self) -> Option<String> {
        None
    }

    /// What may be wrong with it, of a body in a contact with this modulus E* [Pa].
    fn warning(&self, _scene: &Scene, _body: usize, _modulus: f64) -> Option<Refusal> {
        None
    }
}

/// Some places in millimetres, the first few of many.
pub(crate) fn millimetres(places: impl Iterator<Item = f64>) -> String {
    const SHOWN: usize = 6;
    let places: Vec<String> = places.map(|y| format!("{:.3}", 1e3 * y)).collect();
    let more = match places.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{} mm{more}", places[..places.len().min(SHOWN)].join(", "))
}
