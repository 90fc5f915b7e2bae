//! Conversion of the text of a file to the curve of a profile.

use super::error::ProfileError;
use super::orientation::{Body, Heights, oriented};
use super::text::decoded;
use super::{columns, miniprof, simpack};
use crate::outline::{Outline, Smoothing};
use numerics::search::root_between;
use std::path::Path;

/// File format of a profile.
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
    /// Format by the extension of the file name; columns for any other extension.
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
    /// Format of the file.
    pub format: Format,
    /// Body that the profile belongs to.
    pub body: Body,
    /// True if y of the file points to the middle of the track instead of the field side.
    pub mirrored: bool,
    /// Direction of the heights.
    pub heights: Heights,
    /// Smoothing of the points.
    pub smoothing: Smoothing,
}

impl Reading {
    /// Usual settings of a format: Miniprof with y to the middle of the track and z up or down,
    /// SIMPACK with z down, columns with z up.
    #[must_use]
    pub fn usual(format: Format, body: Body) -> Self {
        let mirrored = format == Format::Miniprof;
        let heights = match format {
            Format::Simpack => Heights::Down,
            Format::Miniprof => Heights::Detected,
            Format::Columns => Heights::UpByConvention,
        };
        Self { format, body, mirrored, heights, smoothing: Smoothing::Within(0.0) }
    }
}

/// Reads the curve of a profile in its own axes. s = 0 at y = 0 on the upper side of a rail or the
/// lower side of a wheel.
///
/// # Errors
/// Fails if the text does not match the format, or if its points are not a profile.
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

/// Moves s = 0 to y = 0. If the curve has no such point, s = 0 is at the highest point of a rail or
/// the lowest of a wheel.
#[must_use]
pub fn from_origin(curve: Outline, body: Body) -> Outline {
    let up = if body == Body::Rail { 1.0 } else { -1.0 };
    let [from, to] = curve.range();
    let outermost = curve.largest([from, to], |place| up * place.position[1]);
    let above = |s: f64| curve.at(s).position[0];
    // First crossing on the way from the outermost point towards y = 0.
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
