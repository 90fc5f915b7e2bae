use super::*;

const NU: f64 = 0.3;

/// An elliptic contact with semi-axes (1, b) about (x, y), n elements per unit semi-axis, and
/// tractions proportional to the pressure.
struct Patch {
    grid: Structured,
    pressure: Vec<f64>,
    traction: Vec<f64>,
}

impl Patch {
    fn new(n: usize, b: f64, [x, y]: [f64; 2], friction: [f64; 2]) -> Self {
        let step = 1.0 / n as f64;
        let (nx, ny) = (2 * n + 1, 2 * (b * n as f64).ceil() as usize + 1);
        let (left, low) = (x - step * (nx / 2) as f64, y - step * (ny / 2) as f64);
        let grid = Structured::contact_plane(left, low, step, step, nx, ny);
        let at = |index: usize| {
            let [at_x, at_y, _] = grid.centre(index % nx, index / nx);
            (1.0 - (at_x - x).powi(2) - ((at_y - y) / b).powi(2)).max(0.0).sqrt()
        };
        let pressure: Vec<f64> = (0..grid.points()).map(at).collect();
        let traction = friction.iter().flat_map(|f| pressure.iter().map(move |p| f * p)).collect();
        Self { grid, pressure, traction }
    }

    fn peak(&self) -> Peak {
        let load = SurfaceLoad::new(&self.grid, &self.pressure, &self.traction);
        load.peak(NU, Stress::von_mises).expect("a load has a peak")
    }
}

/// Johnson's textbook values for a round contact at any position: 0.62 p₀ at a depth of 0.48 a.
/// Tolerance: their digits, and the last step.
#[test]
fn below_a_round_contact() {
    for (n, place) in [(8, [0.0, 0.0]), (20, [3.0, -2.0]), (40, [0.0, 0.5])] {
        let Peak { place: [x, y, depth], stress } = Patch::new(n, 1.0, place, [0.0; 2]).peak();
        assert!((stress.von_mises() - 0.62).abs() < 3e-3, "{n}: {}", stress.von_mises());
        assert!((depth - 0.48).abs() < 0.01 && (x - place[0]).hypot(y - place[1]) < 5e-3);
    }
}

/// Below a line contact in plane strain: shear 0.300 p₀ at 0.786 a (Johnson 4.4).
#[test]
fn below_a_line() {
    let n = 50;
    let grid = Structured::contact_plane(-1.0, 0.0, 1.0 / n as f64, 1e3, 2 * n + 1, 1);
    let pressure: Vec<f64> =
        (0..grid.ni).map(|i| (1.0 - grid.x(i).powi(2)).max(0.0).sqrt()).collect();
    let load = SurfaceLoad::new(&grid, &pressure, &[]);
    let Peak { place: [x, y, depth], stress } = load.peak(NU, Stress::max_shear).expect("a peak");
    assert!((stress.max_shear() - 0.300).abs() < 1e-3, "{}", stress.max_shear());
    assert!((depth - 0.786).abs() < 0.01 && x.abs() < 5e-3 && y == 0.0, "{x} {y} {depth}");
}

/// The peak follows the direction of the traction, on the surface or below, and no point of a dense
/// box is higher. Tolerance: half a per cent for the spacing of the points.
#[test]
fn nothing_is_higher_in_a_box() {
    for friction in [[0.0, 0.1], [0.15, 0.1], [0.3, 0.0], [-0.2, 0.5]] {
        let patch = Patch::new(12, 0.7, [0.2, -0.3], friction);
        let found = patch.peak();
        let load = SurfaceLoad::new(&patch.grid, &patch.pressure, &patch.traction);
        let depths: Vec<f64> = (0..24).map(|k| 0.05 * f64::from(k)).collect();
        let mut highest = 0.0_f64;
        for j in 0..patch.grid.nj {
            let mut section = Section::new(&patch.grid, NU, patch.grid.y(j), &depths);
            let mut stresses = vec![Stress::default(); section.points()];
            section.stresses(&load, &mut stresses);
            highest = stresses.iter().map(Stress::von_mises).fold(highest, f64::max);
        }
        let value = found.stress.von_mises();
        assert!(value > highest * (1.0 - 5e-3), "{friction:?}: {value} {highest}");
        assert!(value < highest * 1.05, "{friction:?}: {value} {highest}");
    }
}

/// A single loaded element among light ones, as under a rough surface, is found although the coarse
/// grid averages it.
#[test]
fn a_narrow_peak_is_found() {
    let n = 80;
    let grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, n, n);
    let mut pressure = vec![0.1; n * n];
    pressure[23 * n + 51] = 10.0;
    let load = SurfaceLoad::new(&grid, &pressure, &[]);
    let Peak { place: [x, y, depth], stress } = load.peak(NU, Stress::von_mises).expect("a peak");
    assert!((x - 51.0).abs() < 0.8 && (y - 23.0).abs() < 0.8 && depth < 1.0, "{x} {y} {depth}");
    assert!(stress.von_mises() > 5.0, "{}", stress.von_mises());
}

#[test]
fn without_load_there_is_none() {
    let grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 3, 3);
    let pressure = [0.0; 9];
    assert_eq!(SurfaceLoad::new(&grid, &pressure, &[]).peak(NU, Stress::von_mises), None);
}

/// Principal directions satisfy σ n = s n, have unit length and are perpendicular.
#[test]
fn principal_directions() {
    for values in noise(60, 7).chunks_exact(6) {
        let [xx, yy, zz, yz, xz, xy] = std::array::from_fn(|k| values[k]);
        let stress = Stress { xx, yy, zz, yz, xz, xy };
        let found = stress.principal_directions();
        for (value, n) in found {
            let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            for (row, n_k) in rows.iter().zip(n) {
                let along: f64 = row.iter().zip(n).map(|(s, n)| s * n).sum();
                assert!((along - value * n_k).abs() < 1e-14);
            }
        }
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!(dot(found[0].1, found[1].1).abs() < 1e-14);
        assert!((dot(found[2].1, found[2].1) - 1.0).abs() < 1e-14);
    }
}

/// Two patches, one with twice the size and pressure of the other. Each has the peak of a round
/// contact below its middle, plus the contribution of the other patch, which is negligible far
/// apart. The whole search finds the larger peak. Tolerance: the digits of the textbook, the last
/// step, and p/r² of the other patch.
#[test]
fn every_patch_has_its_peak() {
    let (step, apart) = (0.05, 12.0);
    let grid = Structured::contact_plane(-2.0, -2.0, step, step, 81, 341);
    let at = |x: f64, y: f64| (1.0 - x * x - y * y).max(0.0).sqrt();
    let pressure: Vec<f64> = (0..grid.points())
        .map(|index| {
            let [x, y, _] = grid.centre(index % grid.ni, index / grid.ni);
            at(x, y) + 2.0 * at(0.5 * x, 0.5 * (y - apart))
        })
        .collect();
    let load = SurfaceLoad::new(&grid, &pressure, &[]);
    let all = crate::patches::patches(&grid, &pressure);
    let elements = all.iter().map(|patch| patch.elements.as_slice());
    let found = load.peaks(NU, Stress::von_mises, elements);
    assert_eq!(found.len(), 2);
    for (peak, (size, y)) in found.iter().zip([(1.0, 0.0), (2.0, apart)]) {
        let Peak { place: [at_x, at_y, depth], stress } = peak.expect("a peak");
        assert!((stress.von_mises() / size - 0.62).abs() < 5e-3, "{}", stress.von_mises());
        assert!((depth / size - 0.48).abs() < 0.01, "{depth}");
        assert!(at_x.hypot(at_y - y) < 0.02 * size, "{at_x} {at_y}");
    }
    let whole = load.peak(NU, Stress::von_mises).expect("a peak");
    assert!((whole.place[1] - apart).abs() < 0.04);
}
