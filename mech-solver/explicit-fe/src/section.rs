//! The cross-section of a body: nodes across and into it, fine near the contact, coarser away from
//! it.

/// Numbers of layers, across and in depth, that grow from the fine zone to the faces.
const STRETCHED: [usize; 2] = [10, 15];

/// Sizes of a cross-section [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Edges of the elements in the fine zone.
    pub element: f64,
    /// Lateral position of the middle.
    pub middle: f64,
    /// Half the width, and the depth, of the fine zone.
    pub fine: [f64; 2],
    /// Half the width, and the depth, of the body.
    pub whole: [f64; 2],
}

/// Nodes of a cross-section.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Elements across and in depth.
    pub counts: [usize; 2],
    /// (y, depth) [m] of the nodes, row by row from the surface on; depth counts from the plane
    /// that touches the surface.
    pub nodes: Vec<[f64; 2]>,
    /// First and last node across of the fine zone.
    pub fine: [usize; 2],
}

impl Section {
    /// Creates a cross-section of these sizes, whose surface is `drop(y)` [m] below the plane.
    /// Layers follow the curve of the surface at the top, and are flat at the bottom.
    #[must_use]
    pub fn new(sizes: &Sizes, drop: impl Fn(f64) -> f64) -> Self {
        let Sizes { element, middle, fine, whole } = *sizes;
        let side = graded(element, fine[0], STRETCHED[0], whole[0]);
        let deep = graded(element, fine[1], STRETCHED[1], whole[1]);
        let sides = side[1..].iter().rev().map(|y| -y).chain(side.iter().copied());
        let y: Vec<[f64; 2]> = sides.map(|y| [middle + y, drop(middle + y)]).collect();
        let node = |depth: f64, [y, drop]: [f64; 2]| [y, depth + drop * (1.0 - depth / whole[1])];
        let row = |depth: &f64| y.iter().map(|y| node(*depth, *y)).collect::<Vec<_>>();
        Self {
            counts: [y.len() - 1, deep.len() - 1],
            nodes: deep.iter().flat_map(row).collect(),
            fine: [STRETCHED[0], y.len() - 1 - STRETCHED[0]],
        }
    }

    /// Corners of an element, in the order of [`super::shape::Shape::new`].
    #[must_use]
    pub fn corners(&self, j: usize, k: usize) -> [[f64; 2]; 4] {
        let at = |j: usize, k: usize| self.nodes[k * (self.counts[0] + 1) + j];
        [at(j, k), at(j + 1, k), at(j, k + 1), at(j + 1, k + 1)]
    }

    /// Width represented by a node across [m].
    #[must_use]
    pub fn width(&self, j: usize) -> f64 {
        let y = |j: usize| self.nodes[j][0];
        0.5 * (y((j + 1).min(self.counts[0])) - y(j.saturating_sub(1)))
    }
}

/// Depth of a circle below its top, over y [m]. The radius is infinite for a straight surface and
/// negative for a concave one.
pub fn circle(radius: f64) -> impl Fn(f64) -> f64 + Copy {
    move |y| {
        if radius.is_finite() {
            y * y / (radius + radius.signum() * (radius * radius - y * y).max(0.0).sqrt())
        } else {
            0.0
        }
    }
}

/// Coordinates from 0 on: equal spacing up to `fine` or just beyond, then `count` intervals that
/// grow by a constant ratio up to `whole`.
fn graded(even: f64, fine: f64, count: usize, whole: f64) -> Vec<f64> {
    let steps = (fine / even * (1.0 - 1e-9)).ceil().max(1.0) as usize;
    let mut places: Vec<f64> = (0..=steps).map(|step| step as f64 * even).collect();
    let start = steps as f64 * even;
    let sum = |ratio: f64| (1..=count as i32).map(|i| even * ratio.powi(i)).sum::<f64>();
    let (mut low, mut high) = (0.1, 10.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if start + sum(middle) > whole { &mut high } else { &mut low }) = middle;
    }
    let mut place = start;
    places.extend((1..=count as i32).map(|i| {
        place += even * low.powi(i);
        place
    }));
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fine_in_the_middle_and_whole_at_the_faces() {
        let sizes = Sizes { element: 1e-3, middle: 0.0, fine: [8e-3, 6e-3], whole: [60e-3; 2] };
        let section = Section::new(&sizes, circle(0.3));
        let [across, deep] = section.counts;
        assert_eq!([across, deep], [36, 21]);
        let (first, last) = (section.nodes[0], section.nodes[across]);
        assert!((first[0] + 60e-3).abs() < 1e-12 && (last[0] - 60e-3).abs() < 1e-12);
        // Sagitta of the circle at the face; the bottom is flat.
        let sagitta = 0.3 - (0.09_f64 - 0.0036).sqrt();
        assert!((last[1] - sagitta).abs() < 1e-15, "{last:?}");
        assert!(section.nodes[deep * (across + 1)..].iter().all(|n| (n[1] - 60e-3).abs() < 1e-12));
        let widths = (section.fine[0] + 1..section.fine[1]).map(|j| section.width(j));
        assert!(widths.into_iter().all(|width| (width - 1e-3).abs() < 1e-15));
    }
}
