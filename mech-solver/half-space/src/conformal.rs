//! Contact on a curved surface of bodies that are prismatic along x.
//!
//! Where a wheel's flange root lies in the gauge corner of a rail, the surface turns within the
//! contact and the bodies are not half-spaces: a corner is more compliant, a throat less. Positions
//! are given by x and by s along the surface. Tractions and displacements have components along x,
//! s and the local normal n.
//!
//! | module | what |
//! |---|---|
//! | [`kernel`] | an elastic space under forces that vary like a wave along x |
//! | [`section`] | cross-section of a body's surface |
//! | [`outline`] | the outline of a body as boundary elements |
//! | [`boundary`] | flexibility of a body for a wave along x |
//! | [`shape`] | two arcs that touch |
//! | [`numbers`] | influence numbers of a pair of bodies |
//! | [`elastic`] | displacements of both bodies under pressure and tractions |
//! | [`contact`] | pressure and tractions |
//! | [`pin`] | a pin in a hole |

mod boundary;
pub mod contact;
pub mod elastic;
mod kernel;
pub mod numbers;
mod outline;
pub mod pin;
pub mod section;
pub mod shape;
