//! Kalker's simplified theory: surfaces as beds of springs, whose flexibility is fitted to the
//! linear theory of half-spaces.
//!
//! Strips along x are independent, so a contact of any outline is solved strip by strip. The
//! mech-solver's model `fastsim` solves ellipses, the crate `wheel-rail` patches of any outline.
//!
//! | module | contents |
//! |---|---|
//! | [`flexibility`] | the springs |
//! | `reduction` | softer springs for a creep curve of less slope |
//! | `bound` | the traction bound along a strip, and the nodes fitted to it |
//! | `integration` | strips, cells and the integration along a strip with Coulomb's law |
//! | `strip_theory` | the stick zone by strip theory |
//! | `overlaps` | overlaps of an interval with the elements of a grid |

pub mod bound;
pub mod flexibility;
pub mod integration;
pub mod overlaps;
pub mod reduction;
pub mod strip_theory;
