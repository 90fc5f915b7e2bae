//! Mappings from and to vertices: constants, integrals, orders, stencils of any rank, random
//! points.

use super::*;
use crate::map::MapError;
use contract::grid::{Measure, Vertices};
use proptest::prelude::*;

/// Methods that need no elements.
const METHODS: [Method; 3] =
    [Method::NearestNeighbour, Method::NearestProjection, Method::RadialBasis];

fn cloud(points: Vec<[f64; 3]>, measure: Measure) -> Grid {
    let (edges, triangles) = (Vec::new(), Vec::new());
    Grid::vertices("cloud", Vertices { points, edges, triangles, measure })
}

/// Unit square of n × n cells, each of two triangles, whose inner vertices are moved by up to a
/// fifth of a cell. `lift` gives the third coordinate.
fn triangulated(n: usize, measure: Measure, seed: u64, lift: fn(f64, f64) -> f64) -> Grid {
    let mut noise = noise(seed);
    let mut points = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let mut moved = |k: usize| {
                let inside = k > 0 && k < n;
                (k as f64 + if inside { 0.2 * noise() } else { 0.0 }) / n as f64
            };
            let (x, y) = (moved(i), moved(j));
            points.push([x, y, lift(x, y)]);
        }
    }
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    let cells = (0..n * n).map(|k| (k % n, k / n));
    let halves = |(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = cells.flat_map(halves).collect();
    let grid =
        Grid::vertices("triangles", Vertices { points, edges: Vec::new(), triangles, measure });
    assert_eq!(grid.check(), Ok(()));
    grid
}

fn flat(_: f64, _: f64) -> f64 {
    0.0
}

/// The vertices of a grid without their connectivity.
fn bare(grid: &Grid, measure: Measure) -> Grid {
    cloud((0..grid.points()).map(|n| grid.centre(n)).collect(), measure)
}

/// Polyline in the plane through `n + 1` points of a curve over 0 … 1.
fn polyline(n: usize, measure: Measure, curve: fn(f64) -> [f64; 2]) -> Grid {
    let point = |k: usize| {
        let [x, y] = curve(k as f64 / n as f64);
        [x, y, 0.0]
    };
    let points = (0..=n).map(point).collect();
    let edges = (0..n as u32).map(|k| [k, k + 1]).collect();
    Grid::vertices("line", Vertices { points, edges, triangles: Vec::new(), measure })
}

fn diagonal(s: f64) -> [f64; 2] {
    [3.0 * s - 1.0, 1.0 + 2.0 * s]
}

fn arc(s: f64) -> [f64; 2] {
    [s.cos(), s.sin()]
}

/// Sources and targets of all kinds, with areas on both sides.
fn pairs() -> Vec<[Grid; 2]> {
    let per_area = triangulated(9, Measure::PerArea, 3, flat);
    let per_point = bare(&triangulated(13, Measure::PerPoint, 5, flat), Measure::PerPoint);
    vec![
        [per_area.clone(), per_point.clone()],
        [per_point.clone(), per_area.clone()],
        [square(8), per_point.clone()],
        [per_point, square(8)],
        [square(11), per_area.clone()],
        [per_area, unstructured(6)],
        [polyline(7, Measure::PerArea, arc), polyline(12, Measure::PerPoint, arc)],
        [polyline(12, Measure::PerPoint, diagonal), polyline(7, Measure::PerArea, diagonal)],
        [cloud(vec![[0.5; 3]], Measure::PerPoint), square(3)],
    ]
}

#[test]
fn constants_stay_constant_and_integrals_are_kept() {
    for [source, target] in pairs() {
        for method in METHODS {
            let constant = vec![300.0; source.points()];
            let got = mapped(&source, &target, method, Mapping::Consistent, &constant);
            assert!(got.iter().all(|v| (v / 300.0 - 1.0).abs() < 1e-13), "rounding: {method:?}");

            let field = noisy_field(&source, 2, 9);
            let mapping =
                GridMapping::between(&source, &target, method, Mapping::Conservative).unwrap();
            let mut got = vec![f64::NAN; 2 * target.points()];
            mapping.apply(&field, &mut got);
            assert!(mapping.conserves() && mapping.imbalance(&field, &got) < 1e-13, "{method:?}");
            for component in 0..2 {
                let part = |values: &[f64], count: usize| {
                    values[component * count..(component + 1) * count].to_vec()
                };
                let sent = source.integrate(&part(&field, source.points()));
                let received = target.integrate(&part(&got, target.points()));
                let size: f64 = source.areas().iter().sum();
                assert!((sent - received).abs() < 1e-13 * size, "{method:?}: {sent} {received}");
            }
        }
    }
}

#[test]
fn totals_are_the_plain_transpose() {
    let [from, to] = [bare(&square(5), Measure::PerPoint), bare(&square(9), Measure::PerPoint)];
    for method in METHODS {
        let (u, v) = (noisy_field(&from, 1, 1), noisy_field(&to, 1, 2));
        let there = mapped(&from, &to, method, Mapping::Conservative, &u);
        let back = mapped(&to, &from, method, Mapping::Consistent, &v);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!((dot(&v, &there) - dot(&u, &back)).abs() < 1e-12, "rounding: {method:?}");
    }
}

#[test]
fn without_areas_a_field_is_mapped_consistently() {
    let (known, unknown) = (square(6), bare(&square(4), Measure::Unknown));
    for [source, target] in [[&known, &unknown], [&unknown, &known]] {
        let method = Method::suited_to(Mapping::Conservative, source, target);
        let conservative =
            GridMapping::between(source, target, method, Mapping::Conservative).unwrap();
        let consistent = GridMapping::between(source, target, method, Mapping::Consistent).unwrap();
        assert_eq!(conservative, consistent);
        assert!(!conservative.conserves());
    }
}

#[test]
fn the_intersection_needs_elements_and_auto_avoids_it() {
    let grids = [
        square(6),
        triangulated(4, Measure::PerArea, 1, flat),
        bare(&square(3), Measure::PerPoint),
    ];
    let [elements, connected, bare] = &grids;
    for [source, target] in [[elements, connected], [connected, elements], [bare, connected]] {
        for kind in [Mapping::Consistent, Mapping::Conservative] {
            let refused = GridMapping::between(source, target, Method::Intersection, kind);
            assert!(matches!(refused, Err(MapError::NoElements(_))));
            let suited = Method::suited_to(kind, source, target);
            assert!(GridMapping::between(source, target, suited, kind).is_ok());
        }
    }
    let suited = |kind, source, target| Method::suited_to(kind, source, target);
    assert_eq!(suited(Mapping::Consistent, connected, bare), Method::NearestProjection);
    assert_eq!(suited(Mapping::Consistent, bare, connected), Method::RadialBasis);
    assert_eq!(suited(Mapping::Conservative, elements, bare), Method::NearestProjection);
    assert_eq!(suited(Mapping::Conservative, elements, elements), Method::Intersection);
}

#[test]
fn matching_vertices_are_copied_bit_for_bit() {
    let twice = cloud(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]], Measure::PerPoint);
    for grid in [twice, triangulated(4, Measure::PerArea, 1, flat)] {
        let other = Grid { name: "other".to_owned(), revision: 4, ..grid.clone() };
        for kind in [Mapping::Consistent, Mapping::Conservative] {
            for method in METHODS {
                let mut field = noisy_field(&grid, 2, 3);
                field[0] = -0.0;
                let got = mapped(&grid, &other, method, kind, &field);
                assert!(got.iter().zip(&field).all(|(a, b)| a.to_bits() == b.to_bits()));
            }
        }
    }
}

#[test]
fn equally_near_vertices_share_a_target() {
    let source = cloud(vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], Measure::PerPoint);
    let target = cloud(vec![[0.5, 0.0, 0.0], [2.0, 0.0, 0.0]], Measure::PerPoint);
    for method in [Method::NearestNeighbour, Method::NearestProjection] {
        let got = mapped(&source, &target, method, Mapping::Consistent, &[3.0, 6.0, 12.0]);
        assert!(largest_difference(&got, &[7.0, 9.0]) < 1e-14, "rounding: {method:?} {got:?}");
    }
}

#[test]
fn linear_functions_are_exact_on_stencils_of_any_rank() {
    let linear = |p: [f64; 3]| 3.0 - 2.0 * p[0] + 5.0 * p[1] + 0.5 * p[2];
    let tilted: fn(f64, f64) -> f64 = |x, y| 0.3 * x - 0.7 * y;
    let inside = |n: usize, m: usize| (0.5 + n as f64) / (m as f64 + 1.0);
    let plane: Vec<[f64; 3]> = (0..60)
        .map(|n| [inside(n % 7, 7), inside(n % 11, 11)])
        .map(|[x, y]| [x, y, tilted(x, y)])
        .collect();
    let line = polyline(17, Measure::Unknown, |s| diagonal(0.02 + 0.9 * s));
    let space = |n: usize, low: f64, high: f64| -> Grid {
        let at = |k: usize| low + (high - low) * k as f64 / (n - 1) as f64;
        let point = |k: usize| [at(k % n), at(k / n % n), at(k / n / n)];
        cloud((0..n * n * n).map(point).collect(), Measure::Unknown)
    };
    let coplanar = triangulated(8, Measure::Unknown, 7, tilted);
    let collinear = polyline(11, Measure::Unknown, diagonal);
    let cases = [
        (bare(&collinear, Measure::Unknown), bare(&line, Measure::Unknown), 1),
        (collinear, line, 2),
        (bare(&coplanar, Measure::Unknown), cloud(plane.clone(), Measure::Unknown), 1),
        (coplanar, cloud(plane, Measure::Unknown), 2),
        (space(6, 0.0, 1.0), space(4, 0.11, 0.93), 1),
        (
            cloud(vec![[0.0; 3], [1.0, 1.0, 0.0]], Measure::Unknown),
            cloud(vec![[0.25, 0.25, 0.0]], Measure::Unknown),
            1,
        ),
    ];
    for (source, target, methods) in cases {
        let exact = sampled(&target, linear);
        for method in [Method::RadialBasis, Method::NearestProjection].into_iter().take(methods) {
            let got =
                mapped(&source, &target, method, Mapping::Consistent, &sampled(&source, linear));
            // Rounding, times the condition number of some 1e3 of the interpolation.
            let error = largest_difference(&got, &exact);
            assert!(error < 1e-10, "{method:?} on {} points: {error:e}", source.points());
        }
    }
}

/// Returns the observed order of the root mean square error on four meshes, without the first.
fn order(source: impl Fn(usize) -> Grid, target: impl Fn(usize) -> Grid, method: Method) -> f64 {
    let function = |[x, y, z]: [f64; 3]| (2.0 * x).sin() + (3.0 * y + z).cos();
    let error = |n: usize| {
        let (source, target) = (source(n), target(n));
        let got =
            mapped(&source, &target, method, Mapping::Consistent, &sampled(&source, function));
        let squares = got.iter().zip(sampled(&target, function)).map(|(a, b)| (a - b).powi(2));
        (squares.sum::<f64>() / target.points() as f64).sqrt()
    };
    let errors = [8, 16, 32, 64].map(error);
    println!("{}: {errors:?}", method.word());
    (errors[1] / errors[3]).log2() / 2.0
}

fn cylinder(x: f64, _: f64) -> f64 {
    (1.5 - x * x).sqrt()
}

#[test]
fn orders_of_convergence() {
    let unknown = Measure::Unknown;
    let fine = |lift| move |n: usize| bare(&triangulated(2 * n + 3, unknown, 11, lift), unknown);
    let points = |n: usize| bare(&polyline(3 * n + 1, unknown, arc), unknown);
    let least = 1.9;
    for lift in [flat as fn(f64, f64) -> f64, cylinder] {
        let connected = |n| triangulated(n, unknown, 4, lift);
        for method in [Method::NearestProjection, Method::RadialBasis] {
            let order = order(connected, fine(lift), method);
            assert!(order > least, "{method:?}: {order}");
        }
        let order = order(|n| bare(&connected(n), unknown), fine(lift), Method::RadialBasis);
        assert!(order > least, "points: {order}");
    }
    for method in [Method::NearestProjection, Method::RadialBasis] {
        let order = order(|n| polyline(n, unknown, arc), points, method);
        assert!(order > least, "line, {method:?}: {order}");
    }
    let order = order(|n| bare(&polyline(n, unknown, arc), unknown), points, Method::RadialBasis);
    assert!(order > least, "line of points: {order}");
}

#[test]
fn vertices_beyond_the_border_take_its_value_and_are_counted() {
    let source = triangulated(4, Measure::PerArea, 2, flat);
    let target = cloud(vec![[1.5, 0.5, 0.2], [1.3, 1.4, 0.0], [0.3, 0.4, 0.7]], Measure::Unknown);
    let field = sampled(&source, |p| p[0]);
    for method in [Method::NearestProjection, Method::RadialBasis] {
        let mapping = GridMapping::between(&source, &target, method, Mapping::Consistent).unwrap();
        let mut got = [f64::NAN; 3];
        mapping.apply(&field, &mut got);
        assert!(largest_difference(&got, &[1.0, 1.0, 0.3]) < 1e-12, "{method:?} {got:?}");
        let Coverage { elements, outside, farthest } = mapping.coverage();
        assert_eq!((elements, outside), (3, 2));
        assert!((farthest - 0.5).abs() < 1e-12, "{farthest}");
    }
    let line = polyline(4, Measure::PerArea, |s| [s, 0.0]);
    let ends = cloud(vec![[-0.25, 0.5, 0.0], [0.6, 0.5, 0.0]], Measure::Unknown);
    let mapping =
        GridMapping::between(&line, &ends, Method::NearestProjection, Mapping::Consistent).unwrap();
    assert_eq!(mapping.coverage(), Coverage { elements: 2, outside: 1, farthest: 0.25 });
    // Far from a bare cloud the interpolant does not grow.
    let far = cloud(vec![[1e3, -1e4, 0.0]], Measure::Unknown);
    let got = mapped(
        &bare(&source, Measure::Unknown),
        &far,
        Method::RadialBasis,
        Mapping::Consistent,
        &field,
    );
    assert!(got[0].abs() < 2.0, "{got:?}");
}

proptest! {
    /// Any points, also repeated or on a line, keep constants and sums with finite weights.
    #[test]
    fn random_points_keep_constants_and_sums(
        from in prop::collection::vec(prop::array::uniform3(-4_i8..4), 1..80),
        to in prop::collection::vec(prop::array::uniform3(-4_i8..4), 1..30),
        scale in prop::array::uniform3(prop::sample::select(vec![0.0, 1e-6, 0.3, 1.0])),
    ) {
        let grid = |points: &[[i8; 3]]| {
            let place = |p: &[i8; 3]| std::array::from_fn(|k| f64::from(p[k]) * scale[k]);
            cloud(points.iter().map(place).collect(), Measure::PerPoint)
        };
        let (from, to) = (grid(&from), grid(&to));
        for method in METHODS {
            let got = mapped(&from, &to, method, Mapping::Consistent, &vec![1.0; from.points()]);
            prop_assert!(got.iter().all(|v| (v - 1.0).abs() < 1e-10), "{:?} {:?}", method, got);
            let field = noisy_field(&from, 1, 8);
            let got = mapped(&from, &to, method, Mapping::Conservative, &field);
            let (sent, received) = (from.integrate(&field), to.integrate(&got));
            prop_assert!((sent - received).abs() < 1e-9, "{:?}: {} {}", method, sent, received);
        }
    }
}
