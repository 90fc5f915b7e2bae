use super::linear::{Border, System, Unknowns};
use super::*;
use crate::aligned::AlignedGrid;
use crate::difference::{Difference, Stencil};
use crate::slip_operator::{Accuracy, RowInfluence, SlipOperator};
use elastic::Elasticity;
use elastic::Material;
use grids::Structured;

/// A circular contact with n elements along its radius, under a semi-elliptic bound.
struct Disc {
    n: usize,
    radius: f64,
    x: Vec<f64>,
    offset: Vec<f64>,
    bound: Vec<f64>,
}

impl Disc {
    /// Disc of radius 1 under a bound of 1 at most.
    fn new(n: usize) -> Self {
        Self::of_size(n, [1.0; 2])
    }

    /// Disc of this radius under a bound of `most` at most.
    fn of_size(n: usize, [radius, most]: [f64; 2]) -> Self {
        let half = n as f64 + 1.0;
        let x: Vec<f64> = (0..2 * n + 3).map(|i| (i as f64 - half) / n as f64).collect();
        let at = |x: &f64, y: &f64| most * (1.0 - x * x - y * y).max(0.0).sqrt();
        let bound = x.iter().flat_map(|y| x.iter().map(move |x| at(x, y))).collect();
        let offset = vec![0.0; x.len()];
        Self { n, radius, x: x.iter().map(|x| radius * x).collect(), offset, bound }
    }

    fn step(&self) -> f64 {
        self.radius / self.n as f64
    }

    fn problem(&self) -> Problem<'_> {
        let step = self.step();
        Problem {
            nx: self.x.len(),
            distance: step,
            ahead: 0.5 * step,
            element_area: step * step,
            x: &self.x,
            offset: &self.offset,
            y: &self.x,
            bound: &self.bound,
            slip_history: None,
            layer: None,
            law: None,
            wanted: None,
        }
    }

    fn solver(&self) -> TangentialSolver {
        let body = Material { youngs_modulus: 2.0, poisson_ratio: 0.25 };
        let step = self.step();
        let elasticity = Elasticity::of_pair(&body, &body);
        let count = self.x.len();
        let rows =
            AlignedGrid::regular(Structured::contact_plane(0.0, 0.0, step, step, count, count));
        let influence = RowInfluence::new(&rows, &elasticity.into(), 0.0, Accuracy::Full);
        let stencil = Stencil { along: Some(Difference::Upwind), own: 0.0 };
        TangentialSolver::new(SlipOperator::of_rows(&influence, stencil, self.n as f64))
    }
}

/// GMRES iterations to 1e-6 on the leading three tenths of the disc, sticking. They rise by three
/// with every doubling, where without the preconditioner they would double.
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
        let unknowns = Unknowns { sticking, ..Unknowns::default() };
        let zeros = || vec![0.0; disc.bound.len()];
        let (mut field, mut image) = ([zeros(), zeros()], [zeros(), zeros()]);
        let mut right = vec![0.0; unknowns.len()];
        right[..unknowns.sticking.len()].fill(1.0);
        let mut system = System {
            operator: &mut solver.operator,
            field: &mut field,
            image: &mut image,
            unknowns: &unknowns,
            border: &mut Border::default(),
        };
        let mut x = vec![0.0; right.len()];
        let achieved = solver.gmres.solve(&mut system, &right, 1e-6, &mut x);
        assert!(achieved.reduction <= 1e-6 && achieved.steps <= most, "{n}: {achieved:?}");
    }
}

/// Work of a whole solve from rest: a snapshot of the Newton and GMRES steps with some room, so
/// that the method cannot silently become slower. The steps rise with the resolution, so
/// [`super::super::grid_continuation`] starts on coarse grids.
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

/// Coulomb's law in every element: within the bound without slip, or on the bound against the slip.
/// The tolerances are those of the Newton iteration, 1e-4 of the largest bound in the traction.
fn assert_solved(problem: &Problem, state: &TangentialState) {
    let [xi, eta, phi] = state.creepage;
    let rigid = (xi.hypot(eta) + phi.abs()) * problem.distance;
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

/// Kalker's coefficients for a circle and ν = ¼: F_x = −G a² C_11 ξ, F_y = −G a² (C_22 η + a C_23
/// φ), C = 4.12, 3.67, 1.47. Two per cent cover the grid (first order in Δx at the edge) and the
/// digits.
#[test]
fn kalkers_coefficients_of_the_circle() {
    let disc = Disc::new(40);
    let problem = disc.problem();
    // Shear modulus G of the test material; creepages so small that hardly anything slips.
    let (shear, small) = (2.0 / (2.0 * 1.25), 1e-4);
    let force = |creepage: Creepage, component: usize| {
        let mut state = TangentialState::at_rest(problem.bound, creepage);
        disc.solver().solve(&problem, &mut state, 1e-6).unwrap();
        -problem.forces(&state)[component] / (shear * small)
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

/// Tractions of an earlier solve vanish when nothing moves any more.
#[test]
fn no_creepage_after_another_one() {
    let disc = Disc::new(10);
    let mut solver = disc.solver();
    let mut state = TangentialState::at_rest(&disc.bound, [-0.3, 0.1, 0.05]);
    solver.solve(&disc.problem(), &mut state, 1e-6).unwrap();
    state.creepage = [0.0; 3];
    solver.solve(&disc.problem(), &mut state, 1e-6).unwrap();
    assert!(state.traction.iter().flatten().all(|traction| *traction == 0.0));
}

/// Mirrored in y, and with the creepage reversed.
#[test]
fn mirror_and_reversal() {
    let disc = Disc::new(12);
    let problem = disc.problem();
    let solve = |creepage: Creepage| {
        let mut state = TangentialState::at_rest(problem.bound, creepage);
        disc.solver().solve(&problem, &mut state, 1e-8).unwrap();
        problem.forces(&state)
    };
    let forces = solve([-0.3, 0.2, 0.1]);
    let reversed = solve([0.3, -0.2, -0.1]);
    let mirrored = solve([-0.3, -0.2, -0.1]);
    let signs = [(reversed, [-1.0, -1.0, -1.0]), (mirrored, [1.0, -1.0, -1.0])];
    for (other, sign) in signs {
        for k in 0..3 {
            // Tolerance: the iteration.
            assert!((other[k] - sign[k] * forces[k]).abs() < 1e-7, "{forces:?} {other:?}");
        }
    }
}

impl Disc {
    /// Problem with forces as shares of f N, and the moment as a share of f N times the radius.
    fn wanting(&self, shares: [Option<f64>; 3]) -> (Problem<'_>, f64) {
        let bounds = self.bound.iter();
        let (largest, sum) = (bounds.clone().copied().fold(0.0, f64::max), bounds.sum::<f64>());
        let most = sum * self.step() * self.step();
        let moment = most * self.radius;
        let [x, y, spin] = shares;
        let force = [x.map(|x| x * most), y.map(|y| y * most), spin.map(|spin| spin * moment)];
        // Half of the largest bound, as G is 0.8: at this creepage much of the disc slips.
        let creepage = 0.5 * largest;
        let wanted =
            PrescribedForces { force, tolerance: 1e-6 * most, length: self.radius, creepage };
        (Problem { wanted: Some(wanted), ..self.problem() }, most)
    }
}

/// Creepages found for forces give those forces, for any choice of prescribed components.
/// Tolerances: 1e-6 f N for the forces, and tractions that settle to 1e-7.
#[test]
fn creepages_of_forces_make_those_forces() {
    let disc = Disc::new(12);
    let mut solver = disc.solver();
    for (shares, given) in [
        ([Some(0.5), None, None], [0.0; 3]),
        ([Some(-0.9), None, None], [0.0, 0.2, 0.1]),
        ([Some(0.3), Some(-0.6), None], [0.0, 0.0, -0.3]),
        ([None, Some(0.5), None], [-0.1, 0.0, 0.0]),
        ([Some(0.4), Some(0.3), Some(0.1)], [0.0; 3]),
        ([None, None, Some(-0.3)], [0.0; 3]),
        ([Some(0.999), None, None], [0.0; 3]),
    ] {
        let (problem, most) = disc.wanting(shares);
        let mut state = TangentialState::at_rest(problem.bound, given);
        solver.solve(&problem, &mut state, 1e-7).unwrap();
        assert_solved(&problem, &state);
        let bare = disc.problem();
        let mut again = TangentialState::at_rest(bare.bound, state.creepage);
        solver.solve(&bare, &mut again, 1e-7).unwrap();
        let forces = bare.forces(&again);
        for k in 0..3 {
            match shares[k] {
                Some(share) => {
                    assert!((forces[k] / most - share).abs() < 2e-6, "{shares:?}: {forces:?}")
                }
                None => assert_eq!(state.creepage[k], given[k]),
            }
        }
    }
}

/// The solver has no built-in scale. Lengths and tractions of another order of magnitude, as under
/// a load of 1e-100 N, give the same creepages over the tractions; for powers of two, to the bit.
#[test]
fn contacts_of_any_size_are_the_same() {
    let creepages = |radius: i32, bound: i32| {
        let disc = Disc::of_size(12, [radius, bound].map(|power| 2.0_f64.powi(power)));
        let (problem, _) = disc.wanting([Some(0.5), Some(-0.3), None]);
        let mut state = TangentialState::at_rest(problem.bound, [0.0; 3]);
        disc.solver().solve(&problem, &mut state, 1e-6).unwrap();
        state.creepage.map(|creepage| creepage * 2.0_f64.powi(-bound))
    };
    let expected = creepages(0, 0);
    for [radius, bound] in [[-200, -200], [-200, 0], [150, -150], [200, 150]] {
        assert_eq!(creepages(radius, bound), expected, "2^{radius} m, 2^{bound} Pa");
    }
}

/// A prescribed force takes hardly more products with the operator than its creepage.
#[test]
fn a_force_costs_no_more_than_its_creepage() {
    for n in [10, 20, 40] {
        let disc = Disc::new(n);
        let mut solver = disc.solver();
        for share in [0.1, 0.5, 0.9, 0.99] {
            let (problem, _) = disc.wanting([Some(share), None, None]);
            let mut spent = |problem: &Problem, creepage| {
                let before = solver.work().0;
                let mut state = TangentialState::at_rest(problem.bound, creepage);
                solver.solve(problem, &mut state, 1e-4).unwrap();
                (state.creepage, solver.work().0 - before)
            };
            let (creepage, force) = spent(&problem, [0.0; 3]);
            let (_, alone) = spent(&disc.problem(), creepage);
            assert!(2 * force <= 3 * alone, "{n}, {share}: {force} products against {alone}");
        }
    }
}

/// The creepage grows towards full slip, and a start from full slip returns to the solution.
#[test]
fn forces_up_to_full_slip() {
    let disc = Disc::new(12);
    let mut solver = disc.solver();
    let mut last = 0.0;
    for gap in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let (problem, most) = disc.wanting([Some(1.0 - gap), None, None]);
        let mut state = TangentialState::at_rest(problem.bound, [0.0; 3]);
        solver.solve(&problem, &mut state, 1e-6).unwrap();
        assert!(-state.creepage[0] > last, "{gap}: {:?} after {last}", state.creepage);
        assert!((problem.forces(&state)[0] / most - 1.0 + gap).abs() <= 1e-6);
        last = -state.creepage[0];
    }
    let bare = disc.problem();
    let mut state = TangentialState::at_rest(bare.bound, [-100.0, 0.0, 0.0]);
    solver.solve(&bare, &mut state, 1e-6).unwrap();
    let (problem, most) = disc.wanting([Some(0.5), None, None]);
    solver.solve(&problem, &mut state, 1e-6).unwrap();
    assert!((problem.forces(&state)[0] / most - 0.5).abs() <= 1e-6, "{:?}", state.creepage);
}

/// Forces and a moment that friction cannot carry together are an error.
#[test]
fn forces_out_of_reach_are_said() {
    let disc = Disc::new(10);
    let (problem, _) = disc.wanting([Some(0.9), Some(0.0), Some(0.6)]);
    let mut state = TangentialState::at_rest(problem.bound, [0.0; 3]);
    let error = disc.solver().solve(&problem, &mut state, 1e-4).unwrap_err();
    assert!(error.to_string().contains("exceed what friction carries"), "{error}");
}
