//! The tangential problem on one grid: a step of steady rolling, of transient rolling, or a shift.
//!
//! Find tractions p (two components an element) and their slip S = w Δq + s₀ + B p with
//!
//! - in the adhesion area |p| ≤ g and S = 0,
//! - in the slip area |p| = g and S opposite to p,
//!
//! where g = f p_n is the traction bound, B the operator of [`super::slip_operator`] and s₀ the slip
//! that is there without tractions, if any: what remains of the step before in transient rolling or
//! in a shift, and what the pressure does on bodies of different material.
//!
//! **Algorithm.** A semismooth Newton method. Unknown are both components of p in the adhesion
//! area, and in the slip area the change τ of p across its direction n, since its size is known:
//! turning p by τ/g turns the slip that has to be opposite by as much, so that
//! n·(B n τ) + |S|/g τ = −n·S. The system is solved by GMRES to a modest reduction, preconditioned
//! in the adhesion area by the Fourier inverse and in the slip area by the diagonal. Then p is cut
//! to the bound; an element of adhesion whose traction exceeds the bound slips from now on, one of
//! slip whose traction would push with the slip adheres. It ends when no element changes and the
//! step is below the tolerance; a Newton method needs no relaxation here, and none is used.
//!
//! **Energy.** The power of the step from I + e_x to I is −½(p_I + p_{I+e_x})·S_I V/Δx. Summed over
//! all steps of steady rolling, those that leave the contact too, the part of B vanishes exactly,
//! because pᵀ(Sᵀ − S)A p = 0 for a symmetric A that commutes with the shift: the sum is
//! −V Σ w·p, the power of the forces over the creepages, at every resolution and whether or not the
//! iteration has converged. In transient rolling ([`super::transient`]) what remains is the change of
//! elastic energy.
//!
//! Sources: Kalker (1990) for the problem; Alart & Curnier (1991) and Hüeber & Wohlmuth (2005) for
//! Newton methods on Coulomb friction. The combination is this project's.

use super::slip_operator::SlipOperator;
use numerics::gmres::{Achieved, Gmres, Preconditioned};
use serde::{Deserialize, Serialize};

/// Newton steps after which a solve is given up.
const MOST_STEPS: usize = 60;
/// Reduction of the linear residual asked of GMRES.
const LINEAR_REDUCTION: f64 = 0.3;

/// What an element does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ElementState {
    /// No contact.
    Exterior,
    /// The surfaces stick.
    Adhesion,
    /// The surfaces slip.
    Slip,
}

/// Creepages [ξ, η, φ]: longitudinal [-], lateral [-], spin [rad/m].
pub type Creepage = [f64; 3];

/// The problem on one grid of nx × ny elements.
#[derive(Debug)]
pub struct Problem<'a> {
    /// Elements along x.
    pub nx: usize,
    /// Distance Δq rolled in the step [m]; 1 in a shift, where the creepages are distances [m] and a
    /// rotation [rad].
    pub distance: f64,
    /// Where in the step the rigid slip is taken, ahead of an element's centre; 0 in a shift [m].
    pub ahead: f64,
    /// Area of an element [m²].
    pub element_area: f64,
    /// Centres along x [m].
    pub x: &'a [f64],
    /// Centres along y [m].
    pub y: &'a [f64],
    /// Traction bound g = f p_n [Pa]; 0 outside the contact.
    pub bound: &'a [f64],
    /// Slip s₀ that is there without tractions, x and y [m].
    pub slip_history: Option<[&'a [f64]; 2]>,
}

impl Problem<'_> {
    /// The moment of a contact that turns about the origin, Σ g r dA [N m].
    #[must_use]
    pub fn largest_moment(&self) -> f64 {
        let row = |(bounds, y): (&[f64], &f64)| -> f64 {
            bounds.iter().zip(self.x).map(|(g, x)| g * x.hypot(*y)).sum()
        };
        self.bound.chunks_exact(self.nx).zip(self.y).map(row).sum::<f64>() * self.element_area
    }
}

/// A solution, or the start of one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct TangentialState {
    /// Tractions on body 1, x and y [Pa].
    pub traction: [Vec<f64>; 2],
    /// Slip distance of body 1 relative to body 2 over a step, x and y [m].
    pub slip: [Vec<f64>; 2],
    /// What each element does.
    pub element: Vec<ElementState>,
    /// Creepages.
    pub creepage: Creepage,
}

/// How a solve went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Newton steps.
    pub newton_steps: usize,
    /// GMRES iterations in all.
    pub linear_steps: usize,
    /// Elements that changed between adhesion and slip in the last step.
    pub changes: usize,
    /// Largest change of a traction in the last step, over the largest traction.
    pub last_change: f64,
}

/// A solve that did not end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the tangential problem did not converge in {MOST_STEPS} Newton steps: {} elements still \
     change between adhesion and slip, tractions by {:.1e} of the largest",
    .0.changes, .0.last_change
)]
pub struct NotConverged(pub Effort);

impl TangentialState {
    /// It belongs to a grid of this many elements.
    #[must_use]
    pub fn fits(&self, count: usize) -> bool {
        let pairs = [&self.traction, &self.slip];
        let whole = |pair: &[Vec<f64>; 2]| pair.iter().all(|field| field.len() == count);
        self.element.len() == count && pairs.into_iter().all(whole)
    }

    /// Everything adheres, nothing pulls.
    #[must_use]
    pub fn at_rest(bound: &[f64], creepage: Creepage) -> Self {
        let zeros = vec![0.0; bound.len()];
        let state = |bound: &f64| match *bound > 0.0 {
            true => ElementState::Adhesion,
            false => ElementState::Exterior,
        };
        Self {
            traction: [zeros.clone(), zeros.clone()],
            slip: [zeros.clone(), zeros],
            element: bound.iter().map(state).collect(),
            creepage,
        }
    }

    /// Makes the state fit for another bound: elements enter and leave the contact, tractions are
    /// cut, those that slip grow with the bound.
    pub fn fit(&mut self, bound: &[f64]) {
        let [px, py] = &mut self.traction;
        for (index, (element, g)) in self.element.iter_mut().zip(bound).enumerate() {
            let size = px[index].hypot(py[index]);
            *element = match *element {
                _ if *g == 0.0 => ElementState::Exterior,
                ElementState::Slip if size > 0.0 => ElementState::Slip,
                _ if size > *g => ElementState::Slip,
                _ => ElementState::Adhesion,
            };
            let factor = match *element {
                ElementState::Exterior => 0.0,
                ElementState::Adhesion => 1.0,
                ElementState::Slip => g / size,
            };
            px[index] *= factor;
            py[index] *= factor;
        }
    }

    /// Force on body 1, x and y [N], and its moment about z [N m].
    #[must_use]
    pub fn forces(&self, problem: &Problem) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (row, y) in problem.y.iter().enumerate() {
            let range = row * problem.nx..(row + 1) * problem.nx;
            let rows = self.traction[0][range.clone()].iter().zip(&self.traction[1][range]);
            for ((px, py), x) in rows.zip(problem.x) {
                sum[0] += px;
                sum[1] += py;
                sum[2] += x * py - y * px;
            }
        }
        sum.map(|value| value * problem.element_area)
    }
}

/// The solver on one grid: operator and working memory.
#[derive(Debug)]
pub struct TangentialSolver {
    operator: SlipOperator,
    gmres: Gmres,
    field: [Vec<f64>; 2],
    image: [Vec<f64>; 2],
    sticking: Vec<usize>,
    slipping: Vec<Turn>,
    right: Vec<f64>,
    step: Vec<f64>,
}

/// An element of the slip area in the linear system.
#[derive(Clone, Copy, Debug)]
struct Turn {
    index: usize,
    /// Unit vector across the traction.
    across: [f64; 2],
    /// |S|/g [m/Pa].
    stiffness: f64,
}

impl TangentialSolver {
    /// A solver with this operator.
    #[must_use]
    pub fn new(operator: SlipOperator) -> Self {
        let (field, image) = Default::default();
        let (sticking, slipping, right, step) = Default::default();
        let gmres = Gmres::default();
        Self { operator, gmres, field, image, sticking, slipping, right, step }
    }

    /// Products with the slip operator, and with its approximate inverse, so far.
    #[must_use]
    pub fn work(&self) -> (usize, usize) {
        self.operator.work()
    }

    /// Product of the operator with tractions [m].
    pub fn apply(&mut self, traction: [&[f64]; 2], slip: [&mut [f64]; 2]) {
        self.operator.apply(traction, slip);
    }

    /// Solves from the given state, with its creepages, until tractions change by less than
    /// `tolerance` of the largest.
    ///
    /// # Errors
    /// It did not converge; the state is what was reached.
    pub fn solve(
        &mut self,
        problem: &Problem,
        state: &mut TangentialState,
        tolerance: f64,
    ) -> Result<Effort, NotConverged> {
        let mut effort = Effort::default();
        if problem.bound.iter().all(|g| *g == 0.0) {
            return Ok(effort);
        }
        for buffer in self.field.iter_mut().chain(&mut self.image) {
            buffer.clear();
            buffer.resize(problem.bound.len(), 0.0);
        }
        self.update_slip(problem, state);
        for _ in 0..MOST_STEPS {
            effort.newton_steps += 1;
            let linear = self.linear_step(state, problem.bound);
            effort.linear_steps += linear.steps;
            let change = self.advance(problem, state);
            self.update_slip(problem, state);
            effort.changes = self.release_or_stick(state) + change.released;
            effort.last_change = change.relative();
            let solved = linear.reduction <= LINEAR_REDUCTION;
            if solved && effort.last_change < tolerance && effort.changes == 0 {
                return Ok(effort);
            }
        }
        Err(NotConverged(effort))
    }

    /// S = w Δq + s₀ + B p, with the rigid slip w = (ξ − φ y, η + φ x).
    fn update_slip(&mut self, problem: &Problem, state: &mut TangentialState) {
        let [px, py] = &state.traction;
        let [sx, sy] = &mut state.slip;
        self.operator.apply([px, py], [sx, sy]);
        if let Some([history_x, history_y]) = problem.slip_history {
            sx.iter_mut().zip(history_x).for_each(|(s, earlier)| *s += earlier);
            sy.iter_mut().zip(history_y).for_each(|(s, earlier)| *s += earlier);
        }
        let [xi, eta, phi] = state.creepage.map(|value| value * problem.distance);
        for (row, y) in problem.y.iter().enumerate() {
            let range = row * problem.nx..(row + 1) * problem.nx;
            for ((sx, sy), x) in sx[range.clone()].iter_mut().zip(&mut sy[range]).zip(problem.x) {
                *sx += xi - phi * y;
                *sy += eta + phi * (x + problem.ahead);
            }
        }
    }

    /// Solves the linearised problem for a step of the tractions.
    fn linear_step(&mut self, state: &TangentialState, bound: &[f64]) -> Achieved {
        self.sticking.clear();
        self.slipping.clear();
        self.right.clear();
        let ([px, py], [sx, sy]) = (&state.traction, &state.slip);
        for (index, element) in state.element.iter().enumerate() {
            match element {
                ElementState::Exterior => {}
                ElementState::Adhesion => self.sticking.push(index),
                ElementState::Slip => {
                    let g = bound[index];
                    let across = [-py[index] / g, px[index] / g];
                    let stiffness = sx[index].hypot(sy[index]) / g;
                    self.slipping.push(Turn { index, across, stiffness });
                }
            }
        }
        self.right.extend(self.sticking.iter().map(|&i| -sx[i]));
        self.right.extend(self.sticking.iter().map(|&i| -sy[i]));
        let turned = |t: &Turn| -(t.across[0] * sx[t.index] + t.across[1] * sy[t.index]);
        self.right.extend(self.slipping.iter().map(turned));
        self.step.clear();
        self.step.resize(self.right.len(), 0.0);
        let mut system = System {
            operator: &mut self.operator,
            field: &mut self.field,
            image: &mut self.image,
            sticking: &self.sticking,
            slipping: &self.slipping,
        };
        self.gmres.solve(&mut system, &self.right, LINEAR_REDUCTION, &mut self.step)
    }

    /// Adds the step and cuts tractions to the bound.
    fn advance(&self, problem: &Problem, state: &mut TangentialState) -> Change {
        let mut change = Change::default();
        let count = self.sticking.len();
        let [px, py] = &mut state.traction;
        for (k, &i) in self.sticking.iter().enumerate() {
            let before = [px[i], py[i]];
            let after = [before[0] + self.step[k], before[1] + self.step[count + k]];
            let (size, g) = (after[0].hypot(after[1]), problem.bound[i]);
            let cut = if size > g { g / size } else { 1.0 };
            [px[i], py[i]] = after.map(|value| value * cut);
            if size > g {
                state.element[i] = ElementState::Slip;
                change.released += 1;
            }
            change.see(before, [px[i], py[i]]);
        }
        for (one, by) in self.slipping.iter().zip(&self.step[2 * count..]) {
            let i = one.index;
            let before = [px[i], py[i]];
            let after = [before[0] + one.across[0] * by, before[1] + one.across[1] * by];
            let cut = problem.bound[i] / after[0].hypot(after[1]);
            [px[i], py[i]] = after.map(|value| value * cut);
            change.see(before, [px[i], py[i]]);
        }
        change
    }

    /// Elements that slipped and whose traction now pushes with the slip adhere from now on.
    fn release_or_stick(&self, state: &mut TangentialState) -> usize {
        let ([px, py], [sx, sy]) = (&state.traction, &state.slip);
        let mut stuck = 0;
        for one in &self.slipping {
            let i = one.index;
            if px[i] * sx[i] + py[i] * sy[i] > 0.0 {
                state.element[i] = ElementState::Adhesion;
                stuck += 1;
            }
        }
        stuck
    }
}

/// What a Newton step changed.
#[derive(Clone, Copy, Debug, Default)]
struct Change {
    /// Largest change of a traction, and largest traction [Pa].
    largest: f64,
    traction: f64,
    released: usize,
}

impl Change {
    fn see(&mut self, before: [f64; 2], after: [f64; 2]) {
        let size = (after[0] - before[0]).hypot(after[1] - before[1]);
        self.largest = self.largest.max(size);
        self.traction = self.traction.max(after[0].hypot(after[1]));
    }

    fn relative(&self) -> f64 {
        if self.largest > 0.0 { self.largest / self.traction } else { 0.0 }
    }
}

/// The linear system of a Newton step.
struct System<'a> {
    operator: &'a mut SlipOperator,
    field: &'a mut [Vec<f64>; 2],
    image: &'a mut [Vec<f64>; 2],
    sticking: &'a [usize],
    slipping: &'a [Turn],
}

impl System<'_> {
    /// Puts the unknowns of the adhesion area into the field, zero elsewhere.
    fn spread_sticking(&mut self, x: &[f64]) {
        let count = self.sticking.len();
        for (component, values) in self.field.iter_mut().zip(x.chunks(count.max(1))) {
            component.fill(0.0);
            for (&index, value) in self.sticking.iter().zip(values) {
                component[index] = *value;
            }
        }
    }

    fn gather_sticking(&self, out: &mut [f64]) {
        let count = self.sticking.len();
        for (component, values) in self.image.iter().zip(out.chunks_mut(count.max(1))) {
            for (&index, value) in self.sticking.iter().zip(values) {
                *value = component[index];
            }
        }
    }
}

impl Preconditioned for System<'_> {
    fn operate(&mut self, x: &[f64], out: &mut [f64]) {
        let count = 2 * self.sticking.len();
        self.field.iter_mut().for_each(|component| component.fill(0.0));
        self.spread_sticking(&x[..count]);
        for (one, value) in self.slipping.iter().zip(&x[count..]) {
            self.field[0][one.index] = one.across[0] * value;
            self.field[1][one.index] = one.across[1] * value;
        }
        let [fx, fy] = &*self.field;
        let [ix, iy] = &mut *self.image;
        self.operator.apply([fx, fy], [ix, iy]);
        self.gather_sticking(&mut out[..count]);
        for ((one, out), x) in self.slipping.iter().zip(&mut out[count..]).zip(&x[count..]) {
            let [ix, iy] = &*self.image;
            let along = one.across[0] * ix[one.index] + one.across[1] * iy[one.index];
            *out = along + one.stiffness * x;
        }
    }

    fn precondition(&mut self, x: &[f64], out: &mut [f64]) {
        let count = 2 * self.sticking.len();
        self.field.iter_mut().for_each(|component| component.fill(0.0));
        self.spread_sticking(&x[..count]);
        let [fx, fy] = &*self.field;
        let [ix, iy] = &mut *self.image;
        self.operator.apply_inverse([fx, fy], [ix, iy]);
        self.gather_sticking(&mut out[..count]);
        let own = self.operator.self_influence();
        for ((one, out), x) in self.slipping.iter().zip(&mut out[count..]).zip(&x[count..]) {
            *out = x / (own + one.stiffness);
        }
    }
}

#[cfg(test)]
mod tests;
