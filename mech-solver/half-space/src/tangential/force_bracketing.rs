//! A prescribed force where Newton's method does not end that has its creepage among the unknowns.
//!
//! The force falls as its creepage grows, F'(c) ≤ 0. Where next to nothing adheres it does so in steps, on whose treads
//! Newton's method learns nothing of the creepage: a line of different bodies that roll freely under little friction
//! slips forwards in its middle and backwards beside it, and elements change from the one to the other one by one.
//! Between two creepages whose forces are on either side there is the one looked for: secants through both ends, or
//! their middle where the secant before has not halved their distance, each a problem whose creepages are all known.

use super::newton::{Effort, NotConverged, TangentialSolver};
use super::problem::Problem;
use super::state::TangentialState;

/// Solves at most, of those that look for the other side and of those between: halving alone takes 50 to rounding.
const MOST_SOLVES: usize = 100;
/// First step, as a share of the creepage.
const STEP: f64 = 1e-3;

impl TangentialSolver {
    /// Solves for the force of component `k` alone, from the given state, near its creepage.
    ///
    /// # Errors
    /// A problem of given creepages did not converge, or no creepage has the force.
    pub fn solve_by_bracket(
        &mut self,
        problem: &Problem,
        k: usize,
        state: &mut TangentialState,
        tolerance: f64,
    ) -> Result<Effort, NotConverged> {
        let Some(wanted) = problem.wanted else { return self.solve(problem, state, tolerance) };
        let given = Problem { wanted: None, ..*problem };
        let mut effort = Effort::default();
        // What the force lacks grows with its creepage; [creepage, lack] of both sides.
        let [mut below, mut above]: [Option<[f64; 2]>; 2] = [None; 2];
        let unit = if k == 2 { wanted.length.recip() } else { 1.0 };
        let mut step = (STEP * state.creepage[k].abs()).max(wanted.creepage * unit);
        let mut width = f64::INFINITY;
        for _ in 0..MOST_SOLVES {
            let found = self.solve(&given, state, tolerance)?;
            effort.newton_steps += found.newton_steps;
            effort.linear_steps += found.linear_steps;
            let lack = problem.lack(state);
            effort.force_error = problem.error(lack);
            if effort.force_error <= 1.0 {
                return Ok(effort);
            }
            let here = [state.creepage[k], lack[k]];
            *if lack[k] < 0.0 { &mut below } else { &mut above } = Some(here);
            state.creepage[k] = match (below, above) {
                (Some([low, lacks]), Some([high, has])) => {
                    let halved = high - low <= 0.5 * width;
                    width = high - low;
                    let share = if halved { -lacks / (has - lacks) } else { 0.5 };
                    low + share * width
                }
                (low, _) => {
                    step *= 2.0;
                    here[0] + if low.is_some() { step } else { -step }
                }
            };
        }
        Err(NotConverged(effort))
    }
}
