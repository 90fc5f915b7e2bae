//! Measured profiles from files.

use super::lateral::{Kind, LateralShape, millimetres};
use crate::case::keys::CheckedParams;
use crate::case::noise::Measured;
use crate::case::scene::Scene;
use proto::bodies::{Bodies, UPPER};
use proto::configuration::Refusal;
use proto::description::KeySpec;
use std::path::Path;
use std::sync::Arc;
use wheel_rail::outline::Smoothing;
use wheel_rail::profile::heights::{Profile, ProfileError};
use wheel_rail::profile::orientation::{Body, Heights};

/// Entry of measured profiles in the list of kinds.
pub(super) const KIND: Kind = Kind { key: PROFILE, keys, read };

const PROFILE: &str = "profile";
const TOLERANCE: &str = "profile_tolerance";
const HEIGHTS: &str = "profile_heights";

/// Key of the direction of the heights in the file of a profile.
pub(crate) fn heights_key() -> KeySpec {
    KeySpec::choice(
        &format!("bodies.*.{HEIGHTS}"),
        &["usual", "up", "down"],
        "direction of the heights of the profile; usual: up in a table, down in .prr and .prw, in Miniprof as the shape shows",
    )
    .default_value("usual")
}

/// Reads the direction of the heights, if the case prescribes it.
pub(crate) fn prescribed_heights(
    case: &CheckedParams<'_>,
    names: &Bodies,
    body: usize,
) -> Result<Option<Heights>, Refusal> {
    Ok(match case.text(&names.key(body, HEIGHTS))? {
        "up" => Some(Heights::Up),
        "down" => Some(Heights::Down),
        _ => None,
    })
}

fn keys() -> Vec<KeySpec> {
    let of = |name: &str| format!("bodies.*.{name}");
    let smoothing =
        "largest distance by which smoothing moves a point of the profile; absent: no smoothing";
    vec![
        KeySpec::file(
            &of(PROFILE),
            "measured lateral profile of the body: a table of `y [mm]` (to the left) and `z [mm]` (up), or a file of SIMPACK (.prw, .prr) or Miniprof (.whl, .ban)",
        ),
        KeySpec::quantity(&of(TOLERANCE), "m", smoothing).at_least(0.0),
        heights_key(),
    ]
}

fn read(
    case: &CheckedParams<'_>,
    scene: &Scene,
    body: usize,
) -> Result<Option<Arc<dyn LateralShape>>, Refusal> {
    let [key, tolerance] = [PROFILE, TOLERANCE].map(|name| scene.names.key(body, name));
    let within = case.maybe_number(&tolerance)?;
    if !case.has(&key) {
        return match within {
            Some(_) => Err(Refusal::new(
                &tolerance,
                "smooths a measured profile, but there is none",
                format!("add `{key}`, or remove the key"),
            )),
            None => Ok(None),
        };
    }
    let path = case.text(&key)?;
    let wrong = |error: ProfileError| {
        let fix = "give a table of `y [mm]` and `z [mm]`, or a file of SIMPACK or Miniprof; see docs/how-to/use-a-table.md";
        Refusal::new(&key, format!("`{path}` {error}"), fix)
    };
    let of = if body == UPPER { Body::Wheel } else { Body::Rail };
    let heights = prescribed_heights(case, &scene.names, body)?;
    let profile = Profile::read(Path::new(path), of, heights, within.unwrap_or(0.0));
    let profile = profile.map_err(wrong)?;
    let raw = match within {
        Some(within) if within > 0.0 => {
            Profile::read(Path::new(path), of, heights, 0.0).map_err(wrong)?.curve().passed()
        }
        _ => profile.curve().passed(),
    };
    Ok(Some(Arc::new(MeasuredShape { profile, raw, tolerance: within.unwrap_or(0.0) })))
}

/// A measured profile with its points before smoothing.
#[derive(Debug)]
struct MeasuredShape {
    profile: Profile,
    /// Points before smoothing [m].
    raw: Vec<[f64; 2]>,
    /// Tolerance of the smoothing [m].
    tolerance: f64,
}

impl LateralShape for MeasuredShape {
    fn height(&self, y: f64) -> f64 {
        self.profile.height(y)
    }

    fn slope(&self, y: f64) -> f64 {
        self.profile.slope(y)
    }

    fn range(&self) -> [f64; 2] {
        self.profile.range()
    }

    fn kinks(&self) -> Vec<f64> {
        self.profile.curve().kinks().collect()
    }

    /// Reports the kinks, and the largest displacement of a point by smoothing.
    fn remark(&self) -> Option<String> {
        let curve = self.profile.curve();
        let mut done = Vec::new();
        let kinks = curve.kinks().count();
        if kinks > 0 {
            let ends =
                if kinks == 1 { "splines end at the kink" } else { "splines end at the kinks" };
            done.push(format!("{ends} at y = {}", millimetres(curve.kinks())));
        }
        if curve.moved() > 0.0 {
            done.push(format!("smoothed by at most {:.3} µm", 1e6 * curve.moved()));
        }
        (!done.is_empty()).then(|| format!("{} points, {}", curve.points(), done.join(", ")))
    }

    /// Warns of noise that visibly changes the pressure.
    fn warning(&self, scene: &Scene, body: usize, modulus: f64) -> Option<Refusal> {
        let [key, tolerance] = [PROFILE, TOLERANCE].map(|name| scene.names.key(body, name));
        let measured = Measured {
            key: &key,
            tolerance: &tolerance,
            wavelength: "",
            points: &self.raw,
            smoothing: Smoothing::Within(self.tolerance),
        };
        measured.warning(modulus)
    }
}
