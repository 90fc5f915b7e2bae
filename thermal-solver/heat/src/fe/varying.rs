//! Functions shared by nodal solvers: the block of a body, and its lowest and highest rise.

use super::block::Solver;
use super::body_solver::SolverInput;
use super::conductor::{Conductor, Workspace};
use super::direct::Direct;
use super::law::Law;
use super::mesh::Axis;

/// Creates the block of a body on these axes, and the working memory of its steps.
pub(super) fn conductor(given: SolverInput, axes: [&Axis; 3]) -> (Conductor, Workspace) {
    let mut block = Conductor::new(axes, given.nature.law());
    block.surroundings = given.nature.surroundings;
    let direct = match given.elements.solver {
        Solver::Direct => Some(Direct::new(block.counts)),
        Solver::Auto | Solver::Iterative => None,
    };
    (block, Workspace::with(direct))
}

/// Returns the lowest and highest rise [K].
pub(super) fn extremes(potentials: &[f64], law: &Law) -> [f64; 2] {
    let range = potentials
        .iter()
        .fold([0.0_f64; 2], |[low, high], value| [low.min(*value), high.max(*value)]);
    range.map(|value| law.rise(value))
}
