//! Friction that depends on the slip of each element where Newton's method with derivatives of the
//! bounds does not apply: slip and friction are found in turn.
//!
//! A falling law may have several solutions in a step of transient rolling. Starting from rest,
//! friction falls from pass to pass; starting from the rolling speed, it rises. These starts
//! therefore find the solution with the least and the one with the most slip, which Newton's method
//! may pass over.

use super::bound_law::{Arguments, BoundLaw};
use super::bounds::against;
use super::newton::{Effort, NotConverged, TangentialSolver};
use super::problem::Problem;
use super::state::{Creepage, TangentialState};

/// Limit of passes of friction and slip.
const MOST_PASSES: usize = 600;
/// Passes that take over all of the new slip; later ones take the share below of its change.
const PLAIN_PASSES: usize = 400;
/// Share of the change of slip that later passes take over.
const DAMPED: f64 = 0.3;
/// Friction has settled when the change of the traction bounds, over the largest, is below this.
const SETTLED: f64 = 1e-7;

/// Law of the bounds at given slips.
struct AtSlips<'a> {
    law: &'a dyn BoundLaw,
    slip: &'a [f64],
}

impl BoundLaw for AtSlips<'_> {
    fn arguments(&self) -> Arguments {
        Arguments { slip: false, ..self.law.arguments() }
    }

    fn evaluate(&self, creepage: Creepage, _: &[f64], bound: &mut [f64]) {
        self.law.evaluate(creepage, self.slip, bound);
    }
}

impl TangentialSolver {
    /// Solves for friction that depends on the slip of each element, pass by pass. The first pass
    /// has the bounds of the problem.
    ///
    /// # Errors
    /// A pass does not converge, or friction does not settle.
    pub fn solve_by_slip_passes(
        &mut self,
        problem: &Problem,
        law: &dyn BoundLaw,
        state: &mut TangentialState,
        tolerance: f64,
    ) -> Result<Effort, NotConverged> {
        let mut effort = self.solve(&Problem { law: None, ..*problem }, state, tolerance)?;
        let slips = |state: &TangentialState| {
            (0..state.element.len()).map(|at| against(state, at)).collect()
        };
        let mut slip: Vec<f64> = slips(state);
        let mut bound = problem.bound.to_vec();
        for pass in 0..MOST_PASSES {
            let share = if pass < PLAIN_PASSES { 1.0 } else { DAMPED };
            let largest = bound.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            let before = bound.clone();
            law.evaluate(state.creepage, &slip, &mut bound);
            let off = bound.iter().zip(&before).map(|(bound, before)| (bound - before).abs());
            effort.last_change = off.fold(0.0, f64::max) / (share * largest);
            if effort.last_change <= SETTLED {
                return Ok(effort);
            }
            state.fit(&bound);
            let at_slips = AtSlips { law, slip: &slip };
            let pass = Problem { bound: &bound, law: Some(&at_slips), ..*problem };
            let found = self.solve(&pass, state, tolerance)?;
            let newton_steps = effort.newton_steps + found.newton_steps;
            let linear_steps = effort.linear_steps + found.linear_steps;
            effort = Effort { newton_steps, linear_steps, ..found };
            let now: Vec<f64> = slips(state);
            slip.iter_mut().zip(now).for_each(|(slip, now)| *slip += share * (now - *slip));
        }
        Err(NotConverged(effort))
    }
}
