//! What a model knows before it is built, and its grids.

use super::ends::Ends;
use crate::effects::bulk_heating::PassageHistory;
use crate::effects::contact_conductance::Conductance;
use crate::effects::friction_heat::Partition;
use crate::effects::joule_heat::Current;
use crate::effects::phase_transformation::Criterion;
use crate::scene::Scene;
use crate::{LOWER, UPPER};
use heat::fe::block::Elements;
use heat::fe::body_properties::BodyProperties;
use proto::configuration::Mode;
use proto::grid::{Grid, Structured};

/// Levels of a section in depth, the surface included.
pub const LEVELS: usize = 33;

/// Name of the grid of the surface temperatures.
pub const CONTACT: &str = "contact";

/// Names of the grids of the sections, upper and lower.
pub(super) const SECTION_GRIDS: [&str; 2] = ["upper_section", "lower_section"];

/// What a model knows before it is built.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Materials and speed.
    pub scene: Scene,
    /// How the heat is split.
    pub partition: Partition,
    /// What lets heat flow between the surfaces besides.
    pub conductance: Option<Conductance>,
    /// Steady or transient.
    pub mode: Mode,
    /// The grid of heat flux and temperatures, along x in i and along y in j.
    pub grid: Structured,
    /// Lateral coordinate of the sections, which lie below the row nearest to it [m].
    pub section_y: f64,
    /// What the upper and the lower body are made of, with all effects.
    pub natures: [BodyProperties; 2],
    /// Elements of a model that has its own, in the upper and the lower body.
    pub elements: Option<[Elements; 2]>,
    /// What earlier passages leave in both bodies, where that is asked for.
    pub memories: Option<[PassageHistory; 2]>,
    /// A current through the contact, if there is one.
    pub current: Option<Current>,
    /// When steel transforms, where that is asked for.
    pub criterion: Option<Criterion>,
    /// Ends of the bodies, where they have some.
    pub ends: [Ends; 2],
    /// Threads to compute on.
    pub threads: usize,
}

impl Frame {
    /// The contact's pressure matters.
    #[must_use]
    pub fn feels_pressure(&self) -> bool {
        self.conductance.is_some()
            || self.current.is_some()
            || self.partition == Partition::Continuity
    }

    /// The distance of the surfaces matters.
    #[must_use]
    pub fn feels_gap(&self) -> bool {
        self.conductance.is_some_and(|law| law.gas.is_some())
    }

    /// The row of the sections.
    #[must_use]
    pub fn section_row(&self) -> usize {
        let from_axis = |row: &usize| (self.grid.y(*row) - self.section_y).abs();
        (0..self.grid.nj)
            .min_by(|a, b| from_axis(a).total_cmp(&from_axis(b)))
            .expect("a grid has at least one row")
    }

    /// Distance [m] from one level of a body's section to the next. The last is at 4√(2κL/V) with
    /// L half the length of the grid: even where the whole grid has been heated evenly, the rise
    /// there is below 0.2 per cent of the surface's. It is no deeper than 4 L, where heat spreads to all
    /// sides.
    #[must_use]
    pub fn level_spacing(&self, body: usize) -> f64 {
        let half_length = 0.5 * self.grid.ni as f64 * self.grid.dx();
        let diffusivity = self.scene.materials[body].diffusivity();
        let depth = 4.0 * (2.0 * diffusivity * half_length / self.scene.speeds[body]).sqrt();
        depth.min(4.0 * half_length) / (LEVELS - 1) as f64
    }

    /// Depth c = z/(2√κ) [√s] in a body at the distance z [m] from its surface.
    #[must_use]
    pub fn depth(&self, body: usize, distance: f64) -> f64 {
        distance / (2.0 * self.scene.materials[body].diffusivity().sqrt())
    }

    /// 1/(β√π) of a body [m²·K·√s/J].
    #[must_use]
    pub fn amplitude(&self, body: usize) -> f64 {
        1.0 / (self.scene.materials[body].effusivity() * std::f64::consts::PI.sqrt())
    }

    /// Columns of the sections behind the grid.
    #[must_use]
    pub fn behind(&self) -> usize {
        self.elements.map_or(0, |elements| elements[LOWER].behind(&self.grid))
    }

    /// The grid of a body's section.
    pub(super) fn section_grid(&self, body: usize) -> Grid {
        let spacing = self.level_spacing(body);
        let up = if body == UPPER { spacing } else { -spacing };
        let mut origin = self.grid.centre(0, self.section_row());
        origin[0] -= self.behind() as f64 * self.grid.dx();
        let shape = Structured {
            origin,
            step_i: self.grid.step_i,
            step_j: [0.0, 0.0, up],
            ni: self.grid.ni + self.behind(),
            nj: LEVELS,
        };
        Grid::structured(SECTION_GRIDS[body], shape)
    }
}
