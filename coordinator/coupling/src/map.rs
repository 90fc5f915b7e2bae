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
//!
//! # A field between two grids
//!
//! ```
//! use contract::field::Mapping;
//! use contract::grid::{Grid, Structured};
//! use coupling::map::{GridMapping, Method};
//!
//! // The same square millimetre, in 8 x 8 and in 5 x 5 elements; the first element is centred on h/2.
//! let square = |n: usize| {
//!     let h = 1e-3 / n as f64;
//!     Grid::structured("contact", Structured::contact_plane(h / 2.0, h / 2.0, h, h, n, n))
//! };
//! let (fine, coarse) = (square(8), square(5));
//!
//! // A heat flux [W/m²] keeps its power [W], whatever the grids are.
//! let flux: Vec<f64> = (0..fine.points()).map(|n| 1e6 * (1.0 + fine.centre(n)[0] / 1e-3)).collect();
//! let mut mapped = vec![0.0; coarse.points()];
//! let heat = GridMapping::between(&fine, &coarse, Method::Intersection, Mapping::Conservative)?;
//! heat.apply(&flux, &mut mapped);
//! assert!((coarse.integrate(&mapped) / fine.integrate(&flux) - 1.0).abs() < 1e-14);
//!
//! // A temperature [K] that is the same everywhere stays so.
//! let method = Method::suited_to(Mapping::Consistent);
//! let rise = GridMapping::between(&coarse, &fine, method, Mapping::Consistent)?;
//! let mut there = vec![0.0; fine.points()];
//! rise.apply(&[226.0; 25], &mut there);
//! assert!(there.iter().all(|t| (t - 226.0).abs() < 1e-11));
//! # Ok::<(), coupling::map::MapError>(())
//! ```

mod current;
mod intersection;
mod mapping;
mod method;
mod nearest;
mod operator;
mod patch;
mod projection;
mod radial;
mod surface;
#[cfg(test)]
mod tests;
mod vector;
mod weigh;

pub use current::CurrentMapping;
pub use mapping::{Coverage, GridMapping, MapError};
pub use method::{Mappings, Method};
