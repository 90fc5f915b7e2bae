use super::*;
use crate::difference::Difference;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

const STEEL: Material = Material { youngs_modulus: 209.92e9, poisson_ratio: 0.28 };
/// The gauge corner and flange throat of CONTACT's example conformal.
const CORNER: Arcs =
    Arcs { curvatures: [-1.0 / 10.2e-3, -1.0 / 10e-3], rolling_curvature: FRAC_1_SQRT_2 / 0.46 };
const DRIVEN: Prescription = Prescription {
    load: Prescribed::Approach(90.886e-6),
    creepage: [-4e-3, 9.8995e-3, 1.5372],
    normal_creepage: 9.8995e-3,
    in_plane: false,
    friction: 0.3,
    adheres: true,
};

/// Solver on elements twice as long as CONTACT's 0.4 mm, with CONTACT's difference.
fn corner(turn: f64) -> ConformalSolver {
    let (side, nx, ny) = (0.8e-3, 27, 21);
    let first = |count: usize| -0.5 * (count as f64 - 1.0) * side;
    let grid = Structured::contact_plane(first(nx), first(ny), side, side, nx, ny);
    ConformalSolver::new(&[STEEL, STEEL], (CORNER, turn), &grid, [9e-3, 6e-3], Difference::Upwind)
}

/// Integrals of pressure and tractions [N].
fn integrals(solver: &ConformalSolver, found: &Conformal) -> [f64; 3] {
    let [x, s] = &found.state.traction;
    [&found.pressure, x, s].map(|field| field.iter().sum::<f64>() * solver.grid.element_area())
}

/// Case 4 of the example: the creepages turn with the surface, and the influence numbers are those
/// of half-spaces. CONTACT's elements are half as long, and its arcs turn about a radius of 10.1
/// mm.
#[test]
fn a_corner_of_half_spaces() {
    let mut solver = corner(0.0);
    let found = solver.solve(&DRIVEN).unwrap();
    for (value, contact) in integrals(&solver, &found).into_iter().zip([91.84e3, 10.50e3, -22.51e3])
    {
        assert!((value / contact - 1.0).abs() < 0.01, "{value} instead of {contact}");
    }
}

/// Case 5: influence numbers of a corner and a throat, in CONTACT by finite elements. The numbers
/// here are exact for a cylinder and a bore (`cylinders_and_bores_under_waves`), so the difference
/// is attributed to the finite elements.
#[test]
fn a_corner_in_a_throat() {
    let mut solver = corner(FRAC_PI_2);
    let found = solver.solve(&DRIVEN).unwrap();
    let largest = found.pressure.iter().copied().fold(0.0, f64::max);
    let [n, x, s] = integrals(&solver, &found);
    for (value, contact, tolerance) in
        [(n, 99.83e3, 0.015), (x, 12.70e3, 0.09), (s, -23.83e3, 0.025), (largest, 1040e6, 0.015)]
    {
        assert!((value / contact - 1.0).abs() < tolerance, "{value} instead of {contact}");
    }
    a_given_force_finds_its_approach(&mut solver, &found);
    mirrored_creepages_have_mirrored_forces(&mut solver, &found);
    friction_takes_what_the_rigid_slip_gives(&mut solver, &found);
}

fn a_given_force_finds_its_approach(solver: &mut ConformalSolver, found: &Conformal) {
    let load = Prescribed::Load(found.force[2]);
    let again = solver.solve(&Prescription { load, ..DRIVEN }).unwrap();
    // Tolerance: the iteration between normal and tangential contact.
    assert!((again.approach / found.approach - 1.0).abs() < 1e-5, "{}", again.approach);
}

fn mirrored_creepages_have_mirrored_forces(solver: &mut ConformalSolver, found: &Conformal) {
    let [xi, eta, phi] = DRIVEN.creepage;
    let mirrored = solver.solve(&Prescription {
        creepage: [xi, -eta, -phi],
        normal_creepage: DRIVEN.normal_creepage,
        ..DRIVEN
    });
    let mirrored = mirrored.unwrap();
    for (k, sign) in [1.0, -1.0, 1.0].into_iter().enumerate() {
        let error = (sign * mirrored.force[k] - found.force[k]).abs() / found.force[2];
        assert!(error < 1e-4, "{k}: {:?} and {:?}", mirrored.force, found.force);
    }
}

/// The work of the tractions on the rigid slip equals the friction work plus the work of the
/// pressure on the normal displacement of passing particles. Tolerance: the reciprocity of the
/// influence numbers.
fn friction_takes_what_the_rigid_slip_gives(solver: &mut ConformalSolver, found: &Conformal) {
    let (speed, grid) = (30.0, solver.grid);
    let [x, s] = &found.state.traction;
    let mut displacement = vec![0.0; grid.points()];
    solver.elastic.opening([x, s], &mut displacement);
    displacement.iter_mut().zip(solver.elastic.displacement()).for_each(|(sum, more)| *sum += more);
    let (mut rigid, mut normal) = (0.0, 0.0);
    for index in (0..grid.points()).filter(|index| !(index + 1).is_multiple_of(grid.ni)) {
        let mean = |field: &[f64]| 0.5 * (field[index] + field[index + 1]);
        let [slip, _] = solver.rigid_slips(&DRIVEN, index);
        rigid -= mean(x) * slip[0] + mean(s) * slip[1];
        normal +=
            mean(&found.pressure) * (displacement[index] - displacement[index + 1]) / grid.dx();
    }
    let [rigid, normal] = [rigid, normal].map(|sum| sum * grid.element_area() * speed);
    let friction = solver.friction_power(found, speed).iter().sum::<f64>() * grid.element_area();
    assert!((friction - rigid - normal).abs() < 2e-3 * friction, "{friction} {rigid} {normal}");
    assert!(found.state.slip[0].iter().all(|slip| slip.is_finite()));
}
