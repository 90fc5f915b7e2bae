//! The surface of a wheel or a rail over a position along the rolling direction: a constant profile
//! or slices, with or without a hollow.
//!
//! *Position.* On a rail it is the distance u along the track [m]. On a wheel it is the angle θ
//! [rad] from a mark on it, forwards from the lowest point while the wheel has not turned (`pitch`
//! 0): the mark θ is lowest at the pitch θ.
//!
//! *Hollow.* An irregularity of the depth d over the distance along the surface
//! ([`elastic::axle::Irregularity`]), constant across the profile. A rail is lower by d(u) in the
//! axes of its profile; the radius of a wheel is smaller by d(Rθ), with the nominal radius R. A
//! hollow worn by a rail of the crown radius R_c is shallower by s²/2R_c at the tape distance s
//! from the tape circle, and ends where its depth reaches zero.

use super::outline::{Outline, Place};
use super::slices::{Slices, Spot};
use elastic::axle::Irregularity;
use std::f64::consts::TAU;

/// Surface without its hollow.
#[derive(Clone, Debug, PartialEq)]
enum Sections {
    /// One profile.
    Same(Outline),
    /// Profiles in slices.
    Slices(Slices),
}

/// An irregularity of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hollow {
    form: Irregularity,
    /// Distance along the surface per position: 1 for a rail, the nominal radius for a wheel [m].
    radius: f64,
    circumference: f64,
    /// Half the inverse radius of the counter-body's crown, if it wore the hollow [1/m]; 0 for a
    /// hollow of constant depth across.
    across: f64,
    /// Unit vector into the body, y and z.
    inwards: [f64; 2],
}

/// Surface of a wheel or a rail.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    sections: Sections,
    hollow: Option<Hollow>,
}

impl Hollow {
    /// Moves a point into the body.
    fn dig(&self, position: f64, s: f64, spot: &mut Spot) {
        let Self { form, radius, circumference, across, inwards } = self;
        let way = radius * position;
        let depth = form.hollow(way, *circumference) - across * s * s;
        if depth <= 0.0 {
            return;
        }
        let slope = radius * form.slope(way, *circumference);
        for (k, inwards) in inwards.iter().enumerate() {
            spot.place.position[k] += depth * inwards;
            spot.place.tangent[k] -= 2.0 * across * s * inwards;
            spot.along[k] += slope * inwards;
        }
    }
}

impl From<Outline> for Surface {
    fn from(outline: Outline) -> Self {
        Self { sections: Sections::Same(outline), hollow: None }
    }
}

impl From<Slices> for Surface {
    fn from(slices: Slices) -> Self {
        Self { sections: Sections::Slices(slices), hollow: None }
    }
}

impl Surface {
    /// Adds an irregularity to the surface of a rail.
    #[must_use]
    pub fn hollow_rail(mut self, form: Irregularity) -> Self {
        let (radius, circumference) = (1.0, f64::INFINITY);
        self.hollow =
            Some(Hollow { form, radius, circumference, across: 0.0, inwards: [0.0, -1.0] });
        self
    }

    /// Adds an irregularity to the surface of a wheel of a nominal radius [m]. With `crown` the
    /// hollow was worn by a crown of this radius [m]; otherwise its depth is constant across.
    #[must_use]
    pub fn hollow_wheel(mut self, form: Irregularity, radius: f64, crown: Option<f64>) -> Self {
        let circumference = TAU * radius;
        let across = crown.map_or(0.0, |crown| 0.5 / crown);
        self.hollow = Some(Hollow { form, radius, circumference, across, inwards: [0.0, 1.0] });
        self
    }

    /// Profile, if it is the same at all positions.
    #[must_use]
    pub fn constant(&self) -> Option<&Outline> {
        match (&self.sections, self.hollow) {
            (Sections::Same(outline), None) => Some(outline),
            _ => None,
        }
    }

    /// First and last s [m].
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        match &self.sections {
            Sections::Same(outline) => outline.range(),
            Sections::Slices(slices) => slices.range(),
        }
    }

    /// Point of the surface at a position and s [m]. The search starts at the piece `near`, which
    /// receives the piece of s.
    #[must_use]
    pub fn at(&self, position: f64, s: f64, near: &mut usize) -> Spot {
        let mut spot = match &self.sections {
            Sections::Same(outline) => Spot { place: outline.at_near(s, near), along: [0.0; 2] },
            Sections::Slices(slices) => slices.at(position, s, near),
        };
        if let Some(hollow) = &self.hollow {
            hollow.dig(position, s, &mut spot);
        }
        spot
    }

    /// Point of the surface without the derivatives along the position.
    #[must_use]
    pub fn place(&self, position: f64, s: f64, near: &mut usize) -> Place {
        self.at(position, s, near).place
    }

    /// Inclination of the section at a position and s, from y to z [rad].
    #[must_use]
    pub fn angle(&self, position: f64, s: f64) -> f64 {
        match self.constant() {
            Some(outline) => outline.at(s).angle(),
            None => self.place(position, s, &mut 0).angle(),
        }
    }

    /// Profile at a position. A hollow is included only if its depth is constant across.
    #[must_use]
    pub fn section(&self, position: f64) -> Outline {
        let section = self.smooth_section(position);
        match self.hollow.filter(|hollow| hollow.across == 0.0) {
            None => section,
            Some(Hollow { form, radius, circumference, inwards, .. }) => {
                let depth = form.hollow(radius * position, circumference);
                section.placed(0.0, inwards.map(|part| depth * part))
            }
        }
    }

    /// Profile at a position, without the hollow.
    #[must_use]
    pub fn smooth_section(&self, position: f64) -> Outline {
        match &self.sections {
            Sections::Same(outline) => outline.clone(),
            Sections::Slices(slices) => slices.section(position),
        }
    }

    /// Mirrors the surface at the z-axis: (y, s) → (−y, −s).
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let sections = match &self.sections {
            Sections::Same(outline) => Sections::Same(outline.mirrored()),
            Sections::Slices(slices) => Sections::Slices(slices.mirrored()),
        };
        let flip =
            |hollow: Hollow| Hollow { inwards: [-hollow.inwards[0], hollow.inwards[1]], ..hollow };
        Self { sections, hollow: self.hollow.map(flip) }
    }

    /// Turns the surface about the origin of the profiles, from y to z, by `angle` [rad], then
    /// shifts it by (y, z) [m].
    #[must_use]
    pub fn placed(&self, angle: f64, shift: [f64; 2]) -> Self {
        let sections = match &self.sections {
            Sections::Same(outline) => Sections::Same(outline.placed(angle, shift)),
            Sections::Slices(slices) => Sections::Slices(slices.placed(angle, shift)),
        };
        let (sin, cos) = angle.sin_cos();
        let turn = |hollow: Hollow| {
            let [y, z] = hollow.inwards;
            Hollow { inwards: [cos * y - sin * z, sin * y + cos * z], ..hollow }
        };
        Self { sections, hollow: self.hollow.map(turn) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{rail_60e1, wheel_s1002};
    use elastic::axle::Form;

    /// A hollow worn by a crown has the depth of the form at the tape circle, ends where the crown
    /// does, and has the tangent of its own points.
    #[test]
    fn a_worn_hollow_ends_across() {
        let form = Irregularity { form: Form::Flat, depth: 0.8e-3, length: 0.1, at: 0.0 };
        let profile = wheel_s1002().unwrap();
        let worn = Surface::from(profile.clone()).hollow_wheel(form, 0.46, Some(0.3));
        for (s, depth) in [(0.0, 0.8e-3), (12e-3, 0.56e-3), (-12e-3, 0.56e-3), (22e-3, 0.0)] {
            let height = |s: f64| worn.place(0.0, s, &mut 0).position[1];
            assert!((height(s) - profile.at(s).position[1] - depth).abs() < 1e-12, "{s}");
            let slope = (height(s + 1e-7) - height(s - 1e-7)) / 2e-7;
            assert!((worn.place(0.0, s, &mut 0).tangent[1] - slope).abs() < 1e-6, "{s}");
        }
    }

    /// A hollow goes into the body, is turned and mirrored with the body, and appears in sections.
    #[test]
    fn a_hollow_goes_into_the_body() {
        let form = Irregularity { form: Form::Flat, depth: 1e-3, length: 0.1, at: 0.2 };
        let wheel = Surface::from(wheel_s1002().unwrap()).hollow_wheel(form, 0.5, None);
        let dip = Irregularity { form: Form::Dip, ..form };
        let rail = Surface::from(rail_60e1().unwrap()).hollow_rail(dip);
        for (surface, position, sign) in [(wheel, 0.4, 1.0), (rail, 0.2, -1.0)] {
            assert!(surface.constant().is_none());
            let smooth = surface.smooth_section(0.0).at(3e-3).position;
            for (more, depth) in [(0.0, 1e-3), (0.025 / 0.2 * position, 0.5e-3), (1.0, 0.0)] {
                let at = position + more;
                let [y, z] = surface.place(at, 3e-3, &mut 0).position;
                assert!((y - smooth[0]).abs() < 1e-15);
                assert!((z - smooth[1] - sign * depth).abs() < 1e-12, "{at} {z} {smooth:?}");
                let section = surface.section(at).at(3e-3).position;
                assert!((z - section[1]).abs() < 1e-15);
                let moved = surface.mirrored().placed(0.2, [0.0; 2]);
                let [left, up] = moved.place(at, -3e-3, &mut 0).position;
                let (sin, cos) = 0.2_f64.sin_cos();
                assert!((left - (-cos * y - sin * z)).abs() < 1e-15);
                assert!((up - (cos * z - sin * y)).abs() < 1e-15);
                let [behind, ahead] =
                    [-1e-6, 1e-6].map(|step| surface.place(at + step, 0.0, &mut 0).position[1]);
                let slope = surface.at(at, 0.0, &mut 0).along[1];
                assert!((slope - (ahead - behind) / 2e-6).abs() < 1e-6);
            }
        }
    }
}
