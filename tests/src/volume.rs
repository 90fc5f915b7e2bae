//! Participant with fields on a volume: a block that heats up and may swell.
//!
//! A block with n elements along its length has n × ⌈n/2⌉ × ⌈n/4⌉ hexahedra, a million for n = 200.
//! With u, v, w from 0 to 1 along the edges and g(u) = u(1 + u)/2, the vertices are at
//!
//! | hexahedra | vertices \[m\] |
//! |---|---|
//! | `rectilinear` | x = 2 g(u), y = g(v), z = g(w)/2 |
//! | `structured`, `unstructured` | a bend of radius r = 1 + g(v): x = r sin g(u), y = r cos g(u), z = g(w)/2 |
//!
//! times 1 + s/100 after s windows of swelling. After m accepted windows the temperature is T = (1
//! + m)(2 + sin 1.3x cos 0.9y + z) K.

mod participant;

pub use participant::{Block, VOLUME_PLACE, VOLUME_TEMPERATURE};

use proto::grid::{Grid, Hexahedra, Volume};

/// Name of the volume.
pub const BLOCK: &str = "block";
/// Kinds of elements, as values of `volume.hexahedra`.
pub const KINDS: &[&str] = &["rectilinear", "structured", "unstructured"];

/// Numbers of elements along the edges of a block with `n` elements along its length.
#[must_use]
pub fn counts(n: usize) -> [usize; 3] {
    [n, n.div_ceil(2), n.div_ceil(4)]
}

/// Elements of a block.
#[must_use]
pub fn hexahedra(kind: &str, n: usize) -> Hexahedra {
    let [ni, nj, nk] = counts(n);
    match kind {
        "rectilinear" => Hexahedra::Rectilinear { ni, nj, nk },
        "structured" => Hexahedra::Structured { ni, nj, nk },
        _ => Hexahedra::Unstructured {
            vertices: (ni + 1) * (nj + 1) * (nk + 1),
            elements: ni * nj * nk,
        },
    }
}

/// Block after a number of windows of swelling; its revision is one more than `swollen`.
#[must_use]
pub fn block(kind: &str, n: usize, swollen: u64) -> Grid {
    let counts @ [ni, nj, nk] = counts(n);
    let swell = 1.0 + 0.01 * swollen as f64;
    let node = |at: usize, count: usize| {
        let u = at as f64 / count as f64;
        0.5 * u * (1.0 + u)
    };
    let axis = |count: usize, length: f64| -> Vec<f64> {
        (0..=count).map(|at| swell * length * node(at, count)).collect()
    };
    let vertex = |i: usize, j: usize, k: usize| {
        let (angle, radius) = (node(i, ni), 1.0 + node(j, nj));
        let place = [radius * angle.sin(), radius * angle.cos(), 0.5 * node(k, nk)];
        place.map(|coordinate| swell * coordinate)
    };
    let vertices = || -> Vec<[f64; 3]> {
        let rows = (0..=nk).flat_map(|k| (0..=nj).map(move |j| (j, k)));
        rows.flat_map(|(j, k)| (0..=ni).map(move |i| vertex(i, j, k))).collect()
    };
    let shape = match kind {
        "rectilinear" => {
            let axes = [axis(ni, 2.0), axis(nj, 1.0), axis(nk, 0.5)];
            Volume::rectilinear([&axes[0], &axes[1], &axes[2]])
        }
        "structured" => Volume::structured(counts, &vertices()),
        _ => Volume::unstructured(&vertices(), &elements(counts)),
    };
    Grid { revision: 1 + swollen, ..Grid::volume(BLOCK, shape) }
}

/// Vertices of every element, in the order of VTK.
fn elements([ni, nj, nk]: [usize; 3]) -> Vec<[u32; 8]> {
    let index = |i: usize, j: usize, k: usize| ((k * (nj + 1) + j) * (ni + 1) + i) as u32;
    let face =
        |i, j, k| [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)];
    let element = |i, j, k| {
        let ([a, b, c, d], [e, f, g, h]) = (face(i, j, k), face(i, j, k + 1));
        [a, b, c, d, e, f, g, h]
    };
    let rows = (0..nk).flat_map(|k| (0..nj).map(move |j| (j, k)));
    rows.flat_map(|(j, k)| (0..ni).map(move |i| element(i, j, k))).collect()
}

/// Temperature T after a number of accepted windows \[K\].
#[must_use]
pub fn temperature([x, y, z]: [f64; 3], windows: u64) -> f64 {
    (1.0 + windows as f64) * (2.0 + (1.3 * x).sin() * (0.9 * y).cos() + z)
}
