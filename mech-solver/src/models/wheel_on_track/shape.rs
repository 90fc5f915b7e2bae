//! Surfaces of wheel and rail: a profile or slices read from files, with an optional irregularity.

use crate::case::keys::CheckedParams;
use crate::case::shape::measured::{heights_key, prescribed_heights};
use elastic::axle::{Form, Irregularity};
use proto::bodies::Bodies;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::input_file;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;
use wheel_rail::outline::{Outline, Smoothing};
use wheel_rail::profile::orientation::{Body, Heights};
use wheel_rail::profile::{Format, Reading, SliceFormat, read, read_slices};
use wheel_rail::slices::{Slice, Slices};
use wheel_rail::surface::Surface;

/// Maximum size of a file [byte].
const MOST_BYTES: u64 = 64 << 20;

/// Forms of irregularities.
const FORMS: [&str; 4] = ["dip", "joint", "corrugation", "flat"];
/// Keys of an irregularity in addition to its form.
const SIZES: [&str; 4] = ["depth", "length", "at", "crown_radius"];

/// Keys of the shape of the bodies.
pub(super) fn keys() -> Vec<KeySpec> {
    let smoothing =
        "largest distance by which smoothing moves a point of the profile; absent: no smoothing";
    let size = |name: &str, help: &str| {
        KeySpec::quantity(&format!("bodies.*.irregularity.{name}"), "m", help)
    };
    vec![
        KeySpec::file(
            "bodies.*.profile",
            "profile of the wheel or the rail: .prw, .prr, Miniprof, or a table of `y [mm]` (to the field side) and `z [mm]` (up); or several at \
             positions, for a body that varies: .slcw, .slcs, or .slices with a table of `position [m]` and `profile`",
        )
        .required(),
        KeySpec::quantity("bodies.*.profile_tolerance", "m", smoothing).at_least(0.0),
        heights_key(),
        KeySpec::quantity(
            "bodies.*.smoothing_wavelength",
            "m",
            "smoothing that halves waves of this length in the profile, equally in all slices; in place of the tolerance",
        )
        .above(0.0),
        KeySpec::choice(
            "bodies.*.irregularity.form",
            &FORMS,
            "hollow across the whole profile: in a rail a period of a cosine (dip), ramps that meet in a kink (joint) or waves \
             (corrugation), in a wheel a period of a cosine (flat)",
        ),
        size("depth", "depth (waves: from crest to trough)").above(0.0),
        size("length", "length (waves: from crest to crest)").above(0.0),
        size(
            "at",
            "distance along the rail, or rolled by the wheel, to its middle (waves: to the first crest)",
        ),
        size(
            "crown_radius",
            "for a flat, lateral radius R of the rail that wore it: shallower by y^2/2R beside the tape circle; absent: constant depth across",
        )
        .above(0.0),
    ]
}

/// Surface of a body, and what its noise is judged by.
pub(super) struct ReadSurface {
    /// The surface.
    pub(super) surface: Surface,
    /// Points of its profile before smoothing [m]; empty for slices.
    pub(super) points: Vec<[f64; 2]>,
    /// Smoothing of the profile.
    pub(super) smoothing: Smoothing,
}

/// Reads the surface of a body; `radius` is the nominal radius of a wheel [m].
///
/// # Errors
/// A file that is not a profile; slices that make no surface; an irregularity that does not fit the
/// body.
pub(super) fn surface(
    case: &CheckedParams<'_>,
    names: &Bodies,
    (body, of): (usize, Body),
    radius: f64,
    remarks: &mut Vec<String>,
) -> Result<ReadSurface, Refusal> {
    let key = names.key(body, "profile");
    let path = Path::new(case.text(&key)?);
    let taken = Taken {
        of,
        smoothing: smoothing(case, names, body)?,
        heights: prescribed_heights(case, names, body)?,
    };
    let refused = |reason: String| {
        let reason = format!("{} {reason}", path.display());
        Refusal::new(
            &key,
            reason,
            "give the profile of a wheel or a rail, in one of its formats; see docs/how-to/use-a-table.md",
        )
    };
    let name = &names.0[body];
    let smoothing = taken.smoothing;
    let mut points = Vec::new();
    let surface = match SliceFormat::of(path) {
        None => {
            let rough = Taken { smoothing: Smoothing::Within(0.0), ..taken };
            points = outline(path, &rough).map_err(refused)?.points().to_vec();
            let outline = outline(path, &taken).map_err(refused)?;
            remarks.push(format!("profile of `{name}`: {}", described(&outline)));
            Surface::from(outline)
        }
        Some(format) => {
            let (slices, remark) = sliced(path, format, &taken).map_err(refused)?;
            remarks.push(format!("slices of `{name}`: {remark}"));
            Surface::from(slices)
        }
    };
    let crown = case.maybe_number(&names.key(body, "irregularity.crown_radius"))?;
    let surface = match (irregularity(case, names, body, of)?, of) {
        (None, _) => surface,
        (Some(form), Body::Wheel) => surface.hollow_wheel(form, radius, crown),
        (Some(form), Body::Rail) => surface.hollow_rail(form),
    };
    Ok(ReadSurface { surface, points, smoothing })
}

/// Smoothing of the profiles of a body.
fn smoothing(case: &CheckedParams<'_>, names: &Bodies, body: usize) -> Result<Smoothing, Refusal> {
    let [tolerance, wavelength] =
        ["profile_tolerance", "smoothing_wavelength"].map(|name| names.key(body, name));
    match (case.maybe_number(&tolerance)?, case.maybe_number(&wavelength)?) {
        (Some(_), Some(_)) => {
            let reason = format!("`{tolerance}` already sets the smoothing of the profile");
            Err(Refusal::new(&wavelength, reason, "remove one of the two"))
        }
        (_, Some(wavelength)) => Ok(Smoothing::Halving(wavelength)),
        (tolerance, None) => Ok(Smoothing::Within(tolerance.unwrap_or(0.0))),
    }
}

/// Description of a profile: points, kinks and smoothing.
fn described(outline: &Outline) -> String {
    format!(
        "{} points, {} kinks, smoothing moves points by at most {:.2} µm",
        outline.points().len(),
        outline.kinks().count(),
        1e6 * outline.moved()
    )
}

/// Reads the bytes of a file.
fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    input_file::read(path, MOST_BYTES).map_err(|error| error.to_string())
}

/// Reading options of the profile files of a body.
#[derive(Clone, Copy, Debug)]
struct Taken {
    of: Body,
    smoothing: Smoothing,
    heights: Option<Heights>,
}

impl Taken {
    fn reading(&self, path: &Path) -> Reading {
        let usual = Reading::usual(Format::of(path), self.of);
        let heights = self.heights.unwrap_or(usual.heights);
        Reading { smoothing: self.smoothing, heights, ..usual }
    }
}

/// Reads a profile from its file.
fn outline(path: &Path, taken: &Taken) -> Result<Outline, String> {
    read(&bytes(path)?, &taken.reading(path)).map_err(|error| error.to_string())
}

/// Reads the surface through the profiles listed in a file. Also returns a description of the
/// slices.
fn sliced(path: &Path, format: SliceFormat, taken: &Taken) -> Result<(Slices, String), String> {
    let of = taken.of;
    let list = read_slices(&bytes(path)?, format, of).map_err(|error| error.to_string())?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut known: HashMap<&str, Outline> = HashMap::new();
    let mut slices = Vec::with_capacity(list.slices.len());
    for named in &list.slices {
        let name = named.file.as_str();
        if !known.contains_key(name) {
            let found = outline(&folder.join(name), taken)
                .map_err(|reason| format!("names {name}, which {reason}"))?;
            known.insert(name, found);
        }
        let outline = known[name].clone();
        let [from, to] = outline.range();
        // CONTACT measures the features of a wheel from its field side.
        let features = match of {
            Body::Rail => named.features.clone(),
            Body::Wheel => named.features.iter().rev().map(|s| (to - from - s).max(0.0)).collect(),
        };
        slices.push(Slice { at: named.at, outline, features });
    }
    let period = (of == Body::Wheel).then_some(TAU);
    let surface = Slices::new(&slices, list.along, period).map_err(|error| error.to_string())?;
    let finest = slices.iter().map(|slice| &slice.outline).max_by_key(|one| one.points().len());
    let (first, last) = (slices[0].at, slices[slices.len() - 1].at);
    let remark = format!(
        "{} at {first:.4} to {last:.4} {}; the finest has {}",
        slices.len(),
        if of == Body::Wheel { "rad" } else { "m" },
        finest.map(described).unwrap_or_default()
    );
    Ok((surface, remark))
}

/// Irregularity of a body, if it has one.
fn irregularity(
    case: &CheckedParams<'_>,
    names: &Bodies,
    body: usize,
    of: Body,
) -> Result<Option<Irregularity>, Refusal> {
    let key = |name: &str| names.key(body, &format!("irregularity.{name}"));
    let form_key = key("form");
    if !case.has(&form_key) {
        return match SIZES.into_iter().find(|name| case.has(&key(name))) {
            None => Ok(None),
            Some(name) => {
                let reason = "an irregularity has a size, but no form";
                Err(Refusal::new(&key(name), reason, format!("add `{form_key}`")))
            }
        };
    }
    let name = case.text(&form_key)?;
    let form = Form::NAMES.into_iter().find(|(form, _)| *form == name).map(|(_, form)| form);
    let form =
        form.filter(|form| (*form == Form::Flat) == (of == Body::Wheel)).ok_or_else(|| {
            let (reason, fix) = match of {
                Body::Wheel => {
                    ("is an irregularity of a rail", "write \"flat\", or give it to the rail")
                }
                Body::Rail => (
                    "is an irregularity of a wheel",
                    "write \"dip\", \"joint\" or \"corrugation\", or give it to the wheel",
                ),
            };
            Refusal::new(&form_key, format!("`{name}` {reason}"), fix)
        })?;
    let size = |name: &str| {
        let key = key(name);
        case.maybe_number(&key)?.ok_or_else(|| {
            let reason = "an irregularity needs a depth, a length and a position";
            Refusal::new(&key, reason, format!("add `{key}`"))
        })
    };
    let crown = key("crown_radius");
    if of == Body::Rail && case.has(&crown) {
        let reason = "a hollow of a rail has a constant depth across";
        return Err(Refusal::new(&crown, reason, "remove the key"));
    }
    let (depth, length, at) = (size("depth")?, size("length")?, size("at")?);
    Ok(Some(Irregularity { form, depth, length, at }))
}
