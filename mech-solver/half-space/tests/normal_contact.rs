//! The numerical base of the half-space model against Hertz, and its invariances.

use elastic::Elasticity;
use elastic::Material;
use elastic::hertz::{EllipticContact, elliptic_contact};
use grids::Structured;
use half_space::area::contact_area;
use half_space::extent::{FittedContact, Moments, fit_grid};
use half_space::normal::Prescribed;

const STEEL: Material = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };
const GAP_X: f64 = 0.5 / 0.46;
const GAP_Y: f64 = 0.5 / 0.3;
const LOAD: f64 = 134e3;
const LIMIT: usize = 1_000_000;

fn steel() -> Elasticity {
    Elasticity::of_pair(&STEEL, &STEEL)
}

fn hertz(elasticity: &Elasticity) -> EllipticContact {
    elliptic_contact(GAP_X, GAP_Y, LOAD, elasticity.contact_compliance())
}

fn solve(grid: Structured, elasticity: Elasticity, gap: impl Fn(f64, f64) -> f64) -> FittedContact {
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    fit_grid(grid, elasticity, &gap, Prescribed::Load(LOAD), everywhere, LIMIT, f64::INFINITY)
        .expect("a regular contact")
}

/// Grid of elements of a/`resolution` over an ellipse with a free margin, one of them at the
/// origin.
fn grid_of(estimate: &EllipticContact, resolution: usize) -> Structured {
    let side = estimate.semi_axis_a / resolution as f64;
    let half = |semi_axis: f64| (1.05 * semi_axis / side + 0.5).ceil() as usize;
    centred(half(estimate.semi_axis_a), half(estimate.semi_axis_b), side)
}

fn centred(half_x: usize, half_y: usize, side: f64) -> Structured {
    let (x0, y0) = (-(half_x as f64) * side, -(half_y as f64) * side);
    Structured::contact_plane(x0, y0, side, side, 2 * half_x + 1, 2 * half_y + 1)
}

fn paraboloid(x: f64, y: f64) -> f64 {
    GAP_X * x * x + GAP_Y * y * y
}

/// Relative errors of p_0, δ, a and b.
fn errors(resolution: usize) -> [f64; 4] {
    let exact = hertz(&steel());
    let grid = grid_of(&exact, resolution);
    let solution = solve(grid, steel(), paraboloid);
    assert_eq!(solution.enlargements, 0);
    assert!(solution.contact.iterations <= 15, "{}", solution.contact.iterations);
    let Moments { semi_axes: [a, b], .. } = Moments::of(&grid, &solution.pressure);
    [
        solution.pressure[grid.points() / 2] / exact.max_pressure - 1.0,
        solution.contact.approach / exact.approach - 1.0,
        a / exact.semi_axis_a - 1.0,
        b / exact.semi_axis_b - 1.0,
    ]
}

/// Errors of the discretisation depend on how the edge of the contact meets the elements and fall
/// unevenly. The test bounds them at every mesh, and the order over a factor of eight.
#[test]
fn converges_to_hertz() {
    let table = [10, 20, 40, 80].map(errors);
    let bounds = [
        [8e-4, 8e-4, 8e-4, 5e-3],
        [4e-4, 1e-4, 2e-4, 6e-4],
        [1e-4, 4e-5, 7e-5, 2e-4],
        [2e-5, 1e-5, 2e-5, 5e-5],
    ];
    for (row, bounds) in table.iter().zip(bounds) {
        assert!(row.iter().zip(bounds).all(|(error, bound)| error.abs() < bound), "{row:?}");
    }
    for (coarse, fine) in table[0].iter().zip(table[3]) {
        let order = (coarse / fine).abs().ln() / 8.0_f64.ln();
        assert!(order > 1.5, "order {order}");
    }
}

/// A symmetric gap gives a symmetric pressure, a mirrored gap the mirrored pressure. Tolerance: the
/// iteration, with a factor for the pressure.
#[test]
fn mirror_images() {
    let grid = centred(20, 16, hertz(&steel()).semi_axis_a / 15.0);
    let skew = |x: f64, y: f64| paraboloid(x - 4e-4, y) + x * y + 30.0 * x * x * y;
    let one = solve(grid, steel(), skew);
    let other = solve(grid, steel(), |x, y| skew(-x, y));
    assert_eq!(one.grid, other.grid);
    let peak = one.pressure.iter().copied().fold(0.0, f64::max);
    let nx = one.grid.ni;
    for (row, mirrored) in one.pressure.chunks(nx).zip(other.pressure.chunks(nx)) {
        for (value, image) in row.iter().zip(mirrored.iter().rev()) {
            assert!((value - image).abs() < 1e-6 * peak, "{value} {image}");
        }
    }
}

/// Millimetres and megapascals give the same numbers except for units. Tolerance: rounding over
/// some iterations; powers of two would need none.
#[test]
fn units_do_not_matter() {
    let grid = grid_of(&hertz(&steel()), 12);
    let metres = solve(grid, steel(), paraboloid);
    let material = Material { youngs_modulus: STEEL.youngs_modulus * 1e-6, ..STEEL };
    let elasticity = Elasticity::of_pair(&material, &material);
    let scaled = Structured::contact_plane(
        1e3 * grid.x(0),
        1e3 * grid.y(0),
        1e3 * grid.dx(),
        1e3 * grid.dy(),
        grid.ni,
        grid.nj,
    );
    let gap = |x: f64, y: f64| 1e3 * paraboloid(x * 1e-3, y * 1e-3);
    let millimetres = solve(scaled, elasticity, gap);
    assert_eq!(metres.contact.iterations, millimetres.contact.iterations);
    let quotient = millimetres.contact.approach / metres.contact.approach;
    assert!((quotient / 1e3 - 1.0).abs() < 1e-10);
    for (value, other) in metres.pressure.iter().zip(&millimetres.pressure) {
        assert!((value * 1e-6 - other).abs() < 1e-6, "{value} {other}");
    }
}

/// Without tangential tractions only the sum of the compliances matters, also for bodies whose
/// moduli differ by a hundred. Tolerance: rounding of the sum.
#[test]
fn very_different_bodies() {
    let soft = Material { youngs_modulus: 2.1e9, poisson_ratio: 0.45 };
    let pair = Elasticity::of_pair(&soft, &STEEL);
    assert!(pair.is_coupled());
    let alike = Elasticity {
        shear_compliance: pair.contact_compliance(),
        poisson_compliance: 0.0,
        coupling_compliance: 0.0,
    };
    let exact = hertz(&pair);
    let grid = grid_of(&exact, 20);
    let (one, other) = (solve(grid, pair, paraboloid), solve(grid, alike, paraboloid));
    assert!((one.contact.approach / other.contact.approach - 1.0).abs() < 1e-9);
    let peak = one.pressure[grid.points() / 2];
    // Tolerance: the discretisation at a/20.
    assert!((peak / exact.max_pressure - 1.0).abs() < 1e-3);
    assert!((one.contact.approach / exact.approach - 1.0).abs() < 1e-3);
}

/// Two crowns side by side. Far apart each is a Hertz contact under half the load, with the other's
/// displacement N E*/(2π d) added to the approach. Closer crowns merge, on a growing grid.
#[test]
fn two_crowns_merge() {
    let crowns = |apart: f64| move |x: f64, y: f64| GAP_X * ((x.abs() - apart).powi(2) + y * y);
    let compliance = steel().contact_compliance();
    let half = elliptic_contact(GAP_X, GAP_X, 0.5 * LOAD, compliance);
    let start = centred(27, 27, 3e-4);
    let far = solve(start, steel(), crowns(30e-3));
    let displacement = 0.5 * LOAD * compliance / (std::f64::consts::PI * 60e-3);
    let approach = far.contact.approach - displacement;
    // Tolerance: the discretisation at a/20, and the next term of the distance, (a/d)²/2.
    assert!((approach / half.approach - 1.0).abs() < 4e-3, "{}", approach / half.approach);
    let pressed = |solution: &FittedContact, at: f64| {
        let grid = solution.grid;
        let column = ((at - grid.x(0)) / grid.dx()).round() as usize;
        let row = (-grid.y(0) / grid.dy()).round() as usize;
        solution.pressure[row * grid.ni + column] > 0.0
    };
    assert!(far.enlargements > 0 && pressed(&far, 30e-3) && !pressed(&far, 0.0));
    let near = solve(start, steel(), crowns(2e-3));
    assert!(pressed(&near, 2.1e-3) && pressed(&near, 0.0));
}

/// Area π a b of Hertz's ellipse, round, slender and wide, on grids centred and off centre. The
/// number of elements in contact overestimates it by 1 to 5 %.
#[test]
fn area_of_ellipses() {
    for gap_y in [GAP_X, GAP_Y, 20.0 * GAP_X, 0.2 * GAP_X] {
        let exact = elliptic_contact(GAP_X, gap_y, LOAD, steel().contact_compliance());
        let [a, b] = [exact.semi_axis_a, exact.semi_axis_b];
        for shift in [[0.0, 0.0], [0.37, 0.21]] {
            let off = |resolution: f64| {
                let side = a.min(b) / resolution;
                let half = |semi_axis: f64| (1.05 * semi_axis / side + 1.5).ceil() as usize;
                let mut grid = centred(half(a), half(b), side);
                grid.origin[0] += shift[0] * side;
                grid.origin[1] += shift[1] * side;
                let FittedContact { grid, pressure, .. } =
                    solve(grid, steel(), |x, y| GAP_X * x * x + gap_y * y * y);
                contact_area(&grid, &pressure) / (std::f64::consts::PI * a * b) - 1.0
            };
            for (resolution, most) in [(5.0, 2e-2), (7.0, 5e-3), (10.0, 1.1e-3), (40.0, 4e-4)] {
                let error = off(resolution);
                assert!(error.abs() < most, "{a} {b} {shift:?} {resolution}: {error:e}");
            }
        }
    }
}
