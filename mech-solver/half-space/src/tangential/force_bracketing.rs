//! Fallback for a prescribed force, used when Newton's method with the creepage as an unknown
//! fails.
//!
//! The force falls as its creepage grows, F'(c) ≤ 0. If almost nothing adheres, it falls in steps,
//! and on their flat parts Newton's method has no slope for the creepage. Example: a line contact
//! of different bodies in free rolling under little friction slips forwards in its middle and
//! backwards beside it, and elements switch between both one by one. The creepage lies between two
//! creepages with forces on either side of the prescribed one. Each step takes the secant through
//! both ends, or the midpoint if the previous secant did not halve the interval. Each problem has
//! known creepages.

use super::newton::{Effort, NotConverged, TangentialSolver};
use super::problem::Problem;
use super::state::TangentialState;

/// Limit of solves, to bracket the creepage and to narrow the bracket: halving alone takes 50 to
/// rounding.
const MOST_SOLVES: usize = 100;
/// First step, as a share of the creepage.
const STEP: f64 = 1e-3;

impl TangentialSolver {
    /// Solves for the force of component `k` alone, starting from the given state and its creepage.
    ///
    /// # Errors
    /// A problem of given creepages does not converge, or no creepage carries the force.
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
        // The missing force grows with its creepage; both sides hold [creepage, missing force].
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
