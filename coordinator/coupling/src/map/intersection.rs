//! Mapping by intersection of elements: the weight of source element s in target element t is the
//! area |t ∩ s| of their intersection, projected onto the plane of t.
//!
//! Elements are convex, so t is clipped by the four sides of s in turn (I. E. Sutherland, G. W.
//! Hodgman, *Commun. ACM* 17 (1974) 32–42). In a common plane the areas are exact. On curved
//! surfaces they are as exact as the elements are plane; constants and integrals are kept exactly
//! there too. A target that intersects no source element takes the value of the nearest element, or
//! the mean of several at the same distance.

use super::nodes::{MappingWeights, Nodes, Target};
use super::patch::{Row, Vector};
use super::surface::Surface;
use rstar::AABB;

/// Fraction of the smaller element below which an area is rounding of coordinates.
const SLIVER: f64 = 1e-10;

/// A point in the plane of the target.
type Plane = [f64; 2];

/// Intersections of the elements of two surfaces.
pub(super) struct Intersection<'a> {
    source: &'a Surface,
    target: &'a Surface,
    polygon: Vec<Plane>,
    cut: Vec<Plane>,
}

impl<'a> Intersection<'a> {
    pub(super) fn new(source: &'a Surface, target: &'a Surface) -> Self {
        Self { source, target, polygon: Vec::new(), cut: Vec::new() }
    }

    /// Returns the area common to two plane quadrilaterals.
    fn common(&mut self, target: [Plane; 4], source: [Plane; 4]) -> f64 {
        self.polygon.clear();
        self.polygon.extend(target);
        let turn = area(&source).signum();
        for side in 0..4 {
            let (a, b) = (source[side], source[(side + 1) % 4]);
            let left = |p: Plane| turn * cross(minus(b, a), minus(p, a));
            self.cut.clear();
            for n in 0..self.polygon.len() {
                let (p, q) = (self.polygon[n], self.polygon[(n + 1) % self.polygon.len()]);
                let (at_p, at_q) = (left(p), left(q));
                if at_p >= 0.0 {
                    self.cut.push(p);
                }
                if at_p * at_q < 0.0 {
                    let part = at_p / (at_p - at_q);
                    self.cut.push([0, 1].map(|k| p[k] + part * (q[k] - p[k])));
                }
            }
            std::mem::swap(&mut self.polygon, &mut self.cut);
        }
        area(&self.polygon).abs()
    }
}

impl MappingWeights for Intersection<'_> {
    const OF_POINTS: bool = false;

    fn weigh(&mut self, target: &Target, row: &mut Row) {
        let corners = self.target.corners(target.index);
        let frame = Frame::of(&corners, target.place);
        let shape = corners.map(|corner| frame.place(corner));
        let reach = frame.normal.dot(&(target.foot.point - target.place)).abs();
        let reach = Vector::repeat(reach + SLIVER * self.target.size(target.index));
        let low = corners.iter().fold(corners[0], |low, corner| low.inf(corner)) - reach;
        let high = corners.iter().fold(corners[0], |high, corner| high.sup(corner)) + reach;
        let near = AABB::from_corners(low.into(), high.into());
        let source = self.source;
        for patch in source.tree.locate_in_envelope_intersecting(near) {
            let element = patch.nodes[0] as usize;
            let other = source.corners(element).map(|corner| frame.place(corner));
            let common = self.common(shape, other);
            let smaller = source.areas[element].min(self.target.areas[target.index]);
            if common > SLIVER * smaller {
                row.push((element as u32, common));
            }
        }
        if row.is_empty() {
            row.extend(source.at(&target.foot).map(|element| (element, 1.0)));
        }
    }
}

/// The plane of an element.
struct Frame {
    origin: Vector,
    along: Vector,
    across: Vector,
    normal: Vector,
}

impl Frame {
    fn of(corners: &[Vector; 4], origin: Vector) -> Self {
        let [a, b, c, d] = *corners;
        let normal = (c - a).cross(&(d - b)).normalize();
        let along = b - a;
        let along = (along - along.dot(&normal) * normal).normalize();
        Self { origin, along, across: normal.cross(&along), normal }
    }

    fn place(&self, point: Vector) -> Plane {
        let point = point - self.origin;
        [self.along.dot(&point), self.across.dot(&point)]
    }
}

fn minus(a: Plane, b: Plane) -> Plane {
    [a[0] - b[0], a[1] - b[1]]
}

fn cross(a: Plane, b: Plane) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns the area of a polygon, positive if its corners run anticlockwise.
fn area(polygon: &[Plane]) -> f64 {
    let sides = (0..polygon.len()).map(|n| (polygon[n], polygon[(n + 1) % polygon.len()]));
    0.5 * sides.map(|(a, b)| cross(a, b)).sum::<f64>()
}
