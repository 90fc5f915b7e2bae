//! A mapping between two grids as they are now.

use super::method::Method;
use super::operator::{Row, SparseOperator};
use super::surface::Surface;
use super::vector::COINCIDENT;
use super::weigh::{Target, Weigh};
use super::{intersection, nearest, projection, radial};
use contract::field::Mapping;
use contract::grid::{Grid, pairwise_sum};

/// Why there is no mapping.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum MapError {
    /// A grid is not what [`Grid::check`] lets pass.
    #[error("no mapping from or to an invalid grid: {0}")]
    Grid(String),
    /// Fields on volumes are only written out.
    #[error("no mapping from or to `{0}`, which is a volume")]
    Volume(String),
    /// Columns and vertices are counted with 32 bits.
    #[error("no mapping for grid `{grid}`: {points} points are more than 32 bits can count")]
    Size {
        /// Name of the grid.
        grid: String,
        /// Its points.
        points: usize,
    },
}

/// How far the elements that ask lie on the surface that answers: target elements on the source's
/// for a consistent mapping, source elements on the target's for a conservative one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Elements that ask.
    pub elements: usize,
    /// Those of them whose centres lie beyond the border of the other surface.
    pub outside: usize,
    /// Largest distance of such a centre from the border, along the surface [m].
    pub farthest: f64,
}

impl Coverage {
    /// More than one element in a hundred lies beyond the border: what is there is not mapped but
    /// taken to the border, or from it.
    #[must_use]
    pub fn is_poor(&self) -> bool {
        100 * self.outside > self.elements
    }
}

impl std::fmt::Display for Coverage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { elements, outside, farthest } = *self;
        match outside {
            0 => write!(f, "all of {elements} elements lie within the other grid's border"),
            _ => write!(
                f,
                "{outside} of {elements} elements lie beyond the other grid's border, up to \
                 {:.3} mm",
                1e3 * farthest
            ),
        }
    }
}

/// A mapping between two grids as they are now.
#[derive(Clone, Debug, PartialEq)]
pub struct GridMapping {
    operator: SparseOperator,
    source_areas: Vec<f64>,
    target_areas: Vec<f64>,
    coverage: Coverage,
}

impl GridMapping {
    /// The mapping from a source grid to a target grid.
    ///
    /// # Errors
    /// A grid that does not pass its check, is a volume, or has more than 2³¹ points.
    pub fn between(
        source: &Grid,
        target: &Grid,
        method: Method,
        preserves: Mapping,
    ) -> Result<Self, MapError> {
        let [from, to] = [surface_of(source)?, surface_of(target)?];
        let (operator, coverage) = match preserves {
            Mapping::Consistent => consistent(&from, &to, method),
            Mapping::Conservative => {
                let (opposite, coverage) = consistent(&to, &from, method);
                (opposite.transposed(&from.areas, &to.areas), coverage)
            }
        };
        Ok(Self { operator, source_areas: from.areas, target_areas: to.areas, coverage })
    }

    /// Maps a field, component after component; values are in component-major order. Allocates
    /// nothing.
    ///
    /// # Panics
    /// If the fields do not have the same number of components on their grids.
    pub fn apply(&self, source: &[f64], target: &mut [f64]) {
        let (columns, rows) = (self.source_areas.len(), self.target_areas.len());
        let components = source.len() / columns;
        assert_eq!(source.len(), components * columns, "the source has whole components");
        assert_eq!(target.len(), components * rows, "the target has the source's components");
        for (from, to) in source.chunks_exact(columns).zip(target.chunks_exact_mut(rows)) {
            self.operator.apply(from, to);
        }
    }

    /// Audit of a mapped field: the largest |∫ target − ∫ source| / ∫ |source| of its components
    /// [-], which a conservative mapping keeps at rounding; infinite where something came of
    /// nothing. Allocates nothing.
    #[must_use]
    pub fn imbalance(&self, source: &[f64], target: &[f64]) -> f64 {
        let (from, to) = (&self.source_areas, &self.target_areas);
        let fields = source.chunks_exact(from.len()).zip(target.chunks_exact(to.len()));
        fields.map(|(s, t)| imbalance(from, s, to, t)).fold(0.0, f64::max)
    }

    /// What lies beyond the other surface's border.
    #[must_use]
    pub fn coverage(&self) -> Coverage {
        self.coverage
    }

    /// Number of weights, the memory of which is 12 bytes each.
    #[must_use]
    pub fn weights(&self) -> usize {
        self.operator.len()
    }
}

fn surface_of(grid: &Grid) -> Result<Surface, MapError> {
    grid.check().map_err(MapError::Grid)?;
    let points = grid.points();
    if points > 1 << 31 {
        return Err(MapError::Size { grid: grid.name.clone(), points });
    }
    Surface::of(grid).ok_or_else(|| MapError::Volume(grid.name.clone()))
}

fn imbalance(from: &[f64], source: &[f64], to: &[f64], target: &[f64]) -> f64 {
    let sent = pairwise_sum(0..from.len(), &|s| from[s] * source[s]);
    let received = pairwise_sum(0..to.len(), &|t| to[t] * target[t]);
    let scale = pairwise_sum(0..from.len(), &|s| from[s] * source[s].abs());
    // A mapped NaN must not pass for a balance: `max` would drop it.
    match (received - sent).abs() {
        0.0 => 0.0,
        difference if difference.is_nan() => f64::INFINITY,
        difference => difference / scale,
    }
}

/// C for all elements of `to`, and how they lie on `from`.
fn consistent(from: &Surface, to: &Surface, method: Method) -> (SparseOperator, Coverage) {
    match method {
        Method::NearestNeighbour => rows(from, to, nearest::Nearest::new(from)),
        Method::NearestProjection => rows(from, to, projection::Projection::new(from)),
        Method::RadialBasis => rows(from, to, radial::RadialBasis::new(from)),
        Method::Intersection => rows(from, to, intersection::Intersection::new(from, to)),
    }
}

fn rows<M: Weigh>(from: &Surface, to: &Surface, mut method: M) -> (SparseOperator, Coverage) {
    let mut coverage = Coverage { elements: to.centres.len(), ..Coverage::default() };
    let mut operator = SparseOperator::with_rows(to.centres.len());
    let mut row = Row::new();
    for (index, &centre) in to.centres.iter().enumerate() {
        let foot = from.foot(centre);
        let size = from.size(foot.element);
        if foot.outside > COINCIDENT * size {
            coverage.outside += 1;
            coverage.farthest = coverage.farthest.max(foot.outside);
        }
        row.clear();
        let offset = (foot.point - from.centres[foot.element]).norm();
        if M::OF_POINTS && offset <= COINCIDENT * size {
            row.push((foot.element as u32, 1.0));
        } else {
            method.weigh(&Target { index, centre, foot }, &mut row);
        }
        if row.is_empty() {
            row.push((foot.element as u32, 1.0));
        }
        operator.push(&mut row);
    }
    (operator, coverage)
}
