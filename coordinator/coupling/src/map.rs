//! Mapping of fields between grids that do not match.
//!
//! A mapping is a sparse matrix W, built once for a pair of grids: target = W source. In the
//! *consistent* form C every row sums to one, Σ_s C_ts = 1, so that a constant field stays
//! constant, as temperatures need. The *conservative* form keeps the surface integral of densities
//! such as a heat flux. It is the transpose of the consistent form C' of the opposite direction
//! (from the target's grid to the source's), between integrated quantities, with the element areas
//! A:
//!
//! W_ts = A_s C'_st / A_t,   hence   Σ_t A_t W_ts = A_s Σ_t C'_st = A_s
//!
//! for every source element s and every method. The whole integral of an element arrives, also
//! beyond the edge of the target's grid, because C' has a full row for every element. [`Coverage`]
//! says how many elements have no counterpart, and how far they lie outside.
//!
//! The methods differ in C:
//!
//! | method | value at a target element | order | weights |
//! |---|---|---|---|
//! | [`Method::NearestNeighbour`] | value at the nearest centre or vertex | 1 | ≥ 0 |
//! | [`Method::NearestProjection`] | bilinear between centres, at the target's foot on the surface through them | 2 | ≥ 0 |
//! | [`Method::RadialBasis`] | local interpolant of compactly supported functions with a linear polynomial | 2 to 3 | any |
//! | [`Method::Kernel`] | interpolant of a chosen function with a linear polynomial, through all values or through overlapping clusters of them | 2 and higher | any |
//! | [`Method::Intersection`] | mean over the covered part of the source | 1 | ≥ 0 |
//!
//! Weights ≥ 0 keep a consistently mapped field within the source's extremes. For a conservatively
//! mapped density only [`Method::Intersection`] guarantees this bound, and only where target
//! elements are wholly covered: Σ_s W_ts = Σ_s |t ∩ s|/A_t = 1. This method suits values of finite
//! volumes; the transposed point methods leave elements of a finer target empty. For measured
//! orders and advice see `docs/theory/mapping.md`.
//!
//! On a grid of vertices ([`contract::grid::Vertices`]) the values belong to points. Their areas
//! follow from the measure: with 1 at every point of both grids, the conservative form is the plain
//! transpose, which keeps the sum. A grid of unknown areas has no integral that could be kept, and
//! its fields are always mapped consistently ([`GridMapping::conserves`]). Nearest projection uses
//! the triangles and edges between vertices; the intersection needs elements.
//!
//! Sources: A. de Boer, A. H. van Zuijlen, H. Bijl, *Comput. Methods Appl. Mech. Engrg.* 196 (2007)
//! 1515–1525 (consistent and conservative forms); H. Wendland, *Adv. Comput. Math.* 4 (1995)
//! 389–396 (functions); P. E. Farrell, J. R. Maddison, *Comput. Methods Appl. Mech. Engrg.* 200
//! (2011) 89–100 (intersections). Deviation from the first: the interpolants of
//! [`Method::RadialBasis`] are local, one small system for each target, and those of
//! [`Method::Kernel`] are evaluated as weights. Applying W therefore needs no solve.
//!
//! # A field between two grids
//!
//! ```
//! use contract::field::Mapping;
//! use contract::grid::{Grid, Structured};
//! use coupling::map::{GridMapping, Method};
//!
//! // A square millimetre in 8 x 8 and in 5 x 5 elements; the first element is centred at h/2.
//! let square = |n: usize| {
//!     let h = 1e-3 / n as f64;
//!     Grid::structured("contact", Structured::contact_plane(h / 2.0, h / 2.0, h, h, n, n))
//! };
//! let (fine, coarse) = (square(8), square(5));
//!
//! // A heat flux [W/m²] keeps its power [W] on any pair of grids.
//! let flux: Vec<f64> = (0..fine.points()).map(|n| 1e6 * (1.0 + fine.centre(n)[0] /
//! 1e-3)).collect(); let mut mapped = vec![0.0; coarse.points()]; let heat =
//! GridMapping::between(&fine, &coarse, Method::Intersection, Mapping::Conservative)?;
//! heat.apply(&flux, &mut mapped); assert!((coarse.integrate(&mapped) / fine.integrate(&flux) -
//! 1.0).abs() < 1e-14);
//!
//! // A uniform temperature rise [K] stays uniform.
//! let method = Method::suited_to(Mapping::Consistent, &coarse, &fine);
//! let rise = GridMapping::between(&coarse, &fine, method, Mapping::Consistent)?;
//! let mut there = vec![0.0; fine.points()];
//! rise.apply(&[226.0; 25], &mut there);
//! assert!(there.iter().all(|t| (t - 226.0).abs() < 1e-11));
//! # Ok::<(), coupling::map::MapError>(())
//! ```

mod axes;
mod by_kernel;
mod cloud;
mod dense;
mod error;
mod interpolant;
mod intersection;
mod kernel;
mod mapping;
mod nearest;
mod nodes;
mod operator;
mod partition;
mod patch;
mod prepared;
mod radial;
mod surface;
#[cfg(test)]
mod tests;

pub use crate::settings::{Basis, FieldMapping, Kernel, Mappings, Method};
pub use error::MapError;
pub use mapping::{Coverage, CurrentMapping, GridMapping};
