//! Values of a case that several models read.
//!
//! | module | contents |
//! |---|---|
//! | [`keys`] | values checked against the specifications that the description publishes |
//! | [`scene`] | bodies, load and friction |
//! | [`motion`] | what drives the upper body; speeds of rolling and of the surfaces |
//! | [`resolution`], [`difference`] | elements per semi-axis; difference scheme along x |
//! | [`ellipse`] | the contact patch in closed form, with its grid |
//! | [`piecewise_linear`] | values over a coordinate, from a table |
//! | [`shape`] | lateral shapes of the bodies, of every kind |
//! | [`noise`] | scatter of the points of measured profiles |

pub(crate) mod difference;
pub(crate) mod ellipse;
pub(crate) mod keys;
pub(crate) mod motion;
pub(crate) mod noise;
pub(crate) mod piecewise_linear;
pub(crate) mod resolution;
pub mod scene;
pub(crate) mod shape;
