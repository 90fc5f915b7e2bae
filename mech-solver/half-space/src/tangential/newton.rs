//! A semismooth Newton method for the tangential problem.
//!
//! The unknowns are both components of p in the adhesion area and, in the slip area, the change τ
//! of p across its direction n, since its size is known. Turning p by τ/g turns the opposite slip
//! by the same angle, so that n·(B n τ) + |S|/g τ = −n·S. If forces are prescribed, their creepages
//! are unknown too ([`super::linear`]). GMRES solves the system to a modest reduction while
//! elements still change, then as far as the tolerance requires. Then p is cut to the bound. An
//! element of adhesion whose traction exceeds the bound begins to slip; an element of slip whose
//! traction would push with the slip begins to adhere.
//!
//! The iteration ends when no element changes, the forces are met, and the next step would be below
//! the tolerance. The next step is estimated as the last one times the remaining share of the
//! residual.
//!
//! Where tractions of a long area are just below the bound, as under spin, a single row of narrow
//! elements may slip between rows that stick. Its border of adhesion then moves by one element in a
//! step, although it is far from its place. Late in the iteration, twice as many elements therefore
//! adhere together each time such a border moves again.
//!
//! Newton's method needs no relaxation here, except for unknown creepages. Towards f N they grow
//! without bound, so a step changes them by a limited share. If everything slips, tractions do not
//! determine the creepages, and the creepages are reduced.
//!
//! Sources: Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353, and Hüeber and
//! Wohlmuth, ibid. 194 (2005) 3147, for Newton methods on Coulomb friction. The combination, and
//! creepages as unknowns, are this project's.

use super::bounds::{self, Bounds};
use super::linear::{Border, System, Unknowns};
use super::problem::Problem;
use super::state::{ElementState, TangentialState};
use crate::slip_operator::SlipOperator;
use numerics::gmres::{Achieved, Gmres, Preconditioned};
use tables::readable::number;

/// Limit of Newton steps in a solve.
const MOST_STEPS: usize = 60;
/// Reduction of the linear residual required of GMRES.
const LINEAR_REDUCTION: f64 = 0.3;
/// Strongest reduction required of GMRES, once no element changes.
const LEAST_REDUCTION: f64 = 1e-3;
/// Newton steps after which alternating elements are suppressed: linear systems are solved to the
/// reduction above, and no element adheres again in a step in which another begins to slip.
/// Otherwise two elements at mirrored places, each of which adheres only together with the other,
/// may alternate endlessly.
const LOOSE_STEPS: usize = 20;
/// Share of the tolerance that the next step must be below at the end.
const ERROR_SHARE: f64 = 0.3;
/// Steps of tractions below this share of the largest are rounding. The largest traction at the
/// start counts too, since tractions go to zero where nothing moves any more.
const ROUNDING: f64 = 1e-13;
/// Largest change of creepages in a step, as a share of them.
const GROWTH: f64 = 0.6;
/// Share of the tolerance below which missing forces are ignored.
const FORCE_SHARE: f64 = 0.1;

/// Effort of a solve.
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
    /// Error of the prescribed forces, over their tolerance.
    pub force_error: f64,
}

/// A solve that did not converge.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the tangential problem did not converge in {MOST_STEPS} Newton steps: {} elements still \
     change between adhesion and slip, tractions by {} of the largest{}",
    .0.changes, number(.0.last_change, 2), .0.unmet()
)]
pub struct NotConverged(pub Effort);

impl Effort {
    /// Part of the message about forces that are not met.
    fn unmet(&self) -> String {
        match self.force_error > 1.0 {
            true => format!(
                ", and the prescribed forces are missed by {} times their tolerance; together \
                 they may exceed what friction carries",
                number(self.force_error, 2)
            ),
            false => String::new(),
        }
    }
}

/// Solver of tangential problems on one grid, with operator and working memory.
#[derive(Debug)]
pub struct TangentialSolver {
    pub(super) operator: SlipOperator,
    pub(super) gmres: Gmres,
    field: [Vec<f32>; 2],
    image: [Vec<f32>; 2],
    unknowns: Unknowns,
    bounds: Bounds,
    border: Border,
    right: Vec<f64>,
    start: Vec<f64>,
    step: Vec<f64>,
}

impl TangentialSolver {
    /// Creates a solver with this operator.
    #[must_use]
    pub fn new(operator: SlipOperator) -> Self {
        let (field, image) = Default::default();
        let (unknowns, bounds, border, right, start, step) = Default::default();
        let gmres = Gmres::default();
        Self { operator, gmres, field, image, unknowns, bounds, border, right, start, step }
    }

    /// Products with the slip operator, and with its approximate inverse, so far.
    #[must_use]
    pub fn work(&self) -> (usize, usize) {
        self.operator.work()
    }

    /// Slip of an element by its own unit traction [m/Pa].
    #[must_use]
    pub fn self_influence(&self) -> f64 {
        self.operator.self_influence()
    }

    /// Product of the operator with tractions [m].
    pub fn apply(&mut self, traction: [&[f64]; 2], slip: [&mut [f64]; 2]) {
        self.operator.apply(traction, slip);
    }

    /// Solves from the given state and its creepages, until tractions change by less than
    /// `tolerance` of the largest. Finds the creepages of prescribed forces.
    ///
    /// # Errors
    /// The iteration did not converge; the state holds the last iterate.
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
        let [px, py] = &state.traction;
        let at_start = px.iter().zip(py).map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max);
        for buffer in self.field.iter_mut().chain(&mut self.image) {
            buffer.clear();
            buffer.resize(problem.bound.len(), 0.0);
        }
        self.update_slip(problem, state);
        if problem.layer.is_some() || problem.law.is_some() {
            self.bounds.begin(state);
            self.update_slip(problem, state);
        }
        let mut residual = self.linearise(problem, state);
        let mut reduction = LINEAR_REDUCTION;
        let mut borders = vec![MovingBorder::default(); problem.y.len()];
        for _ in 0..MOST_STEPS {
            effort.newton_steps += 1;
            effort.linear_steps += self.linear_step(problem, state, reduction).steps;
            let whole = self.limit_creepages(problem, state);
            let change = self.advance(problem, state);
            self.update_slip(problem, state);
            let waits = effort.newton_steps >= LOOSE_STEPS && change.released > 0;
            let stuck = if waits { Vec::new() } else { self.stick(state) };
            let more = match effort.newton_steps < LOOSE_STEPS {
                true => 0,
                false => stick_beyond(problem.nx, &mut borders, &stuck, &mut state.element),
            };
            effort.changes = stuck.len() + more + change.released;
            effort.last_change = change.relative();
            effort.force_error = problem.error(problem.lack(state));
            let before = std::mem::replace(&mut residual, self.linearise(problem, state));
            let rests = whole && effort.changes == 0;
            let next = effort.last_change * if before > 0.0 { residual / before } else { 0.0 };
            let rounding = effort.last_change < ROUNDING || change.largest < ROUNDING * at_start;
            let small = next < ERROR_SHARE * tolerance || rounding;
            if rests && small && effort.force_error <= 1.0 {
                if change.traction < ROUNDING * at_start {
                    state.traction.iter_mut().for_each(|traction| traction.fill(0.0));
                    self.update_slip(problem, state);
                }
                return Ok(effort);
            }
            let asked = ERROR_SHARE * tolerance / next;
            reduction = if effort.newton_steps >= LOOSE_STEPS {
                LEAST_REDUCTION
            } else if rests {
                asked.clamp(LEAST_REDUCTION, LINEAR_REDUCTION)
            } else {
                LINEAR_REDUCTION
            };
        }
        Err(NotConverged(effort))
    }

    /// Chooses the unknowns and the right side of a state; returns the norm of the right side [m].
    fn linearise(&mut self, problem: &Problem, state: &TangentialState) -> f64 {
        self.unknowns.choose(state, &self.bounds);
        let gathers = problem.layer.is_some_and(|layer| layer.before.is_none());
        self.unknowns.gathers = gathers.then_some(problem.nx);
        let [sx, sy] = &state.slip;
        self.unknowns.restrict(|i| [-sx[i], -sy[i]], &mut self.right);
        let sizes = self.right.len() - self.unknowns.yielding.len();
        self.unknowns.lacks(self.operator.self_influence(), &mut self.right[sizes..]);
        self.right.iter().map(|value| value * value).sum::<f64>().sqrt()
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
        for (row, (y, offset)) in problem.y.iter().zip(problem.offset).enumerate() {
            let range = row * problem.nx..(row + 1) * problem.nx;
            for ((sx, sy), x) in sx[range.clone()].iter_mut().zip(&mut sy[range]).zip(problem.x) {
                *sx += xi - phi * y;
                *sy += eta + phi * (x + offset + problem.ahead);
            }
        }
        self.bounds.follow(problem, state);
    }

    /// Solves the linearised problem for a step of the tractions and of the unknown creepages, from
    /// the right side made before.
    fn linear_step(
        &mut self,
        problem: &Problem,
        state: &TangentialState,
        reduction: f64,
    ) -> Achieved {
        let Self { operator, gmres, field, image, unknowns, border, right, start, step, .. } = self;
        let mut system = System { operator, field, image, unknowns, border };
        system.make_border(problem, state, &mut self.bounds);
        let count = system.unknowns.len() + system.border.components.len();
        for vector in [&mut *start, &mut *step] {
            vector.clear();
            vector.resize(count, 0.0);
        }
        let lack = problem.lack(state);
        let lacks = problem.error(lack) > FORCE_SHARE;
        if lacks {
            system.towards(lack, start);
            let (image, _) = step.split_at_mut(right.len());
            system.operate(start, image);
            right.iter_mut().zip(image).for_each(|(right, image)| *right -= *image);
        }
        let achieved = gmres.solve(&mut system, right, reduction, step);
        if lacks {
            step.iter_mut().zip(start).for_each(|(step, start)| *step += *start);
        }
        achieved
    }

    /// Shortens the step to the largest change allowed in the creepages; returns false if it was
    /// longer.
    fn limit_creepages(&mut self, problem: &Problem, state: &TangentialState) -> bool {
        let Some(wanted) = &problem.wanted else { return true };
        let (tractions, creepages) = self.step.split_at_mut(self.unknowns.len());
        let mut step = [0.0; 3];
        for (k, by) in self.border.components.iter().zip(&mut *creepages) {
            step[*k] = *by;
        }
        if self.border.is_singular() {
            for (k, by) in self.border.components.iter().zip(creepages) {
                *by = -GROWTH * state.creepage[*k];
            }
            return false;
        }
        let most = wanted.creepage.max(GROWTH * wanted.size(state.creepage));
        let length = wanted.size(step);
        if length <= most {
            return true;
        }
        let factor = most / length;
        tractions.iter_mut().chain(creepages).for_each(|value| *value *= factor);
        false
    }

    /// Adds the step to the creepages, and updates the bounds of friction that follow them.
    fn advance_creepages(&mut self, problem: &Problem, state: &mut TangentialState) {
        for (k, by) in self.border.components.iter().zip(&self.step[self.unknowns.len()..]) {
            state.creepage[*k] += by;
        }
        if !self.border.components.is_empty() {
            self.bounds.follow_friction(problem, state);
        }
    }

    /// Adds the step to the tractions and limits them to friction and the layer, where their sizes
    /// follow the slip.
    fn advance_sizes(&self, problem: &Problem, state: &mut TangentialState) -> Change {
        let Unknowns { sticking, slipping, yielding, .. } = &self.unknowns;
        let before = state.traction.clone();
        let [px, py] = &mut state.traction;
        let (along, rest) = self.step.split_at(2 * sticking.len());
        for (k, &i) in sticking.iter().enumerate() {
            px[i] += along[k];
            py[i] += along[sticking.len() + k];
        }
        let (turns, sizes) = rest.split_at(slipping.len());
        for ((one, turn), (along, by)) in slipping.iter().zip(turns).zip(yielding.iter().zip(sizes))
        {
            let (i, size) = (one.index, px[one.index].hypot(py[one.index]));
            let turned = size.hypot(*turn);
            let wanted = (size + by).max(f64::EPSILON * size);
            let [[nx, ny], [tx, ty]] = [along.direction, one.across];
            px[i] = wanted * (size * nx + turn * tx) / turned;
            py[i] = wanted * (size * ny + turn * ty) / turned;
        }
        let own = self.operator.self_influence();
        let released = bounds::limit(problem, &self.bounds.friction, own, state);
        let mut change = Change { released, ..Change::default() };
        let ([px, py], [qx, qy]) = (&before, &state.traction);
        for i in sticking.iter().copied().chain(slipping.iter().map(|one| one.index)) {
            change.see([px[i], py[i]], [qx[i], qy[i]]);
        }
        change
    }

    /// Adds the step and cuts the tractions to the bound.
    fn advance(&mut self, problem: &Problem, state: &mut TangentialState) -> Change {
        self.advance_creepages(problem, state);
        if problem.sizes_follow_slip() {
            return self.advance_sizes(problem, state);
        }
        let mut change = Change::default();
        let bound = &self.bounds.friction;
        let count = self.unknowns.sticking.len();
        let [px, py] = &mut state.traction;
        for (k, &i) in self.unknowns.sticking.iter().enumerate() {
            let before = [px[i], py[i]];
            let after = [before[0] + self.step[k], before[1] + self.step[count + k]];
            let (size, g) = (after[0].hypot(after[1]), bound[i]);
            let cut = if size > g { g / size } else { 1.0 };
            [px[i], py[i]] = after.map(|value| value * cut);
            if size > g {
                state.element[i] = ElementState::Slip;
                change.released += 1;
            }
            change.see(before, [px[i], py[i]]);
        }
        for (one, by) in self.unknowns.slipping.iter().zip(&self.step[2 * count..]) {
            let i = one.index;
            let before = [px[i], py[i]];
            let after = [before[0] + one.across[0] * by, before[1] + one.across[1] * by];
            let cut = bound[i] / after[0].hypot(after[1]);
            [px[i], py[i]] = after.map(|value| value * cut);
            change.see(before, [px[i], py[i]]);
        }
        change
    }

    /// Changes elements that slip to adhesion where the traction pushes with the slip; returns
    /// them.
    fn stick(&self, state: &mut TangentialState) -> Vec<usize> {
        let ([px, py], [sx, sy]) = (&state.traction, &state.slip);
        let pushes = |i: &usize| px[*i] * sx[*i] + py[*i] * sy[*i] > 0.0;
        let slipping = self.unknowns.slipping.iter().map(|one| one.index);
        let stuck: Vec<usize> = slipping.filter(pushes).collect();
        stuck.iter().for_each(|i| state.element[*i] = ElementState::Adhesion);
        stuck
    }
}

/// Border of adhesion of a row that moves downstream.
#[derive(Clone, Copy, Debug, Default)]
struct MovingBorder {
    /// Element that adhered last.
    last: usize,
    /// Number of elements that adhere together.
    pace: usize,
}

/// Changes the elements downstream of a border of adhesion that moves again, of rows with `nx`
/// elements; `stuck` are those that adhere in this step. Returns their number.
fn stick_beyond(
    nx: usize,
    borders: &mut [MovingBorder],
    stuck: &[usize],
    element: &mut [ElementState],
) -> usize {
    let at_border = |i: &usize| {
        let upstream = i + 1;
        !upstream.is_multiple_of(nx)
            && element[upstream] == ElementState::Adhesion
            && stuck.binary_search(&upstream).is_err()
    };
    let at_borders: Vec<usize> = stuck.iter().copied().filter(at_border).collect();
    let mut count = 0;
    for i in at_borders {
        let (row, border) = (i / nx, &mut borders[i / nx]);
        border.pace = if i < border.last { 2 * border.pace } else { 1 };
        border.last = i;
        for j in (row * nx..i).rev().take(border.pace - 1) {
            if element[j] == ElementState::Slip {
                element[j] = ElementState::Adhesion;
                count += 1;
            }
        }
    }
    count
}

/// Changes by a Newton step.
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
