//! Kalker's simplified theory: surfaces as beds of springs, whose flexibility follows from the linear theory of half-spaces.
//!
//! A strip along x knows nothing of the others, so that a contact of any outline is solved strip by strip
//! ([`crate::models`] has the ellipse, [`wheel_rail`] any patch).
//!
//! | module | what |
//! |---|---|
//! | [`flexibility`] | the springs |
//! | `reduction` | softer springs for a creep curve of less slope |
//! | `bound` | the traction bound along a strip, and the nodes that fit it |
//! | `march` | strips, cells and the march with Coulomb's law |
//! | `strip_theory` | the stick zone by strip theory |
//! | `overlaps` | parts of a cell in the elements of a grid |

pub mod bound;
pub mod flexibility;
pub mod integration;
pub mod overlaps;
pub mod reduction;
pub mod strip_theory;
