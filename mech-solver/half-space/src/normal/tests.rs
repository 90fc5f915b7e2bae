use super::*;
use crate::extent::sample;
use elastic::Elasticity;
use elastic::Material;
use grids::Structured;

const STEEL: Material = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };

fn influence(dx: f64, dy: f64) -> Influence {
    Influence { dx, dy, elasticity: Elasticity::of_pair(&STEEL, &STEEL), plane_strain: false }
}

/// Sums of waves in many directions, of the same amplitude times length^0.8.
fn roughness(amplitude: f64) -> impl Fn(f64, f64) -> f64 {
    move |x, y| {
        let wave = |k: i32| {
            let (sine, cosine) = (1.7 * f64::from(k)).sin_cos();
            let number = 300.0 * 1.2_f64.powi(k);
            1.2_f64.powf(-0.8 * f64::from(k))
                * (number * (x * cosine + y * sine) + f64::from(k)).cos()
        };
        x * x + y * y + amplitude * (0..40).map(wave).sum::<f64>()
    }
}

/// Checks the conditions of contact with direct sums. Tolerance: ten times the residual of the
/// iteration, since the largest value is compared with a mean square.
fn assert_contact(grid: Structured, distance: &[f64], pressure: &[f64], contact: &NormalContact) {
    let of = influence(grid.dx(), grid.dy());
    let displacement = |target: usize| -> f64 {
        let term = |(source, p): (usize, &f64)| {
            let i = (target % grid.ni) as i32 - (source % grid.ni) as i32;
            let j = (target / grid.ni) as i32 - (source / grid.ni) as i32;
            if *p == 0.0 { 0.0 } else { p * of.zz(i, j) }
        };
        pressure.iter().enumerate().map(term).sum()
    };
    let gaps: Vec<(f64, f64)> = (0..grid.points())
        .map(displacement)
        .zip(distance)
        .map(|(u, h)| (u, h + u - contact.approach))
        .collect();
    let scale = gaps.iter().fold(0.0_f64, |max, (u, _)| max.max(*u));
    let tolerance = 10.0 * NormalSolver::TOLERANCE * scale;
    for ((_, gap), p) in gaps.iter().zip(pressure) {
        assert!(*p >= 0.0 && *gap >= -tolerance, "p = {p} Pa, gap = {gap} m");
        assert!(*p == 0.0 || *gap <= tolerance, "p = {p} Pa, gap = {gap} m");
    }
    let load = pressure.iter().sum::<f64>() * grid.element_area();
    assert!((load / contact.normal_force - 1.0).abs() < 1e-13);
}

/// Solves under a load and checks the solution in several ways; `iterations` is the limit.
fn solve(
    grid: Structured,
    gap: impl Fn(f64, f64) -> f64,
    load: f64,
    iterations: usize,
) -> NormalContact {
    let distance = sample(&grid, &gap);
    let mut solver = NormalSolver::new(grid.ni, grid.nj, &influence(grid.dx(), grid.dy()));
    let mut pressure = vec![0.0; grid.points()];
    let contact = solver.solve(&distance, Prescribed::Load(load), &mut pressure).unwrap();
    assert!(contact.iterations <= iterations, "{} iterations", contact.iterations);
    assert!((contact.normal_force / load - 1.0).abs() < 1e-12);
    assert_contact(grid, &distance, &pressure, &contact);
    // The approach found, when prescribed, gives the same contact. Tolerance: both residuals,
    // multiplied in the load.
    let mut again = vec![0.0; grid.points()];
    let prescribed = Prescribed::Approach(contact.approach);
    let reverse = solver.solve(&distance, prescribed, &mut again).unwrap();
    assert!((reverse.normal_force / load - 1.0).abs() < 1e-7, "{}", reverse.normal_force);
    // With its pressure as the first guess the solver stops at once.
    let warm = solver.solve(&distance, Prescribed::Load(load), &mut pressure).unwrap();
    assert!(warm.iterations <= 1, "{} iterations", warm.iterations);
    contact
}

/// Grid with an odd number of elements each way, one of them at the origin.
fn centred(nx: usize, ny: usize, dx: f64, dy: f64) -> Structured {
    let (x0, y0) = (-((nx / 2) as f64) * dx, -((ny / 2) as f64) * dy);
    Structured::contact_plane(x0, y0, dx, dy, nx, ny)
}

fn square(n: usize) -> Structured {
    centred(n, n, 1e-4, 1e-4)
}

#[test]
fn sphere() {
    let contact = solve(square(41), |x, y| x * x + y * y, 1e3, 10);
    assert!(!contact.touches_edge);
}

#[test]
fn two_patches_and_their_merger() {
    let grid = centred(121, 61, 2e-4, 2e-4);
    let gap = |x: f64, y: f64| (x.abs() - 5e-3).powi(2) + y * y;
    let apart = solve(grid, gap, 1e3, 12);
    let merged = solve(grid, gap, 1e4, 15);
    assert!(merged.contact_elements > 4 * apart.contact_elements);
}

#[test]
fn rough_surfaces() {
    let counts: Vec<usize> = [(1e-7, 12), (1e-6, 16), (1e-5, 19)]
        .map(|(amplitude, limit)| solve(square(61), roughness(amplitude), 1e3, limit))
        .iter()
        .map(|contact| contact.contact_elements)
        .collect();
    assert!(counts[0] > counts[1] && counts[1] > 3 * counts[2], "{counts:?}");
}

#[test]
fn slender_elements_and_contacts() {
    let grid = centred(61, 41, 4e-4, 5e-5);
    solve(grid, |x, y| 0.01 * x * x + 5.0 * y * y, 10.0, 15);
}

/// Flat punch over the whole grid: N E*/(δ c) = π·0.366787 for a rigid square of side c, from the
/// capacitance of the square. Tolerance: the singular edge at 61 elements.
#[test]
fn flat_punch() {
    let contact = solve(square(61), |_, _| 0.0, 1e4, 12);
    assert!(contact.touches_edge);
    assert_eq!(contact.contact_elements, 61 * 61);
    let compliance = 2.0 * STEEL.compliance();
    let stiffness = 1e4 * compliance / (contact.approach * 61e-4);
    assert!((stiffness / (std::f64::consts::PI * 0.366787) - 1.0).abs() < 0.02, "{stiffness}");
}

#[test]
fn a_single_element_and_loads_down_to_nothing() {
    let of = influence(1e-4, 1e-4);
    for load in [1e-3, 1e-30, 1e-150] {
        let contact = solve(square(11), |x, y| x * x + y * y, load, 0);
        assert_eq!(contact.contact_elements, 1);
        assert!((contact.approach * 1e-8 / (load * of.zz(0, 0)) - 1.0).abs() < 1e-12);
    }
    let mut solver = NormalSolver::new(3, 1, &of);
    let mut pressure = [1.0; 3];
    let none = solver.solve(&[2.0, 1.0, 3.0], Prescribed::Load(0.0), &mut pressure).unwrap();
    assert_eq!((none.approach, none.normal_force, pressure), (1.0, 0.0, [0.0; 3]));
    let apart = solver.solve(&[2.0, 1.0, 3.0], Prescribed::Approach(1.0), &mut pressure).unwrap();
    assert_eq!((apart.contact_elements, apart.normal_force), (0, 0.0));
}

#[test]
fn refusals_carry_the_numbers() {
    let mut solver = NormalSolver::new(3, 1, &influence(1e-4, 1e-4));
    let mut solve = |distance: [f64; 3], what| solver.solve(&distance, what, &mut [0.0; 3]);
    let flat = [0.0; 3];
    assert_eq!(solve(flat, Prescribed::Load(-2.0)), Err(NormalError::Load { force: -2.0 }));
    assert!(matches!(solve(flat, Prescribed::Load(f64::NAN)), Err(NormalError::Load { .. })));
    let endless = Prescribed::Approach(f64::INFINITY);
    assert!(matches!(solve(flat, endless), Err(NormalError::Approach { .. })));
    let hole = solve([0.0, f64::INFINITY, 0.0], Prescribed::Load(1.0));
    assert_eq!(hole, Err(NormalError::Distance { element: 1, distance: f64::INFINITY }));
}

#[test]
fn reports_that_it_did_not_converge() {
    let grid = square(41);
    let mut solver = NormalSolver::new(41, 41, &influence(1e-4, 1e-4));
    solver.iteration_limit = 2;
    let distance = sample(&grid, &|x, y| x * x + 2.0 * y * y);
    let error = solver.solve(&distance, Prescribed::Load(1e3), &mut vec![0.0; 1681]).unwrap_err();
    let NormalError::NotConverged { iterations: 2, residual, tolerance } = error else {
        panic!("{error}");
    };
    assert!(residual > tolerance && error.to_string().contains("did not converge"));
}

/// A bound above the pressure changes nothing, to the bit. A lower bound is met with the conditions
/// of contact: p = p̂ only where the bodies would penetrate each other. Tolerance: ten times the
/// residual of the iteration, since the largest value is compared with a mean square.
#[test]
fn a_bound_of_the_pressure() {
    let grid = square(41);
    let (load, rough) = (1000.0, roughness(2e-7));
    for gap in [&(|x: f64, y: f64| x * x + y * y) as &dyn Fn(f64, f64) -> f64, &rough] {
        let distance = sample(&grid, gap);
        let solve = |bound: f64| {
            let mut solver = NormalSolver::new(grid.ni, grid.nj, &influence(1e-4, 1e-4));
            solver.pressure_bound = bound;
            let mut pressure = vec![0.0; grid.points()];
            let contact = solver.solve(&distance, Prescribed::Load(load), &mut pressure).unwrap();
            (pressure, contact, solver.displacement().to_vec())
        };
        let (free, free_contact, _) = solve(f64::INFINITY);
        let largest = free.iter().copied().fold(0.0, f64::max);
        assert_eq!(solve(1.001 * largest).0, free);
        for share in [0.9, 0.5, 0.4] {
            let bound = share * largest;
            let (pressure, contact, displacement) = solve(bound);
            assert!((contact.normal_force / load - 1.0).abs() < 1e-8, "{contact:?}");
            assert!(!contact.touches_edge && contact.approach > free_contact.approach);
            let scale = displacement.iter().copied().fold(0.0, f64::max);
            let tolerance = 10.0 * NormalSolver::TOLERANCE * scale;
            for ((p, h), u) in pressure.iter().zip(&distance).zip(&displacement) {
                let gap = h + u - contact.approach;
                assert!((0.0..=bound).contains(p), "{p}");
                assert!(*p == bound || gap >= -tolerance, "p = {p} Pa, gap = {gap} m");
                assert!(*p == 0.0 || gap <= tolerance, "p = {p} Pa, gap = {gap} m");
            }
            assert!(pressure.contains(&bound));
        }
    }
}

/// Under a bound far below the elastic pressure the whole contact is at the bound and has the area
/// N/p̂. Tolerance: the free elements at the edge.
#[test]
fn a_contact_that_yields_everywhere_has_the_area_of_its_load() {
    let (grid, load, bound) = (square(101), 2000.0, 1e8);
    let distance = sample(&grid, &|x, y| x * x + y * y);
    let mut solver = NormalSolver::new(grid.ni, grid.nj, &influence(1e-4, 1e-4));
    solver.pressure_bound = bound;
    let mut pressure = vec![0.0; grid.points()];
    let contact = solver.solve(&distance, Prescribed::Load(load), &mut pressure).unwrap();
    let area = contact.contact_elements as f64 * grid.element_area();
    assert!((area / (load / bound) - 1.0).abs() < 0.05, "{area}");
    assert!(!contact.touches_edge);
}
