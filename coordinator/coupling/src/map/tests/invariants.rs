//! Invariants of every mapping: constants, linear functions, extremes, matching grids, numbering.

use super::*;
use crate::map::CurrentMapping;

const BOTH: [Mapping; 2] = [Mapping::Consistent, Mapping::Conservative];

/// Pairs of grids: structured and unstructured, of similar and different resolution, partly
/// outside.
fn pairs() -> Vec<[Grid; 2]> {
    let beyond = rectangle([-0.3, 0.2], [0.7, 1.4], 23, 9);
    let tilted = [jittered(9, 14, [1.0, 1.0], 0.5, 1), jittered(17, 5, [1.0, 1.0], 0.5, 2)];
    vec![
        [square(12), square(31)],
        [square(31), square(12)],
        [square(20), square(10)],
        [square(16), unstructured(7)],
        [unstructured(6), square(25)],
        [square(14), beyond.clone()],
        [beyond, unstructured(5)],
        tilted,
    ]
}

#[test]
fn constants_stay_constant() {
    for [source, target] in pairs() {
        for method in Method::ALL {
            let field = vec![300.0; source.points()];
            let got = mapped(&source, &target, method, Mapping::Consistent, &field);
            // Rounding of some 40 weights of size one.
            assert!(got.iter().all(|v| (v / 300.0 - 1.0).abs() < 1e-14), "{method:?}");
        }
    }
}

#[test]
fn a_projected_or_intersected_density_stays_within_its_extremes() {
    for [source, target] in pairs() {
        let field = noisy_field(&source, 1, 7);
        for method in [Method::NearestNeighbour, Method::NearestProjection, Method::Intersection] {
            let got = mapped(&source, &target, method, Mapping::Consistent, &field);
            let peak = field.iter().fold(0.0, |peak: f64, v| peak.max(v.abs()));
            assert!(got.iter().all(|v| v.abs() <= peak * (1.0 + 1e-14)), "{method:?}");
        }
    }
    let (source, target) = (square(13), square(29));
    let got = mapped(&source, &target, Method::Intersection, Mapping::Conservative, &[5.0; 169]);
    assert!(got.iter().all(|v| (v / 5.0 - 1.0).abs() < 1e-12), "areas are exact up to rounding");
}

#[test]
fn linear_functions_are_exact_where_nothing_is_extrapolated() {
    let linear = |p: [f64; 3]| 3.0 - 2.0 * p[0] + 5.0 * p[1] + 0.5 * p[2];
    for [source, target] in pairs() {
        let field = sampled(&source, linear);
        let exact = sampled(&target, linear);
        let inside = |n: usize, margin: f64| {
            let [x, y, z] = target.centre(n);
            [x.hypot(z).copysign(x), y].iter().all(|v| (margin..=1.0 - margin).contains(v))
        };
        // Margins: half an element and its jitter for the projection, only the jitter for the
        // others.
        for (method, margin) in [(Method::NearestProjection, 0.11), (Method::RadialBasis, 0.03)] {
            let got = mapped(&source, &target, method, Mapping::Consistent, &field);
            let source_covers = |n: &usize| inside(*n, margin) && covered(&source, &target, *n);
            let checked: Vec<usize> = (0..target.points()).filter(source_covers).collect();
            assert!(checked.len() * 4 > target.points(), "{} checked", checked.len());
            for n in checked {
                // Rounding, times the condition number of some 1e3 of the interpolation.
                assert!((got[n] - exact[n]).abs() < 1e-11, "{method:?} {}", got[n] - exact[n]);
            }
        }
    }
}

/// Returns whether the source extends at least an element beyond a target's centre.
fn covered(source: &Grid, target: &Grid, n: usize) -> bool {
    let at = target.centre(n);
    let quadrants = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    quadrants.iter().all(|side| {
        (0..source.points()).any(|m| {
            let centre = source.centre(m);
            (0..2).all(|k| side[k] * (centre[k] - at[k]) >= 0.0)
        })
    })
}

#[test]
fn bilinear_functions_are_exact_on_rectangles() {
    let bilinear = |p: [f64; 3]| (1.0 - 2.0 * p[0]) * (3.0 + p[1]);
    let (source, target) = (square(9), rectangle([0.06; 2], [0.94; 2], 20, 31));
    let field = sampled(&source, bilinear);
    let got = mapped(&source, &target, Method::NearestProjection, Mapping::Consistent, &field);
    assert!(largest_difference(&got, &sampled(&target, bilinear)) < 1e-13, "rounding");
}

#[test]
fn matching_grids_are_copied_bit_for_bit() {
    let grids = [square(9), unstructured(4), jittered(6, 7, [2.0, 1e-3], 0.3, 5), square(1)];
    for grid in grids {
        let mut field = noisy_field(&grid, 2, 3);
        field[0] = -0.0;
        let apart = moved(&grid, [0.0, 0.0, 1e-4]);
        for (method, kind) in Method::ALL.into_iter().flat_map(|m| BOTH.map(|kind| (m, kind))) {
            let got = mapped(&grid, &grid.clone(), method, kind, &field);
            let same = got.iter().zip(&field).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same, "{method:?} {kind:?} on {} elements", grid.points());
            if grid.as_structured().is_some() {
                let got = mapped(&grid, &apart, method, kind, &field);
                assert!(largest_difference(&got, &field) < 1e-13, "a gap changes nothing");
            }
        }
    }
}

fn moved(grid: &Grid, by: [f64; 3]) -> Grid {
    let count = match &grid.shape {
        contract::grid::Shape::Structured(s) => (s.ni + 1) * (s.nj + 1),
        contract::grid::Shape::Quadrilaterals(q) => q.points.len(),
        contract::grid::Shape::Vertices(v) => v.points.len(),
        contract::grid::Shape::Volume(v) => v.hexahedra().vertices(),
        contract::grid::Shape::Points(p) => p.count(),
    };
    let displacement: Vec<f64> = by.iter().flat_map(|v| std::iter::repeat_n(*v, count)).collect();
    grid.displaced(&displacement).unwrap()
}

/// Returns the same elements in another order, with rotated corners, and the new index of each.
fn renumbered(grid: &Grid) -> (Grid, Vec<usize>) {
    let contract::grid::Shape::Quadrilaterals(surface) = moved(grid, [0.0; 3]).shape else {
        unreachable!("a moved grid is unstructured")
    };
    let count = surface.elements.len();
    let stride = (count / 2..).find(|stride| gcd(*stride, count) == 1).unwrap();
    let order: Vec<usize> = (0..count).map(|n| n * stride % count).collect();
    let element = |n: &usize| {
        let mut corners = surface.elements[*n];
        corners.rotate_left(n % 4);
        if n.is_multiple_of(3) {
            corners.reverse();
        }
        corners
    };
    let elements = order.iter().map(element).collect();
    (Grid::quadrilaterals("renumbered", Quadrilaterals { elements, ..surface }), order)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[test]
fn numbering_and_the_kind_of_grid_do_not_matter() {
    for [source, target] in pairs() {
        let field = noisy_field(&source, 1, 11);
        let (other_source, from) = renumbered(&source);
        let (other_target, to) = renumbered(&target);
        let other_field: Vec<f64> = from.iter().map(|n| field[*n]).collect();
        for (method, kind) in Method::ALL.into_iter().flat_map(|m| BOTH.map(|kind| (m, kind))) {
            let one = mapped(&source, &target, method, kind, &field);
            let other = mapped(&other_source, &other_target, method, kind, &other_field);
            let one: Vec<f64> = to.iter().map(|n| one[*n]).collect();
            let peak = one.iter().fold(1.0, |peak: f64, v| peak.max(v.abs()));
            // Rounding, times the condition number of some 1e3 of the interpolation.
            let difference = largest_difference(&one, &other) / peak;
            assert!(difference < 1e-11, "{method:?} {kind:?}: {difference:e}");
        }
    }
}

#[test]
fn a_mirrored_field_stays_mirrored() {
    // Every target is halfway between sources, or every source halfway between targets.
    for (fine, coarse) in [(square(20), square(10)), (square(10), square(20))] {
        let even = sampled(&fine, |p| franke([p[0], 4.0 * p[1] * (1.0 - p[1]), 0.0]));
        for (method, kind) in Method::ALL.into_iter().flat_map(|m| BOTH.map(|kind| (m, kind))) {
            let got = mapped(&fine, &coarse, method, kind, &even);
            let n = coarse.as_structured().unwrap().ni;
            let mirrored: Vec<f64> = got.chunks(n).rev().flatten().copied().collect();
            let difference = largest_difference(&got, &mirrored);
            assert!(difference < 1e-12, "rounding: {method:?} {kind:?} {difference:e}");
        }
    }
}

#[test]
fn metres_or_millimetres() {
    let (source, target) =
        (jittered(7, 9, [1.0, 1.0], 0.2, 1), jittered(11, 5, [1.0, 1.0], 0.2, 2));
    let small = |seed, nx, ny| jittered(nx, ny, [1e-3, 1e-3], 0.2, seed);
    let field = noisy_field(&source, 1, 1);
    for (method, kind) in Method::ALL.into_iter().flat_map(|m| BOTH.map(|kind| (m, kind))) {
        let one = mapped(&source, &target, method, kind, &field);
        let other = mapped(&small(1, 7, 9), &small(2, 11, 5), method, kind, &field);
        assert!(largest_difference(&one, &other) < 1e-11, "rounding: {method:?} {kind:?}");
    }
}

#[test]
fn components_are_mapped_one_by_one() {
    let (source, target) = (square(6), unstructured(3));
    let field = noisy_field(&source, 3, 2);
    let together = mapped(&source, &target, Method::NearestProjection, Mapping::Consistent, &field);
    let apart: Vec<f64> = field
        .chunks(source.points())
        .flat_map(|one| {
            mapped(&source, &target, Method::NearestProjection, Mapping::Consistent, one)
        })
        .collect();
    assert_eq!(together, apart);
}

#[test]
fn grids_of_one_element_and_of_one_row() {
    let grids =
        [square(1), rectangle([0.0; 2], [1.0; 2], 7, 1), rectangle([0.0; 2], [1.0; 2], 1, 5)];
    for (source, target) in grids.iter().flat_map(|a| grids.iter().map(move |b| (a, b))) {
        let linear = sampled(source, |p| 1.0 + p[0] + p[1]);
        for method in Method::ALL {
            let got = mapped(source, target, method, Mapping::Consistent, &linear);
            // Extrapolation at the border by half an element: 2.5 in the corner, at most 1.5
            // elsewhere.
            assert!(got.iter().all(|v| (0.99..=3.01).contains(v)), "{method:?} {got:?}");
        }
    }
    let row = rectangle([0.0; 2], [1.0; 2], 7, 1);
    let fine = rectangle([0.1, 0.0], [0.9, 1.0], 12, 1);
    for method in [Method::NearestProjection, Method::RadialBasis] {
        let got = mapped(&row, &fine, method, Mapping::Consistent, &sampled(&row, |p| p[0]));
        assert!(largest_difference(&got, &sampled(&fine, |p| p[0])) < 1e-12, "{method:?}");
    }
}

#[test]
fn a_wrong_grid_is_refused() {
    let wrong = rectangle([0.0; 2], [1.0; 2], 0, 3);
    for [source, target] in [[&square(2), &wrong], [&wrong, &square(2)]] {
        let got = GridMapping::between(source, target, Method::Intersection, Mapping::Consistent);
        assert!(matches!(got, Err(crate::map::MapError::Grid(_))), "{got:?}");
    }
}

#[test]
fn thin_elements_are_interpolated_across() {
    // Aspect ratio 40: the 25 nearest centres would all lie in one row.
    let source = rectangle([0.0; 2], [1.0; 2], 400, 10);
    let target = rectangle([0.1; 2], [0.9; 2], 17, 23);
    let linear = |p: [f64; 3]| p[0] + p[1];
    let got = mapped(
        &source,
        &target,
        Method::RadialBasis,
        Mapping::Consistent,
        &sampled(&source, linear),
    );
    assert!(
        largest_difference(&got, &sampled(&target, linear)) < 1e-11,
        "rounding times condition"
    );
}

/// n × n elements of the unit square, bent along x = 1/2 by this angle [rad].
fn folded(n: usize, angle: f64) -> Grid {
    let mut surface = Quadrilaterals::from(square(n).as_structured().unwrap());
    for point in &mut surface.points {
        let beyond = (point[0] - 0.5).max(0.0);
        *point = [point[0].min(0.5) + beyond * angle.cos(), point[1], beyond * angle.sin()];
    }
    Grid::quadrilaterals("folded", surface)
}

#[test]
fn a_sharp_fold_keeps_constants_and_integrals() {
    // Stencils across the fold are projected on their best-fit plane, where elements may coincide.
    for angle in [0.5, 1.5, 2.5, 3.1] {
        let (source, target) = (folded(10, angle), folded(16, angle));
        let field = noisy_field(&source, 1, 9);
        for method in Method::ALL {
            let ones = mapped(&source, &target, method, Mapping::Consistent, &[1.0; 100]);
            assert!(ones.iter().all(|v| (v - 1.0).abs() < 1e-12), "rounding: {method:?}");
            let got = mapped(&source, &target, method, Mapping::Conservative, &field);
            let difference = target.integrate(&got) - source.integrate(&field);
            // Weights reach some 1e2 where the stencil is nearly degenerate.
            assert!(difference.abs() < 1e-12, "{method:?} {angle}: {difference:e}");
        }
    }
}

#[test]
fn a_mapping_is_made_once_for_a_revision() {
    let (source, mut target) = (square(4), square(5));
    let mut current = CurrentMapping::new(Some(Method::Intersection), Mapping::Conservative);
    for _ in 0..3 {
        current.between(&source, &target).unwrap();
    }
    assert_eq!(current.builds(), 1);
    let before = current.between(&source, &target).unwrap().clone();
    target = moved(&target, [0.05, 0.0, 0.0]);
    assert_ne!(current.between(&source, &target).unwrap(), &before);
    assert_eq!(current.builds(), 2);
    target.revision = 3;
    target.shape = rectangle([0.0; 2], [1.0; 2], 0, 1).shape;
    assert!(current.between(&source, &target).is_err());
    assert_eq!(current.builds(), 2);
}
