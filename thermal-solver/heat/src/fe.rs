//! Finite elements of both bodies.
//!
//! Conduction, ρc(T) ∂T/∂t = ∇·(λ(T) ∇T) in material that passes under the contact at the speed V
//! towards −x, with the flux q into the surface z = 0. The mesh of a body is a product of three
//! axes ([`mesh`]): columns along, as long as the elements of the heat flux; rows across; and
//! layers in depth. The layers are graded, beginning with a small fraction of the depth that heat
//! reaches while the material passes an element ([`block`]). Hexahedra are trilinear and integrated
//! at their vertices: the mass is lumped, and a node is coupled to its six neighbours.
//!
//! | module | content |
//! |---|---|
//! | [`mesh`], [`block`] | axes; the mesh of a body from the settings of the case |
//! | [`modes`], [`basis`] | modes of an axis; modes across and in depth, and their relation to the rows of the flux |
//! | [`steady`], [`transient`] | constant properties in modes: exact along in steady motion; steps in time |
//! | [`mesh_advection`], [`scheme`] | steps of a mesh that moves with the material; backward Euler, BDF2, Crank–Nicolson |
//! | [`law`], [`conductor`], [`direct`] | properties over temperature; Newton and conjugate gradients on a block; sparse Cholesky instead of conjugate gradients |
//! | [`body_properties`], [`body_solver`], [`body`] | material of a body; interface of the solvers; selection of a solver |
//! | [`steady_modal`], [`transient_modal`], [`steady_marching`], [`transient_nodal`] | the four solvers with their states |
//! | [`steady_corrected`] | the march downstream, corrected by its error for constant properties |
//! | [`section`], [`height`] | temperatures below a row; thermal displacement of the surface |
//! | [`error`] | errors of a solve |
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
pub mod steady_corrected;
pub mod steady_marching;
pub mod steady_modal;
pub mod transient;
pub mod transient_modal;
pub mod transient_nodal;
mod varying;
