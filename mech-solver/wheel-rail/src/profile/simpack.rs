//! SIMPACK files, `.prr` for rails and `.prw` for wheels: `key = value` between `….begin` and
//! `….end`, points between `point.begin` and `point.end`, comments behind `!` or, as in CONTACT's
//! examples, `%`.
//!
//! The requests in the file are applied to its points in this order:
//!
//! 1. Omit points closer than `point.dist.min`.
//! 2. Shift by `shift.y`, `shift.z`.
//! 3. Rotate about x by `rotate`, from y to z.
//! 4. Omit points outside `bound.y.min` to `bound.y.max`, likewise for z, if the maximum is larger
//!    than the minimum.
//! 5. Mirror by `mirror.y`, `mirror.z`.
//! 6. Reverse the order with `inversion`.
//!
//! Lengths are divided by `units.len.f`, angles by `units.ang.f`. Smoothing follows
//! [`super::read::Reading`], not the file. Axes of the file are y to the field side and z down.

use super::error::ProfileError;
use super::text::{lines, number, numbers};

/// Contents of a file.
#[derive(Debug)]
struct Content {
    /// 0 for a rail, 1 for a wheel.
    body: Option<f64>,
    closest: f64,
    shift: [f64; 2],
    rotate: f64,
    /// Least and largest y, least and largest z.
    bounds: [f64; 4],
    mirror: [bool; 2],
    inverted: bool,
    length_unit: f64,
    angle_unit: f64,
    points: Vec<[f64; 2]>,
}

/// Reads the points in the axes of the file [m]. The second value is true for a wheel, false for a
/// rail, `None` if the file does not say.
///
/// # Errors
/// Fails if a line does not match the format, or if there are no points.
pub fn points(text: &str) -> Result<(Vec<[f64; 2]>, Option<bool>), ProfileError> {
    let content = parse(text)?;
    let is_wheel = content.body.map(|body| body != 0.0);
    Ok((content.processed(), is_wheel))
}

fn parse(text: &str) -> Result<Content, ProfileError> {
    let mut content = Content {
        body: None,
        closest: 0.0,
        shift: [0.0; 2],
        rotate: 0.0,
        bounds: [1.0, 0.0, 1.0, 0.0],
        mirror: [false; 2],
        inverted: false,
        length_unit: 1e3,
        angle_unit: 1.0,
        points: Vec::new(),
    };
    let (mut section, mut has_points) = ("", false);
    for (line, entry) in lines(text, &['!', '%']) {
        if let Some(name) = entry.strip_suffix(".begin") {
            section = name;
            has_points |= name == "point";
        } else if let Some(name) = entry.strip_suffix(".end") {
            // The points are nested in a spline section.
            section = if name == "point" { "spline" } else { "" };
        } else if section == "point" {
            let values = numbers(entry).filter(|values| (2..=3).contains(&values.len()));
            let point = values.map(|values| [values[0], values[1]]);
            let what = "is not a point: y, z and perhaps a weight";
            content.points.push(point.ok_or_else(|| ProfileError::line(line, what))?);
        } else if let Some((key, value)) = entry.split_once('=') {
            content.take(section, line, key.trim(), value)?;
        } else {
            return Err(ProfileError::line(line, "is neither `key = value` nor `….begin`"));
        }
    }
    if has_points { Ok(content) } else { Err(ProfileError::Missing("`point.begin`")) }
}

impl Content {
    fn take(
        &mut self,
        section: &str,
        line: usize,
        key: &str,
        value: &str,
    ) -> Result<(), ProfileError> {
        let number = || number(line, key, value);
        let positive = || match number()? {
            unit if unit > 0.0 => Ok(unit),
            _ => Err(ProfileError::line(line, format!("`{key}` is not above zero"))),
        };
        match key {
            "type" if section == "header" => self.body = Some(number()?),
            "point.dist.min" => self.closest = number()?,
            "shift.y" => self.shift[0] = number()?,
            "shift.z" => self.shift[1] = number()?,
            "rotate" => self.rotate = number()?,
            "bound.y.min" => self.bounds[0] = number()?,
            "bound.y.max" => self.bounds[1] = number()?,
            "bound.z.min" => self.bounds[2] = number()?,
            "bound.z.max" => self.bounds[3] = number()?,
            "mirror.y" => self.mirror[0] = number()? != 0.0,
            "mirror.z" => self.mirror[1] = number()? != 0.0,
            "inversion" => self.inverted = number()? != 0.0,
            "units.len.f" => self.length_unit = positive()?,
            "units.ang.f" => self.angle_unit = positive()?,
            _ => {}
        }
        Ok(())
    }

    fn processed(self) -> Vec<[f64; 2]> {
        let (sin, cos) = (self.rotate / self.angle_unit).sin_cos();
        let mut kept: Vec<[f64; 2]> = Vec::new();
        let [least_y, most_y, least_z, most_z] = self.bounds;
        let within =
            |value: f64, least: f64, most: f64| least >= most || (least..=most).contains(&value);
        let mut last: Option<[f64; 2]> = None;
        for point in self.points {
            let near =
                |last: [f64; 2]| (point[0] - last[0]).hypot(point[1] - last[1]) < self.closest;
            if last.is_some_and(near) {
                continue;
            }
            last = Some(point);
            let [y, z] = [point[0] + self.shift[0], point[1] + self.shift[1]];
            let [y, z] = [cos * y - sin * z, sin * y + cos * z];
            if within(y, least_y, most_y) && within(z, least_z, most_z) {
                let flip = |value: f64, flipped: bool| if flipped { -value } else { value };
                let mirrored = [flip(y, self.mirror[0]), flip(z, self.mirror[1])];
                kept.push(mirrored.map(|value| value / self.length_unit));
            }
        }
        if self.inverted {
            kept.reverse();
        }
        kept
    }
}
