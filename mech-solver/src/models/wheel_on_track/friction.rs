//! The friction coefficient of every element: that of the case, and its factors over the surface of the rail or along the track.

use super::case::{Case, Position};
use crate::bands::{At, Bands, Over};
use crate::track::rail::Side;
use crate::track::settings::FrictionPlace;
use proto::bodies::LOWER;

/// The coefficient of friction of an element of one side at a position.
pub(super) fn coefficient(
    case: &Case,
    side: Side,
    position: &Position,
    spot: &FrictionPlace,
) -> f64 {
    let factor =
        case.terms.bands().map(|bands| bands.factor(place(bands, case, side, position, spot)));
    position.friction * factor.unwrap_or(1.0)
}

/// The coordinate of factors at an element, or at the reference of its patch.
fn place(bands: &Bands, case: &Case, side: Side, position: &Position, spot: &FrictionPlace) -> f64 {
    let [x, tape] = match bands.at {
        At::Elements => spot.element,
        At::Patches => spot.reference,
    };
    match (bands.over, bands.at) {
        (Over::Lateral, _) => tape,
        (Over::Track, _) => position.motion.way + x,
        (Over::Inclination, At::Elements) => {
            case.surfaces[LOWER].angle(position.motion.way + x, side.sign() * tape)
        }
        // In the axes of the profile, which cant and deviation have turned.
        (Over::Inclination, At::Patches) => {
            side.sign() * (spot.angle - position.deviation.roll) - case.track.cant
        }
    }
}
