//! Chosen radial basis functions: closed forms, linear functions, orders, integrals, numbering,
//! partition of unity, refusals.

use super::*;
use crate::map::by_kernel;
use crate::map::interpolant::Source;
use crate::map::mapping::targets;
use crate::map::operator::SparseOperator;
use crate::map::partition::Partition;
use crate::map::prepared::Prepared;
use crate::map::{Basis, Kernel, MapError};
use contract::grid::{Measure, Vertices};

/// Returns the method with a function, whose radius is used if it has one.
fn method(basis: Basis, radius: f64) -> Method {
    Method::Kernel(Kernel { basis, radius: basis.has_radius().then_some(radius) })
}

/// Returns the method with a radius that is neither narrow nor flat for points at this distance,
/// also if they are scattered.
fn moderate(basis: Basis, spacing: f64) -> Method {
    let lengths = match basis {
        Basis::Multiquadrics | Basis::InverseMultiquadrics => 2.0,
        Basis::Gaussian => 6.0,
        _ => 15.0,
    };
    method(basis, lengths * spacing)
}

fn cloud(points: Vec<[f64; 3]>) -> Grid {
    let (edges, triangles) = (Vec::new(), Vec::new());
    Grid::vertices("cloud", Vertices { points, edges, triangles, measure: Measure::PerPoint })
}

/// `count` points with the coordinates of a function of three numbers between 0 and 1.
fn scattered(count: usize, seed: u64, place: impl Fn([f64; 3]) -> [f64; 3]) -> Grid {
    let mut noise = noise(seed);
    let mut number = || 0.5 + 0.5 * noise();
    cloud((0..count).map(|_| place([number(), number(), number()])).collect())
}

/// Functions that are zero beyond their radius.
const COMPACT: [Basis; 6] = [
    Basis::WendlandC0,
    Basis::WendlandC2,
    Basis::WendlandC4,
    Basis::WendlandC6,
    Basis::WendlandC8,
    Basis::CompactThinPlateSplinesC2,
];

#[test]
fn compact_functions_fall_smoothly_from_one_to_zero() {
    for basis in COMPACT {
        let value = |p: f64| basis.value(p);
        assert_eq!((value(0.0), value(1.0), value(1.5)), (1.0, 0.0, 0.0), "{basis:?}");
        let falls = (0..1000).all(|n| value(f64::from(n) * 1e-3) > value(f64::from(n + 1) * 1e-3));
        assert!(falls, "{basis:?}");
        // At the radius at least (1 − p)²; at the centre 1 − φ ~ p² unless there is a kink.
        assert!(value(1.0 - 1e-4) < 2e-8, "{basis:?}: {:e}", value(1.0 - 1e-4));
        let kink = (1.0 - value(1e-4)) / 1e-4;
        assert_eq!(kink > 0.1, basis == Basis::WendlandC0, "{basis:?}: {kink}");
    }
}

#[test]
fn lengths_of_functions_mean_what_the_keys_say() {
    assert!((Basis::Gaussian.value(1.0) / 1e-9 - 1.0).abs() < 1e-13, "rounding");
    // The scaled forms are multiples of √(a² + r²), 1/√(a² + r²), r² log r + … and r.
    let (a, r) = (0.3_f64, 0.7_f64);
    let hardy = a * Basis::Multiquadrics.value(r / a);
    assert!((hardy - a.hypot(r)).abs() < 1e-15);
    let inverse = Basis::InverseMultiquadrics.value(r / a) / a;
    assert!((inverse - 1.0 / a.hypot(r)).abs() < 1e-14);
    let spline = a * a * Basis::ThinPlateSplines.value(r / a) + r * r * a.ln();
    assert!((spline - r * r * r.ln()).abs() < 1e-15);
    assert_eq!(Basis::VolumeSplines.value(r), r);
    assert_eq!(Basis::ThinPlateSplines.value(0.0), 0.0);
}

#[test]
fn decaying_functions_are_positive_definite_in_space() {
    let points = scattered(60, 3, |p| p);
    for basis in Basis::ALL.into_iter().filter(|basis| basis.decays()) {
        let matrix = nalgebra::DMatrix::from_fn(60, 60, |m, n| {
            let apart = (0..3).map(|k| points.centre(m)[k] - points.centre(n)[k]);
            basis.value(apart.map(|d| d * d).sum::<f64>().sqrt() / 0.6)
        });
        assert!(matrix.cholesky().is_some(), "{basis:?}");
    }
}

#[test]
fn kernels_name_themselves() {
    let shown = |basis, radius| method(basis, radius).to_string();
    assert_eq!(shown(Basis::WendlandC6, 5e-3), "radial-basis, wendland-c6 within 5 mm");
    assert_eq!(shown(Basis::Multiquadrics, 3e-4), "radial-basis, multiquadrics of 0.3 mm");
    assert_eq!(shown(Basis::ThinPlateSplines, 1.0), "radial-basis, thin-plate-splines");
}

/// A grid of places on the unit square, lifted from the plane; `margin` cuts off its border.
fn lifted(n: usize, margin: f64, lift: impl Fn([f64; 2]) -> [f64; 3]) -> Grid {
    let square = rectangle([margin; 2], [1.0 - margin; 2], n, n);
    let place = |k: usize| square.centre(k);
    cloud((0..n * n).map(|k| lift([place(k)[0], place(k)[1]])).collect())
}

#[test]
fn linear_functions_are_exact() {
    let linear = |p: [f64; 3]| 3.0 - 2.0 * p[0] + 5.0 * p[1] + 0.5 * p[2];
    let tilted = |[x, y]: [f64; 2]| [x, y, 0.3 * x - 0.7 * y];
    let cylinder = |[x, y]: [f64; 2]| [x.sin(), y, x.cos()];
    let line =
        |n: usize| cloud((0..n).map(|k| k as f64 / n as f64).map(|s| [s, 2.0 * s, 1.0]).collect());
    let pairs = [
        (0.11, lifted(9, 0.0, tilted), lifted(13, 0.0, tilted)),
        (0.08, lifted(12, 0.0, cylinder), lifted(7, 0.1, cylinder)),
        (0.16, line(14), line(23)),
        (0.19, scattered(150, 1, |p| p), scattered(90, 2, |p| p)),
        (0.11, jittered(9, 14, [1.0, 1.0], 0.5, 1), jittered(17, 5, [0.9, 0.9], 0.5, 2)),
        (0.02, lifted(46, 0.0, tilted), lifted(30, 0.0, tilted)),
        (0.07, scattered(2100, 3, |p| p), scattered(90, 4, |p| p)),
        (1.0, cloud(vec![[0.2; 3]]), cloud(vec![[0.2; 3], [0.2, 0.2, 0.2 + 1e-12]])),
    ];
    for (spacing, source, target) in pairs {
        for basis in Basis::ALL {
            let exact = sampled(&target, linear);
            let field = sampled(&source, linear);
            let method = moderate(basis, spacing);
            let got = mapped(&source, &target, method, Mapping::Consistent, &field);
            let error = largest_difference(&got, &exact);
            // Rounding of weights that sum to one.
            assert!(error < 1e-11, "{basis:?} on {} points: {error:e}", source.points());
        }
    }
}

fn rms(source: &Grid, target: &Grid, method: Method) -> f64 {
    let exact = sampled(target, franke);
    let got = mapped(source, target, method, Mapping::Consistent, &sampled(source, franke));
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let difference = squares(&mut got.iter().zip(&exact).map(|(a, b)| a - b));
    (difference / squares(&mut exact.iter().copied())).sqrt()
}

#[test]
fn errors_fall_with_the_mesh() {
    // Two meshes with one interpolant, and two with a partition of unity. Smooth functions with a
    // fixed radius have no bound on their order but that of the field.
    let orders = [
        (Basis::WendlandC0, 0.35, 1.9),
        (Basis::WendlandC2, 0.35, 2.4),
        (Basis::WendlandC4, 0.35, 3.2),
        (Basis::WendlandC6, 0.35, 3.7),
        (Basis::WendlandC8, 0.35, 4.0),
        (Basis::CompactThinPlateSplinesC2, 0.35, 2.3),
        (Basis::Gaussian, 0.25, 3.4),
        (Basis::Multiquadrics, 0.08, 3.5),
        (Basis::InverseMultiquadrics, 0.1, 3.4),
        (Basis::ThinPlateSplines, 0.0, 1.9),
        (Basis::VolumeSplines, 0.0, 1.9),
    ];
    for (basis, radius, least) in orders {
        let errors = [20, 40, 45, 64].map(|n: usize| {
            // Fewer places than points: rows take most time.
            let m = (0.73 * n as f64) as usize;
            rms(&square(n), &rectangle([0.0; 2], [1.0; 2], m, m - 3), method(basis, radius))
        });
        let order = |a: usize, b: usize, ratio: f64| (errors[a] / errors[b]).ln() / ratio.ln();
        let (whole, clusters) = (order(0, 1, 2.0), order(2, 3, 64.0 / 45.0));
        println!(
            "{}: {:.1e} {:.1e} {:.1e} {:.1e} orders {whole:.2} {clusters:.2}",
            basis.word(),
            errors[0],
            errors[1],
            errors[2],
            errors[3]
        );
        assert!(whole > least && clusters > least, "{basis:?}: {whole} {clusters}");
    }
}

/// Sources and targets of both sizes: one interpolant, or a partition of unity, for each direction.
fn pairs() -> Vec<[Grid; 2]> {
    vec![
        [square(12), unstructured(7)],
        [square(46), square(23)],
        [square(23), square(46)],
        [
            scattered(400, 5, |[x, y, _]| [x, y, x * y]),
            scattered(2100, 6, |[x, y, _]| [x, y, x * y]),
        ],
    ]
}

#[test]
fn integrals_are_kept() {
    for [source, target] in pairs() {
        for basis in Basis::ALL {
            let field = noisy_field(&source, 2, 4);
            let form = Mapping::Conservative;
            let method = moderate(basis, 1.0 / (target.points() as f64).sqrt());
            let mapping = GridMapping::between(&source, &target, method, form).unwrap();
            let mut got = vec![f64::NAN; 2 * target.points()];
            mapping.apply(&field, &mut got);
            let imbalance = mapping.imbalance(&field, &got);
            assert!(imbalance < 1e-13, "{basis:?}: {imbalance:e}");
        }
    }
}

#[test]
fn the_numbering_of_points_has_no_influence() {
    for count in [300, 3000] {
        let place = |[x, y, _]: [f64; 3]| [x, y, 0.3 * x * y];
        let (source, target) = (scattered(count, 7, place), scattered(200, 8, place));
        // A multiplier without a common factor with the number of points.
        let renumbered: Vec<[f64; 3]> =
            (0..count).map(|n| source.centre((n * 1009 + 17) % count)).collect();
        let renumbered = cloud(renumbered);
        for basis in [Basis::WendlandC2, Basis::ThinPlateSplines, Basis::Multiquadrics] {
            let by = |source: &Grid| {
                let field = sampled(source, franke);
                let method = moderate(basis, 1.0 / (count as f64).sqrt());
                mapped(source, &target, method, Mapping::Consistent, &field)
            };
            let difference = largest_difference(&by(&source), &by(&renumbered));
            // Rounding, times the condition number.
            assert!(difference < 1e-9, "{basis:?} on {count} points: {difference:e}");
        }
    }
}

#[test]
fn a_partition_of_unity_is_smooth_across_its_balls() {
    let source = square(30);
    let prepared = Prepared::new(&source).unwrap();
    let count = 2000;
    // A line that is oblique to the balls, in steps of a hundredth of an element.
    let line = |k: usize| 0.3 + 0.4 * k as f64 / count as f64;
    let target = cloud((0..count).map(|k| [line(k), 0.2 + 0.7 * line(k), 0.0]).collect());
    let to = Prepared::new(&target).unwrap();
    let (targets, _) = targets(prepared.nodes(), to.nodes());
    let exact = sampled(&target, franke);
    for (basis, radius) in
        [(Basis::WendlandC2, 0.35), (Basis::WendlandC6, 0.35), (Basis::ThinPlateSplines, 0.0)]
    {
        let Method::Kernel(kernel) = method(basis, radius) else { continue };
        let of_source = Source::new(prepared.nodes(), kernel, "square").unwrap();
        let errors = |operator: &SparseOperator| -> Vec<f64> {
            let mut got = vec![f64::NAN; count];
            operator.apply(&sampled(&source, franke), &mut got);
            got.iter().zip(&exact).map(|(a, b)| a - b).collect()
        };
        let mut operator = SparseOperator::with_rows(count);
        Partition::new(&of_source).push_rows(&targets, &mut operator).unwrap();
        let clusters = errors(&operator);
        let whole = errors(&by_kernel::operator(prepared.nodes(), &targets, kernel, "s").unwrap());
        let most = |errors: &[f64]| errors.iter().fold(0.0, |most: f64, e| most.max(e.abs()));
        let jump = clusters.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        // A cluster lacks the points beyond its ball: its error is between that of the whole
        // interpolant and that of a stencil of 25 points.
        let field = sampled(&source, franke);
        let local = mapped(&source, &target, Method::RadialBasis, Mapping::Consistent, &field);
        let local = largest_difference(&local, &exact);
        let (clustered, whole) = (most(&clusters), most(&whole));
        assert!(whole < clustered && clustered < 0.5 * local, "{basis:?}: {whole} {clustered}");
        assert!(jump < 0.1 * most(&clusters), "{basis:?}: {jump:e}");
    }
}

#[test]
fn a_cluster_of_a_stretched_mesh_has_more_than_one_row() {
    let source = rectangle([0.0; 2], [100.0, 1.0], 60, 50);
    let target = rectangle([5.0, 0.1], [95.0, 0.9], 40, 30);
    let linear = |p: [f64; 3]| 3.0 - 2.0 * p[0] + 5.0 * p[1];
    let field = sampled(&source, linear);
    let got = mapped(&source, &target, method(Basis::WendlandC2, 5.0), Mapping::Consistent, &field);
    let error = largest_difference(&got, &sampled(&target, linear));
    assert!(error < 1e-9, "rounding: {error:e}");
}

#[test]
fn points_at_the_same_place_are_named() {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let (source, target) = (cloud(points), square(3));
    let method = method(Basis::WendlandC2, 3.0);
    for [from, to, form] in [[0, 1, 0], [1, 0, 1]] {
        let grids = [&source, &target];
        let form = [Mapping::Consistent, Mapping::Conservative][form];
        let refused = GridMapping::between(grids[from], grids[to], method, form).unwrap_err();
        assert!(matches!(refused, MapError::SamePlace { points: [1, 3], .. }), "{refused}");
        assert_eq!(
            refused.to_string(),
            "no interpolant by wendland-c2 within 3 m on `cloud`: its points 1 and 3 (counted from 0) \
             are at the same place; remove one of them, or use \"radial-basis\" without `basis`"
        );
    }
}

#[test]
fn a_narrow_function_is_refused_with_a_radius_that_works() {
    for n in [20, 46] {
        let (source, target) = (square(n), square(37));
        for basis in Basis::ALL.into_iter().filter(|basis| basis.decays()) {
            let built = |radius| {
                let method = method(basis, radius);
                GridMapping::between(&source, &target, method, Mapping::Consistent)
            };
            let radius = if basis == Basis::InverseMultiquadrics { 1e-4 } else { 0.005 };
            let refused = built(radius).unwrap_err();
            let MapError::Narrow { radius, .. } = refused else { panic!("{refused}") };
            assert!(built(radius).is_ok(), "{basis:?} {radius}");
        }
    }
    let refused = GridMapping::between(
        &square(20),
        &square(37),
        method(Basis::WendlandC2, 0.01),
        Mapping::Consistent,
    );
    assert_eq!(
        refused.unwrap_err().to_string(),
        "wendland-c2 within 10 mm is too narrow on `square`: at 1257 of 1369 mapped places the \
         function has fallen below a hundredth at the nearest point; set a radius of about 150 mm"
    );
}

#[test]
fn a_flat_function_is_refused_or_accurate() {
    let smooth = [
        Basis::WendlandC4,
        Basis::WendlandC6,
        Basis::WendlandC8,
        Basis::Gaussian,
        Basis::Multiquadrics,
        Basis::InverseMultiquadrics,
    ];
    for (basis, n) in smooth.into_iter().flat_map(|basis| [20, 28, 46].map(|n| (basis, n))) {
        for radius in [0.3, 1.0, 3.0, 10.0, 100.0, 1000.0] {
            let (source, target) = (square(n), rectangle([0.05; 2], [0.95; 2], 19, 19));
            let method = method(basis, radius);
            match GridMapping::between(&source, &target, method, Mapping::Consistent) {
                Ok(mapping) => {
                    let mut got = vec![f64::NAN; target.points()];
                    mapping.apply(&sampled(&source, franke), &mut got);
                    let error = largest_difference(&got, &sampled(&target, franke));
                    assert!(error < 0.02, "{method} on {n} x {n}: {error:e}");
                }
                Err(refused) => {
                    assert!(matches!(refused, MapError::Singular { .. }), "{refused}");
                    let compact = COMPACT.contains(&basis);
                    assert!(radius > 1.0 || !compact && radius >= 0.3, "{refused}");
                }
            }
        }
    }
    let refused = GridMapping::between(
        &square(20),
        &square(37),
        method(Basis::Gaussian, 100.0),
        Mapping::Consistent,
    );
    assert_eq!(
        refused.unwrap_err().to_string(),
        "gaussian within 100 m is too flat on `square`: it hardly differs between neighbouring \
         points, and the linear system is singular to working precision; set a smaller radius, or a \
         less smooth function such as \"wendland-c2\""
    );
}

#[test]
fn a_gap_and_coincident_targets_change_nothing() {
    let source = square(20);
    let lifted = moved(&square(31), 0.3);
    let method = method(Basis::WendlandC4, 0.4);
    let field = sampled(&source, franke);
    let flat = mapped(&source, &square(31), method, Mapping::Consistent, &field);
    let got = mapped(&source, &lifted, method, Mapping::Consistent, &field);
    assert!(largest_difference(&got, &flat) < 1e-12, "rounding");
    // All 400 centres of the source are among those of a grid three times as fine.
    let finer = mapped(&source, &square(60), method, Mapping::Consistent, &field);
    for (n, value) in field.iter().enumerate() {
        let there = (n / 20 * 3 + 1) * 60 + n % 20 * 3 + 1;
        assert_eq!(finer[there].to_bits(), value.to_bits());
    }
}

/// The places of a grid at another height.
fn moved(grid: &Grid, height: f64) -> Grid {
    cloud((0..grid.points()).map(|n| grid.centre(n)).map(|[x, y, _]| [x, y, height]).collect())
}
