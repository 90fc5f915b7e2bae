//! Settings of a model that are known before it is built, and its grids.

use super::ends::Ends;
use crate::effects::bulk_heating::PassageHistory;
use crate::effects::contact_conductance::Conductance;
use crate::effects::friction_heat::Partition;
use crate::effects::joule_heat::Current;
use crate::effects::phase_transformation::Criterion;
use crate::scene::Scene;
use crate::{LOWER, UPPER};
use heat::columns::history::History;
use heat::fe::block::Elements;
use heat::fe::body_properties::BodyProperties;
use proto::configuration::{Mode, Windows};
use proto::grid::{Grid, Structured};

/// Levels of a section in depth, the surface included.
pub const LEVELS: usize = 33;

/// Name of the grid of the surface temperatures.
pub const CONTACT: &str = "contact";

/// Names of the grids of the sections, upper and lower.
pub(super) const SECTION_GRIDS: [&str; 2] = ["upper_section", "lower_section"];

/// Most elements along a line that grids of elliptic contacts have in addition to those within it.
/// Where a grid has fewer, the semi-axes are too small and the errors that follow from them are
/// upper bounds.
const BEYOND: usize = 3;
/// Assumed number of windows of a run without a known end.
const MANY: f64 = 1e3;

/// Settings of a model that are known before it is built.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Materials and speeds.
    pub scene: Scene,
    /// Partition of the friction heat between the bodies.
    pub partition: Partition,
    /// Law of the contact conductance, if the case has one.
    pub conductance: Option<Conductance>,
    /// Lowest expected speeds of the upper and the lower body over the run [m/s].
    pub slowest: [f64; 2],
    /// Mode of the case: steady or transient.
    pub mode: Mode,
    /// Windows of a transient case.
    pub windows: Option<Windows>,
    /// Speeds of the upper and the lower body for the error of models that neglect conduction along
    /// the surface [m/s]: the lowest of the rows; of steady rows, the lowest at which a body moves.
    pub slowest_motion: [f64; 2],
    /// Grid of heat flux and temperatures, along x in i and along y in j.
    pub grid: Structured,
    /// Grid on which the heat flux arrives.
    pub arriving: Structured,
    /// Expected half lengths of the heated region along x and y [m], if its source knows them.
    pub heated: Option<[f64; 2]>,
    /// Lateral coordinate of the sections, which lie below the row nearest to it [m].
    pub section_y: f64,
    /// Properties of the upper and the lower body, with all effects.
    pub body_properties: [BodyProperties; 2],
    /// Settings of the elements in the upper and the lower body, if the model has elements.
    pub elements: Option<[Elements; 2]>,
    /// Earlier passages over both bodies, if `bulk_heating` is active.
    pub memories: Option<[PassageHistory; 2]>,
    /// Electric current through the contact, if the case has one.
    pub current: Option<Current>,
    /// Criterion of the phase transformation, if that effect is active.
    pub criterion: Option<Criterion>,
    /// Lengths and initial rises of the bodies as rods.
    pub ends: [Ends; 2],
    /// Number of threads.
    pub threads: usize,
}

impl Frame {
    /// Returns true if the model needs the contact pressure.
    #[must_use]
    pub fn feels_pressure(&self) -> bool {
        self.conductance.is_some()
            || self.current.is_some()
            || self.partition == Partition::Continuity
    }

    /// Returns true if the model needs the gap between the surfaces.
    #[must_use]
    pub fn feels_gap(&self) -> bool {
        self.conductance.is_some_and(|law| law.gas.is_some())
    }

    /// Returns the half lengths of the heated region [m]; if unknown, those of the grid of the heat
    /// flux without the elements that it has beyond the edges of the contact.
    #[must_use]
    pub fn heated_lengths(&self) -> [f64; 2] {
        if let Some(heated) = self.heated {
            return heated;
        }
        let half = |count: usize, length: f64| {
            let within = count.saturating_sub(BEYOND);
            0.5 * length * if within > 0 { within } else { count } as f64
        };
        [half(self.arriving.ni, self.arriving.dx()), half(self.arriving.nj, self.arriving.dy())]
    }

    /// Returns the number of windows that the history of a body keeps; 1 in a steady case.
    #[must_use]
    pub fn kept_windows(&self, body: usize) -> usize {
        let Some(Windows { usual, end, .. }) = self.windows else { return 1 };
        let passage = self.grid.dx() / self.scene.speeds[body];
        let end = end.unwrap_or(MANY * usual);
        History::expected_windows(self.grid.ni, passage, usual, end)
    }

    /// Returns the row of elements below which the sections lie.
    #[must_use]
    pub fn section_row(&self) -> usize {
        let from_axis = |row: &usize| (self.grid.y(*row) - self.section_y).abs();
        (0..self.grid.nj)
            .min_by(|a, b| from_axis(a).total_cmp(&from_axis(b)))
            .expect("a grid has at least one row")
    }

    /// Distance [m] between the levels of a body's section. The last level is at 4√(2κL/V) with L
    /// half the length of the grid. Even if the whole grid is heated uniformly, the rise there is
    /// below 0.2 per cent of that of the surface. The depth is limited to 4 L, because heat spreads
    /// in all directions over such distances.
    #[must_use]
    pub fn level_spacing(&self, body: usize) -> f64 {
        let half_length = 0.5 * self.grid.ni as f64 * self.grid.dx();
        let diffusivity = self.scene.materials[body].diffusivity();
        let depth = 4.0 * (2.0 * diffusivity * half_length / self.scene.speeds[body]).sqrt();
        depth.min(4.0 * half_length) / (LEVELS - 1) as f64
    }

    /// Converts a distance z [m] from the surface of a body to the depth c = z/(2√κ) [√s].
    #[must_use]
    pub fn depth(&self, body: usize, distance: f64) -> f64 {
        distance / (2.0 * self.scene.materials[body].diffusivity().sqrt())
    }

    /// Factor 1/(β√π) of a body [m²·K·√s/J].
    #[must_use]
    pub fn amplitude(&self, body: usize) -> f64 {
        1.0 / (self.scene.materials[body].effusivity() * std::f64::consts::PI.sqrt())
    }

    /// Number of columns of the sections behind the grid.
    #[must_use]
    pub fn behind(&self) -> usize {
        self.elements.map_or(0, |elements| elements[LOWER].behind(&self.grid))
    }

    /// Returns the grid of a body's section.
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
