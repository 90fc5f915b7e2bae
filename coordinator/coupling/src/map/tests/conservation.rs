//! Conservative mappings: integrals, transposes, heat beyond the border, random grids.

use super::*;
use proptest::prelude::*;

/// Rounding of sums of up to 1e5 terms that cancel to about their square root.
const ROUNDING: f64 = 1e-13;

fn balanced(source: &Grid, target: &Grid, method: Method, field: &[f64]) -> f64 {
    let mapping = GridMapping::between(source, target, method, Mapping::Conservative).unwrap();
    let mut got = vec![f64::NAN; target.points() * (field.len() / source.points())];
    mapping.apply(field, &mut got);
    assert!(got.iter().all(|v| v.is_finite()));
    // The imbalance agrees with the integrals of the grids.
    let (sent, received) =
        (source.integrate(&field[..source.points()]), target.integrate(&got[..target.points()]));
    let size: f64 =
        source.integrate(&field[..source.points()].iter().map(|v| v.abs()).collect::<Vec<_>>());
    assert!((received - sent).abs() <= ROUNDING * size, "{method:?}: {sent:e} {received:e}");
    mapping.imbalance(field, &got)
}

#[test]
fn the_integral_is_kept_on_large_grids() {
    let (source, target) = (rectangle([-8e-3, -6e-3], [8e-3, 6e-3], 166, 152), unstructured(40));
    let target = scaled(&target, 1.2e-2);
    let mut field = sampled(&source, |[x, y, _]| {
        1e9 * (1.0 - (x / 8e-3).powi(2) - (y / 6e-3).powi(2)).max(0.0).sqrt()
    });
    field.extend(noisy_field(&source, 1, 4));
    for method in Method::ALL {
        let imbalance = balanced(&source, &target, method, &field);
        assert!(imbalance < ROUNDING, "{method:?}: {imbalance:e}");
    }
}

fn scaled(grid: &Grid, factor: f64) -> Grid {
    let contract::grid::Shape::Quadrilaterals(surface) = &grid.shape else {
        unreachable!("called with unstructured grids only")
    };
    let points = surface.points.iter().map(|p| p.map(|v| factor * v)).collect();
    Grid::quadrilaterals("scaled", Quadrilaterals { points, ..surface.clone() })
}

#[test]
fn conservative_is_the_transpose_of_the_opposite_consistent_mapping() {
    let (source, target) = (jittered(13, 8, [1.0, 1.0], 0.1, 3), square(11));
    let (u, v) = (noisy_field(&source, 1, 5), noisy_field(&target, 1, 6));
    let times =
        |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a * b).collect() };
    for method in Method::ALL {
        let there = mapped(&source, &target, method, Mapping::Conservative, &u);
        let back = mapped(&target, &source, method, Mapping::Consistent, &v);
        let (left, right) =
            (target.integrate(&times(&v, &there)), source.integrate(&times(&u, &back)));
        assert!((left - right).abs() < 1e-14, "rounding: {method:?} {left:e} {right:e}");
    }
}

#[test]
fn heat_beyond_the_target_goes_to_its_border_and_is_counted() {
    let source = rectangle([0.0; 2], [2.0, 1.0], 20, 10);
    let target = square(8);
    for method in Method::ALL {
        let field = sampled(&source, |p| if p[0] > 1.0 { 1.0 } else { 0.0 });
        let mapping =
            GridMapping::between(&source, &target, method, Mapping::Conservative).unwrap();
        let mut got = vec![0.0; 64];
        mapping.apply(&field, &mut got);
        assert!((target.integrate(&got) - 1.0).abs() < ROUNDING, "{method:?}");
        let border: f64 = got.iter().skip(7).step_by(8).sum::<f64>() / 64.0;
        // At the border the interpolant uses the border element and some of its neighbours.
        let least = if method == Method::RadialBasis { 0.9 } else { 1.0 - 1e-13 };
        assert!(border >= least, "{method:?}: {border}");
        let coverage = mapping.coverage();
        assert_eq!((coverage.elements, coverage.outside), (200, 100), "{method:?}");
        assert!((coverage.farthest - 0.95).abs() < 1e-12, "{method:?}: {coverage:?}");
    }
}

#[test]
fn targets_beyond_the_source_take_the_border_s_value_and_are_counted() {
    let (source, target) = (square(10), rectangle([0.0; 2], [1.5, 1.0], 15, 10));
    let field = sampled(&source, |p| p[1]);
    for method in Method::ALL {
        let mapping = GridMapping::between(&source, &target, method, Mapping::Consistent).unwrap();
        let mut got = vec![f64::NAN; 150];
        mapping.apply(&field, &mut got);
        let exact = sampled(&target, |p| p[1]);
        assert!(largest_difference(&got, &exact) < 1e-12, "{method:?}");
        assert_eq!(mapping.coverage().outside, 50);
        assert!((mapping.coverage().farthest - 0.45).abs() < 1e-12);
    }
    // A gap along the normal does not count as outside.
    let mut above = square(7);
    let contract::grid::Shape::Structured(shape) = &mut above.shape else { unreachable!() };
    shape.origin[2] = 0.3;
    let mapping =
        GridMapping::between(&source, &above, Method::Intersection, Mapping::Consistent).unwrap();
    assert_eq!(mapping.coverage().outside, 0);
}

#[test]
fn intersections_of_rectangles_are_products_of_intervals() {
    let (source, target) =
        (rectangle([0.0; 2], [1.0; 2], 7, 5), rectangle([0.1, -0.2], [0.8, 0.9], 4, 9));
    let field = noisy_field(&source, 1, 8);
    let got = mapped(&source, &target, Method::Intersection, Mapping::Consistent, &field);
    let (s, t) = (source.as_structured().unwrap(), target.as_structured().unwrap());
    let length = |a: f64, da: f64, b: f64, db: f64| {
        let (low, high) = ((a - da / 2.0).max(b - db / 2.0), (a + da / 2.0).min(b + db / 2.0));
        (high - low).max(0.0)
    };
    for (n, value) in got.iter().enumerate() {
        let (mut sum, mut area) = (0.0, 0.0);
        for (m, field) in field.iter().enumerate() {
            let common = length(s.x(m % 7), s.dx(), t.x(n % 4), t.dx())
                * length(s.y(m / 7), s.dy(), t.y(n / 4), t.dy());
            sum += common * field;
            area += common;
        }
        assert!(area == 0.0 || (value - sum / area).abs() < 1e-12, "rounding: {n}");
    }
}

#[test]
fn a_lost_or_invalid_value_is_no_balance() {
    let (source, target) = (square(3), square(4));
    let mapping =
        GridMapping::between(&source, &target, Method::Intersection, Mapping::Conservative)
            .unwrap();
    assert!((mapping.imbalance(&[1.0; 9], &[0.5; 16]) - 0.5).abs() < 1e-15);
    assert_eq!(mapping.imbalance(&[0.0; 9], &[0.0; 16]), 0.0);
    assert_eq!(mapping.imbalance(&[0.0; 9], &[1.0; 16]), f64::INFINITY);
    assert_eq!(mapping.imbalance(&[f64::NAN; 9], &[1.0; 16]), f64::INFINITY);
}

fn grids() -> impl Strategy<Value = Grid> {
    let size = 1..9_usize;
    let extent = (0.2..3.0_f64, 0.2..3.0_f64);
    (size.clone(), size, extent, -1.0..1.0_f64, any::<u64>())
        .prop_map(|(nx, ny, (x, y), tilt, seed)| jittered(nx, ny, [x, y], tilt, seed))
}

proptest! {
    #[test]
    fn random_surfaces_conserve_and_keep_constants(source in grids(), target in grids(), seed: u64) {
        let field = noisy_field(&source, 2, seed);
        for method in Method::ALL {
            let imbalance = balanced(&source, &target, method, &field);
            prop_assert!(imbalance < ROUNDING, "{:?}: {:e}", method, imbalance);
            let ones = vec![1.0; source.points()];
            let got = mapped(&source, &target, method, Mapping::Consistent, &ones);
            prop_assert!(got.iter().all(|v| (v - 1.0).abs() < 1e-12), "{:?}", method);
        }
    }
}
