use super::*;
use elastic::subsurface::{circular_contact_axis, line_contact};

/// Loads without symmetry, on a grid whose origin is arbitrary.
fn load() -> (Structured, Vec<f64>, Vec<f64>) {
    let grid = Structured::contact_plane(-0.7, 0.4, 0.1, 0.15, 13, 9);
    let (pressure, traction) = (noise(grid.points(), 3), noise(2 * grid.points(), 4));
    (grid, pressure, traction)
}

fn direct(load: &SurfaceLoad<'_>, [xs, ys, depths]: [&[f64]; 3]) -> Vec<Stress> {
    let mut points = Vec::new();
    for &depth in depths {
        points.extend(ys.iter().flat_map(|&y| xs.iter().map(move |&x| [x, y, depth])));
    }
    load.stresses_at(0.3, &points)
}

fn axis(first: f64, step: f64, count: usize) -> Vec<f64> {
    (0..count).map(|n| first + n as f64 * step).collect()
}

/// Lattices with the spacing of the elements, half of it, twice of it and any other spacing,
/// within, over and beyond the grid, by transforms and by sums over nodes. The reference is the
/// direct sum over elements. Tolerance: rounding of corner sums and transforms, with loads up to 1.
#[test]
fn lattices_equal_the_direct_sum() {
    let (grid, pressure, traction) = load();
    let depths = [0.0, 0.07, 0.9];
    let (x, y) = (grid.x(0), grid.y(0));
    let lattices = [
        [axis(x, 0.1, 13), axis(y, 0.15, 9)],
        [axis(x - 0.3, 0.05, 40), axis(y - 0.2, 0.075, 30)],
        [axis(x + 0.033, 0.2, 9), axis(y - 1.0, 0.15, 25)],
        [axis(x - 2.0, 0.1, 60), axis(y + 0.02, 0.3, 8)],
        [axis(x, 0.123, 7), axis(y, 0.051, 5)],
        [vec![0.31], axis(y, 0.15, 9)],
    ];
    for traction in [&traction[..], &[]] {
        let load = SurfaceLoad::new(&grid, &pressure, traction);
        for [xs, ys] in &lattices {
            let stresses = load.on_lattice(0.3, [xs, ys, &depths]);
            let expected = direct(&load, [xs, ys, &depths]);
            for (stress, expected) in stresses.iter().zip(expected) {
                let error = largest(&(*stress - expected));
                assert!(error < 2e-12, "{} x {}: {error:e}", xs.len(), ys.len());
            }
        }
    }
}

/// One loaded element has four nodes, its corners; a uniform load has no nodes inside.
#[test]
fn loads_have_their_nodes() {
    let grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 3, 3);
    let count = |pressure: &[f64]| Nodes::of(&SurfaceLoad::new(&grid, pressure, &[]), 0.3).count();
    let mut one = [0.0; 9];
    one[4] = 1.0;
    assert_eq!((count(&one), count(&[2.0; 9]), count(&[0.0; 9])), (4, 4, 0));
}

/// Hertzian pressure and traction at the centres of elements, n per radius or half-width 1.
fn hertz(n: usize, rows: usize, dy: f64) -> (Structured, Vec<f64>, Vec<f64>) {
    let step = 1.0 / n as f64;
    let first_y = if rows == 1 { 0.0 } else { -1.0 };
    let grid = Structured::contact_plane(-1.0, first_y, step, dy, 2 * n + 1, rows);
    let pressure: Vec<f64> = (0..grid.points())
        .map(|at| {
            let [x, y, _] = grid.centre(at % grid.ni, at / grid.ni);
            (1.0 - x * x - y * y).max(0.0).sqrt()
        })
        .collect();
    let mut traction: Vec<f64> = pressure.iter().map(|p| 0.4 * p).collect();
    traction.resize(2 * pressure.len(), 0.0);
    (grid, pressure, traction)
}

/// A sliding circular contact, on the axis. Tolerance: pressure taken at the centres of elements,
/// whose error falls with the power 3/2 of their size.
#[test]
fn the_axis_of_a_sliding_circle() {
    for n in [10_usize, 40] {
        let (grid, pressure, traction) = hertz(n, 2 * n + 1, 1.0 / n as f64);
        let load = SurfaceLoad::new(&grid, &pressure, &traction);
        let depths = [0.1, 0.48, 1.0, 2.0];
        let (xs, ys) =
            (axis(-1.0, 1.0 / n as f64, 2 * n + 1), axis(-1.0, 1.0 / n as f64, 2 * n + 1));
        let found = load.on_lattice(0.3, [&xs, &ys, &depths]);
        for (layer, depth) in depths.iter().enumerate() {
            let stress = found[layer * xs.len() * ys.len() + n * xs.len() + n];
            let error = largest(&(stress - circular_contact_axis(1.0, 1.0, 0.4, 0.3, *depth)));
            assert!(error < 0.25 * (n as f64).powf(-1.5), "{n} at {depth}: {error:e}");
        }
    }
}

/// A line of contact (a single row): McEwen's stresses, also beside the axis. Tolerance: pressure
/// taken at the centres of elements.
#[test]
fn a_sliding_line() {
    for n in [25_usize, 100] {
        let (grid, pressure, traction) = hertz(n, 1, 2e4);
        let load = SurfaceLoad::new(&grid, &pressure, &traction);
        let (xs, depths) = (axis(-1.55, 0.05, 60), [0.2, 0.786, 2.0]);
        let found = load.on_lattice(0.3, [&xs, &[0.0], &depths]);
        for (at, stress) in found.iter().enumerate() {
            let (x, depth) = (xs[at % xs.len()], depths[at / xs.len()]);
            let error = largest(&(*stress - line_contact(1.0, 1.0, 0.4, 0.3, [x, depth])));
            assert!(error < (n as f64).powf(-1.5), "{n} at {x}, {depth}: {error:e}");
        }
    }
}

/// A square with a unit pressure and a traction along x, at points of CONTACT's example subsurf,
/// case 2: mean, von Mises, xx, yy, zz, xy, yz, xz. Tolerance: six printed digits, and a load that
/// is 1e-6 short of 1.
#[test]
fn the_points_of_contact() {
    #[rustfmt::skip]
    const PRINTED: &[[f64; 11]] = &[
        [-2.0, -0.8, 0.0, 0.027928, 0.10618, 0.086797, -0.0030141, 3.5702e-10, 0.034009, 0.0, 4.9537e-10],
        [0.6, -0.8, 0.0, -0.095772, 0.229123, -0.20927, -0.078044, -2.7074e-07, 0.079466, 4.9452e-13, -3.7566e-07],
        [-2.0, 0.2, 0.0, 0.03442, 0.127675, 0.118088, -0.014827, -1.119e-08, -0.01133, 3.7899e-15, -1.5526e-08],
        [0.6, 0.2, 0.0, -0.487832, 0.992641, -1.11551, -0.347986, -2.5809e-07, -0.05185, -2.4188e-13, -3.5809e-07],
        [-2.0, -0.8, 0.5, 0.018842, 0.075089, 0.056936, -0.0040961, 0.0036861, 0.023532, -0.0053656, -0.013907],
        [0.6, -0.8, 0.5, -0.117158, 0.347715, -0.114843, -0.118907, -0.117723, 0.109734, 0.130731, -0.105666],
        [-2.0, 0.2, 0.5, 0.022863, 0.089112, 0.076255, -0.012787, 0.0051199, -0.0077154, 0.0018292, -0.019127],
        [0.6, 0.2, 0.5, -0.264017, 0.718575, -0.288588, -0.048621, -0.454842, -0.064452, -0.083059, -0.345481],
        [-2.0, -0.8, 1.667, 0.0018133, 0.011414, 0.0066723, -0.0033323, 0.0020998, 0.0030814, -0.00095979, -0.0028148],
        [0.6, -0.8, 1.667, -0.04023, 0.140444, -0.0069308, -0.0097876, -0.103971, 0.015466, 0.044836, -0.035723],
        [-2.0, 0.2, 1.667, 0.0020138, 0.012091, 0.0078193, -0.0042708, 0.0024929, -0.000874, 0.00028349, -0.0033425],
        [0.6, 0.2, 1.667, -0.050502, 0.1765, -0.0093404, 0.007962, -0.150127, -0.0053459, -0.015854, -0.050847],
    ];
    let grid = Structured::contact_plane(1e-4, 2e-4, 1.0, 1.0, 1, 1);
    let load = SurfaceLoad::new(&grid, &[1.0], &[0.999, 0.0]);
    for [x, y, z, mean, mises, xx, yy, zz, xy, yz, xz] in PRINTED {
        let stress = load.on_lattice(0.28, [&[*x], &[*y], &[*z]])[0];
        let found = [
            stress.mean(),
            stress.von_mises(),
            stress.xx,
            stress.yy,
            stress.zz,
            stress.xy,
            stress.yz,
            stress.xz,
        ];
        for (found, printed) in found.iter().zip([mean, mises, xx, yy, zz, xy, yz, xz]) {
            let tolerance = 2e-6 + 1e-5 * printed.abs();
            assert!((found - printed).abs() < tolerance, "{x} {y} {z}: {found} {printed}");
        }
    }
}
