//! Properties of mappings, with shared grids and fields.

mod conservation;
mod invariants;
mod kernels;
mod orders;
mod vertices;

use super::{Coverage, GridMapping, Method};
use contract::field::Mapping;
use contract::grid::{Grid, Quadrilaterals, Structured};
use std::collections::HashMap;

/// n × n elements on the unit square of the contact plane.
fn square(n: usize) -> Grid {
    rectangle([0.0, 0.0], [1.0, 1.0], n, n)
}

fn rectangle(low: [f64; 2], high: [f64; 2], nx: usize, ny: usize) -> Grid {
    let (dx, dy) = ((high[0] - low[0]) / nx as f64, (high[1] - low[1]) / ny as f64);
    let (x0, y0) = (low[0] + 0.5 * dx, low[1] + 0.5 * dy);
    Grid::structured("square", Structured::contact_plane(x0, y0, dx, dy, nx, ny))
}

/// The unit square cut into 2 n² triangles, each split into three quadrilaterals around its
/// centroid. Three, four and six elements meet at inner vertices.
fn unstructured(n: usize) -> Grid {
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut known = HashMap::new();
    // Coordinates are multiples of 1/6n, up to rounding.
    let mut index = |point: [f64; 2]| {
        *known.entry(point.map(|v| (6.0 * v).round() as u32)).or_insert_with(|| {
            points.push([point[0] / n as f64, point[1] / n as f64, 0.0]);
            points.len() as u32 - 1
        })
    };
    let mean = |all: &[[f64; 2]]| {
        let sum = all.iter().fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
        sum.map(|v| v / all.len() as f64)
    };
    let mut elements = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let at = |k: usize, l: usize| [(i + k) as f64, (j + l) as f64];
            let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            for t in [[a, b, c], [a, c, d]] {
                for k in 0..3 {
                    let [p, q, r] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
                    let corners = [p, mean(&[p, q]), mean(&t), mean(&[r, p])];
                    elements.push(corners.map(&mut index));
                }
            }
        }
    }
    Grid::quadrilaterals("triangles", Quadrilaterals { points, elements })
}

fn sampled(grid: &Grid, function: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    (0..grid.points()).map(|n| function(grid.centre(n))).collect()
}

fn mapped(source: &Grid, target: &Grid, method: Method, kind: Mapping, field: &[f64]) -> Vec<f64> {
    let mapping = GridMapping::between(source, target, method, kind).unwrap();
    let mut values = vec![f64::NAN; target.points() * (field.len() / source.points())];
    mapping.apply(field, &mut values);
    values
}

/// Franke's function on the unit square: R. Franke, *Math. Comp.* 38 (1982) 181–200.
fn franke([x, y, _]: [f64; 3]) -> f64 {
    let (x, y) = (9.0 * x, 9.0 * y);
    let hump = |p: f64, q: f64| (-p * p - q * q).exp();
    0.75 * hump(0.5 * (x - 2.0), 0.5 * (y - 2.0))
        + 0.75 * (-(x + 1.0).powi(2) / 49.0 - (y + 1.0) / 10.0).exp()
        + 0.5 * hump(0.5 * (x - 7.0), 0.5 * (y - 3.0))
        - 0.2 * hump(x - 4.0, y - 7.0)
}

/// Eggholder function of (x, y), each from -512 to 512: D. Whitley et al., *Artif. Intell.* 85
/// (1996) 245–276. √|·| makes a cusp along the lines x/2 + y + 47 = 0 and x − y − 47 = 0.
fn eggholder(x: f64, y: f64) -> f64 {
    let y = y + 47.0;
    -y * (0.5 * x + y).abs().sqrt().sin() - x * (x - y).abs().sqrt().sin()
}

/// A surface of nx × ny elements, tilted and shifted, whose vertices are moved by up to a fifth of
/// an element. `seed` selects the random displacement.
fn jittered(nx: usize, ny: usize, size: [f64; 2], tilt: f64, seed: u64) -> Grid {
    let plane = rectangle([0.0, 0.0], size, nx, ny);
    let mut surface = Quadrilaterals::from(plane.as_structured().unwrap());
    let mut noise = noise(seed);
    let steps = [size[0] / nx as f64, size[1] / ny as f64];
    for point in &mut surface.points {
        let [x, y] = [0, 1].map(|k| point[k] + 0.2 * steps[k] * noise());
        *point = [x * tilt.cos(), y, x * tilt.sin()];
    }
    let grid = Grid::quadrilaterals("jittered", surface);
    assert_eq!(grid.check(), Ok(()));
    grid
}

/// Pseudo-random numbers between -1 and 1 (the upper bits of a linear congruential generator).
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

fn noisy_field(grid: &Grid, components: usize, seed: u64) -> Vec<f64> {
    let mut noise = noise(seed);
    (0..components * grid.points()).map(|_| noise()).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn coverage_is_poor_beyond_one_in_a_hundred() {
    let coverage = |outside| Coverage { elements: 1000, outside, farthest: 2.5e-4 };
    assert!(!coverage(10).is_poor() && coverage(11).is_poor());
    let text = "11 of 1000 elements lie beyond the other grid's border, up to 0.250 mm";
    assert_eq!(coverage(11).to_string(), text);
    let all = "all of 1000 elements lie within the other grid's border";
    assert_eq!(coverage(0).to_string(), all);
    assert!(Method::ALL.iter().all(|method| Method::from_word(method.word()) == Some(*method)));
}
