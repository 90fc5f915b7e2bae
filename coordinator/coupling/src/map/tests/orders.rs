//! Observed orders of convergence on Franke's function and the eggholder.
//!
//! Errors are root mean squares over the target's centres, over that of the function. The target is
//! 2.37 times as fine as the source in both directions: none of its centres keeps the same place in
//! the source's elements.

use super::*;

type Function = fn([f64; 3]) -> f64;

/// The quarter of the eggholder's square that its cusps do not cross, as the unit square.
fn smooth_eggholder([x, y, _]: [f64; 3]) -> f64 {
    eggholder(256.0 * x, 256.0 + 256.0 * y)
}

/// All of the eggholder's square, as the unit square.
fn whole_eggholder([x, y, _]: [f64; 3]) -> f64 {
    eggholder(1024.0 * x - 512.0, 1024.0 * y - 512.0)
}

fn error(source: &Grid, target: &Grid, method: Method, kind: Mapping, function: Function) -> f64 {
    let exact = sampled(target, function);
    let got = mapped(source, target, method, kind, &sampled(source, function));
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let difference = squares(&mut got.iter().zip(&exact).map(|(a, b)| a - b));
    (difference / squares(&mut exact.iter().copied())).sqrt()
}

/// Source grids of about n × n elements of the same mean size.
const SOURCES: [fn(usize) -> Grid; 2] = [square, |n| unstructured(n / 2)];

/// Errors for sources of these sizes, on targets that stay `margin` away from the border.
fn errors(
    source: fn(usize) -> Grid,
    sizes: &[usize],
    margin: f64,
    method: Method,
    function: Function,
) -> Vec<f64> {
    let one = |n: &usize| {
        let m = (2.37 * (1.0 - 2.0 * margin) * *n as f64) as usize;
        let target = rectangle([margin; 2], [1.0 - margin; 2], m, m - 3);
        error(&source(*n), &target, method, Mapping::Consistent, function)
    };
    let errors: Vec<f64> = sizes.iter().map(one).collect();
    println!("{}, margin {margin}: {}", method.name(), shown(&errors));
    errors
}

fn shown(errors: &[f64]) -> String {
    let each: Vec<String> = errors.iter().map(|error| format!("{error:.2e}")).collect();
    each.join(" ")
}

/// Mean order over all halvings of the element size but the first, which is still coarse.
fn order(errors: &[f64]) -> f64 {
    (errors[1] / errors[errors.len() - 1]).log2() / (errors.len() - 2) as f64
}

/// The method's order for every source and smooth function, within a band.
fn assert_order(method: Method, margin: f64, band: std::ops::RangeInclusive<f64>) {
    for source in SOURCES {
        for function in [franke as Function, smooth_eggholder] {
            let order = order(&errors(source, &[16, 32, 64, 128], margin, method, function));
            println!("  order {order:.2}");
            assert!(band.contains(&order), "{method:?}: {order}");
        }
    }
}

/// Far enough from the border for it not to matter.
const INSIDE: f64 = 0.15;

#[test]
fn nearest_neighbour_is_of_first_order() {
    assert_order(Method::NearestNeighbour, INSIDE, 0.9..=1.1);
    assert_order(Method::NearestNeighbour, 0.0, 0.9..=1.1);
}

#[test]
fn nearest_projection_is_of_second_order_inside() {
    assert_order(Method::NearestProjection, INSIDE, 1.9..=2.1);
}

#[test]
fn nearest_projection_is_constant_in_the_border_s_half_element() {
    // First order in a strip whose area is of first order: 3/2 in the root mean square.
    assert_order(Method::NearestProjection, 0.0, 1.4..=1.7);
}

#[test]
fn radial_basis_is_of_second_order_at_least() {
    // Second from the polynomial. The functions, which are stretched with the elements, add to that
    // on coarse grids; 3 is the limit of φ(r) = 1 − 10 r² + 20 r³ − …, whose first odd power is r³.
    assert_order(Method::RadialBasis, INSIDE, 1.85..=3.0);
    assert_order(Method::RadialBasis, 0.0, 1.9..=3.0);
}

#[test]
fn intersection_is_of_first_order() {
    assert_order(Method::Intersection, INSIDE, 0.9..=1.1);
    assert_order(Method::Intersection, 0.0, 0.9..=1.1);
}

#[test]
fn cusps_limit_every_method_to_first_order() {
    // At a cusp √|s| the error is of order 1/2, in a strip whose area is of first order: 1 in the
    // root mean square, give or take how the cusps lie among the elements (a factor of two in four
    // halvings is 1/4).
    let hold = |method: Method| {
        let errors = errors(square, &[16, 32, 64, 128, 256], 0.0, method, whole_eggholder);
        let order = (errors[0] / errors[4]).log2() / 4.0;
        println!("  order {order:.2}");
        assert!((0.75..=1.25).contains(&order), "{method:?}: {order}");
    };
    // Side by side: they take longer than all other tests of mappings together.
    std::thread::scope(|scope| {
        Method::ALL.into_iter().for_each(|method| {
            scope.spawn(move || hold(method));
        });
    });
}

/// n × n elements whose corners lie on a quarter of the cylinder of radius 1 round the y axis, or
/// the part of it that stays `margin` of its width away from the border.
fn cylinder(n: usize, margin: f64) -> Grid {
    let plane = rectangle([margin; 2], [1.0 - margin; 2], n, n);
    let mut surface = Quadrilaterals::from(plane.as_structured().unwrap());
    for point in &mut surface.points {
        let angle = std::f64::consts::FRAC_PI_2 * point[0];
        *point = [angle.sin(), point[1], angle.cos()];
    }
    Grid::quadrilaterals("cylinder", surface)
}

#[test]
fn orders_hold_on_a_cylinder_that_two_grids_cut_differently() {
    let function: Function = |[x, y, z]| (3.0 * x).sin() * (2.0 * y + z).cos();
    let orders = [
        (Method::NearestNeighbour, 0.9..=1.1),
        (Method::NearestProjection, 1.9..=2.1),
        // As in the plane, with the second order of the chords.
        (Method::RadialBasis, 1.85..=3.0),
        (Method::Intersection, 0.9..=1.1),
    ];
    for (method, band) in orders {
        let one = |n: usize| {
            let target = cylinder((2.37 * 0.7 * n as f64) as usize, INSIDE);
            error(&cylinder(n, 0.0), &target, method, Mapping::Consistent, function)
        };
        let errors: Vec<f64> = [16, 32, 64, 128].into_iter().map(one).collect();
        let order = order(&errors);
        println!("{}, cylinder: {} order {order:.2}", method.name(), shown(&errors));
        assert!(band.contains(&order), "{method:?}: {order}");
    }
}

/// Errors of conservatively mapped Franke functions, target `ratio` times as fine as the source.
fn conservative(method: Method, ratio: f64) -> Vec<f64> {
    let one = |n: usize| {
        let m = (ratio * n as f64) as usize;
        let target = rectangle([0.0; 2], [1.0; 2], m, m);
        error(&square(n), &target, method, Mapping::Conservative, franke)
    };
    let errors: Vec<f64> = [16, 32, 64, 128].into_iter().map(one).collect();
    println!("{} conservative, ratio {ratio}: {}", method.name(), shown(&errors));
    errors
}

#[test]
fn conservative_intersection_is_of_first_order_both_ways() {
    // Towards a coarser grid the mean over many elements is of second order but for its borders.
    assert!((0.9..=1.1).contains(&order(&conservative(Method::Intersection, 2.37))));
    assert!((1.1..=2.1).contains(&order(&conservative(Method::Intersection, 0.37))));
}

#[test]
fn transposed_point_methods_converge_in_the_integral_only() {
    // Why a heat flux is mapped by intersection: in the other methods what an element receives
    // depends on how many centres happen to be near it, an error that no refinement takes away.
    for method in [Method::NearestNeighbour, Method::NearestProjection, Method::RadialBasis] {
        let errors = conservative(method, 1.37);
        assert!(order(&errors).abs() < 0.2 && errors[3] > 0.05, "{method:?}: {errors:?}");
    }
}
