//! Kinds of lateral shapes, and the trait of a shape.

use crate::case::keys::CheckedParams;
use crate::case::scene::Scene;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use std::fmt::Debug;
use std::sync::Arc;

/// Kind of lateral shape.
pub(super) struct Kind {
    /// Key of a body that selects this kind of shape.
    pub(super) key: &'static str,
    pub(super) keys: fn() -> Vec<KeySpec>,
    pub(super) read: Read,
}

/// Reads the shape of a body; `None` if the case gives no shape of this kind.
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

    /// First and last lateral coordinate at which the shape is known [m].
    fn range(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    /// Lateral coordinates at which the slope jumps [m].
    fn kinks(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Returns a remark on the processing of the data, if there is anything to report.
    fn remark(&self) -> Option<String> {
        None
    }

    /// Returns a warning if the shape is implausible for a body in a contact with this modulus E*
    /// [Pa].
    fn warning(&self, _scene: &Scene, _body: usize, _modulus: f64) -> Option<Refusal> {
        None
    }
}

/// Formats coordinates in millimetres; of many only the first few.
pub(crate) fn millimetres(places: impl Iterator<Item = f64>) -> String {
    const SHOWN: usize = 6;
    let places: Vec<String> = places.map(|y| format!("{:.3}", 1e3 * y)).collect();
    let more = match places.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{} mm{more}", places[..places.len().min(SHOWN)].join(", "))
}
