//! A body, with the solver of its temperatures and the quantities that the model needs.
//!
//! | | steady | in time |
//! |---|---|---|
//! | constant properties, in the modes of the mesh | [`super::steady_modal`] | [`super::transient_modal`] |
//! | properties over temperature, free surfaces that cool, or a solver chosen by name | [`super::steady_corrected`] | [`super::transient_nodal`] |

use super::block::{Block, Elements, Solver};
use super::body_properties::BodyProperties;
use super::body_solver::{BodySolver, Rises, SolverInput};
use super::section::Below;
use super::steady_corrected::SteadyCorrected;
use super::steady_modal::SteadyModal;
use super::transient_modal::TransientModal;
use super::transient_nodal::TransientNodal;
use crate::window::Stage;
use grids::Structured;

/// A body with its temperature solver.
pub struct Body {
    grid: Structured,
    depths: Vec<f64>,
    /// Number of nodes in depth; the depth below the last node is held.
    nodes: usize,
    /// Element means of the flux into the body [W/m²].
    pub means: Vec<f64>,
    /// Solver of its temperatures.
    pub motion: Box<dyn BodySolver>,
}

impl Body {
    /// Creates a cold body below a grid of the heat flux, in steady motion or in time. The elements
    /// are laid out for an expected speed [m/s].
    #[must_use]
    pub fn new(
        grid: &Structured,
        nature: &BodyProperties,
        expected_speed: f64,
        elements: &Elements,
        steady: bool,
    ) -> Self {
        let block = Block::new(grid, &nature.material, expected_speed, elements);
        let given = SolverInput { grid, nature, block: &block, elements };
        let in_modes = nature.is_constant() && elements.solver == Solver::Auto;
        let motion: Box<dyn BodySolver> = match (in_modes, steady) {
            (true, true) => Box::new(SteadyModal::new(given)),
            (true, false) => Box::new(TransientModal::new(given)),
            (false, true) => Box::new(SteadyCorrected::new(given)),
            (false, false) => Box::new(TransientNodal::new(given)),
        };
        let means = vec![0.0; grid.points()];
        Self { grid: *grid, means, motion, depths: block.depths(), nodes: block.depth.len() }
    }

    /// Returns the rises below a row of a state.
    #[must_use]
    pub fn below(&self, stage: Stage, row: usize) -> Below {
        let Rises { mut values, behind, dense } = self.motion.below(stage, row);
        let columns = values.len() / self.nodes;
        values.resize(columns * self.depths.len(), 0.0);
        Below {
            columns,
            rises: values,
            first: self.grid.x(0) - behind * self.grid.dx(),
            spacing: self.grid.dx() / dense as f64,
            depths: self.depths.clone(),
        }
    }
}
