//! Influence numbers of a pair of prismatic bodies with a curved surface.
//!
//! The number A_ab(i; t, q) is the displacement difference u = u₁ − u₂ along a at the middle of
//! element (i, t) by a unit traction along b over element (0, q), on body 1 and its opposite on
//! body 2; a, b are x, s or n. It is the number of half-spaces ([`crate::influence`]) at the
//! distance along the surface, plus the change by curvature:
//!
//! A_ab = A⁰_ab + (1/π) ∫₀^∞ [M_ab(k) − M⁰_ab(k)] (2/k) sin(kΔx/2) e(kx) dk,
//!
//! M is the flexibility of the bodies for the wave number k ([`super::boundary`]), and M⁰ that of
//! flat bodies with the same elements. The error of constant tractions on elements thus cancels
//! where it is large. e is cos for components of which both or none are along x, and ± sin for the
//! others. The difference decays like the curvature over k², and grows like ln k for long waves.
//!
//! The change of M by curvature varies over lengths of the radius. If rows are finer than
//! [`MOST_TURN`] of the radius, boundary elements of that length are used, with linear
//! interpolation between their midpoints.
//!
//! The integral over k₀ < k < k₁ uses cubics in ln k between the wave numbers at which M is
//! computed.
//!
//! Sources: Kalker (1990) §1.6 for influence numbers of bodies that are not half-spaces; Vollebregt
//! and Segal, Vehicle System Dynamics 52 (2014) suppl. 455, who compute them by finite elements.
//! The transform along the axis and the boundary elements are this project's.

use super::boundary::Body;
use super::kernel::ElasticConstants;
use super::outline::Outline;
use super::section::CrossSection;
use crate::influence::Influence;
use elastic::Elasticity;
use elastic::Material;
use faer::Mat;
use numerics::quadrature::GAUSS_4;
use numerics::rows::{Kernel, Parity, Rows};
use numerics::team::{self, Team};
use std::f64::consts::PI;

/// Longest wave computed, divided by 2π, over the length of the grid or the radius of the surface.
/// Tested against ten times longer waves, two thirds of the step between wave numbers and elements
/// that grow by 1.35 in place of 1.5: forces in a gauge corner change by 1e-3.
const LONGEST: f64 = 100.0;
/// Shortest wave: wave number times the width of an element.
const SHORTEST: f64 = 3.0;
/// Wave numbers per factor of two.
const DENSITY: f64 = 2.0;
/// Reach of the outline, over the inverse of the smallest wave number.
const REACH: f64 = 5.0;
/// Largest angle that a boundary element of the contact turns where rows are finer [rad].
const MOST_TURN: f64 = 0.01;
/// Least number of boundary elements in the contact where rows are finer.
const FEWEST: usize = 16;
/// Phase of the shortest step of the quadrature.
const PHASE: f64 = 1.0;
/// Grid of the contact along x and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceGrid {
    /// Elements along x and s.
    pub counts: [usize; 2],
    /// Sides of an element along x and s [m].
    pub sides: [f64; 2],
    /// Lower end of the grid along s [m].
    pub first: f64,
}

/// Component of a traction or displacement: x, s, n.
const COMPONENTS: usize = 3;

/// The influence numbers A, and products with them.
#[derive(Debug)]
pub struct InfluenceNumbers {
    patch: SurfaceGrid,
    /// A_ab(i; t, q) [m/Pa], i fastest, then q, t, b, a.
    values: Vec<f64>,
}

impl InfluenceNumbers {
    /// Computes the numbers of body 1 (upper) and body 2, whose sections share the coordinate s.
    #[must_use]
    pub fn new(
        materials: &[Material; 2],
        sections: &[CrossSection; 2],
        patch: &SurfaceGrid,
    ) -> Self {
        let [nx, ny] = patch.counts;
        let [dx, ds] = patch.sides;
        let influence =
            Influence::of_elements([dx, ds], Elasticity::of_pair(&materials[0], &materials[1]));
        let mut numbers = Self { patch: *patch, values: vec![0.0; 9 * ny * ny * nx] };
        for (pair, values) in numbers.values.chunks_exact_mut(ny * ny * nx).enumerate() {
            for (at, value) in values.iter_mut().enumerate() {
                let (i, q, t) = (at % nx, at / nx % ny, at / (nx * ny));
                *value = of_half_spaces(&influence, pair, i as i32, t as i32 - q as i32);
            }
        }
        if sections.iter().any(|section| section.turn() > 0.0) {
            let joined = joined(sections, patch);
            numbers.add(materials, sections, joined);
        }
        numbers
    }

    /// Adds the change by curvature, from boundary elements of `joined` rows each.
    fn add(&mut self, materials: &[Material; 2], sections: &[CrossSection; 2], joined: usize) {
        let SurfaceGrid { counts: [nx, rows], sides: [dx, side], first } = self.patch;
        let (ny, ds) = (rows.div_ceil(joined), joined as f64 * side);
        let bent = sections.iter().filter(|section| section.turn() > 0.0);
        // Radius of an arc.
        let radius = |section: &CrossSection| {
            let [from, to] = section.ends();
            (to - from) / section.turn()
        };
        let longest = [nx as f64 * dx, ny as f64 * ds]
            .into_iter()
            .chain(bent.map(radius))
            .fold(0.0, f64::max);
        let (least, most) = (1.0 / (LONGEST * longest), SHORTEST / dx.min(ds));
        let steps = (DENSITY * (most / least).log2()).ceil();
        let waves: Vec<f64> =
            (0..=steps as usize).map(|n| least * (most / least).powf(n as f64 / steps)).collect();
        let outline =
            |section: &CrossSection| Outline::open(section, [first, ds], ny, REACH / least);
        let straight = CrossSection::straight();
        let bodies = [(0, -1.0), (1, 1.0)].map(|(body, outward)| {
            let material = ElasticConstants::of(&materials[body]);
            let of = |section: &CrossSection| Body { material, outline: outline(section), outward };
            (of(&sections[body]), of(&straight))
        });
        let same = materials[0] == materials[1];
        let change = |k: f64| {
            let mut change = Mat::zeros(3 * ny, 3 * ny);
            let mut known: Option<Mat<f64>> = None;
            for ((curved, flat), section) in bodies.iter().zip(sections) {
                if section.turn() == 0.0 {
                    continue;
                }
                let of_flat = match known.take() {
                    Some(other) if same => mirrored(other),
                    _ => flat.flexibility(k),
                };
                change += curved.flexibility(k) - &of_flat;
                known = Some(of_flat);
            }
            change
        };
        let mut changes = vec![Mat::zeros(0, 0); waves.len()];
        let places = waves.iter().zip(&mut changes);
        let operations = team::WORTH * waves.len() as u64;
        Team::of_process(()).sweep(operations, places, |(), (k, place)| {
            *place = change(*k);
            1
        });
        let [even, odd] = weights(&waves, self.patch);
        // Boundary element below the middle of a row, and the row's relative distance to the next
        // one.
        let between = |row: usize| {
            let at = (row as f64 + 0.5) / joined as f64 - 0.5;
            let below = at.max(0.0).min(ny.saturating_sub(2) as f64).floor();
            (below as usize, if ny > 1 { at - below } else { 0.0 })
        };
        let (len, share) = (nx * rows * rows, 1.0 / joined as f64);
        let series = vec![0.0; waves.len()];
        let operations = (len * waves.len()) as u64;
        for (pair, values) in self.values.chunks_exact_mut(len).enumerate() {
            let (a, b) = (pair / COMPONENTS, pair % COMPONENTS);
            let (weights, sign) = match (a, b) {
                (0, 1 | 2) => (&odd, -1.0),
                (1 | 2, 0) => (&odd, 1.0),
                _ => (&even, 1.0),
            };
            let targets = values.chunks_exact_mut(nx * rows).enumerate();
            Team::of_process(series.clone()).sweep(operations, targets, |series, (t, values)| {
                let (t, part_t) = between(t);
                for (q, values) in values.chunks_exact_mut(nx).enumerate() {
                    let (q, part_q) = between(q);
                    let change = |change: &Mat<f64>| {
                        let of =
                            |t: usize, q: usize| change[(COMPONENTS * t + a, COMPONENTS * q + b)];
                        let along = |t: usize| match part_q {
                            0.0 => of(t, q),
                            _ => (1.0 - part_q) * of(t, q) + part_q * of(t, q + 1),
                        };
                        let all = match part_t {
                            0.0 => along(t),
                            _ => (1.0 - part_t) * along(t) + part_t * along(t + 1),
                        };
                        sign * share * all
                    };
                    series.iter_mut().zip(&changes).for_each(|(value, of)| *value = change(of));
                    for (value, weights) in values.iter_mut().zip(weights.chunks_exact(waves.len()))
                    {
                        *value += weights.iter().zip(&*series).map(|(w, v)| w * v).sum::<f64>();
                    }
                }
                nx as u64
            });
        }
    }

    /// A_ab at a distance of i ≥ 0 elements along x, on row t by row q [m/Pa].
    #[must_use]
    pub fn value(&self, [a, b]: [usize; 2], i: usize, [t, q]: [usize; 2]) -> f64 {
        let [nx, ny] = self.patch.counts;
        self.values[(((COMPONENTS * a + b) * ny + t) * ny + q) * nx + i]
    }

    /// Transform of A_ab for as many rows as `rows` has, starting at the row `first`. For a = b,
    /// which is symmetric, both directions are averaged.
    #[must_use]
    pub(super) fn kernel(&self, rows: &mut Rows, first: usize, [a, b]: [usize; 2]) -> Kernel {
        rows.kernel(parity([a, b]), |i, t, q| {
            let [t, q] = [first + t, first + q];
            let one = self.value([a, b], i, [t, q]);
            if a == b { 0.5 * (one + self.value([a, b], i, [q, t])) } else { one }
        })
    }

    /// Transform of the difference between A_ab and the number of half-spaces, like
    /// [`Self::kernel`].
    #[must_use]
    pub(super) fn change(
        &self,
        rows: &mut Rows,
        first: usize,
        influence: &Influence,
        [a, b]: [usize; 2],
    ) -> Kernel {
        rows.kernel(parity([a, b]), |i, t, q| {
            let pair = COMPONENTS * a + b;
            self.value([a, b], i, [first + t, first + q])
                - of_half_spaces(influence, pair, i as i32, t as i32 - q as i32)
        })
    }

    /// Returns the grid.
    #[must_use]
    pub fn patch(&self) -> &SurfaceGrid {
        &self.patch
    }
}

/// Number of rows per boundary element.
fn joined(sections: &[CrossSection; 2], patch: &SurfaceGrid) -> usize {
    let SurfaceGrid { counts: [_, rows], sides: [_, side], first } = *patch;
    let edge = |row: usize| first + row as f64 * side;
    let turn = |section: &CrossSection| {
        let direction = |row: usize| section.at(edge(row)).1;
        (0..rows).map(|row| (direction(row + 1) - direction(row)).abs()).fold(0.0, f64::max)
    };
    let most = sections.iter().map(turn).fold(f64::MIN_POSITIVE, f64::max);
    ((MOST_TURN / most) as usize).clamp(1, (rows / FEWEST).max(1))
}

/// Flexibility of the flat body on the opposite side of the surface.
fn mirrored(flexibility: Mat<f64>) -> Mat<f64> {
    let along_normal = |at: usize| at % COMPONENTS == 2;
    Mat::from_fn(flexibility.nrows(), flexibility.ncols(), |row, column| {
        let value = flexibility[(row, column)];
        if along_normal(row) == along_normal(column) { value } else { -value }
    })
}

fn parity([a, b]: [usize; 2]) -> Parity {
    if (a == 0) == (b == 0) { Parity::Even } else { Parity::Odd }
}

/// A⁰ of a pair of components at an offset, target minus source.
fn of_half_spaces(influence: &Influence, pair: usize, i: i32, j: i32) -> f64 {
    match (pair / COMPONENTS, pair % COMPONENTS) {
        (0, 0) => influence.xx(i, j),
        (1, 1) => influence.yy(i, j),
        (2, 2) => influence.zz(i, j),
        (0, 1) | (1, 0) => influence.xy(i, j),
        (0, 2) => influence.xz(i, j),
        (1, 2) => influence.yz(i, j),
        (2, 0) => influence.zx(i, j),
        _ => influence.zy(i, j),
    }
}

/// Weights of the values at the wave numbers in the even and the odd integral, one row per offset
/// along x [1].
fn weights(waves: &[f64], patch: SurfaceGrid) -> [Vec<f64>; 2] {
    let ([nx, _], [dx, _]) = (patch.counts, patch.sides);
    let count = waves.len();
    let [mut even, mut odd] = [vec![0.0; nx * count], vec![0.0; nx * count]];
    // Below the first wave number the value is taken as constant.
    for row in even.chunks_exact_mut(count) {
        row[0] += waves[0] * dx / PI;
    }
    let reach = nx as f64 * dx;
    for n in 0..count - 1 {
        let [low, high] = [waves[n], waves[n + 1]];
        let steps = ((high - low) * reach / PHASE).ceil().max(1.0);
        let from = n.saturating_sub(1).min(count - 4);
        for step in 0..steps as usize {
            for (x, weight) in GAUSS_4 {
                let (x, weight) = (0.5 * (1.0 + x), 0.5 * weight);
                let k = low + (high - low) * (step as f64 + x) / steps;
                let width = weight * (high - low) / steps;
                let load = 2.0 / k * (0.5 * k * dx).sin() / PI;
                let basis: [f64; 4] = std::array::from_fn(|m| {
                    let others = (0..4).filter(|l| *l != m);
                    others
                        .map(|l| {
                            (k / waves[from + l]).ln() / (waves[from + m] / waves[from + l]).ln()
                        })
                        .product()
                });
                for i in 0..nx {
                    let (sin, cos) = (k * i as f64 * dx).sin_cos();
                    for (m, basis) in basis.iter().enumerate() {
                        even[i * count + from + m] += width * load * basis * cos;
                        odd[i * count + from + m] += width * load * basis * sin;
                    }
                }
            }
        }
    }
    [even, odd]
}

#[cfg(test)]
mod tests;
