//! Steady rolling over a softening layer, where Newton's method overshoots: plastic shifts
//! accumulate along the rows.
//!
//! Particles arrive at an element with the plastic shifts of the previous solve, and solves repeat
//! until the shifts settle. Each problem thus has known shifts, like a step of transient rolling. A
//! pass multiplies the change of the shifts by about k A, with the flexibility A of the whole
//! contact. The method therefore suits layers that soften, whose |k| A is below one unless the
//! contact itself is unstable.

use super::newton::{Effort, NotConverged, TangentialSolver};
use super::problem::{Layer, Problem};
use super::state::TangentialState;

/// Limit of passes: thirty reach the smallest tolerance if each leaves half of a change.
const MOST_PASSES: usize = 60;

impl TangentialSolver {
    /// Solves for the forces or creepages of a problem over a layer, pass by pass.
    ///
    /// # Errors
    /// A pass does not converge, or the shifts do not settle.
    pub fn solve_by_passes(
        &mut self,
        problem: &Problem,
        layer: Layer<'_>,
        state: &mut TangentialState,
        tolerance: f64,
    ) -> Result<Effort, NotConverged> {
        let count = problem.bound.len();
        let largest = problem.bound.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let mut before = vec![0.0; count];
        let mut effort = Effort::default();
        for _ in 0..MOST_PASSES {
            let given = Layer { before: Some(&before), ..layer };
            let pass = Problem { layer: Some(given), ..*problem };
            let found = self.solve(&pass, state, tolerance)?;
            let newton_steps = effort.newton_steps + found.newton_steps;
            let linear_steps = effort.linear_steps + found.linear_steps;
            let mut change = 0.0_f64;
            let mut upstream = 0.0;
            for index in (0..count).rev() {
                if (index + 1).is_multiple_of(problem.nx) {
                    upstream = 0.0;
                }
                let stress = |shift| layer.law.limit(problem.bound[index], shift);
                change = change.max((stress(upstream) - stress(before[index])).abs());
                before[index] = upstream;
                upstream += state.yielded[index];
                state.plastic[index] = upstream;
            }
            effort = Effort { newton_steps, linear_steps, last_change: change / largest, ..found };
            if effort.last_change <= tolerance {
                return Ok(effort);
            }
        }
        Err(NotConverged(effort))
    }
}
