//! Conduction into half-spaces under a flux that repeats along the surface, wave by wave and exact in time.
//!
//! A wave q̂ e^{i(k_x x + k_y y)} of the flux into a body whose material passes with V towards −x, κ its diffusivity, λ its
//! conductivity, ρc its capacity, k² = k_x² + k_y². Extended evenly through the surface, the rise has in depth the cosine transform
//! ϑ̂(s, t), and every pair of wave numbers decays by itself:
//!
//! dϑ̂/dt = −r ϑ̂ + q̂/(ρc), r = κ(k² + s²) − i k_x V,
//! ϑ(z) = (2/π) ∫₀^∞ ϑ̂ cos(sz) ds, W = ∫₀^∞ ϑ e^{−kz} dz = (2/π) ∫₀^∞ ϑ̂ k/(k² + s²) ds,
//!
//! W being what raises the surface ([`crate::moving_source::rise_integral`]); for k = 0, where it only moves a body as a whole, it is
//! left out. So the state of a
//! wave is ϑ̂ at some nodes s ([`depth`]), and a window Δt with a constant flux is one product for each,
//! ϑ̂ ← ϑ̂ e^{−rΔt} + q̂/(ρc) (1 − e^{−rΔt})/r: the past costs nothing, however long it is, and windows may have any length.
//! Below the surface the part q̂/(ρc r), that of a flux that has always been, is taken in closed form, q̂ e^{−mz}/(λm) with
//! m² = k² − i k_x V/κ, and what is left has decayed beyond s = 6/√(κΔt); for k = 0 it is that of this window alone.
//!
//! Source: Carslaw & Jaeger, Conduction of Heat in Solids (1959), 2.4 and 10.7, for the equation and its closed forms. Errors: of the rule
//! over s, 1e-8 of the rise at the surface and 1e-4 below it, for windows from 1e-9 s to a day in all; the flux is a sum of the waves of its
//! grid, so that a jump of it overshoots.

pub mod depth;
pub mod half_space;
