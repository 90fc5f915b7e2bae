//! Model `explicit-fe`: explicit finite elements of both bodies, rolled until that is steady ([`explicit_fe`]).
//!
//! The lower body is straight or convex, the upper one rolls on it with a longitudinal creepage or force; both may be curved
//! across, or have measured profiles. Hertz's contact, or one of half-spaces, only sizes the meshes. Steady rolling is computed once, when the model is built, with its
//! progress reported. Where an axle may move, the bodies roll on from there, window by window.
//!
//! | file | what |
//! |---|---|
//! | [`entry`] | what the list of models and the description say |
//! | [`keys`] | the keys of the case, and the sizes that they leave open |
//! | [`surfaces`] | what touches, and about where |
//! | [`creep_curve`] | along which the creepage of a force is looked for |
//! | [`setup`] | a case, checked, and bodies made of it |
//! | [`passage`] | rolling on in time |
//! | [`heated`] | steady rolling that heat changes |
//! | [`outcome`] | what a measurement gives: faults, fields, figures |

mod creep_curve;
mod entry;
mod heated;
mod keys;
mod outcome;
mod passage;
mod setup;
mod surfaces;

pub(super) use entry::MODEL;
