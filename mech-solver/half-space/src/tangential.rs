//! The tangential problem on one grid: a step of steady rolling, of transient rolling, or a shift.
//!
//! Find tractions p (two components an element) and their slip S = w Δq + s₀ + B p with
//!
//! - in the adhesion area |p| ≤ g and S = 0,
//! - in the slip area |p| = g and S opposite to p,
//!
//! where g = f p_n is the traction bound, B the operator of [`super::slip_operator`] and s₀ the
//! slip without tractions, if any: the remainder of the previous step in transient rolling or in a
//! shift, and the slip caused by the pressure on bodies of different material.
//!
//! **Yielding layer** ([`super::yielding`]). The bound becomes a function g(|S|) of the slip of an
//! element, which comprises the slip of the surfaces and the plastic shift of the layer. The
//! conditions and the energy balance stay the same; the balance includes the dissipation in the
//! layer.
//!
//! **Energy.** With the upwind difference the power of the step from I + e_x to I is
//! −½(p_I + p_{I+e_x})·S_I V/Δx. Summed over all steps of steady rolling, including those that
//! leave the contact, the part of B vanishes exactly, because pᵀ(Sᵀ − S)A p = 0 for a symmetric A
//! that commutes with the shift: the sum is −V Σ w·p, the power of the forces over the creepages,
//! at every resolution and whether or not the iteration has converged. Fromm's difference keeps the
//! same balance with its numerical dissipation ([`super::dissipation`]). In transient rolling the
//! remainder is the change of elastic energy.
//!
//! Source: Kalker, *Three-Dimensional Elastic Bodies in Rolling Contact* (1990) ch. 4.

mod bound_law;
mod bounds;
mod force_bracketing;
mod linear;
mod newton;
mod passes;
mod problem;
mod slip_passes;
mod state;

pub use bound_law::{Arguments, BoundLaw};
pub use newton::{Effort, NotConverged, TangentialSolver};
pub use problem::{Layer, PrescribedForces, PrescribedMotion, Problem};
pub use state::{Creepage, ElementState, TangentialState};

#[cfg(test)]
mod tests;
