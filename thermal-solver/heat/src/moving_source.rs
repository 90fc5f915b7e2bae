//! Heat conduction in a half-space under a moving flux, in all three directions, at any speed.
//!
//! # Equation
//!
//! The material of a body passes under the contact at the speed V ≥ 0, towards −x. The flux q [W/m²]
//! that a place has received an age τ ago has spread since: with the diffusivity κ and the effusivity β,
//! and s² = 4κτ, the rise at (x, y) in the depth z is (Carslaw & Jaeger, 10.4 and 10.7)
//!
//! T = 1/(β√π) ∫₀^∞ dτ/√τ e^{−z²/s²} ∬ q(x', y') g((x' − x − Vτ)/s) g((y' − y)/s) dx' dy'/s²,
//! g(v) = e^{−v²}/√π.
//!
//! It is exact for constant properties and an insulated surface beside the flux, from rest to
//! V → ∞, where it becomes [`crate::columns`].
//!
//! # Discretisation
//!
//! Along x the flux is the piecewise parabolic one of [`crate::columns::reconstruction`], across it is
//! constant over an element. For every age the integrals over elements are products of one in x and one
//! in y, in closed form by the error function ([`element`]). The ages are integrated over by Gauss's rule
//! on panels that follow the width s of what has spread ([`ages`]). So the influence of an element on
//! another is a sum over some hundreds of ages, cut to where it is not zero, and the surface is a
//! convolution over Fourier space ([`half_space`]). Rises at single places and in depth come from the same
//! sum, with the flux contracted to a row of the grid.
//!
//! Heat that flows between two bodies where they touch is solved for in [`exchange`], in the shape
//! functions of [`contact_basis`].
//!
//! What the heat does to the height of the surface is [`rise_integral`].
//!
//! In time the flux of every window is constant over it, and contributes over its own ages, from the
//! youngest to the oldest.
//!
//! # Errors
//!
//! The ages and the elements' integrals leave some 1e-9 of the largest rise. What remains is the
//! flux: of order 2.5 along x where it is an ellipse, as for the columns, and of second order across.

pub mod ages;
pub mod contact_basis;
pub mod element;
pub mod exchange;
pub mod half_space;
pub mod past;
pub mod rise_integral;
