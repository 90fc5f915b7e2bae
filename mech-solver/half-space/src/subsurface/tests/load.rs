use super::*;
use elastic::subsurface::{circular_contact_axis, line_contact};
use numerics::quadrature::GAUSS_5;
use std::f64::consts::PI;

const NU: f64 = 0.3;
const FRICTION: f64 = 0.4;

/// Semi-ellipsoidal pressure of radius 1 with n elements per radius, values at the centres of the
/// elements, and traction along x of `FRICTION` times the pressure.
struct Disc {
    grid: Structured,
    pressure: Vec<f64>,
    traction: Vec<f64>,
}

impl Disc {
    fn new(n: usize) -> Self {
        let (count, step) = (2 * n + 1, 1.0 / n as f64);
        let grid = Structured::contact_plane(-1.0, -1.0, step, step, count, count);
        let at = |index: usize| {
            let [x, y, _] = grid.centre(index % count, index / count);
            (1.0 - x * x - y * y).max(0.0).sqrt()
        };
        let pressure: Vec<f64> = (0..grid.points()).map(at).collect();
        let mut traction: Vec<f64> = pressure.iter().map(|p| FRICTION * p).collect();
        traction.resize(2 * pressure.len(), 0.0);
        Self { grid, pressure, traction }
    }

    fn load(&self) -> SurfaceLoad<'_> {
        SurfaceLoad::new(&self.grid, &self.pressure, &self.traction)
    }
}

/// Error of the stresses on the axis of a sliding Hertz contact, at depths of at least one element.
fn error_on_axis(n: usize) -> f64 {
    let disc = Disc::new(n);
    let depths = [0.1, 0.2, 0.48, 1.0, 2.0];
    let stresses = disc.load().stresses_at(NU, &depths.map(|depth| [0.0, 0.0, depth]));
    let error = |(stress, depth): (&Stress, f64)| {
        largest(&(*stress - circular_contact_axis(1.0, 1.0, FRICTION, NU, depth)))
    };
    stresses.iter().zip(depths).map(error).fold(0.0, f64::max)
}

/// Tolerance: pressure taken at the centres of elements. The root at the edge of the contact makes
/// the error fall with the power 3/2 of the step; the staircase makes it uneven.
#[test]
fn sliding_hertz_contact_on_the_axis() {
    let errors = [10, 20, 40, 80].map(error_on_axis);
    for (error, n) in errors.iter().zip([10.0_f64, 20.0, 40.0, 80.0]) {
        assert!(*error < 0.25 * n.powf(-1.5), "{errors:?}");
    }
    let order = (errors[0] / errors[3]).log2() / 3.0;
    assert!(order > 1.3, "{order} {errors:?}");
}

/// The textbook's maxima below the discretised contact (Johnson, §3.4): τ_max = 0.31 p_0 at
/// 0.48 a, von Mises' stress 0.62 p_0. Tolerance: the quoted digits, and the steps of the depth.
#[test]
fn textbook_maxima_below_a_hertz_contact() {
    let disc = Disc::new(20);
    let depths: Vec<f64> = (1..100).map(|k| 0.01 * f64::from(k)).collect();
    let mut section = Section::new(&disc.grid, NU, 0.0, &depths);
    let (mut mises, mut shear) = (vec![0.0; section.points()], vec![0.0; section.points()]);
    let load = SurfaceLoad::new(&disc.grid, &disc.pressure, &[]);
    section.equivalents(&load, None, &mut mises, &mut shear);
    let columns = disc.grid.ni;
    let deep = 10 * columns;
    let best = (deep..shear.len()).max_by(|a, b| shear[*a].total_cmp(&shear[*b])).unwrap();
    assert_eq!(best % columns, columns / 2, "on the axis");
    assert!((depths[best / columns] - 0.48).abs() < 0.015, "{}", depths[best / columns]);
    assert!((shear[best] - 0.31).abs() < 5e-3 && (mises[best] - 0.62).abs() < 5e-3);
}

/// Error of a line contact. Elements are long enough to act like strips: (half-length)^-2 is 1e-8.
fn error_of_line_contact(n: usize) -> f64 {
    let step = 1.0 / n as f64;
    let grid = Structured::contact_plane(-1.0 + 0.5 * step, 0.0, step, 2e4, 2 * n, 1);
    let pressure: Vec<f64> = (0..2 * n).map(|i| (1.0 - grid.x(i).powi(2)).sqrt()).collect();
    let mut traction: Vec<f64> = pressure.iter().map(|p| FRICTION * p).collect();
    traction.resize(4 * n, 0.0);
    let depths = [0.2, 0.4, 0.78, 1.5, 3.0];
    let mut section = Section::new(&grid, NU, 0.0, &depths);
    let mut stresses = vec![Stress::default(); section.points()];
    section.stresses(&SurfaceLoad::new(&grid, &pressure, &traction), &mut stresses);
    let error = |(index, stress): (usize, &Stress)| {
        let place = [grid.x(index % (2 * n)), depths[index / (2 * n)]];
        largest(&(*stress - line_contact(1.0, 1.0, FRICTION, NU, place)))
    };
    stresses.iter().enumerate().map(error).fold(0.0, f64::max)
}

/// Every stress at every point below a sliding line contact. Tolerance: pressure taken at the
/// centres of elements, of order 3/2.
#[test]
fn sliding_line_contact() {
    let errors = [10, 20, 40, 80].map(error_of_line_contact);
    for (pair, n) in errors.windows(2).zip([20.0_f64, 40.0, 80.0]) {
        assert!(pair[1] < 0.5 * n.powf(-1.5), "{errors:?}");
        assert!((pair[0] / pair[1]).log2() > 1.35, "{errors:?}");
    }
}

/// Reversed traction mirrors the stresses in x. Tolerance: rounding.
#[test]
fn reversed_traction_mirrors_the_stress() {
    let disc = Disc::new(6);
    let reversed: Vec<f64> = disc.traction.iter().map(|q| -q).collect();
    let braking = SurfaceLoad::new(&disc.grid, &disc.pressure, &reversed);
    let places = [[0.3, 0.2, 0.4], [-1.4, 0.1, 0.2], [0.0, 0.9, 0.7]];
    let mirrored = places.map(|[x, y, z]| [-x, y, z]);
    let stresses = disc.load().stresses_at(NU, &places);
    for (one, other) in stresses.iter().zip(braking.stresses_at(NU, &mirrored)) {
        let back = Stress { xz: -other.xz, xy: -other.xy, ..other };
        assert!(largest(&(*one - back)) < 1e-14);
        assert!((one.von_mises() - other.von_mises()).abs() < 1e-14);
    }
}

/// Loads add up, and stresses do not depend on the unit of length. Tolerance: rounding.
#[test]
fn superposition_and_scaling() {
    let disc = Disc::new(5);
    let none = vec![0.0; disc.pressure.len()];
    let place = [[0.7, -0.2, 0.3]];
    let by = |pressure: &[f64], traction: &[f64]| {
        SurfaceLoad::new(&disc.grid, pressure, traction).stresses_at(NU, &place)[0]
    };
    let both = by(&disc.pressure, &disc.traction);
    let parts = by(&disc.pressure, &[]) + by(&none, &disc.traction);
    assert!(largest(&(both - parts)) < 1e-14);
    let Structured { origin: [x, y, _], ni, nj, .. } = disc.grid;
    let unit = 1e-3;
    let step = unit * disc.grid.dx();
    let small = Structured::contact_plane(unit * x, unit * y, step, step, ni, nj);
    let load = SurfaceLoad::new(&small, &disc.pressure, &disc.traction);
    let scaled = load.stresses_at(NU, &place.map(|place| place.map(|x| unit * x)))[0];
    assert!(largest(&(both - scaled)) < 1e-13);
}

/// Integral of a stress over the whole plane at a depth: polar coordinates with the radius
/// s/(1 − s), the midpoint rule in the angle and Gauss's rule with five points on parts of s.
fn over_plane(load: &SurfaceLoad<'_>, depth: f64) -> Stress {
    const ANGLES: usize = 48;
    const PARTS: usize = 40;
    let mut sum = Stress::default();
    for part in 0..PARTS {
        for (node, weight) in GAUSS_5 {
            let s = (part as f64 + 0.5 * (1.0 + node)) / PARTS as f64;
            let radius = s / (1.0 - s);
            let angle = |k: usize| 2.0 * PI * (k as f64 + 0.5) / ANGLES as f64;
            let place = |k: usize| [radius * angle(k).cos(), radius * angle(k).sin(), depth];
            let ring: Stress =
                load.stresses_at(NU, &(0..ANGLES).map(place).collect::<Vec<_>>()).into_iter().sum();
            let area = 0.5 * weight / PARTS as f64 * radius / (1.0 - s).powi(2) * 2.0 * PI;
            sum = sum + area / ANGLES as f64 * ring;
        }
    }
    sum
}

/// Every horizontal plane carries the whole load: ∫σ_zz = −N, ∫σ_xz = −Q_x, ∫σ_yz = −Q_y.
/// Tolerance: the quadrature.
#[test]
fn planes_carry_the_load() {
    let grid = Structured::contact_plane(-0.3, -0.2, 0.25, 0.2, 3, 3);
    let pressure = [1.0, 2.0, 0.5, 0.0, 3.0, 1.0, 0.2, 0.0, 1.5];
    let traction: Vec<f64> = [
        [0.7, 0.1, -0.4, 0.9, 0.0, 0.3, 0.3, 0.2, -0.1],
        [0.2, 0.5, 0.1, 0.0, -0.3, 0.4, 0.3, 0.2, 0.6],
    ]
    .concat();
    let load = SurfaceLoad::new(&grid, &pressure, &traction);
    let total = |values: &[f64]| grid.element_area() * values.iter().sum::<f64>();
    for depth in [0.7, 1.5] {
        let Stress { zz, xz, yz, .. } = over_plane(&load, depth);
        let (along_x, along_y) = traction.split_at(9);
        for (force, expected) in
            [(zz, total(&pressure)), (xz, total(along_x)), (yz, total(along_y))]
        {
            assert!((force + expected).abs() < 1e-8, "{depth}: {force} {expected}");
        }
    }
}

#[test]
#[should_panic(expected = "4 pressures and 3 tractions on 4 elements")]
fn refuses_fields_of_another_length() {
    let grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 2);
    let _ = SurfaceLoad::new(&grid, &[0.0; 4], &[0.0; 3]);
}
