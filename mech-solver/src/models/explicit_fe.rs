//! Model `explicit-fe`: explicit finite elements of both bodies, rolled until steady
//! ([`explicit_fe`]).
//!
//! The lower body is straight or convex; the upper body rolls on it with a longitudinal creepage or
//! force. Both may be curved laterally, or have measured profiles. The contact of Hertz or of
//! half-spaces only determines the size of the meshes. Steady rolling is computed once, when the
//! model is built, and reports its progress. With an axle that may move, the bodies roll on from
//! that state, window by window.
//!
//! | module | contents |
//! |---|---|
//! | [`entry`] | registry entry and description |
//! | [`keys`] | keys of the case, and default sizes |
//! | [`surfaces`] | undeformed surfaces, and an estimate of the contact |
//! | [`creep_curve`] | creep curve that starts the search for the creepage of a force |
//! | [`setup`] | a checked case, and the bodies built from it |
//! | [`passage`] | rolling in time |
//! | [`heated`] | steady rolling of heated bodies |
//! | [`outcome`] | evaluation of a measurement: checks, fields, figures |

mod creep_curve;
mod entry;
mod heated;
mod keys;
mod outcome;
mod passage;
mod setup;
mod surfaces;

pub(super) use entry::MODEL;
