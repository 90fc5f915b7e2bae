//! Two participants that solve x = Mx + b_w together: `relay` sends back the values it receives,
//! `operator` answers x with Mx + b_w in window w.
//!
//! A seed gives, by splitmix64 as numbers in [−1, 1), two vectors b₀ and b₁, ten vectors v_k, and
//! for P5 and P6 a matrix G, by rows. Q is the product of the reflections H_k = I −
//! 2v_kv_kᵀ/v_kᵀv_k, and i = 0..n−1:
//!
//! | problem | M |
//! |---|---|
//! | P1 | QΛQᵀ, λ_i = 0.95(−1 + 2i/(n−1)) |
//! | P2 | QΛQᵀ, λ_i = −1.5 + 2i/(n−1) |
//! | P3 | QΛQᵀ, λ_i = −1.5 · 0.8^i |
//! | P4 | QΛQᵀ, λ_i = 0.95 · 0.8^i |
//! | P5 | 0.95 G/ρ(G) |
//! | P6 | 1.5 G/ρ(G) |
//! | diagonal | Λ of P1, with b_w only |
//!
//! The right side is b_w = (1 + 0.2 sin w) b₀ + 0.2 cos w b₁. Each participant receives its input
//! on its own grid. `relay.points` gives the relay a different grid; then M acts between the
//! mappings there and back. The operator knows the exact solution from a direct solve. The summary
//! contains the largest relative error of an accepted window.

mod dense;
mod participant;
mod problem;

pub use participant::{Linear, OPERATOR_VALUE, RELAY_VALUE, grid};
pub use problem::{LARGEST_DENSE, PROBLEMS, Problem};
