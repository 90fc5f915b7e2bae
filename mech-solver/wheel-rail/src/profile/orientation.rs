//! Conversion from the axes of a file to those of a profile: y to the field side, z up, points with
//! rising y.
//!
//! The direction of the heights is that of the format, or that which the case prescribes. It is
//! read from the shape for an instrument that writes either. The flange of a wheel and the corners
//! or the groove of a rail then hang below the running surface, whose height is the median over y.
//! Without such a feature the shape shows nothing: a hollow tread turned over is a crown. The side
//! of the middle of the track shows only in a wheel, by its flange. There it is checked; for a rail
//! the file must be trusted.

use super::error::ProfileError;

/// Direction of the heights in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heights {
    /// Detected from the shape; a shape that does not show it is refused.
    #[default]
    Detected,
    /// Up by convention; a shape that shows the opposite is refused.
    UpByConvention,
    /// Up, for any shape.
    Up,
    /// Down, for any shape.
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
/// Depth of the corners of a rail below its running surface that shows which way is up [m]. Between
/// them a worn head is hollow by far less.
const CORNERS: f64 = 5e-3;
/// Least and largest width of a profile [m]. The height is limited by the larger value too.
const WIDTH: [f64; 2] = [5e-3, 0.5];

/// Converts points to the axes of a profile [m]; `mirrored` if y of the file points to the middle
/// of the track.
///
/// # Errors
/// Fails if the size is implausible for a profile, if the shape does not show the direction of its
/// heights or contradicts the convention, or if the flange is on the field side.
pub fn oriented(
    mut points: Vec<[f64; 2]>,
    body: Body,
    heights: Heights,
    mirrored: bool,
) -> Result<Vec<[f64; 2]>, ProfileError> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Err(ProfileError::Missing("points"));
    };
    let falls = first[0] > last[0];
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
        Heights::Detected => shows_down(&points, body).ok_or(ProfileError::UnclearHeights)?,
        Heights::UpByConvention => match shows_down(&points, body) {
            Some(true) => return Err(ProfileError::HeightsDown),
            _ => false,
        },
    };
    for point in &mut points {
        let flip = |value: f64, flipped: bool| if flipped { -value } else { value };
        *point = [flip(point[0], mirrored), flip(point[1], down)];
    }
    if falls != mirrored {
        points.reverse();
    }
    match body {
        Body::Wheel => check_flange(&points, width)?,
        Body::Rail => {}
    }
    Ok(points)
}

/// Returns whether the shape shows that heights point down; `None` if it does not show either.
fn shows_down(points: &[[f64; 2]], body: Body) -> Option<bool> {
    let surface = running_surface(points);
    let heights = || points.iter().map(|point| point[1] - surface);
    let [above, below] = [heights().fold(0.0, f64::max), -heights().fold(0.0, f64::min)];
    let feature = match body {
        Body::Wheel => FLANGE,
        Body::Rail => CORNERS,
    };
    match above.max(below) > feature {
        true if above < 0.5 * below => Some(false),
        true if below < 0.5 * above => Some(true),
        _ => None,
    }
}

/// Median of the heights over y [m]: half of the width is higher.
fn running_surface(points: &[[f64; 2]]) -> f64 {
    let part =
        |pair: &[[f64; 2]]| (0.5 * (pair[0][1] + pair[1][1]), (pair[1][0] - pair[0][0]).abs());
    let mut parts: Vec<(f64, f64)> = points.windows(2).map(part).collect();
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let width: f64 = parts.iter().map(|part| part.1).sum();
    let mut covered = 0.0;
    let middle = parts.iter().find(|part| {
        covered += part.1;
        covered >= 0.5 * width
    });
    middle.or(parts.last()).map_or(points[0][1], |part| part.0)
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
