//! Quality of the elements of a body, with the measures of a mesh generator.

use super::section::Section;
use super::shape::{SIGNS, nodes};

/// Worst values over all elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Ratio of the longest to the shortest edge of an element.
    pub aspect: f64,
    /// Scaled Jacobian: the determinant of the unit vectors along the three edges at a node. It is
    /// 1 in a cuboid, and not positive in an element that folds over (Knupp, Int. J. Numer. Meth.
    /// Engng 48 (2000) 1165–1185).
    pub jacobian: f64,
    /// Ratio of an edge to the next one in the same direction, larger to smaller.
    pub growth: f64,
    /// Shortest edge [m].
    pub shortest: f64,
}

impl Quality {
    /// Quality of the elements of a cross-section, extruded over a length [m] along x or revolved
    /// about an axis.
    #[must_use]
    pub fn of(section: &Section, length: f64, radius: f64) -> Self {
        let mut worst = Self { aspect: 1.0, jacobian: 1.0, growth: 1.0, shortest: f64::INFINITY };
        let [across, deep] = section.counts;
        let mut widths = vec![0.0_f64; across];
        for layer in 0..deep {
            let mut beside = 0.0;
            for (j, above) in widths.iter_mut().enumerate() {
                let nodes = nodes(section.corners(j, layer), length, radius);
                let edge = |from: usize, to: usize| {
                    let edge: [f64; 3] = std::array::from_fn(|k| nodes[to][k] - nodes[from][k]);
                    edge.map(|part| part / edge.iter().map(|part| part * part).sum::<f64>().sqrt())
                };
                let size = |from: usize, to: usize| {
                    nodes[from]
                        .iter()
                        .zip(nodes[to])
                        .map(|(from, to)| (to - from).powi(2))
                        .sum::<f64>()
                        .sqrt()
                };
                let (mut longest, mut shortest) = (0.0_f64, f64::INFINITY);
                for (node, sign) in SIGNS.iter().enumerate() {
                    let ends = [node ^ 1, node ^ 2, node ^ 4];
                    let [x, y, z] = ends.map(|end| edge(node, end));
                    let product: f64 = (0..3)
                        .map(|k| {
                            x[k] * (y[(k + 1) % 3] * z[(k + 2) % 3]
                                - y[(k + 2) % 3] * z[(k + 1) % 3])
                        })
                        .sum();
                    // Edges point into the element. They are ordered like the axes if an even
                    // number of signs is positive.
                    let order = -sign.iter().product::<f64>();
                    worst.jacobian = worst.jacobian.min(order * product);
                    for end in ends {
                        longest = longest.max(size(node, end));
                        shortest = shortest.min(size(node, end));
                    }
                }
                worst.aspect = worst.aspect.max(longest / shortest);
                worst.shortest = worst.shortest.min(shortest);
                let [width, depth] = [size(0, 2), size(0, 4)];
                for (before, now) in [(beside, width), (*above, depth)] {
                    if before > 0.0 {
                        worst.growth = worst.growth.max((now / before).max(before / now));
                    }
                }
                (beside, *above) = (width, depth);
            }
        }
        worst
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section(nodes: Vec<[f64; 2]>) -> Section {
        Section { counts: [2, 1], nodes, fine: [0, 2] }
    }

    /// Cuboids 1 and 2 wide, 4 deep, 2 long; then with a corner moved such that its angle is 45°,
    /// and folded over.
    #[test]
    fn cuboids_and_worse() {
        let cuboids = vec![[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [0.0, 4.0], [1.0, 4.0], [3.0, 4.0]];
        let quality = Quality::of(&section(cuboids.clone()), 2.0, f64::INFINITY);
        let expected = Quality { aspect: 4.0, jacobian: 1.0, growth: 2.0, shortest: 1.0 };
        assert_eq!(quality, expected);
        let mut skewed = cuboids.clone();
        skewed[2] = [3.0, 2.0];
        let angle = Quality::of(&section(skewed), 2.0, f64::INFINITY).jacobian;
        assert!((angle - 0.5_f64.sqrt()).abs() < 1e-15, "{angle}");
        let mut folded = cuboids;
        folded[1] = [-0.5, 0.0];
        assert!(Quality::of(&section(folded), 2.0, f64::INFINITY).jacobian < 0.0);
    }

    /// About an axis, edges along the motion are shorter at depth: (R − 4)/R times the chord of 2
    /// at the surface.
    #[test]
    fn about_an_axis_edges_shorten() {
        let nodes = vec![[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [0.0, 4.0], [2.0, 4.0], [4.0, 4.0]];
        let quality = Quality::of(&section(nodes), 2.0, 8.0);
        assert!((quality.shortest - 8.0 * 0.125_f64.sin()).abs() < 1e-12, "{quality:?}");
        assert!(quality.jacobian < 1.0);
    }
}
