use super::*;
use crate::half_space::influence::{Elasticity, Influence};
use crate::scene::Material;

/// A circular contact of radius 1 with n elements along it, under a semi-elliptic bound.
struct Disc {
    n: usize,
    x: Vec<f64>,
    bound: Vec<f64>,
}

impl Disc {
    fn new(n: usize) -> Self {
        let half = n as f64 + 1.0;
        let x: Vec<f64> = (0..2 * n + 3).map(|i| (i as f64 - half) / n as f64).collect();
        let at = |x: &f64, y: &f64| (1.0 - x * x - y * y).max(0.0).sqrt();
        let bound = x.iter().flat_map(|y| x.iter().map(move |x| at(x, y))).collect();
        Self { n, x, bound }
    }

    fn problem(&self) -> Problem<'_> {
        let step = 1.0 / self.n as f64;
        Problem {
            nx: self.x.len(),
            distance: step,
            ahead: 0.5 * step,
            element_area: step * step,
            x: &self.x,
            y: &self.x,
            bound: &self.bound,
            slip_history: None,
        }
    }

    fn solver(&self) -> TangentialSolver {
        let body = Material { youngs_modulus: 2.0, poisson_ratio: 0.25 };
        let step = 1.0 / self.n as f64;
        let elasticity = Elasticity::of_pair(&body, &body);
        let influence = Influence { dx: step, dy: step, elasticity };
        let count = self.x.len();
        TangentialSolver::new(SlipOperator::rolling(&influence, 0.0, count, count, self.n as f64))
    }
}

/// GMRES iterations to 1e-6 on the leading three tenths of the disc, sticking. They rise by three
/// with every doubling; that they do not double is what the preconditioner is for.
#[test]
fn linear_steps_hardly_depend_on_the_resolution() {
    for (n, most) in [(10, 14), (20, 17), (40, 20), (80, 23)] {
        let disc = Disc::new(n);
        let mut solver = disc.solver();
        let count = disc.x.len();
        let sticks = |index: &usize| {
            let (x, y) = (disc.x[index % count], disc.x[index / count]);
            disc.bound[*index] > 0.0 && x > 0.4 * (1.0 - y * y).max(0.0).sqrt()
        };
        let sticking: Vec<usize> = (0..disc.bound.len()).filter(sticks).collect();
        let zeros = || vec![0.0; disc.bound.len()];
        let (mut field, mut image) = ([zeros(), zeros()], [zeros(), zeros()]);
        let mut right = vec![0.0; 2 * sticking.len()];
        right[..sticking.len()].fill(1.0);
        let mut system = System {
            operator: &mut solver.operator,
            field: &mut field,
            image: &mut image,
            sticking: &sticking,
            slipping: &[],
        };
        let mut x = vec![0.0; right.len()];
        let achieved = solver.gmres.solve(&mut system, &right, 1e-6, &mut x);
        assert!(achieved.reduction <= 1e-6 && achieved.steps <= most, "{n}: {achieved:?}");
    }
}

/// Work of a whole solve from rest: a snapshot of the Newton and GMRES steps with some room, so
/// that the method cannot silently become slower. From rest they rise with the resolution, which is
/// why [`super::super::levels`] starts on coarse grids.
#[test]
fn newton_steps_of_a_solve_from_rest() {
    for (n, newton, linear) in [(10, 12, 45), (20, 15, 65), (40, 22, 90)] {
        let disc = Disc::new(n);
        let problem = disc.problem();
        let mut state = TangentialState::at_rest(problem.bound, [-0.7, 0.0, 0.0]);
        let effort = disc.solver().solve(&problem, &mut state, 1e-4).unwrap();
        assert!(effort.newton_steps <= newton && effort.linear_steps <= linear, "{n}: {effort:?}");
        assert_solved(&problem, &state);
    }
}

/// Coulomb's law in every element: within the bound and no slip, or on it and against the slip. The
/// tolerances are those of the Newton iteration, 1e-4 of the largest bound in the traction.
fn assert_solved(problem: &Problem, state: &TangentialState) {
    let rigid = state.creepage[0].hypot(state.creepage[1]) * problem.distance;
    for (index, element) in state.element.iter().enumerate() {
        let p = [state.traction[0][index], state.traction[1][index]];
        let s = [state.slip[0][index], state.slip[1][index]];
        let (size, slip) = (p[0].hypot(p[1]), s[0].hypot(s[1]));
        match element {
            ElementState::Exterior => assert_eq!(size, 0.0),
            ElementState::Adhesion => {
                assert!(size <= problem.bound[index] && slip < 1e-3 * rigid, "{index}: {slip}");
            }
            ElementState::Slip => {
                assert!((size - problem.bound[index]).abs() < 1e-12);
                let along = -(p[0] * s[0] + p[1] * s[1]) / size;
                assert!(slip - along <= 1e-3 * rigid, "{index}: slip {slip}, against p {along}");
            }
        }
    }
}

/// Kalker's coefficients for a circle and ν = ¼: F_x = −G a² C_11 ξ, F_y = −G a² (C_22 η + a C_23 φ),
/// C = 4.12, 3.67, 1.47. Two per cent cover the grid (first order in Δx at the edge) and the digits.
#[test]
fn kalkers_coefficients_of_the_circle() {
    let disc = Disc::new(40);
    let problem = disc.problem();
    // G of the test material; creepages so small that hardly anything slips.
    let (shear, small) = (2.0 / (2.0 * 1.25), 1e-4);
    let force = |creepage: Creepage, component: usize| {
        let mut state = TangentialState::at_rest(problem.bound, creepage);
        disc.solver().solve(&problem, &mut state, 1e-6).unwrap();
        -state.forces(&problem)[component] / (shear * small)
    };
    let found = [
        (force([small, 0.0, 0.0], 0), 4.12),
        (force([0.0, small, 0.0], 1), 3.67),
        (force([0.0, 0.0, small], 1), 1.47),
    ];
    for (coefficient, expected) in found {
        assert!((coefficient / expected - 1.0).abs() < 0.02, "{coefficient}, not {expected}");
    }
}

/// Mirrored in y, and with the direction of the creepage reversed.
#[test]
fn mirror_and_reversal() {
    let disc = Disc::new(12);
    let problem = disc.problem();
    let solve = |creepage: Creepage| {
        let mut state = TangentialState::at_rest(problem.bound, creepage);
        disc.solver().solve(&problem, &mut state, 1e-8).unwrap();
        state.forces(&problem)
    };
    let forces = solve([-0.3, 0.2, 0.1]);
    let reversed = solve([0.3, -0.2, -0.1]);
    let mirrored = solve([-0.3, -0.2, -0.1]);
    let signs = [(reversed, [-1.0, -1.0, -1.0]), (mirrored, [1.0, -1.0, -1.0])];
    for (other, sign) in signs {
        for k in 0..3 {
            // The iteration's own tolerance.
            assert!((other[k] - sign[k] * forces[k]).abs() < 1e-7, "{forces:?} {other:?}");
        }
    }
}
