//! Finite elements of both bodies.
//!
//! Conduction, ρc(T) ∂T/∂t = ∇·(λ(T) ∇T) in material that passes under the contact at the speed V towards −x, with
//! the flux q into the surface z = 0. The mesh of a body is a product of three axes ([`mesh`]): columns along,
//! as long as the elements of the heat flux, rows across, and layers in depth that are graded from a small part of
//! the depth to which heat goes while an element passes ([`block`]). Hexahedra are trilinear, integrated at
//! their vertices: mass is lumped, and a node is coupled to its six neighbours.
//!
//! | module | what |
//! |---|---|
//! | [`mesh`], [`block`] | axes; the mesh of a body and what the case says of it |
//! | [`modes`], [`basis`] | modes of an axis; those across and in depth, and the way to the rows of the flux |
//! | [`steady`], [`transient`] | constant properties in modes: exact along in steady motion; steps in time |
//! | [`mesh_advection`], [`scheme`] | how a mesh moves with the material, step by step; backward Euler, BDF2, Crank–Nicolson |
//! | [`law`], [`conductor`], [`direct`] | properties over temperature; Newton and conjugate gradients on a block; a sparse Cholesky in their place |
//! | [`body_properties`], [`body_solver`], [`body`] | what a body is made of; a way to solve for it; which one |
//! | [`steady_modal`], [`transient_modal`], [`steady_marching`], [`transient_nodal`] | the four ways, with their states |
//! | [`section`], [`height`] | what is below a row; what raises the surface |
//! | [`error`] | why there is no answer |
//!
//! Theory, sources and figures: docs/theory/fe.md.

pub mod basis;
pub mod block;
pub mod body;
pub mod body_properties;
pub mod body_solver;
pub mod conductor;
pub mod direct;
pub mod error;
pub mod height;
pub mod law;
pub mod mesh;
pub mod mesh_advection;
pub mod modes;
pub mod scheme;
pub mod section;
pub mod steady;
pub mod steady_marching;
pub mod steady_modal;
pub mod transient;
pub mod transient_modal;
pub mod transient_nodal;
mod varying;
