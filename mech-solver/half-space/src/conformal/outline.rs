//! The outline of a prismatic body across the axis, as boundary elements.
//!
//! Elements are arcs. The elements of the contact are equal and numbered along the surface. The
//! outline continues on both sides in growing elements: along the section as far as it is given,
//! and straight beyond. A closed outline is a circle.

use super::section::CrossSection;

/// Length of an element over the length of its inner neighbour, away from the contact.
const GROWTH: f64 = 1.5;
/// Largest angle that an element spans away from the contact [rad].
const MOST_ANGLE: f64 = 0.2;
/// Rounding allowed in that angle, as a share.
const ROUNDING: f64 = 1e-9;

/// A boundary element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Middle of the element [m].
    pub(super) centre: [f64; 2],
    /// Direction θ of the surface at the middle [rad].
    pub(super) direction: f64,
    /// Length along s [m].
    pub(super) length: f64,
    /// dθ/ds [1/m].
    pub(super) curvature: f64,
}

impl Arc {
    /// Position [m] and direction [rad] at the distance s from the middle [m].
    #[must_use]
    pub(super) fn at(&self, s: f64) -> ([f64; 2], f64) {
        let half = 0.5 * self.curvature * s;
        let chord = if half.abs() > 1e-8 { s * half.sin() / half } else { s };
        let along = self.direction + half;
        let [y, z] = self.centre;
        let place = [y + chord * along.cos(), z + chord * along.sin()];
        (place, self.direction + 2.0 * half)
    }
}

/// Outline of a body; the elements of the contact come first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outline {
    /// Number of elements of the contact.
    pub(super) contact: usize,
    /// All elements; those beyond the contact are sorted by their distance from it.
    pub(super) elements: Vec<Arc>,
    /// Distances along an open outline at which the elements beyond the contact begin [m].
    away: Vec<f64>,
    /// The outline is a circle whose elements cover the whole circumference.
    pub(super) closed: bool,
}

impl Outline {
    /// Outline of a section up to `reach` [m] beyond the contact, whose `count` elements of the
    /// given length [m] begin at `first` [m].
    #[must_use]
    pub(super) fn open(
        section: &CrossSection,
        [first, length]: [f64; 2],
        count: usize,
        reach: f64,
    ) -> Self {
        let turn = |from: f64, length: f64| section.at(from + length).1 - section.at(from).1;
        let place = |from: f64, length: f64| {
            let (centre, direction) = section.at(from + 0.5 * length);
            Arc { centre, direction, length, curvature: turn(from, length) / length }
        };
        let mut elements: Vec<Arc> =
            (0..count).map(|j| place(first + j as f64 * length, length)).collect();
        let last = first + count as f64 * length;
        let ends = section.ends();
        let mut beyond: Vec<(f64, Arc)> = Vec::new();
        for (start, sign) in [(last, 1.0), (first, -1.0)] {
            let (mut at, mut size) = (start, length);
            while (at - start).abs() < reach {
                size *= GROWTH;
                // Ends an element where the section begins or ends to turn.
                for end in ends {
                    let left = sign * (end - at);
                    if left > 1e-9 * length && size > 0.75 * left {
                        size = if size > left { left } else { 0.5 * left };
                    }
                }
                let spanned = |size: f64| turn(at, sign * size).abs() / MOST_ANGLE;
                while spanned(size) > 1.0 + ROUNDING {
                    size /= spanned(size);
                }
                let arc = place(if sign > 0.0 { at } else { at - size }, size);
                beyond.push(((at - start).abs(), arc));
                at += sign * size;
            }
        }
        beyond.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (away, beyond): (Vec<f64>, Vec<Arc>) = beyond.into_iter().unzip();
        elements.extend(beyond);
        Self { contact: count, elements, away, closed: false }
    }

    /// Elements of the contact and those within `reach` of it along the outline [m]; all elements
    /// of a circle.
    #[must_use]
    pub(super) fn near_contact(&self, reach: f64) -> &[Arc] {
        match self.closed {
            true => &self.elements,
            false => {
                let near = self.away.partition_point(|away| *away <= reach);
                &self.elements[..self.contact + near]
            }
        }
    }

    /// Circle of this curvature [1/m] in `count` elements; the middle of the contact is at s = 0.
    #[must_use]
    pub(super) fn circle(curvature: f64, count: usize, contact: usize) -> Self {
        let length = std::f64::consts::TAU / curvature.abs() / count as f64;
        let turned = Arc { centre: [0.0; 2], direction: 0.0, length, curvature };
        let first = -0.5 * (contact as f64 - 1.0) * length;
        let place = |j: usize| {
            let (centre, direction) = turned.at(first + j as f64 * length);
            Arc { centre, direction, length, curvature }
        };
        let elements = (0..count).map(place).collect();
        Self { contact, elements, away: Vec::new(), closed: true }
    }
}
