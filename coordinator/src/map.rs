//! Mapping of fields between grids that do not match.
//!
//! A mapping is a sparse matrix W, made once for a pair of grids: target = W source. In its
//! *consistent* form C every row sums to one, Σ_s C_ts = 1, so that a constant stays one: what
//! temperatures want. Its *conservative* form keeps the surface integral of densities such as a
//! heat flux. It is the transpose of the consistent form C' of the opposite direction (from the
//! target's grid to the source's), between integrated quantities, with the element areas A:
//!
//! W_ts = A_s C'_st / A_t,   hence   Σ_t A_t W_ts = A_s Σ_t C'_st = A_s
//!
//! for every source element s and every method: whatever leaves an element arrives, also where the
//! target's grid ends, for C' has a full row for every element, wherever it lies.
//! A mapping says how many elements found nothing opposite them, and how far off they were
//! ([`Coverage`]).
//!
//! The four methods differ in C:
//!
//! | method | a target takes | order | weights |
//! |---|---|---|---|
//! | [`Method::NearestNeighbour`] | the nearest centre's value | 1 | ≥ 0 |
//! | [`Method::NearestProjection`] | the value, bilinear between centres, at its foot on the surface through them | 2 | ≥ 0 |
//! | [`Method::RadialBasis`] | an interpolant of compactly supported functions with a linear polynomial | 2 to 3 | any |
//! | [`Method::Intersection`] | the mean over the part of the source that it covers | 1 | ≥ 0 |
//!
//! Weights ≥ 0 keep a consistently mapped field within the source's extremes. A conservatively
//! mapped density is bounded that way only by [`Method::Intersection`], and there where target
//! elements are wholly covered: Σ_s W_ts = Σ_s |t ∩ s|/A_t = 1.
//! It is the natural mapping of what finite volumes exchange; the transposed point methods leave
//! elements of a finer target empty. Orders measured and advice: `docs/theory/mapping.md`.
//!
//! Sources: A. de Boer, A. H. van Zuijlen, H. Bijl, *Comput. Methods Appl. Mech. Engrg.* 196 (2007)
//! 1515–1525 (consistent and conservative forms); H. Wendland, *Adv. Comput. Math.* 4 (1995)
//! 389–396 (functions); P. E. Farrell, J. R. Maddison, *Comput. Methods Appl. Mech. Engrg.* 200
//! (2011) 89–100 (intersections). Deviation from the first: the interpolants are local, one small
//! system for each target, so that W is sparse and there is nothing to solve when it is applied.

mod current;
mod nearest;
mod operator;
mod overlap;
mod patch;
mod projection;
mod radial;
mod surface;
#[cfg(test)]
mod tests;

pub use current::CurrentMapping;

use operator::{Row, SparseOperator};
use proto::field::Mapping;
use proto::grid::{Grid, pairwise_sum};
use surface::Surface;

/// How the value of a target element is made of those of source elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The value of the nearest element centre; the mean if several are equally near.
    NearestNeighbour,
    /// Bilinear between the element centres around the target's foot on the surface; constant
    /// beyond the outermost centres, so that nothing overshoots.
    NearestProjection,
    /// Wendland's C2 function with a linear polynomial on a few rings of elements.
    RadialBasis,
    /// Mean over the intersections of the elements, exact in a common plane.
    Intersection,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 4] =
        [Self::NearestNeighbour, Self::NearestProjection, Self::RadialBasis, Self::Intersection];

    /// Name in case files and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NearestNeighbour => "nearest-neighbour",
            Self::NearestProjection => "nearest-projection",
            Self::RadialBasis => "radial-basis",
            Self::Intersection => "intersection",
        }
    }

    /// The method of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }

    /// What suits a field that nobody chose a method for: second order without overshoot for point
    /// values, exact areas for densities.
    #[must_use]
    pub fn suited_to(preserves: Mapping) -> Self {
        match preserves {
            Mapping::Consistent => Self::NearestProjection,
            Mapping::Conservative => Self::Intersection,
        }
    }
}

/// Why there is no mapping.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum MapError {
    /// A grid is not what [`Grid::check`] lets pass.
    #[error("no mapping from or to an invalid grid: {0}")]
    Grid(String),
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
    /// A grid that does not pass its check, or has more than 2³¹ points.
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
    Ok(Surface::of(grid))
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
        Method::Intersection => rows(from, to, overlap::Intersection::new(from, to)),
    }
}

/// One method on one source surface.
trait Weigh {
    /// Adds the weights of one target element, up to a common factor; none if there is no answer.
    fn weigh(&mut self, target: &Target, row: &mut Row);

    /// Whether a target in the very centre of an element is no special case.
    const OF_POINTS: bool = true;
}

/// A target element, and where it lies on the source.
struct Target {
    /// Index on its own grid.
    index: usize,
    /// Its centre [m].
    centre: surface::Vector,
    /// What of the source is nearest to it.
    foot: surface::Foot,
}

/// Distances below this fraction of an element's size are taken for zero: coordinates [m] of doubles
/// are exact to some 1e-12 of an element.
const COINCIDENT: f64 = 1e-10;

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
