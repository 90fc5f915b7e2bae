#![forbid(unsafe_code)]
#![doc = include_str!("../README.md")]
//! # Modules
//!
//! | module | content |
//! |---|---|
//! | [`profile`] | profiles of rails and wheels, from files: Miniprof, SIMPACK, columns |
//! | [`outline`] | a profile as a curve over its arc length |
//! | [`curve`], `spline` | a height over a coordinate; splines between kinks, smoothed |
//! | [`slices`], [`surface`] | profiles that vary along the rail or round the wheel |
//! | [`standard`] | the rail 60E1 and the wheel S1002, from their formulae |
//! | [`rail`], [`wheelset`] | positions of rails and wheels, and their motion |
//! | [`silhouette`] | the silhouette of a wheel along the rail |
//! | [`rows`], `gap`, [`columns`] | cuts across the rail; gaps between the bodies; varying bodies |
//! | [`search`], [`region`] | penetration of the undeformed bodies, and the patches that result |
//! | [`local`], [`distance`] | axes, elements and undeformed distance of a patch; varying bodies |
//! | [`creepage`] | creepages and rolling speed of a patch |
//! | [`fields`], [`patch`] | fields, forces and figures of patches; sums of a wheel |
//! | [`developed`] | the fields of all patches on one grid over x and the tape distance |
//! | [`contact`] | **entry point**: one position after another, by height or vertical force |
//! | [`balance`] | one or two wheels: the roll under both loads, the speed under a torque |
//! | [`settings`], [`error`] | settings of the solvers; errors |
//! | `parabolas`, `kpec`, `analyn`, `strips` | approximate theories of the normal contact |
//! | `curved` | a patch on a curved surface |
//! | `mutual` | mutual influence of patches in different planes |
//! | `springs` | the simplified theory of the tangential contact, strip by strip |
//! | [`interface`], `tractions` | heights and friction; tractions of a patch with that friction |
//! | `pair`, `pressed`, `pool` | a wheel on a rail; a patch under pressure; solvers by size |
//! | `root` | root finder for expensive functions |
//!
//! ```text
//! profiles ─► outline ─► surface ─► rail, wheelset ─► silhouette, columns ─► search ─► region ─┐
//!                                                                                              │
//!         balance ◄─ contact ◄─ patch ◄─ creepage; pressed ◄─ local, distance ◄────────────────┘
//! ```
//!
//! Every patch is a contact of half-spaces ([`half_space`]) in its own plane, or is solved by a
//! fast theory instead. The bodies have the same material and roll steadily. Axes are those of
//! [`rail`]: x forward, y to the left, z up; forces act on the wheel. Where rail and wheel form one
//! surface round a corner (conformal contact), half-spaces are a rough approximation; such a patch
//! may lie on a curved surface ([`half_space::conformal`]).

pub use elastic::Material;

mod analyn;
pub mod balance;
pub mod columns;
pub mod contact;
pub mod creepage;
pub mod curve;
mod curved;
pub mod developed;
pub mod distance;
pub mod error;
pub mod fields;
mod gap;
pub mod interface;
mod kpec;
pub mod local;
mod mutual;
pub mod outline;
mod pair;
mod parabolas;
pub mod patch;
mod pool;
mod pressed;
pub mod profile;
pub mod rail;
pub mod region;
mod root;
pub mod rows;
pub mod search;
pub mod settings;
pub mod silhouette;
pub mod slices;
mod sliding;
mod spline;
mod springs;
pub mod standard;
mod strips;
pub mod surface;
#[cfg(test)]
mod tests;
mod tractions;
pub mod wheelset;
