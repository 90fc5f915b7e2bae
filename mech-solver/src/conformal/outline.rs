//! The outline of a prismatic body across its axis, as boundary elements.
//!
//! Elements are arcs. Those of the contact are equal, and numbered along the surface; the outline goes on from them
//! on both sides, along the shape as far as it is given and straight from there, in elements that grow. A closed outline is a circle.
//!
//! y is across, z up, s along the surface; the direction of the surface is (cos θ, sin θ), the common normal of
//! both bodies (−sin θ, cos θ), from the lower into the upper body.

/// How much longer an element is than the one before, away from the contact.
const GROWTH: f64 = 1.5;
/// Angle that an element spans at most, away from the contact [rad].
const MOST_ANGLE: f64 = 0.2;

/// A boundary element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Its middle [m].
    pub(super) centre: [f64; 2],
    /// Direction θ of the surface there [rad].
    pub(super) direction: f64,
    /// Length along s [m].
    pub(super) length: f64,
    /// dθ/ds [1/m].
    pub(super) curvature: f64,
}

impl Arc {
    /// The place [m] and direction [rad] at the distance s from the middle [m].
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

/// A body's outline; the first elements are those of the contact.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outline {
    /// Elements of the contact.
    pub(super) contact: usize,
    /// All elements.
    pub(super) elements: Vec<Arc>,
    /// A circle whose elements reach round it.
    pub(super) closed: bool,
}

impl Outline {
    /// An arc of this curvature [1/m] over |s| ≤ `arc` [m], and straight beyond, as far as `reach` [m]; with `count` elements of
    /// the contact, of this length [m], from `first` on [m].
    #[must_use]
    pub(super) fn open(
        curvature: f64,
        arc: f64,
        [first, length]: [f64; 2],
        count: usize,
        reach: f64,
    ) -> Self {
        let bend = |s: f64| if s.abs() < arc { curvature } else { 0.0 };
        let place = |from: f64, length: f64| {
            let middle = from + 0.5 * length;
            let inside = middle.clamp(-arc, arc);
            let turned = Arc { centre: [0.0; 2], direction: 0.0, length: 0.0, curvature };
            let (end, direction) = turned.at(inside);
            let rest = middle - inside;
            let centre = [end[0] + rest * direction.cos(), end[1] + rest * direction.sin()];
            Arc { centre, direction, length, curvature: bend(middle) }
        };
        let mut elements: Vec<Arc> =
            (0..count).map(|j| place(first + j as f64 * length, length)).collect();
        let last = first + count as f64 * length;
        for (start, sign) in [(last, 1.0), (first, -1.0)] {
            let (mut at, mut size) = (start, length);
            while (at - start).abs() < reach {
                size *= GROWTH;
                // Up to where the arc begins or ends.
                let outwards = sign * at;
                for end in [-arc, arc] {
                    let left = end - outwards;
                    if left > 1e-9 * length && size > 0.75 * left {
                        size = if size > left { left } else { 0.5 * left };
                    }
                }
                if bend(at + sign * 0.5 * size) != 0.0 {
                    size = size.min(MOST_ANGLE / curvature.abs());
                }
                elements.push(place(if sign > 0.0 { at } else { at - size }, size));
                at += sign * size;
            }
        }
        Self { contact: count, elements, closed: false }
    }

    /// A circle of this curvature [1/m] in `count` elements, of which the middle of the contact's is at s = 0.
    #[must_use]
    pub(super) fn circle(curvature: f64, count: usize, contact: usize) -> Self {
        let length = std::f64::consts::TAU / curvature.abs() / count as f64;
        let turned = Arc { centre: [0.0; 2], direction: 0.0, length, curvature };
        let first = -0.5 * (contact as f64 - 1.0) * length;
        let place = |j: usize| {
            let (centre, direction) = turned.at(first + j as f64 * length);
            Arc { centre, direction, length, curvature }
        };
        Self { contact, elements: (0..count).map(place).collect(), closed: true }
    }
}
