//! Mappings between two grids: a sparse matrix in compressed rows for fixed grids, and a mapping
//! that follows moving grids.

use super::error::MapError;
use super::nodes::{MappingWeights, Nodes, Target};
use super::operator::SparseOperator;
use super::patch::{COINCIDENT, Row};
use super::prepared::Prepared;
use super::{by_kernel, intersection, nearest, radial};
use crate::settings::Method;
use contract::field::Mapping;
use contract::grid::{Grid, pairwise_sum};

/// Distance beyond the border, in sizes of the nearest element, that does not count: two borders
/// that coincide differ by rounding, or by the coarser description of a curve.
const BEYOND: f64 = 1e-3;

/// Position of the elements of one grid on the surface of the other. These are target elements on
/// the source for a consistent mapping, and source elements on the target for a conservative one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Number of elements.
    pub elements: usize,
    /// Number of elements whose centres lie beyond the border of the other surface, by more than a
    /// thousandth of an element.
    pub outside: usize,
    /// Largest distance of such a centre from the border, along the surface [m].
    pub farthest: f64,
}

impl Coverage {
    /// Returns whether more than one element in a hundred lies beyond the border. Their values are
    /// not mapped but moved to the border, or taken from it.
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

/// A mapping between two fixed grids.
#[derive(Clone, Debug, PartialEq)]
pub struct GridMapping {
    operator: SparseOperator,
    source_areas: Vec<f64>,
    target_areas: Vec<f64>,
    coverage: Coverage,
    conserves: bool,
}

impl GridMapping {
    /// Builds the mapping from a source grid to a target grid. Between grids of the same geometry
    /// it copies. A field that cannot be conserved because one of the grids has no areas is mapped
    /// consistently, see [`GridMapping::conserves`].
    ///
    /// # Errors
    /// A grid fails its check, is a volume or of points in blocks, or has more than 2³¹ points; or
    /// the method is the intersection and a grid is of vertices; or a chosen radial basis function
    /// does not suit the grid.
    pub fn between(
        source: &Grid,
        target: &Grid,
        method: Method,
        preserves: Mapping,
    ) -> Result<Self, MapError> {
        let conserves =
            preserves == Mapping::Conservative && source.has_areas() && target.has_areas();
        let (source_areas, target_areas) = (checked_areas(source)?, checked_areas(target)?);
        if source.shape == target.shape {
            let operator = SparseOperator::identity(source.points());
            let coverage = Coverage { elements: source.points(), ..Coverage::default() };
            return Ok(Self { operator, source_areas, target_areas, coverage, conserves });
        }
        let (operator, coverage) = match conserves {
            false => consistent(source, target, method)?,
            true => {
                let (opposite, coverage) = consistent(target, source, method)?;
                (opposite.transposed(&source_areas, &target_areas), coverage)
            }
        };
        Ok(Self { operator, source_areas, target_areas, coverage, conserves })
    }

    /// Returns whether the mapping keeps the integral of a field: it is conservative, and both
    /// grids have areas.
    #[must_use]
    pub fn conserves(&self) -> bool {
        self.conserves
    }

    /// Maps a field, one component after another; values are in component-major order. Allocates
    /// nothing.
    ///
    /// # Panics
    /// The two fields differ in their number of components.
    pub fn apply(&self, source: &[f64], target: &mut [f64]) {
        let (columns, rows) = (self.source_areas.len(), self.target_areas.len());
        let components = source.len() / columns;
        assert_eq!(
            source.len(),
            components * columns,
            "the length of the source field is a multiple of its points"
        );
        assert_eq!(
            target.len(),
            components * rows,
            "source and target have the same number of components"
        );
        for (from, to) in source.chunks_exact(columns).zip(target.chunks_exact_mut(rows)) {
            self.operator.apply(from, to);
        }
    }

    /// Returns the imbalance of a mapped field [-]: the largest |∫ target − ∫ source| / ∫ |source|
    /// of its components. A conservative mapping keeps it at rounding. The value is infinite where
    /// a zero source gives a nonzero target. Allocates nothing.
    #[must_use]
    pub fn imbalance(&self, source: &[f64], target: &[f64]) -> f64 {
        let (from, to) = (&self.source_areas, &self.target_areas);
        let fields = source.chunks_exact(from.len()).zip(target.chunks_exact(to.len()));
        fields.map(|(s, t)| imbalance(from, s, to, t)).fold(0.0, f64::max)
    }

    /// Returns how far the elements of one surface lie within the other.
    #[must_use]
    pub fn coverage(&self) -> Coverage {
        self.coverage
    }

    /// Returns the number of weights; each takes 12 bytes of memory.
    #[must_use]
    pub fn weights(&self) -> usize {
        self.operator.len()
    }
}

/// Checks a grid, and returns its areas.
fn checked_areas(grid: &Grid) -> Result<Vec<f64>, MapError> {
    if grid.only_written() {
        return Err(MapError::OnlyWritten(grid.name.clone()));
    }
    grid.check().map_err(MapError::Grid)?;
    let points = grid.points();
    if points > 1 << 31 {
        return Err(MapError::Size { grid: grid.name.clone(), points });
    }
    Ok(grid.areas())
}

fn prepared(grid: &Grid) -> Result<Prepared, MapError> {
    Prepared::new(grid).ok_or_else(|| MapError::OnlyWritten(grid.name.clone()))
}

fn imbalance(from: &[f64], source: &[f64], to: &[f64], target: &[f64]) -> f64 {
    let sent = pairwise_sum(0..from.len(), &|s| from[s] * source[s]);
    let received = pairwise_sum(0..to.len(), &|t| to[t] * target[t]);
    let scale = pairwise_sum(0..from.len(), &|s| from[s] * source[s].abs());
    // A mapped NaN must not pass as a balance: `max` would drop it.
    match (received - sent).abs() {
        0.0 => 0.0,
        difference if (difference / scale).is_nan() => f64::INFINITY,
        difference => difference / scale,
    }
}

/// Builds C for all values of `target`, and their coverage by `source`.
fn consistent(
    source: &Grid,
    target: &Grid,
    method: Method,
) -> Result<(SparseOperator, Coverage), MapError> {
    let [from, to] = [prepared(source)?, prepared(target)?];
    let nodes = (from.nodes(), to.nodes());
    let by_nearest = || rows(nodes.0, nodes.1, nearest::Nearest::new(nodes.0));
    Ok(match (method, &from, &to) {
        (Method::NearestNeighbour, ..) => by_nearest(),
        (Method::NearestProjection, ..) => match nearest::Projection::new(nodes.0) {
            Some(projection) => rows(nodes.0, nodes.1, projection),
            None => by_nearest(),
        },
        (Method::RadialBasis, ..) => rows(nodes.0, nodes.1, radial::RadialBasis::new(nodes.0)),
        (Method::Kernel(kernel), ..) => {
            let (targets, coverage) = targets(nodes.0, nodes.1);
            (by_kernel::operator(nodes.0, &targets, kernel, &source.name)?, coverage)
        }
        (Method::Intersection, Prepared::Surface(from), Prepared::Surface(to)) => {
            rows(from, to, intersection::Intersection::new(from, to))
        }
        (Method::Intersection, Prepared::Cloud(_), _) => {
            return Err(MapError::NoElements(source.name.clone()));
        }
        (Method::Intersection, ..) => return Err(MapError::NoElements(target.name.clone())),
    })
}

fn rows<M: MappingWeights>(
    from: &dyn Nodes,
    to: &dyn Nodes,
    mut method: M,
) -> (SparseOperator, Coverage) {
    let (targets, coverage) = targets(from, to);
    let mut operator = SparseOperator::with_rows(targets.len());
    let mut row = Row::new();
    for target in &targets {
        row.clear();
        if !(M::OF_POINTS && target.at_node) {
            method.weigh(target, &mut row);
        }
        operator.push_or_copy(&mut row, target);
    }
    (operator, coverage)
}

/// Returns the nodes of a grid as targets, and their coverage by the other grid.
pub(super) fn targets(from: &dyn Nodes, to: &dyn Nodes) -> (Vec<Target>, Coverage) {
    let mut coverage = Coverage { elements: to.places().len(), ..Coverage::default() };
    let target = |(index, &place)| {
        let foot = from.foot(place);
        let size = from.size(foot.node);
        if foot.outside > BEYOND * size {
            coverage.outside += 1;
            coverage.farthest = coverage.farthest.max(foot.outside);
        }
        let offset = (foot.point - from.places()[foot.node]).norm();
        Target { index, place, foot, at_node: offset <= COINCIDENT * size }
    };
    let targets = to.places().iter().enumerate().map(target).collect();
    (targets, coverage)
}

/// A mapping that follows its grids: rebuilt only when the revision of a grid changes.
#[derive(Clone, Debug)]
pub struct CurrentMapping {
    method: Option<Method>,
    preserves: Mapping,
    /// Revisions of source and target, and the mapping between them.
    made: Option<([u64; 2], GridMapping)>,
    builds: u64,
}

impl CurrentMapping {
    /// Creates an empty mapping; the first request builds it. Without a method the one suited to
    /// the grids is used, see [`Method::suited_to`].
    #[must_use]
    pub fn new(method: Option<Method>, preserves: Mapping) -> Self {
        Self { method, preserves, made: None, builds: 0 }
    }

    /// Returns the mapping between the grids as they are now. Every call must pass the same two
    /// grids: only their revisions are compared.
    ///
    /// # Errors
    /// See [`GridMapping::between`]. The old mapping is then kept but not returned.
    pub fn between(&mut self, source: &Grid, target: &Grid) -> Result<&GridMapping, MapError> {
        let revisions = [source.revision, target.revision];
        if self.made.as_ref().is_none_or(|(made_for, _)| *made_for != revisions) {
            let suited = || Method::suited_to(self.preserves, source, target);
            let method = self.method.unwrap_or_else(suited);
            let mapping = GridMapping::between(source, target, method, self.preserves)?;
            self.made = Some((revisions, mapping));
            self.builds += 1;
        }
        Ok(&self.made.as_ref().expect("it was there or has just been made").1)
    }

    /// Returns the coverage of the current mapping; `None` before the first build.
    #[must_use]
    pub fn coverage(&self) -> Option<Coverage> {
        self.made.as_ref().map(|(_, mapping)| mapping.coverage())
    }

    /// Returns how often the mapping was built.
    #[must_use]
    pub fn builds(&self) -> u64 {
        self.builds
    }
}
