#![doc = include_str!("../README.md")]
//! # Modules
//!
//! | module | what |
//! |---|---|
//! | [`profile`] | profiles of rails and wheels, from files: Miniprof, SIMPACK, columns |
//! | [`outline`] | a profile as a curve over its length |
//! | [`curve`], `spline` | a height over a coordinate; splines between kinks, smoothed |
//! | [`slices`], [`surface`] | profiles that vary along the rail or round the wheel; with an irregularity or without |
//! | [`standard`] | the rail 60E1 and the wheel S1002, from their formulae |
//! | [`rail`], [`wheelset`] | where rails are, and wheels, and how they move |
//! | [`silhouette`] | the shadow of a wheel along the rail |
//! | [`rows`], `gap`, [`columns`] | the rail cut across into rows; what is between the bodies there; where they vary |
//! | [`search`], [`region`] | where they penetrate each other undeformed; the patches that this makes |
//! | [`local`], [`distance`] | a patch in its own plane: axes, elements, undeformed distance; the same of bodies that vary |
//! | [`creepage`] | creepages and rolling speed of a patch |
//! | [`fields`], [`patch`] | fields, forces and figures of patches; sums of a wheel |
//! | [`developed`] | the fields of all patches on one grid over x and the tape |
//! | [`contact`] | **all of it**: one position after another, by height or vertical force |
//! | [`balance`] | one wheel or both: the roll under two loads, the angular velocity under a torque |
//! | [`settings`], [`error`] | what it is solved with; why there is no solution |
//! | `parabolas`, `kpec`, `analyn`, `strips` | approximate theories of the normal contact: a patch row by row |
//! | `curved` | a patch on a surface that turns under it |
//! | `mutual` | what patches in planes of their own do to each other |
//! | `springs` | the simplified theory of the tangential one, strip by strip |
//! | [`interface`], `tractions` | heights and friction; a patch that slides under it |
//! | `pair`, `pressed`, `pool` | a position at one height after another; a patch under pressure; solvers of all sizes |
//! | `root` | the root of a function that is dear to evaluate |
//!
//! ```text
//! profiles ─► outline ─► surface ─► rail, wheelset ─► silhouette, columns ─► search ─► region ─► local, distance ─► pressed ─┐
//!                                                                                       creepage ─► patch ─► contact ─► balance
//! ```
//!
//! Every patch is a contact of half-spaces ([`half_space`]) in its own plane, or what fast theories have in their place, of bodies of the same
//! material, rolling steadily. Axes are those of [`rail`]: x forward, y to the left, z up; forces act on the wheel.
//! On a rail and a wheel that are one surface round a corner (conformal contact) half-spaces are a rough picture: there a patch may be on a
//! curved surface ([`half_space::conformal`]).

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
