//! Conversion from the axes of a file to those of a profile: y to the field side, z up, points with
//! rising y.
//!
//! The shape shows whether heights point up or down. Between its ends a rail rises above the
//! straight line through them, and a wheel hangs below that line, with or without its flange. The
//! side of the middle of the track shows only in a wheel, by its flange. There it is checked; for a
//! rail the file must be trusted.

use super::error::ProfileError;

/// Direction of the heights in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heights {
    /// Detected from the shape.
    #[default]
    Detected,
    /// Up.
    Up,
    /// Down.
    Down,
}

/// A body of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The lower body.
    Rail,
    /// The upper body.
    Wheel,
}

/// A profile has a flange if it hangs below its highest point by more than this [m].
const FLANGE: f64 = 15e-3;
/// Least and largest width of a profile [m]. The height is limited by the larger value too.
const WIDTH: [f64; 2] = [5e-3, 0.5];

/// Converts points to the axes of a profile [m]; `mirrored` if y of the file points to the middle
/// of the track.
///
/// # Errors
/// Fails if the size is implausible for a profile, or if the flange is on the field side.
pub fn oriented(
    mut points: Vec<[f64; 2]>,
    body: Body,
    heights: Heights,
    mirrored: bool,
) -> Result<Vec<[f64; 2]>, ProfileError> {
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
        return Err(ProfileError::Missing("points"));
    };
    let [width, height] = [0, 1].map(|k| {
        let values = || points.iter().map(|point| point[k]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    });
    if !(WIDTH[0]..=WIDTH[1]).contains(&width) || height > WIDTH[1] {
        return Err(ProfileError::Size(width.max(height)));
    }
    let down = match heights {
        Heights::Up => false,
        Heights::Down => true,
        Heights::Detected => (farthest(&points, first, last) > 0.0) != (body == Body::Rail),
    };
    for point in &mut points {
        let flip = |value: f64, flipped: bool| if flipped { -value } else { value };
        *point = [flip(point[0], mirrored), flip(point[1], down)];
    }
    if (first[0] > last[0]) != mirrored {
        points.reverse();
    }
    match body {
        Body::Wheel => check_flange(&points, width)?,
        Body::Rail => {}
    }
    Ok(points)
}

/// Height over the straight line through the ends [m], at the point where its magnitude is largest.
fn farthest(points: &[[f64; 2]], first: [f64; 2], last: [f64; 2]) -> f64 {
    let slope = match last[0] - first[0] {
        0.0 => 0.0,
        width => (last[1] - first[1]) / width,
    };
    let above = points.iter().map(|[y, z]| z - first[1] - slope * (y - first[0]));
    above.fold(0.0, |far: f64, height| if height.abs() > far.abs() { height } else { far })
}

fn check_flange(points: &[[f64; 2]], width: f64) -> Result<(), ProfileError> {
    let by_height = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
    let (Some(lowest), Some(highest)) =
        (points.iter().min_by(by_height), points.iter().max_by(by_height))
    else {
        return Ok(());
    };
    let from_field_side = points.iter().map(|[y, _]| y - lowest[0]).fold(0.0, f64::max);
    match highest[1] - lowest[1] > FLANGE && from_field_side < 0.5 * width {
        true => Err(ProfileError::FlangeOutside(lowest[0])),
        false => Ok(()),
    }
}
