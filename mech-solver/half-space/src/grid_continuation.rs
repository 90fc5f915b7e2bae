//! The tangential problem by continuation in resolution: solve on a coarse grid, prolong, solve on
//! the next. A line of contact (a single row) is coarsened along x only.
//!
//! Every second element of a grid, along x and along y, is an element of the next coarser grid,
//! with twice the side. The traction bound is restricted by full weighting (1/4, 1/2, 1/4 along
//! each axis), which keeps its sum. The direction and the share p/g of the traction are prolonged
//! bilinearly over the elements in contact, the state of an element from its nearest neighbour.
//!
//! Prescribed forces are met on every grid, from the creepages of the coarser one.
//!
//! Displaced rows ([`super::aligned`]) keep their places on the coarser grids, which only provide a
//! start.

use super::aligned::AlignedGrid;
use super::difference::{Difference, Stencil};
use super::dissipation::Dissipation;
use super::slip_operator::{Accuracy, Displacement, RowInfluence, SlipOperator};
use super::tangential::{
    BoundLaw, ElementState, Layer, NotConverged, PrescribedForces, PrescribedMotion, Problem,
    TangentialSolver, TangentialState,
};
use super::viscoelastic::Bodies;
use super::yielding::Yield;
use elastic::Elasticity;
use grids::Structured;
use serde::{Deserialize, Serialize};
use tables::readable::{number, quantity};

/// Grids with at most this many elements along their longer side are not coarsened.
const COARSEST: usize = 26;
/// Tractions on coarser grids have settled when they change by less than this share of the largest.
const COARSE_TOLERANCE: f64 = 1e-2;
/// Tolerance of a prescribed force on coarser grids, as a share of f N.
const COARSE_FORCE: f64 = 1e-3;
/// Tolerance of a prescribed force on the finest grid, as a share of the tolerance of the
/// tractions.
const FORCE_SHARE: f64 = 0.01;
/// Relative tolerance of small forces.
const SMALL_FORCE: f64 = 1e-4;
/// Rounding of the forces over f N.
const ROUNDING: f64 = 1e-13;
/// Share of f N by which a prescribed force may exceed it through rounding.
const BEYOND: f64 = 1e-6;

/// Relative motion of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Steady rolling along x.
    SteadyRolling,
    /// The first step of transient rolling along x, by one element: the slip is the displacement
    /// less that of the particle one step ago.
    FirstRollingStep,
    /// A later step of transient rolling: the slip has the difference along x of steady rolling,
    /// and the second-order backward difference in time.
    RollingStep,
    /// A tangential shift in place, without rolling.
    Shift,
}

impl Motion {
    /// Stencil from displacements at the end of a step to slip.
    #[must_use]
    pub fn stencil(self, difference: Difference) -> Stencil {
        match self {
            Self::SteadyRolling => Stencil { along: Some(difference), own: 0.0 },
            Self::FirstRollingStep | Self::Shift => Stencil { along: None, own: 1.0 },
            Self::RollingStep => Stencil { along: Some(difference), own: 1.5 },
        }
    }
}

/// Contact for which tangential problems are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The two bodies; they may be viscoelastic in steady rolling only.
    pub bodies: Bodies,
    /// Tangential flexibility of a third body [m/Pa], 0 for none.
    pub layer: f64,
    /// Yielding layer.
    pub yields: Option<Yield>,
    /// Approximate semi-axes a and b [m].
    pub semi_axes: [f64; 2],
    /// Motion of the bodies.
    pub motion: Motion,
    /// Difference along x, in steady rolling.
    pub difference: Difference,
    /// Tractions on the finest grid have settled when they change by less than this share of the
    /// largest.
    pub tolerance: f64,
}

impl Contact {
    /// −∂F_x/∂ξ [N] of the linear theory, G a b C₁₁ with C₁₁ = 4; in a shift −∂F_x/∂s [N/m], 4 G
    /// r/(2 − ν) of a circle.
    fn slope(&self) -> f64 {
        let [a, b] = self.semi_axes;
        let Elasticity { shear_compliance, poisson_compliance, .. } = self.bodies.instantaneous;
        match self.motion {
            Motion::SteadyRolling => 4.0 * a * b / shear_compliance,
            Motion::FirstRollingStep | Motion::RollingStep | Motion::Shift => {
                4.0 * (a * b).sqrt() / (2.0 * shear_compliance - poisson_compliance)
            }
        }
    }
}

/// Solvers on all grids, finest first.
#[derive(Debug)]
pub struct Levels {
    contact: Contact,
    levels: Vec<Level>,
    dissipation: Option<Dissipation>,
}

/// Solver and data of one grid.
#[derive(Debug)]
struct Level {
    nx: usize,
    ny: usize,
    /// True for steady rolling, false for a step in time.
    steady: bool,
    /// Distance Δq, and the point of the step at which the rigid slip is taken, as in [`Problem`].
    distance: f64,
    ahead: f64,
    area: f64,
    x: Vec<f64>,
    /// Displacement of each row along x [m].
    offset: Vec<f64>,
    y: Vec<f64>,
    bound: Vec<f64>,
    yields: Option<Yield>,
    solver: TangentialSolver,
}

impl Level {
    fn new(rows: &AlignedGrid, contact: &Contact, influence: Option<&RowInfluence>) -> Self {
        let grid = rows.grid();
        let (dx, dy) = (grid.dx(), grid.dy());
        let Contact { bodies, layer, yields, semi_axes: [a, _], motion, difference, .. } = *contact;
        let (nx, ny) = (grid.ni, grid.nj);
        let stencil = motion.stencil(difference);
        let operator = match influence {
            Some(influence) => SlipOperator::of_rows(influence, stencil, a / dx),
            None => SlipOperator::of_memory(&bodies, stencil, layer, [nx, ny], [dx, dy], a / dx),
        };
        let (distance, ahead) = match motion {
            Motion::Shift => (1.0, 0.0),
            _ => (dx, difference.rigid_slip_ahead() * dx),
        };
        Self {
            nx,
            ny,
            steady: motion == Motion::SteadyRolling,
            distance,
            ahead,
            area: dx * dy,
            x: (0..nx).map(|i| grid.x(i)).collect(),
            offset: (0..ny).map(|j| rows.offset(j)).collect(),
            y: (0..ny).map(|j| grid.y(j)).collect(),
            bound: vec![0.0; grid.points()],
            yields,
            solver: TangentialSolver::new(operator),
        }
    }

    /// Solves with prescribed creepages or forces, starting from the state; returns the number of
    /// Newton steps.
    fn find(
        &mut self,
        target: &Target<'_>,
        state: &mut TangentialState,
    ) -> Result<usize, TangentialError> {
        let most_force = self.most_force();
        let Self { nx, steady, distance, ahead, area, x, offset, y, bound, yields, solver, .. } =
            self;
        let Target { prescribed, history, .. } = *target;
        let before = history.and_then(|history| history.plastic);
        let mut problem = Problem {
            nx: *nx,
            distance: *distance,
            ahead: *ahead,
            element_area: *area,
            x,
            offset,
            y,
            bound,
            law: target.law,
            slip_history: history.map(|history| history.slip),
            layer: yields.map(|law| Layer { law, before }),
            wanted: None,
        };
        for (k, creepage) in state.creepage.iter_mut().enumerate() {
            if prescribed.force[k].is_none() {
                *creepage = prescribed.creepage[k];
            }
        }
        if prescribed.has_force() {
            problem.wanted = Some(target.wanted(most_force));
        }
        let before = state.creepage;
        // On a softening layer in steady rolling, accumulated shifts soften all elements
        // downstream, and Newton's method overshoots.
        let softens =
            problem.layer.filter(|layer| layer.before.is_none() && layer.law.hardening < 0.0);
        let slip_law = target.law.filter(|law| law.arguments().slip);
        let solved = match (softens, slip_law) {
            (Some(layer), _) => solver.solve_by_passes(&problem, layer, state, target.accuracy),
            // A step in time may have several solutions.
            (None, Some(law)) if !*steady => {
                return Ok(solver
                    .solve_by_slip_passes(&problem, law, state, target.accuracy)?
                    .newton_steps);
            }
            _ => solver.solve(&problem, state, target.accuracy),
        };
        let mut forces = (0..3).filter(|k| prescribed.force[*k].is_some());
        let effort = match (solved, forces.next(), forces.next()) {
            // An element may alternate for ever. From another start it rarely does.
            (Err(_), None, _) if softens.is_none() => {
                *state = TangentialState::at_rest(bound, before);
                match slip_law {
                    Some(law) => solver.solve_by_slip_passes(&problem, law, state, target.accuracy),
                    None => solver.solve(&problem, state, target.accuracy),
                }
            }
            // Where friction depends on the creepage, the force may also fall with it.
            (Err(_), Some(k), None) if !target.depends_on_creepage() => {
                *state = TangentialState::at_rest(bound, before);
                solver.solve_by_bracket(&problem, k, state, target.accuracy)
            }
            (solved, ..) => solved,
        };
        Ok(effort?.newton_steps)
    }

    /// Friction limit f N on this grid [N].
    fn most_force(&self) -> f64 {
        match self.yields {
            Some(law) => self.bound.iter().map(|g| law.most(*g)).sum::<f64>() * self.area,
            None => self.bound.iter().sum::<f64>() * self.area,
        }
    }

    /// Moment of a contact that spins about the origin, Σ g r dA [N m].
    fn most_moment(&self) -> f64 {
        let most = |g: &f64| self.yields.map_or(*g, |law| law.most(*g));
        let row = |(bounds, (y, offset)): (&[f64], (&f64, &f64))| -> f64 {
            bounds.iter().zip(&self.x).map(|(g, x)| most(g) * (x + offset).hypot(*y)).sum()
        };
        let places = self.y.iter().zip(&self.offset);
        self.bound.chunks_exact(self.nx).zip(places).map(row).sum::<f64>() * self.area
    }

    fn refuse_beyond_friction(&self, prescribed: &PrescribedMotion) -> Result<(), TangentialError> {
        let stiffness = self.solver.self_influence().recip();
        if let Some(Yield { hardening, .. }) = self.yields.filter(|law| law.hardening <= -stiffness)
        {
            return Err(TangentialError::SofteningUnstable { hardening, stiffness });
        }
        let [x, y, moment] = prescribed.force.map(Option::unwrap_or_default);
        let (force, most) = (x.hypot(y), self.most_force());
        if force > most * (1.0 + BEYOND) {
            return Err(TangentialError::BeyondFriction { force, most });
        }
        match moment.abs() > self.most_moment() {
            true => Err(TangentialError::MomentBeyondFriction { moment, most: self.most_moment() }),
            false => Ok(()),
        }
    }
}

/// State before a step.
#[derive(Clone, Copy, Debug)]
pub struct History<'a> {
    /// Slip s₀ without tractions, x and y [m].
    pub slip: [&'a [f64]; 2],
    /// Plastic shift of a yielding layer on every element before the step [m]; `None` in steady
    /// rolling.
    pub plastic: Option<&'a [f64]>,
}

impl<'a> History<'a> {
    /// State of bodies without a layer, with this slip s₀.
    #[must_use]
    pub fn of_slip(slip: [&'a [f64]; 2]) -> Self {
        Self { slip, plastic: None }
    }
}

/// Friction of the elements.
#[derive(Clone, Copy, Debug)]
pub struct Friction<'a> {
    /// Traction bound g [Pa], at the start if it depends on the solution.
    pub bound: &'a [f64],
    /// Law of the bound, if it depends on creepages or slips.
    pub law: Option<&'a dyn BoundLaw>,
}

impl<'a, B: AsRef<[f64]> + ?Sized> From<&'a B> for Friction<'a> {
    /// Friction with bounds [Pa] that do not depend on the solution.
    fn from(bound: &'a B) -> Self {
        Self { bound: bound.as_ref(), law: None }
    }
}

/// Task for one grid.
struct Target<'a> {
    prescribed: &'a PrescribedMotion,
    law: Option<&'a dyn BoundLaw>,
    history: Option<History<'a>>,
    /// Tolerance of the tractions.
    accuracy: f64,
    /// Error allowed in the forces, over f N.
    tolerance: f64,
    /// Approximate −∂F_x/∂ξ at small creepage [N], or [N/m] in a shift.
    slope: f64,
    /// Length scale of the contact [m].
    length: f64,
}

impl Target<'_> {
    fn depends_on_creepage(&self) -> bool {
        self.law.is_some_and(|law| law.arguments().creepage)
    }

    /// Prescribed forces on a grid whose friction limit is `most_force`.
    fn wanted(&self, most_force: f64) -> PrescribedForces {
        let PrescribedMotion { force, creepage } = *self.prescribed;
        let [x, y, moment] = force.map(|one| one.unwrap_or_default().abs());
        // Small forces are met more closely, if only their own creepage drives the contact.
        let alone = self.history.is_none() && creepage == [0.0; 3];
        let size = x.max(y).max(moment / self.length) / most_force;
        let relative =
            if alone && size > 0.0 { (SMALL_FORCE * size).max(ROUNDING) } else { f64::INFINITY };
        PrescribedForces {
            force,
            tolerance: self.tolerance.min(relative) * most_force,
            length: self.length,
            creepage: most_force / self.slope,
        }
    }
}

/// Solution on the finest grid, and its cost.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Solution {
    /// Tractions, slips, states and creepages.
    pub state: TangentialState,
    /// Products with the slip operator on the finest grid.
    pub operator_applications: usize,
    /// Newton steps on all grids.
    pub newton_steps: usize,
}

/// Reason why a tangential problem has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TangentialError {
    /// The iteration on one grid did not converge.
    #[error(transparent)]
    NotConverged(#[from] NotConverged),
    /// The force exceeds the friction limit.
    #[error(
        "a tangential force of {force} exceeds the friction limit f N = {most}; \
         prescribe a smaller force, or a creepage", force = quantity(*.force, "N", 7), most = quantity(*.most, "N", 7))]
    BeyondFriction {
        /// Prescribed force [N].
        force: f64,
        /// Friction limit f N [N].
        most: f64,
    },
    /// A layer softens faster than an element unloads.
    #[error(
        "the layer softens by {} Pa/m, faster than an element of this grid unloads \
         ({stiffness} Pa/m), so that its slip jumps; reduce the softening, or use \
         finer elements",
        number(-.hardening, 4), stiffness = number(*.stiffness, 4))]
    SofteningUnstable {
        /// Change of the yield stress with the plastic shift [Pa/m].
        hardening: f64,
        /// Traction that takes back a unit of slip of an element [Pa/m].
        stiffness: f64,
    },
    /// The moment exceeds the friction limit.
    #[error(
        "a spin moment of {moment} N m exceeds the {most} N m of a contact in pure spin", moment = number(*.moment, 7), most = number(*.most, 7))]
    MomentBeyondFriction {
        /// Prescribed moment [N m].
        moment: f64,
        /// Σ g r dA about the origin [N m].
        most: f64,
    },
}

impl Solution {
    /// Wraps a state with zero counts of work.
    #[must_use]
    pub fn new(state: TangentialState) -> Self {
        Self { state, operator_applications: 0, newton_steps: 0 }
    }
}

impl Levels {
    /// Creates the operators for this grid and all coarser grids.
    #[must_use]
    pub fn new(grid: &Structured, contact: &Contact) -> Self {
        Self::of_rows(&AlignedGrid::regular(*grid), contact)
    }

    /// Creates the operators for a grid whose rows may be displaced, and all coarser grids. The
    /// bodies of displaced rows are elastic.
    #[must_use]
    pub fn of_rows(rows: &AlignedGrid, contact: &Contact) -> Self {
        let Contact { bodies, layer, difference, .. } = contact;
        let elastic = |rows: &AlignedGrid, accuracy| {
            (!bodies.remember()).then(|| RowInfluence::new(rows, bodies, *layer, accuracy))
        };
        let influence = elastic(rows, Accuracy::Full);
        let mut levels = vec![Level::new(rows, contact, influence.as_ref())];
        let dissipation = match contact.motion {
            Motion::SteadyRolling | Motion::RollingStep => Dissipation::new(
                *difference,
                bodies,
                *layer,
                rows.grid(),
                influence.map(Displacement::from),
            ),
            Motion::FirstRollingStep | Motion::Shift => None,
        };
        let mut rows = rows.clone();
        let coarsens = matches!(contact.motion, Motion::SteadyRolling | Motion::Shift);
        let narrow = |grid: &Structured| grid.nj > 1 && grid.ni.min(grid.nj) <= 4;
        let longest = |grid: &Structured| grid.ni.max(grid.nj);
        while coarsens && longest(rows.grid()) > COARSEST && !narrow(rows.grid()) {
            rows = rows.coarser();
            let influence = elastic(&rows, Accuracy::Start);
            levels.push(Level::new(&rows, contact, influence.as_ref()));
        }
        Self { contact: *contact, levels, dissipation }
    }

    /// Solves for this friction on the finest grid, starting on the coarsest grid. Bounds that
    /// depend on the solution keep their values at the start on the coarser grids, and until a
    /// first solution is found if they depend on slips.
    ///
    /// # Errors
    /// The forces exceed the friction limit, or an iteration does not converge.
    pub fn solve<'a>(
        &mut self,
        friction: impl Into<Friction<'a>>,
        prescribed: &PrescribedMotion,
    ) -> Result<Solution, TangentialError> {
        let friction = friction.into();
        self.restrict(friction.bound);
        self.levels[0].refuse_beyond_friction(prescribed)?;
        let most_force = self.levels[0].most_force();
        let applied = self.levels[0].solver.work().0;
        let mut state = TangentialState::default();
        let mut newton_steps = 0;
        for index in (0..self.levels.len()).rev() {
            // Scales forces by the friction limit, which a coarser grid underestimates at the edge
            // of the contact.
            let share = self.levels[index].most_force() / most_force;
            let prescribed = PrescribedMotion {
                force: prescribed.force.map(|one| one.map(|force| share * force)),
                ..*prescribed
            };
            let mut target = self.target(&prescribed, None, index == 0);
            let law = friction.law.filter(|_| index == 0);
            target.law = law.filter(|law| !law.arguments().slip);
            let (fine, coarse) = self.levels.split_at_mut(index + 1);
            let level = &mut fine[index];
            state = match coarse.first() {
                None => TangentialState::at_rest(&level.bound, [0.0; 3]),
                Some(coarse) => prolong(coarse, &state, level),
            };
            newton_steps += level.find(&target, &mut state)?;
            if law.is_some_and(|law| law.arguments().slip) {
                target.law = law;
                newton_steps += level.find(&target, &mut state)?;
            }
        }
        let operator_applications = self.levels[0].solver.work().0 - applied;
        Ok(Solution { state, operator_applications, newton_steps })
    }

    /// Solves on the finest grid only, starting from a nearby solution, whose tractions are cut to
    /// the new bound. `history` holds the slip without tractions and the plastic shift before the
    /// step.
    ///
    /// # Errors
    /// The conditions of [`Levels::solve`].
    pub fn improve<'a>(
        &mut self,
        friction: impl Into<Friction<'a>>,
        prescribed: &PrescribedMotion,
        history: Option<History<'_>>,
        solution: &mut Solution,
    ) -> Result<(), TangentialError> {
        let friction = friction.into();
        let target = Target { law: friction.law, ..self.target(prescribed, history, true) };
        let level = &mut self.levels[0];
        let bound = friction.bound;
        level.bound.copy_from_slice(bound);
        level.refuse_beyond_friction(prescribed)?;
        let applied = level.solver.work().0;
        match (level.yields, history.and_then(|history| history.plastic)) {
            (Some(law), Some(before)) => {
                let pairs = bound.iter().zip(before);
                let limit: Vec<f64> = pairs.map(|(g, before)| law.limit(*g, *before)).collect();
                solution.state.fit(&limit);
            }
            _ => solution.state.fit(bound),
        }
        solution.newton_steps += level.find(&target, &mut solution.state)?;
        solution.operator_applications += level.solver.work().0 - applied;
        Ok(())
    }

    /// Numerical dissipation on the finest grid [W/m²], from tractions and pressure [Pa] and the
    /// speed of rolling [m/s]. Elements without pressure dissipate nothing; its size matters only
    /// to bodies of different constants. Returns `None` for the upwind difference and for motions
    /// in time.
    pub fn dissipation(
        &mut self,
        traction: [&[f64]; 2],
        pressure: &[f64],
        speed: f64,
    ) -> Option<Vec<f64>> {
        Some(self.dissipation.as_mut()?.power(traction, pressure, speed))
    }

    /// Displacement difference A p of tractions on the finest grid [m], for a motion whose operator
    /// is A.
    pub fn displacement(&mut self, traction: [&[f64]; 2], displacement: [&mut [f64]; 2]) {
        assert!(
            matches!(self.contact.motion, Motion::FirstRollingStep | Motion::Shift),
            "the operator of this motion is not A"
        );
        self.levels[0].solver.apply(traction, displacement);
    }

    fn target<'a>(
        &self,
        prescribed: &'a PrescribedMotion,
        history: Option<History<'a>>,
        finest: bool,
    ) -> Target<'a> {
        let [a, b] = self.contact.semi_axes;
        // Rolling by one element shifts by ξ Δx.
        let distance = self.levels[0].distance;
        let slope = match self.contact.motion {
            Motion::FirstRollingStep | Motion::RollingStep => self.contact.slope() * distance,
            Motion::SteadyRolling | Motion::Shift => self.contact.slope(),
        };
        let accuracy = if finest { self.contact.tolerance } else { COARSE_TOLERANCE };
        let tolerance = if finest { FORCE_SHARE * accuracy } else { COARSE_FORCE };
        let length = (a * b).sqrt();
        Target { prescribed, law: None, history, accuracy, tolerance, slope, length }
    }

    fn restrict(&mut self, bound: &[f64]) {
        self.levels[0].bound.copy_from_slice(bound);
        for index in 1..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(index);
            full_weighting(&fine[index - 1], &mut coarse[0]);
        }
    }
}

/// Restricts the bound to every second element, averaged with its neighbours.
fn full_weighting(fine: &Level, coarse: &mut Level) {
    let at = |i: i64, j: i64| {
        let inside = (0..fine.nx as i64).contains(&i) && (0..fine.ny as i64).contains(&j);
        if inside { fine.bound[j as usize * fine.nx + i as usize] } else { 0.0 }
    };
    for (index, value) in coarse.bound.iter_mut().enumerate() {
        let (i, j) = (2 * (index % coarse.nx) as i64, 2 * (index / coarse.nx) as i64);
        let row = |j: i64| 0.25 * at(i - 1, j) + 0.5 * at(i, j) + 0.25 * at(i + 1, j);
        *value = match fine.ny {
            1 => row(0),
            _ => 0.25 * row(j - 1) + 0.5 * row(j) + 0.25 * row(j + 1),
        };
    }
}

/// Prolongs a coarse solution to the start on the next finer grid.
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

/// Share p/g at an element of the fine grid, bilinear over the coarse elements in contact.
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
