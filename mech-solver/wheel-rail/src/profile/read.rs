//! From the text of a file to the curve of a profile.

use super::error::ProfileError;
use super::orientation::{Body, Heights, oriented};
use super::text::decoded;
use super::{columns, miniprof, simpack};
use crate::outline::{Outline, Smoothing};
use numerics::search::root_between;
use std::path::Path;

/// A format of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Miniprof, `.ban` and `.whl`.
    Miniprof,
    /// SIMPACK, `.prr` and `.prw`.
    Simpack,
    /// Columns of y and z.
    Columns,
}

impl Format {
    /// The format that the ending of a file's name tells; columns, if none.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("ban" | "whl") => Self::Miniprof,
            Some("prr" | "prw") => Self::Simpack,
            _ => Self::Columns,
        }
    }
}

/// Settings with which a file is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Its format.
    pub format: Format,
    /// Whose profile it is.
    pub body: Body,
    /// y of the file points to the middle of the track, not to the field side.
    pub mirrored: bool,
    /// Which way its heights point.
    pub heights: Heights,
    /// Smoothing of its points.
    pub smoothing: Smoothing,
}

impl Reading {
    /// As files of a format usually are: Miniprof with y to the middle of the track, SIMPACK with z down.
    #[must_use]
    pub fn usual(format: Format, body: Body) -> Self {
        let mirrored = format == Format::Miniprof;
        let heights = match format {
            Format::Simpack => Heights::Down,
            Format::Miniprof | Format::Columns => Heights::Detected,
        };
        Self { format, body, mirrored, heights, smoothing: Smoothing::Within(0.0) }
    }
}

/// The curve of a profile in its own axes, s = 0 at y = 0 on its upper or, of a wheel, lower side.
///
/// # Errors
/// The text is not of the format, or its points are no profile.
pub fn read(text: &[u8], reading: &Reading) -> Result<Outline, ProfileError> {
    let text = decoded(text)?;
    let points = match reading.format {
        Format::Miniprof => miniprof::points(&text)?,
        Format::Columns => columns::points(text)?,
        Format::Simpack => {
            let (points, is_wheel) = simpack::points(&text)?;
            match (reading.body, is_wheel) {
                (Body::Rail, Some(true)) => return Err(ProfileError::OtherBody("wheel")),
                (Body::Wheel, Some(false)) => return Err(ProfileError::OtherBody("rail")),
                _ => points,
            }
        }
    };
    let points = oriented(points, reading.body, reading.heights, reading.mirrored)?;
    Ok(from_origin(Outline::smoothed(&points, reading.smoothing)?, reading.body))
}

/// The curve with s = 0 where y = 0; at the highest point of a rail or the lowest of a wheel if it has no such
/// place.
#[must_use]
pub fn from_origin(curve: Outline, body: Body) -> Outline {
    let up = if body == Body::Rail { 1.0 } else { -1.0 };
    let [from, to] = curve.range();
    let outermost = curve.largest([from, to], |place| up * place.position[1]);
    let above = |s: f64| curve.at(s).position[0];
    // From the outermost point towards y = 0: the first place on that way.
    let side = if above(outermost) > 0.0 { from } else { to };
    let steps = 2000;
    let place = |k: usize| outermost + (side - outermost) * k as f64 / f64::from(steps);
    let sign = above(outermost).signum();
    let crossed = (0..=steps as usize).find(|k| above(place(*k)) * sign <= 0.0);
    let origin = match crossed {
        Some(0) => outermost,
        Some(k) => root_between([place(k - 1), place(k)], above).unwrap_or(place(k)),
        None => outermost,
    };
    curve.starting_at(origin)
}
