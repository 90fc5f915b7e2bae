//! Finite elements of the section of a prismatic body, a reference for the boundary elements.
//!
//! Displacements (i u_x, u_y, u_z) e^{ikx} have the strains −k u_x, ∂_y u_y, ∂_z u_z, ∂_z u_y + ∂_y
//! u_z, i(∂_y u_x + k u_y) and i(∂_z u_x + k u_z), so that the energy is a real form of three
//! fields over the section. Elements have nine nodes in columns below (or above) the surface, at
//! the distances of a graded row from it; far away, where the wave has decayed, they are held.
//! Tractions are integrated over the arcs on which they act. Only the section is shared with the
//! boundary elements.

use super::*;
use crate::conformal::section::CrossSection;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use numerics::quadrature::GAUSS_3;

/// Finite elements per boundary element, and growth of the elements beyond them.
const FINER: usize = 3;
const GROWTH: f64 = 1.3;
/// Distance k·s at which the body is held; a share e^{−HELD} of the displacement is left there.
const HELD: f64 = 9.0;

/// Quadratic shape functions on (−1, 1), and their slopes.
fn quadratic(x: f64) -> [[f64; 2]; 3] {
    [[0.5 * x * (x - 1.0), x - 0.5], [1.0 - x * x, -2.0 * x], [0.5 * x * (x + 1.0), x + 0.5]]
}

/// Edges of elements, with the midpoints between them.
fn with_middles(edges: &[f64]) -> Vec<f64> {
    let mut nodes = vec![edges[0]];
    nodes.extend(edges.windows(2).flat_map(|pair| [0.5 * (pair[0] + pair[1]), pair[1]]));
    nodes
}

/// Edges from `start` to beyond `reach`; the first element has the length `size`, later ones grow.
fn growing(start: f64, size: f64, reach: f64) -> Vec<f64> {
    let (mut edges, mut size) = (vec![start], size);
    while edges[edges.len() - 1] < reach {
        edges.push(edges[edges.len() - 1] + size);
        size *= GROWTH;
    }
    edges
}

/// Displacements in the middles of `count` boundary elements under tractions on them [m/Pa],
/// indexed like [`Body::flexibility`]. The elements cover `length` [m] about s = 0 on a body below
/// (`outward` 1) or above the surface. The surface turns within `half` [m] of the middle.
fn flexibility(
    material: &ElasticConstants,
    section: &CrossSection,
    outward: f64,
    k: f64,
    [length, half]: [f64; 2],
    count: usize,
) -> Mat<f64> {
    let size = length / FINER as f64;
    // A boundary element always begins at the edge of a finite element.
    let beside = (half / size - 0.5 * (FINER * count) as f64).ceil().max(0.0) as usize;
    let fine = FINER * count + 2 * beside;
    let reach = HELD / k;
    let side = growing(0.5 * fine as f64 * size, size, reach);
    let mut edges: Vec<f64> = side[1..].iter().rev().map(|s| -s).collect();
    edges.extend((0..=fine).map(|n| (n as f64 - 0.5 * fine as f64) * size));
    edges.extend(&side[1..]);
    let (along, deep) = (with_middles(&edges), with_middles(&growing(0.0, 0.5 * size, reach)));
    let rows = deep.len();
    let place = |i: usize, j: usize| {
        let ([y, z], _) = section.at(along[i]);
        [y, z - outward * deep[j]]
    };
    let held = |i: usize, j: usize| i == 0 || i == along.len() - 1 || j == rows - 1;
    let mut number = vec![usize::MAX; along.len() * rows];
    let mut free = 0;
    for i in 0..along.len() {
        for j in 0..rows {
            if !held(i, j) {
                number[i * rows + j] = free;
                free += 1;
            }
        }
    }
    let (mu, nu) = (material.shear_modulus, material.poisson_ratio);
    let lambda = 2.0 * mu * nu / (1.0 - 2.0 * nu);
    let mut triplets = Vec::new();
    for i in (0..along.len() - 1).step_by(2) {
        for j in (0..rows - 1).step_by(2) {
            let nodes: [(usize, usize); 9] = std::array::from_fn(|n| (i + n % 3, j + n / 3));
            let mut stiffness = [[0.0; 27]; 27];
            for (x, weight_x) in GAUSS_3 {
                for (y, weight_y) in GAUSS_3 {
                    let (by_x, by_y) = (quadratic(x), quadratic(y));
                    let mut jacobian = [[0.0; 2]; 2];
                    let shape: [[f64; 3]; 9] = std::array::from_fn(|n| {
                        let ([f, df], [g, dg]) = (by_x[n % 3], by_y[n / 3]);
                        [f * g, df * g, f * dg]
                    });
                    for ((i, j), [_, a, b]) in nodes.iter().zip(&shape) {
                        for (r, coordinate) in place(*i, *j).into_iter().enumerate() {
                            jacobian[r][0] += a * coordinate;
                            jacobian[r][1] += b * coordinate;
                        }
                    }
                    let [[ya, yb], [za, zb]] = jacobian;
                    let area = ya * zb - yb * za;
                    let weight = weight_x * weight_y * area.abs();
                    // Strains xx, yy, zz, yz, xy, xz of the three fields of a node.
                    let strains: [[[f64; 6]; 3]; 9] = std::array::from_fn(|n| {
                        let [f, a, b] = shape[n];
                        let (dy, dz) = ((a * zb - b * za) / area, (b * ya - a * yb) / area);
                        [
                            [-k * f, 0.0, 0.0, 0.0, dy, dz],
                            [0.0, dy, 0.0, dz, k * f, 0.0],
                            [0.0, 0.0, dz, dy, 0.0, k * f],
                        ]
                    });
                    for (p, one) in strains.iter().flatten().enumerate() {
                        let trace = lambda * (one[0] + one[1] + one[2]);
                        for (q, other) in strains.iter().flatten().enumerate() {
                            let normal: f64 = (0..3).map(|r| one[r] * other[r]).sum();
                            let shear: f64 = (3..6).map(|r| one[r] * other[r]).sum();
                            let volume = trace * (other[0] + other[1] + other[2]);
                            stiffness[p][q] += weight * (volume + mu * (2.0 * normal + shear));
                        }
                    }
                }
            }
            let of = |at: usize| {
                let (i, j) = nodes[at / 3];
                (!held(i, j)).then(|| 3 * number[i * rows + j] + at % 3)
            };
            for (p, row) in stiffness.iter().enumerate() {
                for (q, value) in row.iter().enumerate() {
                    if let (Some(row), Some(column)) = (of(p), of(q)) {
                        triplets.push(Triplet::new(row, column, *value));
                    }
                }
            }
        }
    }
    let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(3 * free, 3 * free, &triplets)
        .expect("indices within the matrix");
    // Node of the surface where the contact begins.
    let first_edge = edges
        .iter()
        .position(|s| (s + 0.5 * count as f64 * length).abs() < 1e-6 * length)
        .expect("boundary elements begin with an element");
    let mut load = Mat::zeros(3 * free, 3 * count);
    for q in 0..count {
        for element in 0..FINER {
            let node = 2 * (first_edge + FINER * q + element);
            let (from, to) = (along[node], along[node + 2]);
            for (x, weight) in GAUSS_3 {
                let (_, direction) = section.at(0.5 * (from + to) + 0.5 * (to - from) * x);
                let width = 0.5 * (to - from) * weight;
                for (c, axis) in axes(direction).iter().enumerate() {
                    for (n, [f, _]) in quadratic(x).into_iter().enumerate() {
                        for (r, part) in axis.iter().enumerate() {
                            load[(3 * number[(node + n) * rows] + r, 3 * q + c)] +=
                                width * f * part;
                        }
                    }
                }
            }
        }
    }
    let solved = matrix.sp_cholesky(Side::Lower).expect("a stiffness of a held body").solve(&load);
    let mut flexibility = Mat::zeros(3 * count, 3 * count);
    for t in 0..count {
        // Each boundary element has an odd number of finite elements, so its middle is a node.
        let node = 2 * (first_edge + FINER * t) + FINER;
        let (_, direction) = section.at(along[node]);
        for (c, axis) in axes(direction).iter().enumerate() {
            for column in 0..3 * count {
                let at = 3 * number[node * rows];
                flexibility[(3 * t + c, column)] =
                    axis.iter().enumerate().map(|(r, part)| part * solved[(at + r, column)]).sum();
            }
        }
    }
    flexibility
}

/// The change of flexibility by curvature agrees with finite elements in all nine pairs of
/// components. The case is a corner of 10 mm and the throat round it (CONTACT's conformal
/// examples), also with tractions and displacements exchanged. Tolerances are shares of the largest
/// change of the pair. A tenth covers constant tractions on boundary elements of a tenth of the
/// radius, where 6 % are reached. 3 % covers reciprocity, which collocation meets only
/// approximately.
#[test]
fn a_corner_and_a_throat_are_those_of_finite_elements() {
    let material = ElasticConstants { shear_modulus: 82e9, poisson_ratio: 0.28 };
    let (length, count) = (1e-3, 11);
    let quarter = std::f64::consts::FRAC_PI_4;
    for k in [50.0, 200.0] {
        let mut changes =
            [Mat::<f64>::zeros(3 * count, 3 * count), Mat::zeros(3 * count, 3 * count)];
        for (radius, outward) in [(10.2e-3, -1.0), (10e-3, 1.0)] {
            let half = quarter * radius;
            for (sign, section) in
                [(1.0, CrossSection::arc(-1.0 / radius, half)), (-1.0, CrossSection::straight())]
            {
                let first = -0.5 * count as f64 * length;
                let outline = Outline::open(&section, [first, length], count, 100.0 / k);
                let body = Body { material, outline, outward };
                changes[0] += sign * body.flexibility(k);
                changes[1] +=
                    sign * flexibility(&material, &section, outward, k, [length, half], count);
            }
        }
        let [boundary, finite] = &changes;
        let of = |matrix: &Mat<f64>, [t, a]: [usize; 2], [q, b]: [usize; 2]| {
            matrix[(3 * t + a, 3 * q + b)]
        };
        let largest = |a: usize, b: usize| {
            let pairs = (0..count * count).map(|at| (at / count, at % count));
            pairs.map(|(t, q)| of(finite, [t, a], [q, b]).abs()).fold(0.0, f64::max)
        };
        for a in 0..3 {
            for b in 0..3 {
                let (mut off, mut exchanged) = (0.0_f64, 0.0_f64);
                for t in 0..count {
                    for q in 0..count {
                        let value = of(boundary, [t, a], [q, b]);
                        off = off.max((value - of(finite, [t, a], [q, b])).abs());
                        exchanged = exchanged.max((value - of(boundary, [q, b], [t, a])).abs());
                    }
                }
                let shares = [off, exchanged].map(|value| value / largest(a, b));
                println!("k {k} {}{}: {shares:.4?}", ["x", "s", "n"][a], ["x", "s", "n"][b]);
                assert!(shares[0] < 0.1 && shares[1] < 0.03, "{k} {a}{b}: {shares:?}");
            }
        }
    }
}
