//! Steady rolling by continuation in resolution: solve on a coarse grid, prolong, solve on the next.
//!
//! Every second element of a grid, along x and along y, is an element of the next coarser one, with
//! twice the side. The traction bound is restricted by full weighting (1/4, 1/2, 1/4 along each
//! axis), which keeps its sum; the direction and the share p/g of the traction are prolonged
//! bilinearly over the elements in contact, the state of an element by its nearest neighbour.
//!
//! A prescribed force is found on every grid by a secant method that starts from the creepage and the
//! slope of the coarser one and cannot leave its bracket: forces below and above the one asked for,
//! of which none at no creepage is the first.

use super::influence::{Elasticity, Influence};
use super::slip_operator::SlipOperator;
use super::steady_rolling::{
    Creepage, Effort, ElementState, NotConverged, Problem, State, SteadyRolling,
};
use proto::grid::Structured;

/// Grids with no more elements than this along their longer side are not made coarser.
const COARSEST: usize = 26;
/// Tractions have settled when they change by less than this share of the largest bound; a Newton
/// step leaves about a third of that as error.
const TOLERANCE: f64 = 1e-4;
/// A prescribed force is met to this share of f N.
const FORCE_TOLERANCE: f64 = 1e-6;
/// Solves spent on a prescribed force at most, on one grid.
const MOST_TRIALS: usize = 60;
/// Largest growth of the creepage from one trial to the next while no upper bound is known.
const GROWTH: f64 = 1.6;

/// What is prescribed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prescribed {
    /// All creepages.
    Creepage(Creepage),
    /// The longitudinal force on body 1 [N]; lateral creepage and spin are zero.
    Force(f64),
}

/// The solvers of all grids, finest first.
#[derive(Debug)]
pub struct Levels {
    levels: Vec<Level>,
}

/// One grid.
#[derive(Debug)]
struct Level {
    nx: usize,
    ny: usize,
    step: f64,
    area: f64,
    x: Vec<f64>,
    y: Vec<f64>,
    bound: Vec<f64>,
    solver: SteadyRolling,
}

impl Level {
    fn new(grid: &Structured, bodies: &Elasticity, layer: f64, semi_axis: f64) -> Self {
        let (dx, dy) = (grid.dx(), grid.dy());
        let influence = Influence { dx, dy, elasticity: *bodies };
        let operator = SlipOperator::new(&influence, layer, grid.ni, grid.nj, semi_axis / dx);
        Self {
            nx: grid.ni,
            ny: grid.nj,
            step: dx,
            area: dx * dy,
            x: (0..grid.ni).map(|i| grid.x(i)).collect(),
            y: (0..grid.nj).map(|j| grid.y(j)).collect(),
            bound: vec![0.0; grid.points()],
            solver: SteadyRolling::new(operator),
        }
    }

    fn solve(&mut self, state: &mut State) -> Result<Effort, NotConverged> {
        let Self { nx, step, area, x, y, bound, solver, .. } = self;
        let problem = Problem { nx: *nx, step: *step, element_area: *area, x, y, bound };
        solver.solve(&problem, state, TOLERANCE)
    }

    fn force(&self, state: &State) -> f64 {
        state.traction[0].iter().sum::<f64>() * self.area
    }

    /// f N on this grid [N].
    fn most_force(&self) -> f64 {
        self.bound.iter().sum::<f64>() * self.area
    }

    fn at_rest(&self, creepage: Creepage) -> State {
        let Self { nx, step, area, x, y, bound, .. } = self;
        let problem = Problem { nx: *nx, step: *step, element_area: *area, x, y, bound };
        State::at_rest(&problem, creepage)
    }
}

/// A solution on the finest grid, and what it took.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Tractions, slips, states and creepages.
    pub state: State,
    /// Products with the slip operator on the finest grid.
    pub operator_applications: usize,
    /// Newton steps on all grids.
    pub newton_steps: usize,
}

/// Why there is no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RollingError {
    /// A grid did not converge.
    #[error(transparent)]
    NotConverged(#[from] NotConverged),
    /// The force is beyond what friction carries.
    #[error("a force of {force:.6e} N is beyond f N = {most:.6e} N")]
    BeyondFriction {
        /// The force asked for [N].
        force: f64,
        /// f N [N].
        most: f64,
    },
    /// The force was not found.
    #[error("no creepage was found that gives a force of {force:.6e} N")]
    NoCreepage {
        /// The force asked for [N].
        force: f64,
    },
}

impl Levels {
    /// Operators for this grid and all coarser ones. `layer` is the tangential flexibility of a
    /// third body [m/Pa], 0 for none; `semi_axis` the contact's semi-axis a [m].
    #[must_use]
    pub fn new(grid: &Structured, bodies: &Elasticity, layer: f64, semi_axis: f64) -> Self {
        let mut levels = vec![Level::new(grid, bodies, layer, semi_axis)];
        let mut grid = *grid;
        while grid.ni.max(grid.nj) > COARSEST && grid.ni.min(grid.nj) > 4 {
            grid.ni = grid.ni.div_ceil(2);
            grid.nj = grid.nj.div_ceil(2);
            grid.step_i = grid.step_i.map(|value| 2.0 * value);
            grid.step_j = grid.step_j.map(|value| 2.0 * value);
            levels.push(Level::new(&grid, bodies, layer, semi_axis));
        }
        Self { levels }
    }

    /// Solves for this traction bound g [Pa] on the finest grid. `slope` is an estimate of
    /// |dF/dξ| [N], by the linear theory, to start the search for a prescribed force.
    ///
    /// # Errors
    /// The force is beyond f N, or an iteration does not converge.
    pub fn solve(
        &mut self,
        bound: &[f64],
        prescribed: Prescribed,
        slope: f64,
    ) -> Result<Solution, RollingError> {
        self.restrict(bound);
        let before = self.levels[0].solver.work().0;
        let mut state = State::default();
        let mut search = Search { slope, ..Search::default() };
        for index in (0..self.levels.len()).rev() {
            let (fine, coarse) = self.levels.split_at_mut(index + 1);
            let level = &mut fine[index];
            let creepage = match prescribed {
                Prescribed::Creepage(creepage) => creepage,
                Prescribed::Force(_) => state.creepage,
            };
            state = match coarse.first() {
                None => level.at_rest(creepage),
                Some(coarse) => prolong(coarse, &state, level),
            };
            match prescribed {
                Prescribed::Creepage(_) => {
                    search.newton_steps += level.solve(&mut state)?.newton_steps
                }
                Prescribed::Force(force) => search.find(level, &mut state, force)?,
            }
        }
        let operator_applications = self.levels[0].solver.work().0 - before;
        Ok(Solution { state, operator_applications, newton_steps: search.newton_steps })
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
fn prolong(coarse: &Level, from: &State, fine: &Level) -> State {
    let mut state = fine.at_rest(from.creepage);
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
fn share(coarse: &Level, from: &State, i: usize, j: usize) -> [f64; 2] {
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

/// The search for a prescribed force, from grid to grid.
#[derive(Clone, Copy, Debug, Default)]
struct Search {
    /// Creep |ξ| at which to start; 0 before the first grid.
    creep: f64,
    /// Slope d|F|/d|ξ| [N].
    slope: f64,
    newton_steps: usize,
}

impl Search {
    /// Solves with the creepage that gives the force.
    fn find(
        &mut self,
        level: &mut Level,
        state: &mut State,
        force: f64,
    ) -> Result<(), RollingError> {
        let most = level.most_force();
        if force.abs() > most * (1.0 + FORCE_TOLERANCE) {
            return Err(RollingError::BeyondFriction { force, most });
        }
        let (wanted, direction) = (force.abs(), -force.signum());
        let (mut low, mut high) = (0.0, None);
        let mut creep = if self.creep > 0.0 { self.creep } else { wanted / self.slope };
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..MOST_TRIALS {
            state.creepage = [direction * creep, 0.0, 0.0];
            self.newton_steps += level.solve(state)?.newton_steps;
            let excess = level.force(state).abs() - wanted;
            if let Some((creep_before, excess_before)) = before
                && (excess - excess_before) * (creep - creep_before) > 0.0
            {
                self.slope = (excess - excess_before) / (creep - creep_before);
            }
            self.creep = creep;
            if excess.abs() <= FORCE_TOLERANCE * most {
                return Ok(());
            }
            before = Some((creep, excess));
            match excess < 0.0 {
                true => low = creep,
                false => high = Some(creep),
            }
            creep = next(creep - excess / self.slope, low, high);
        }
        Err(RollingError::NoCreepage { force })
    }
}

/// The secant's proposal if it lies inside the bracket, else its middle; without an upper bound no
/// more than a limited growth.
fn next(proposal: f64, low: f64, high: Option<f64>) -> f64 {
    match high {
        None => proposal.clamp(low, low * GROWTH),
        Some(high) if low < proposal && proposal < high => proposal,
        Some(high) => 0.5 * (low + high),
    }
}
