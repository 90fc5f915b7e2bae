//! Contact on a curved surface of bodies that are prismatic along x.
//!
//! Where a wheel's flange root lies in the gauge corner of a rail the surface turns under the contact, and the bodies
//! are no half-spaces: a corner yields more, a throat less. Places are given by x and s along the surface, tractions
//! and displacements by their components along x, s and the local normal n.
//!
//! | module | what |
//! |---|---|
//! | [`kernel`] | an elastic space under forces that vary like a wave along x |
//! | [`section`] | where the surface of a body goes across its axis |
//! | [`outline`] | the outline of a body as boundary elements |
//! | [`boundary`] | its flexibility for a wave along x |
//! | [`shape`] | two arcs that touch |
//! | [`numbers`] | influence numbers of a pair of bodies |
//! | [`elastic`] | what they displace under pressure and tractions |
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
