//! Error of models that conduct heat normal to the surface only and neglect conduction along it.
//!
//! The error is that of the largest rise of a body under an elliptic contact with the semi-axes a
//! and b, as an upper bound:
//!
//! - in steady motion max(0.55 (s/b)², 0.1)/Pe with Pe = V s/2κ and the half length s of the slip
//!   zone. The first part is conduction across the track: to first order, heat that has entered
//!   over the distance s spreads sideways by (κ s/V)/b². It is fitted to three-dimensional
//!   integrals for b/a from 0.25 to 4 and Pe from 3 to 100. The second part is conduction along the
//!   track near the edges of the flux. Carter's slip zones of any length have at most 0.077/Pe; the
//!   rest covers the estimate of the zone. Where nothing is known of the zone, it is assumed to
//!   have a fifth of the length of the contact, or the whole one for the first part;
//! - at rest, for a time t, (2/√π)(√(κt)) over [`heat::closed_form::scales::rest_length_after`],
//!   less 1. This bounds the error of a slowly moving body as well.

use super::frame::Frame;
use crate::{LOWER, UPPER};
use heat::closed_form::scales::rest_length_after;
use proto::accuracy::Simplification;
use proto::configuration::Mode;

/// Factor of the conduction across the track.
const ACROSS: f64 = 0.55;
/// Factor of the conduction along the track.
const ALONG: f64 = 0.1;
/// Length of a slip zone over that of the contact, where its source does not know it.
const UNKNOWN: f64 = 0.2;
/// Largest error that is stated. A body at rest for an unknown time has no bound.
const LARGEST: f64 = 1e3;

/// Returns the simplification that all models with conduction normal to the surface share. Its size
/// depends on the case, see [`along_the_surface_at`].
pub(super) fn along_the_surface() -> Simplification {
    Simplification::always("no conduction along the surface", 0.0, "estimated for each case")
}

/// Returns the error in a case, for the body in which it is larger.
pub(super) fn along_the_surface_at(frame: &Frame) -> Option<Simplification> {
    let errors = [LOWER, UPPER].map(|body| in_body(frame, body));
    errors.into_iter().max_by(|one, other| one.error.total_cmp(&other.error))
}

/// Returns the error in a body: that of its slowest motion, or that of the time at rest if smaller.
fn in_body(frame: &Frame, body: usize) -> Simplification {
    let axes = frame.heated_lengths();
    let diffusivity = frame.scene.materials[body].diffusivity();
    let peclet = 0.5 * frame.slowest_motion[body] * axes[0] / diffusivity;
    let along = if frame.heated.is_some() { ALONG } else { ALONG / UNKNOWN };
    let moving = (ACROSS * (axes[0] / axes[1]).powi(2)).max(along) / peclet;
    let end = frame.windows.and_then(|windows| windows.end).unwrap_or(f64::INFINITY);
    let spread = (4.0 * diffusivity * end).sqrt();
    let resting = match frame.mode {
        Mode::Steady => f64::INFINITY,
        Mode::Transient => {
            spread / std::f64::consts::PI.sqrt() / rest_length_after(axes, spread) - 1.0
        }
    };
    let what = "no conduction along the surface";
    if moving <= resting {
        let what = format!("{what}, at Pe = {peclet:.3}");
        return Simplification::always(&what, moving.min(LARGEST), BY_SPEED);
    }
    let name = &frame.scene.names.0[body];
    let part = spread / axes[0];
    let what = format!(
        "{what} of `{name}`, in which heat spreads by sqrt(4 kappa t) = {part:.2} a up to the end"
    );
    Simplification::always(&what, resting.min(LARGEST), BY_TIME)
}

/// Source of the error as a function of speed.
const BY_SPEED: &str = "model `moving-source` (docs/theory/moving-source.md)";
/// Source of the error as a function of time.
const BY_TIME: &str = "closed form of an ellipse at rest (docs/theory/columns.md)";
