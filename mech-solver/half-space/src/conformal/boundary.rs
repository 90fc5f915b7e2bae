//! Flexibility of a prismatic body by boundary elements.
//!
//! Tractions t e^{ikx} on the surface make displacements u e^{ikx} with Somigliana's identity,
//!
//! ½ u_j(P) + ∫ T_ij(Q − P) u_i(Q) ds = ∫ U_ij(Q − P) t_i(Q) ds,
//!
//! U and T are the kernels of [`super::kernel`], with the normal out of the body. u and t are
//! constant on each element, and the identity is collocated at the midpoints of the elements.
//!
//! In plane strain (k = 0) the load on a circle has to be in balance. A line force through the
//! centre balances it, and the rigid-body motion is removed.
//!
//! Components are along x (with the factor i), along the surface, and along the common normal of
//! both bodies.
//!
//! Source: Brebbia, Telles, Wrobel, Boundary Element Techniques (1984), ch. 5.

use super::kernel::{ElasticConstants, Tensor, kernel};
use super::outline::{Arc, Outline};
use faer::Mat;
use faer::prelude::Solve;
use numerics::quadrature::{GAUSS_4, GAUSS_8, GAUSS_16};

/// Waves that decay by more than e^{−NOTHING} are neglected.
const NOTHING: f64 = 45.0;
/// Reach of the outline beyond the contact, over 1/k: displacements there have decayed to e^{−FAR}.
const FAR: f64 = 25.0;
/// Power that clusters quadrature points at the middle of an element, for the logarithm there.
const GATHERED: i32 = 5;

/// A prismatic body.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Elastic constants.
    pub(super) material: ElasticConstants,
    /// Surface of the body.
    pub(super) outline: Outline,
    /// 1 for the body below the surface, −1 for the body above.
    pub(super) outward: f64,
}

impl Body {
    /// Returns the displacements of the contact's elements under tractions on them [m/Pa], at the
    /// wave number k [1/m]. Component c on element j has row and column 3j + c.
    #[must_use]
    pub(super) fn flexibility(&self, k: f64) -> Mat<f64> {
        let (elements, contact) = (self.outline.near_contact(FAR / k), self.outline.contact);
        let size = 3 * elements.len();
        let mut left = Mat::zeros(size, size);
        let mut right = Mat::zeros(size, 3 * contact);
        for (q, source) in elements.iter().enumerate() {
            for (p, target) in elements.iter().enumerate() {
                let [u, t] = self.integrals(k, target, source, p == q);
                let (own, turned) = (if p == q { 0.5 } else { 0.0 }, axes(target.direction));
                for j in 0..3 {
                    for i in 0..3 {
                        left[(3 * p + j, 3 * q + i)] = t[i][j] + own * turned[i][j];
                        if q < contact {
                            right[(3 * p + j, 3 * q + i)] = u[i][j];
                        }
                    }
                }
            }
        }
        // A closed body bounded by the circle is not held at k = 0.
        if k == 0.0 && self.outline.closed && self.outward * elements[0].curvature < 0.0 {
            self.balance(&mut left, &mut right);
        }
        let solved = left.partial_piv_lu().solve(&right);
        solved.subrows(0, 3 * contact).to_owned()
    }

    /// Integrals of U and T over a source element, seen from the middle of a target. Rows are
    /// components along the source's axes, columns along y and z.
    fn integrals(&self, k: f64, target: &Arc, source: &Arc, own: bool) -> [Tensor; 2] {
        let mut sums = [[[0.0; 3]; 3]; 2];
        let half = 0.5 * source.length;
        let mut add = |s: f64, weight: f64| {
            let (place, direction) = source.at(s);
            let d = [place[0] - target.centre[0], place[1] - target.centre[1]];
            let normal = [-self.outward * direction.sin(), self.outward * direction.cos()];
            let both = kernel(&self.material, k, d, normal);
            let axes = axes(direction);
            for (sum, tensor) in sums.iter_mut().zip(both) {
                for i in 0..3 {
                    for j in 0..3 {
                        let along: f64 = (0..3).map(|l| axes[i][l] * tensor[l][j]).sum();
                        sum[i][j] += weight * along;
                    }
                }
            }
        };
        if own {
            for (x, weight) in GAUSS_16 {
                let x = 0.5 * (1.0 + x);
                let s = half * x.powi(GATHERED);
                let weight = 0.5 * weight * half * f64::from(GATHERED) * x.powi(GATHERED - 1);
                add(s, weight);
                add(-s, weight);
            }
            return sums;
        }
        let d = [source.centre[0] - target.centre[0], source.centre[1] - target.centre[1]];
        let distance = d[0].hypot(d[1]);
        if k * (distance - half) > NOTHING {
            return sums;
        }
        let distance = distance / source.length;
        let rule: &[(f64, f64)] = match distance {
            near if near < 1.6 => &GAUSS_16,
            near if near < 5.0 => &GAUSS_8,
            _ => &GAUSS_4,
        };
        for (x, weight) in rule {
            add(half * x, half * weight);
        }
        sums
    }

    /// Holds a closed body at the centre.
    fn balance(&self, left: &mut Mat<f64>, right: &mut Mat<f64>) {
        let elements = &self.outline.elements;
        let curvature = elements[0].curvature;
        let centre = [0.0, 1.0 / curvature];
        // Subtracts the force of each traction, applied at the centre.
        for (p, target) in elements.iter().enumerate() {
            let d = [centre[0] - target.centre[0], centre[1] - target.centre[1]];
            let [u, _] = kernel(&self.material, 0.0, d, [0.0, 1.0]);
            for (q, source) in elements[..self.outline.contact].iter().enumerate() {
                let turned = axes(source.direction);
                // The mean direction over an arc is the direction of its middle, shortened by the
                // turn of the arc.
                let half = 0.5 * source.curvature * source.length;
                let mean = source.length * half.sin() / half;
                for i in 0..3 {
                    let length = if i == 0 { source.length } else { mean };
                    for j in 0..3 {
                        let along: f64 = (0..3).map(|l| turned[i][l] * u[l][j]).sum();
                        right[(3 * p + j, 3 * q + i)] -= length * along;
                    }
                }
            }
        }
        // Rigid motions: along x, y and z, and about the centre. Columns are along the axes of the
        // elements, rows along y and z.
        let motion = |kind: usize, element: &Arc| -> [f64; 3] {
            let arm = [0, 1].map(|k| (element.centre[k] - centre[k]) * curvature);
            match kind {
                0 => [1.0, 0.0, 0.0],
                1 => [0.0, 1.0, 0.0],
                2 => [0.0, 0.0, 1.0],
                _ => [0.0, -arm[1], arm[0]],
            }
        };
        for kind in 0..4 {
            let global: Vec<[f64; 3]> = elements.iter().map(|e| motion(kind, e)).collect();
            for (q, element) in elements.iter().enumerate() {
                for (i, axis) in axes(element.direction).iter().enumerate() {
                    let along: f64 = axis.iter().zip(&global[q]).map(|(a, g)| a * g).sum();
                    for (p, global) in global.iter().enumerate() {
                        for (j, global) in global.iter().enumerate() {
                            left[(3 * p + j, 3 * q + i)] += global * along / elements.len() as f64;
                        }
                    }
                }
            }
        }
    }
}

/// Directions x, s and n, in components x, y, z.
fn axes(direction: f64) -> Tensor {
    let (sin, cos) = direction.sin_cos();
    [[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]]
}

#[cfg(test)]
mod elements;
#[cfg(test)]
mod tests;
