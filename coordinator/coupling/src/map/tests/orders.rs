//! Observed orders of convergence on Franke's function and the eggholder.
//!
//! Errors are root mean squares over the target's centres, relative to the root mean square of the
//! function. The target is 2.37 times as fine as the source in both directions, so that its centres
//! lie at ever different places in the source's elements; for radial basis functions, whose rows
//! take most time, 0.73 times.

use super::*;

type Function = fn([f64; 3]) -> f64;

/// The quarter of the eggholder's square without cusps, scaled to the unit square.
fn smooth_eggholder([x, y, _]: [f64; 3]) -> f64 {
    eggholder(256.0 * x, 256.0 + 256.0 * y)
}

/// The whole eggholder's square, scaled to the unit square.
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

/// Returns the errors for sources of these sizes, on targets that stay `margin` away from the
/// border.
fn errors(
    source: fn(usize) -> Grid,
    sizes: &[usize],
    margin: f64,
    method: Method,
    function: Function,
) -> Vec<f64> {
    let finer = if method == Method::RadialBasis { 0.73 } else { 2.37 };
    let one = |n: &usize| {
        let m = (finer * (1.0 - 2.0 * margin) * *n as f64) as usize;
        let target = rectangle([margin; 2], [1.0 - margin; 2], m, m - 3);
        error(&source(*n), &target, method, Mapping::Consistent, function)
    };
    let errors: Vec<f64> = sizes.iter().map(one).collect();
    println!("{}, margin {margin}: {}", method.word(), shown(&errors));
    errors
}

fn shown(errors: &[f64]) -> String {
    let each: Vec<String> = errors.iter().map(|error| format!("{error:.2e}")).collect();
    each.join(" ")
}

/// Returns the mean order over all halvings of the element size except the first, which is still
/// coarse.
fn order(errors: &[f64]) -> f64 {
    (errors[1] / errors[errors.len() - 1]).log2() / (errors.len() - 2) as f64
}

/// Asserts the method's order for every source and smooth function.
fn assert_order(method: Method, margin: f64, band: std::ops::RangeInclusive<f64>) {
    for source in SOURCES {
        for function in [franke as Function, smooth_eggholder] {
            let order = order(&errors(source, &[12, 24, 48, 96], margin, method, function));
            println!("  order {order:.2}");
            assert!(band.contains(&order), "{method:?}: {order}");
        }
    }
}

/// Margin at which the border has no influence.
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
    // The error is of first order in a strip whose area is of first order: 3/2 in the root mean
    // square.
    assert_order(Method::NearestProjection, 0.0, 1.4..=1.7);
}

#[test]
fn radial_basis_is_of_second_order_at_least() {
    // The polynomial gives second order. The functions, which are stretched with the elements, add
    // to the order on coarse grids. The limit is 3, from the first odd power r³ of φ(r) = 1 − 10
    // r² + 20 r³ − ….
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
    // root mean square. The position of the cusps in the elements changes this by ±1/4 (a factor of
    // two in four halvings).
    let hold = |method: Method| {
        let errors = errors(square, &[16, 32, 64, 128, 256], 0.0, method, whole_eggholder);
        let order = (errors[0] / errors[4]).log2() / 4.0;
        println!("  order {order:.2}");
        assert!((0.75..=1.25).contains(&order), "{method:?}: {order}");
    };
    // The methods run in parallel: this test takes longer than all other tests of mappings
    // together.
    std::thread::scope(|scope| {
        Method::ALL.into_iter().for_each(|method| {
            scope.spawn(move || hold(method));
        });
    });
}

/// n × n elements whose corners lie on a quarter of the cylinder of radius 1 around the y axis.
/// `margin` cuts off this part of the width along the border.
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
        // Same order as in the plane; the chords are of second order.
        (Method::RadialBasis, 1.85..=3.0),
        (Method::Intersection, 0.9..=1.1),
    ];
    for (method, band) in orders {
        let one = |n: usize| {
            let target = cylinder((2.37 * 0.7 * n as f64) as usize, INSIDE);
            error(&cylinder(n, 0.0), &target, method, Mapping::Consistent, function)
        };
        let errors: Vec<f64> = [12, 24, 48, 96].into_iter().map(one).collect();
        let order = order(&errors);
        println!("{}, cylinder: {} order {order:.2}", method.word(), shown(&errors));
        assert!(band.contains(&order), "{method:?}: {order}");
    }
}

/// Returns the errors of conservatively mapped Franke functions, for a target `ratio` times as fine
/// as the source.
fn conservative(method: Method, ratio: f64) -> Vec<f64> {
    let one = |n: usize| {
        let m = (ratio * n as f64) as usize;
        let target = rectangle([0.0; 2], [1.0; 2], m, m);
        error(&square(n), &target, method, Mapping::Conservative, franke)
    };
    let errors: Vec<f64> = [16, 32, 64, 128].into_iter().map(one).collect();
    println!("{} conservative, ratio {ratio}: {}", method.word(), shown(&errors));
    errors
}

#[test]
fn conservative_intersection_is_of_first_order_both_ways() {
    // The mean over many elements on a coarser grid is of second order except at the borders.
    assert!((0.9..=1.1).contains(&order(&conservative(Method::Intersection, 2.37))));
    assert!((1.1..=2.1).contains(&order(&conservative(Method::Intersection, 0.37))));
}

#[test]
fn transposed_point_methods_converge_in_the_integral_only() {
    // Reason for mapping a heat flux by intersection: in the other methods the value of an element
    // depends on the number of nearby centres. Refinement does not reduce this error.
    for method in [Method::NearestNeighbour, Method::NearestProjection, Method::RadialBasis] {
        let errors = conservative(method, 1.37);
        assert!(order(&errors).abs() < 0.2 && errors[3] > 0.05, "{method:?}: {errors:?}");
    }
}
