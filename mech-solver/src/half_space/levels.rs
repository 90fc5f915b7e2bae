//! The tangential problem by continuation in resolution: solve on a coarse grid, prolong, solve on
//! the next.
//!
//! Every second element of a grid, along x and along y, is an element of the next coarser one, with
//! twice the side. The traction bound is restricted by full weighting (1/4, 1/2, 1/4 along each
//! axis), which keeps its sum; the direction and the share p/g of the traction are prolonged
//! bilinearly over the elements in contact, the state of an element by its nearest neighbour.
//!
//! Prescribed forces are found on every grid ([`super::force_search`]), from the creepages and the
//! slopes of the coarser one.

use super::force_search::{ForceSearch, NotFound, Prescribed, Scales};
use super::influence::{Elasticity, Influence};
use super::slip_operator::SlipOperator;
use super::tangential::{
    Creepage, ElementState, NotConverged, Problem, TangentialSolver, TangentialState,
};
use proto::grid::Structured;
use serde::{Deserialize, Serialize};

/// Grids with no more elements than this along their longer side are not made coarser.
const COARSEST: usize = 26;
/// On coarser grids tractions have settled when they change by less than this share of the largest;
/// a Newton step leaves about a third of that as error.
const COARSE_TOLERANCE: f64 = 1e-4;
/// A prescribed force is met to this share of f N on coarser grids.
const COARSE_FORCE: f64 = 1e-4;
/// On the finest grid the same: this share of the tolerance of the tractions.
const FORCE_SHARE: f64 = 0.01;

/// How the bodies move on each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Steady rolling along x.
    SteadyRolling,
    /// A step of transient rolling along x, by one element.
    RollingStep,
    /// A shift in place.
    Shift,
}

/// A contact on which tangential problems are posed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Elastic constants of the bodies.
    pub bodies: Elasticity,
    /// Tangential flexibility of a third body [m/Pa], 0 for none.
    pub layer: f64,
    /// Semi-axes a and b, or what comes near them [m].
    pub semi_axes: [f64; 2],
    /// How the bodies move.
    pub motion: Motion,
    /// Tractions on the finest grid have settled when they change by less than this share of the
    /// largest.
    pub tolerance: f64,
}

impl Contact {
    /// −∂F_x/∂ξ [N] of the linear theory, G a b C₁₁ with C₁₁ = 4; in a shift −∂F_x/∂s [N/m],
    /// 4 G r/(2 − ν) of a circle.
    fn slope(&self) -> f64 {
        let [a, b] = self.semi_axes;
        let Elasticity { shear_compliance, poisson_compliance, .. } = self.bodies;
        match self.motion {
            Motion::SteadyRolling => 4.0 * a * b / shear_compliance,
            Motion::RollingStep | Motion::Shift => {
                4.0 * (a * b).sqrt() / (2.0 * shear_compliance - poisson_compliance)
            }
        }
    }
}

/// The solvers of all grids, finest first.
#[derive(Debug)]
pub struct Levels {
    contact: Contact,
    levels: Vec<Level>,
    search: ForceSearch,
}

/// Where the rigid slip of a step is taken, ahead of an element's centre, over the way of the step. The step's elastic slip is that of its
/// middle, and the traction that it turns against that of its end: in between, errors of forces under spin nearly cancel
/// (docs/theory/half-space.md). CONTACT has the same.
pub const RIGID_SLIP_AHEAD: f64 = 1.0 / 6.0;

/// One grid.
#[derive(Debug)]
struct Level {
    nx: usize,
    ny: usize,
    /// Δq and the place of the rigid slip within the step, as in [`Problem`].
    distance: f64,
    ahead: f64,
    area: f64,
    x: Vec<f64>,
    y: Vec<f64>,
    bound: Vec<f64>,
    solver: TangentialSolver,
}

impl Level {
    fn new(grid: &Structured, contact: &Contact) -> Self {
        let (dx, dy) = (grid.dx(), grid.dy());
        let Contact { bodies, layer, semi_axes: [a, _], motion, .. } = *contact;
        let influence = Influence { dx, dy, elasticity: bodies };
        let (nx, ny) = (grid.ni, grid.nj);
        let operator = match motion {
            Motion::SteadyRolling => SlipOperator::rolling(&influence, layer, nx, ny, a / dx),
            Motion::RollingStep | Motion::Shift => {
                SlipOperator::instantaneous(&influence, layer, nx, ny)
            }
        };
        let (distance, ahead) = match motion {
            Motion::SteadyRolling | Motion::RollingStep => (dx, RIGID_SLIP_AHEAD * dx),
            Motion::Shift => (1.0, 0.0),
        };
        Self {
            nx,
            ny,
            distance,
            ahead,
            area: dx * dy,
            x: (0..nx).map(|i| grid.x(i)).collect(),
            y: (0..ny).map(|j| grid.y(j)).collect(),
            bound: vec![0.0; grid.points()],
            solver: TangentialSolver::new(operator),
        }
    }

    /// Solves with prescribed creepages or forces; the number of Newton steps.
    fn find(
        &mut self,
        target: &Target<'_>,
        search: &mut ForceSearch,
        start: Option<Creepage>,
        state: &mut TangentialState,
    ) -> Result<usize, TangentialError> {
        let most_force = self.most_force();
        let Self { nx, distance, ahead, area, x, y, bound, solver, .. } = self;
        let (nx, distance, ahead, element_area) = (*nx, *distance, *ahead, *area);
        let slip_history = target.slip_history;
        let problem = Problem { nx, distance, ahead, element_area, x, y, bound, slip_history };
        if !target.prescribed.has_force() {
            state.creepage = target.prescribed.creepage;
            return Ok(solver.solve(&problem, state, target.scales.accuracy)?.newton_steps);
        }
        let moment_arm = problem.largest_moment() / most_force;
        refuse_beyond_friction(target.prescribed, most_force, moment_arm)?;
        let scales = Scales { most_force, ..target.scales };
        let mut newton_steps = 0;
        search.find(target.prescribed, start, &scales, |creepage, tolerance| {
            state.creepage = creepage;
            newton_steps += solver.solve(&problem, state, tolerance)?.newton_steps;
            Ok::<_, TangentialError>(state.forces(&problem))
        })?;
        Ok(newton_steps)
    }

    /// f N on this grid [N].
    fn most_force(&self) -> f64 {
        self.bound.iter().sum::<f64>() * self.area
    }
}

/// What is asked of a grid.
struct Target<'a> {
    prescribed: &'a Prescribed,
    slip_history: Option<[&'a [f64]; 2]>,
    scales: Scales,
}

fn refuse_beyond_friction(
    prescribed: &Prescribed,
    most_force: f64,
    arm: f64,
) -> Result<(), TangentialError> {
    let [x, y, moment] = prescribed.force.map(Option::unwrap_or_default);
    let force = x.hypot(y);
    if force > most_force * (1.0 + COARSE_FORCE) {
        return Err(TangentialError::BeyondFriction { force, most: most_force });
    }
    let most = arm * most_force;
    match moment.abs() > most {
        true => Err(TangentialError::MomentBeyondFriction { moment, most }),
        false => Ok(()),
    }
}

/// A solution on the finest grid, and what it took.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Solution {
    /// Tractions, slips, states and creepages.
    pub state: TangentialState,
    /// Products with the slip operator on the finest grid.
    pub operator_applications: usize,
    /// Newton steps on all grids.
    pub newton_steps: usize,
}

/// Why there is no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TangentialError {
    /// A grid did not converge.
    #[error(transparent)]
    NotConverged(#[from] NotConverged),
    /// The force is beyond what friction carries.
    #[error(
        "a tangential force of {force:.6e} N is beyond f N = {most:.6e} N; prescribe less, or \
         motion.creepage"
    )]
    BeyondFriction {
        /// The force asked for [N].
        force: f64,
        /// f N [N].
        most: f64,
    },
    /// The moment is beyond what friction carries.
    #[error("a spin moment of {moment:.6e} N m is beyond the {most:.6e} N m of a turning contact")]
    MomentBeyondFriction {
        /// The moment asked for [N m].
        moment: f64,
        /// Σ g r dA about the origin [N m].
        most: f64,
    },
    /// The forces were not found.
    #[error(transparent)]
    NoCreepage(#[from] NotFound),
}

impl Solution {
    /// A state that no work has gone into.
    #[must_use]
    pub fn new(state: TangentialState) -> Self {
        Self { state, operator_applications: 0, newton_steps: 0 }
    }
}

impl Levels {
    /// Operators for this grid and all coarser ones.
    #[must_use]
    pub fn new(grid: &Structured, contact: &Contact) -> Self {
        let mut levels = vec![Level::new(grid, contact)];
        let mut grid = *grid;
        let coarsens = contact.motion != Motion::RollingStep;
        while coarsens && grid.ni.max(grid.nj) > COARSEST && grid.ni.min(grid.nj) > 4 {
            grid.ni = grid.ni.div_ceil(2);
            grid.nj = grid.nj.div_ceil(2);
            grid.step_i = grid.step_i.map(|value| 2.0 * value);
            grid.step_j = grid.step_j.map(|value| 2.0 * value);
            levels.push(Level::new(&grid, contact));
        }
        Self { contact: *contact, levels, search: ForceSearch::default() }
    }

    /// Solves for this traction bound g [Pa] on the finest grid, coarsest grid first.
    ///
    /// # Errors
    /// The forces are beyond what friction carries, or an iteration does not converge.
    pub fn solve(
        &mut self,
        bound: &[f64],
        prescribed: &Prescribed,
    ) -> Result<Solution, TangentialError> {
        self.restrict(bound);
        let applied = self.levels[0].solver.work().0;
        let mut state = TangentialState::default();
        let mut newton_steps = 0;
        self.search = ForceSearch::default();
        for index in (0..self.levels.len()).rev() {
            let target = self.target(prescribed, None, index == 0);
            let (fine, coarse) = self.levels.split_at_mut(index + 1);
            let level = &mut fine[index];
            let start = match coarse.first() {
                None => {
                    state = TangentialState::at_rest(&level.bound, [0.0; 3]);
                    None
                }
                Some(coarse) => {
                    state = prolong(coarse, &state, level);
                    Some(state.creepage)
                }
            };
            newton_steps += level.find(&target, &mut self.search, start, &mut state)?;
        }
        let operator_applications = self.levels[0].solver.work().0 - applied;
        Ok(Solution { state, operator_applications, newton_steps })
    }

    /// Solves on the finest grid only, from a solution that is near, whose tractions are cut to the
    /// new bound; `slip_history` is the slip s₀ that is there without tractions [m].
    ///
    /// # Errors
    /// As for [`Levels::solve`].
    pub fn improve(
        &mut self,
        bound: &[f64],
        prescribed: &Prescribed,
        slip_history: Option<[&[f64]; 2]>,
        solution: &mut Solution,
    ) -> Result<(), TangentialError> {
        let target = self.target(prescribed, slip_history, true);
        let level = &mut self.levels[0];
        level.bound.copy_from_slice(bound);
        let applied = level.solver.work().0;
        let state = &mut solution.state;
        state.fit(bound);
        let start = Some(state.creepage).filter(|creepage| *creepage != [0.0; 3]);
        solution.newton_steps += level.find(&target, &mut self.search, start, state)?;
        solution.operator_applications += level.solver.work().0 - applied;
        Ok(())
    }

    /// The displacement difference A p of tractions on the finest grid [m]; for a motion whose
    /// operator is A.
    pub fn displacement(&mut self, traction: [&[f64]; 2], displacement: [&mut [f64]; 2]) {
        assert!(
            self.contact.motion != Motion::SteadyRolling,
            "the operator of this motion is not A"
        );
        self.levels[0].solver.apply(traction, displacement);
    }

    /// The search for prescribed forces, whose slopes serve the next solve.
    pub fn search(&mut self) -> &mut ForceSearch {
        &mut self.search
    }

    fn target<'a>(
        &self,
        prescribed: &'a Prescribed,
        slip_history: Option<[&'a [f64]; 2]>,
        finest: bool,
    ) -> Target<'a> {
        let [a, b] = self.contact.semi_axes;
        // Rolling by one element shifts by ξ Δx.
        let distance = self.levels[0].distance;
        let slope = match self.contact.motion {
            Motion::RollingStep => self.contact.slope() * distance,
            Motion::SteadyRolling | Motion::Shift => self.contact.slope(),
        };
        let accuracy = if finest { self.contact.tolerance } else { COARSE_TOLERANCE };
        let tolerance = if finest { FORCE_SHARE * accuracy } else { COARSE_FORCE };
        let length = (a * b).sqrt();
        let passive = slip_history.is_none();
        let scales = Scales { slope, length, most_force: 0.0, tolerance, accuracy, passive };
        Target { prescribed, slip_history, scales }
    }

    fn restrict(&mut self, bound: &[f64]) {
        self.levels[0].bound.copy_from_slice(bound);
        for index in 1..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(index);
            full_weighting(&fine[index - 1], &mut coarse[0]);
        }
    }
}

/// Bound of every second element, averaged with its neighbours.
fn full_weighting(fine: &Level, coarse: &mut Level) {
    let at = |i: i64, j: i64| {
        let inside = (0..fine.nx as i64).contains(&i) && (0..fine.ny as i64).contains(&j);
        if inside { fine.bound[j as usize * fine.nx + i as usize] } else { 0.0 }
    };
    for (index, value) in coarse.bound.iter_mut().enumerate() {
        let (i, j) = (2 * (index % coarse.nx) as i64, 2 * (index / coarse.nx) as i64);
        let row = |j: i64| 0.25 * at(i - 1, j) + 0.5 * at(i, j) + 0.25 * at(i + 1, j);
        *value = 0.25 * row(j - 1) + 0.5 * row(j) + 0.25 * row(j + 1);
    }
}

/// A coarse solution as the start on the next finer grid.
fn prolong(coarse: &Level, from: &TangentialState, fine: &Level) -> TangentialState {
    let mut state = TangentialState::at_rest(&fine.bound, from.creepage);
    for index in 0..fine.bound.len() {
        let g = fine.bound[index];
        if g == 0.0 {
            continue;
        }
        let (i, j) = (index % fine.nx, index / fine.nx);
        let [rx, ry] = share(coarse, from, i, j);
        let nearest = (j / 2).min(coarse.ny - 1) * coarse.nx + (i / 2).min(coarse.nx - 1);
        let size = rx.hypot(ry);
        let slips = from.element[nearest] != ElementState::Adhesion && size > 0.0;
        let cut = if slips || size > 1.0 { 1.0 / size } else { 1.0 };
        state.traction[0][index] = rx * cut * g;
        state.traction[1][index] = ry * cut * g;
        if slips {
            state.element[index] = ElementState::Slip;
        }
    }
    state
}

/// p/g at an element of the fine grid, bilinear over the coarse elements in contact.
fn share(coarse: &Level, from: &TangentialState, i: usize, j: usize) -> [f64; 2] {
    let mut sum = [0.0; 2];
    let mut weights = 0.0;
    for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let (ci, cj) =
            ((i / 2 + di * (i % 2)).min(coarse.nx - 1), (j / 2 + dj * (j % 2)).min(coarse.ny - 1));
        let at = cj * coarse.nx + ci;
        let g = coarse.bound[at];
        if g > 0.0 {
            sum[0] += from.traction[0][at] / g;
            sum[1] += from.traction[1][at] / g;
            weights += 1.0;
        }
    }
    if weights > 0.0 { sum.map(|value| value / weights) } else { sum }
}
