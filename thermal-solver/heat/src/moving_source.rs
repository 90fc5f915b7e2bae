//! Heat conduction in a half-space under a moving flux, in all three directions, at any speed.
//!
//! # Equation
//!
//! The material of a body passes under the contact at the speed V ≥ 0, towards −x. The flux q
//! [W/m²] that a place received an age τ ago has spread since. With the diffusivity κ, the
//! effusivity β and s² = 4κτ, the rise at (x, y) in the depth z is (Carslaw & Jaeger, 10.4 and
//! 10.7)
//!
//! T = 1/(β√π) ∫₀^∞ dτ/√τ e^{−z²/s²} ∬ q(x', y') g((x' − x − Vτ)/s) g((y' − y)/s) dx' dy'/s²,
//! g(v) = e^{−v²}/√π.
//!
//! The equation is exact for constant properties and an insulated surface beside the flux, from
//! rest to V → ∞, where it becomes [`crate::columns`].
//!
//! # Discretisation
//!
//! Along x the flux is the piecewise parabola of [`crate::columns::reconstruction`]; across, it is
//! constant over an element. For every age the integrals over elements are products of an integral
//! in x and an integral in y, in closed form by the error function ([`element`]). The ages are
//! integrated by Gauss's rule on panels that follow the spreading width s ([`ages`]). The influence
//! of an element on another is thus a sum over some hundreds of ages, restricted to nonzero terms,
//! and the surface is a convolution by Fourier transforms ([`half_space`]). Rises at single places
//! and in depth come from the same sum, with the flux contracted to a row of the grid.
//!
//! [`exchange`] solves for the heat that flows between two bodies where they touch, in the shape
//! functions of [`contact_basis`].
//!
//! [`rise_integral`] gives the thermal displacement of the surface.
//!
//! In time the flux of every window is constant over the window, and contributes over its own ages,
//! from the youngest to the oldest.
//!
//! # Errors
//!
//! The integrals over ages and elements have an error of some 1e-9 of the largest rise. The
//! remaining error is that of the flux: of order 2.5 along x for an elliptic flux, as for the
//! columns, and of second order across.

pub mod ages;
pub mod contact_basis;
pub mod element;
pub mod exchange;
pub mod half_space;
pub mod past;
pub mod rise_integral;
