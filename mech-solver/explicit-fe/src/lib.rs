#![doc = include_str!("../README.md")]
//! Both bodies are rows of like elements: a cross-section of quadrilaterals, drawn along the motion for a straight body and
//! about its axis for one that rolls. Nodes are material; displacements u are those from the rigid motion, in the directions of
//! each node's own place (along, across, into the body), so that both bodies are nearly at rest in their own frames and the
//! contact travels over them. The mesh travels with it: when the material has gone back by an element, each row is shifted by one
//! column, the last one is dropped and one without displacement is added in front. That is exact.
//!
//! Central differences: v′ = v − Δt M⁻¹ f(u + βv), u′ = u + Δt v′, with the lumped mass M and a small damping β that is
//! proportional to stiffness. Contact by multipliers in forward increments (Carpenter, Taylor & Katona, Int. J. Numer. Meth.
//! Engng 32 (1991) 103–128): impulses make the surfaces touch, not overlap, at the end of the step, and stick or slide by
//! Coulomb's law during it.
//!
//! # Modules
//!
//! | module | what |
//! |---|---|
//! | [`shape`] | gradients and hourglass modes of an element |
//! | [`kernel`] | forces of a row of elements, vectorised along the row |
//! | [`section`] | the cross-section's mesh |
//! | [`quality`] | how good its elements are |
//! | [`block`] | a body: its state and its step |
//! | [`frequency`] | an upper bound of its highest frequency, for the stable step |
//! | [`contact`] | impulses between the surfaces |
//! | [`plane`] | what happens in the contact, summed on a plane that travels with it |
//! | [`rolling`] | two bodies, an axle, their steps |
//! | [`steady_rolling`] | rolling until that is steady |
//!
//! Left out: what the rotation of the axle does to the wheel (V² ρ is 12 MPa at 140 km/h beside a pressure of 1.3 GPa) and Coriolis
//! forces; wheel and rail are held at the faces of their blocks.

pub mod block;
pub mod contact;
pub mod frequency;
pub mod kernel;
pub mod plane;
pub mod quality;
pub mod rolling;
pub mod section;
pub mod shape;
pub mod steady_rolling;
