//! A body: which way its temperatures are solved for, and what the model asks of them.
//!
//! | | steady | in time |
//! |---|---|---|
//! | constant properties, in the modes of the mesh | [`super::held`] | [`super::marched`] |
//! | properties over temperature, free surfaces that cool, or a solver by name | [`super::swept`] | [`super::stepped`] |

use super::block::{Block, Elements, Solver};
use super::held::Held;
use super::marched::Marched;
use super::motion::{Given, Motion, Rises};
use super::nature::Nature;
use super::section::Below;
use super::stepped::Stepped;
use super::swept::Swept;
use crate::window::Stage;
use grids::Structured;

/// A body.
pub struct Body {
    grid: Structured,
    depths: Vec<f64>,
    /// Nodes in depth; one depth more is held.
    nodes: usize,
    /// Element means of the flux into it [W/m²].
    pub means: Vec<f64>,
    /// Solver of its temperatures.
    pub motion: Box<dyn Motion>,
}

impl Body {
    /// A cold body below a grid of the heat flux, its elements laid out for a speed [m/s], in steady motion or in
    /// time.
    #[must_use]
    pub fn new(
        grid: &Structured,
        nature: &Nature,
        expected_speed: f64,
        elements: &Elements,
        steady: bool,
    ) -> Self {
        let block = Block::new(grid, &nature.material, expected_speed, elements);
        let given = Given { grid, nature, block: &block, elements };
        let in_modes = nature.is_constant() && elements.solver == Solver::Auto;
        let motion: Box<dyn Motion> = match (in_modes, steady) {
            (true, true) => Box::new(Held::new(given)),
            (true, false) => Box::new(Marched::new(given)),
            (false, true) => Box::new(Swept::new(given)),
            (false, false) => Box::new(Stepped::new(given)),
        };
        let means = vec![0.0; grid.points()];
        Self { grid: *grid, means, motion, depths: block.depths(), nodes: block.depth.len() }
    }

    /// Rises below a row of a state.
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
