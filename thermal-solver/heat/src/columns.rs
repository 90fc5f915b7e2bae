//! Heat conduction normal to the surface: every column of material on its own.
//!
//! # Equation
//!
//! A column of material passes under the contact at the surface speed V and conducts heat along z
//! only (valid for Pe = Va/(2κ) ≫ 1, Ertz & Knothe, Wear 253 (2002) 498–508). With the heat flux
//! q [W/m²] into the body, the effusivity β and the diffusivity κ, its temperature rise at the
//! distance z from the surface is, by Duhamel's principle (Carslaw & Jaeger, 2.9),
//!
//! T(x, z, t) = 1/(β√π) ∫₀^∞ q(x + s(τ), t − τ) exp(−z²/(4κτ)) dτ/√τ,  s(τ) = ∫₀^τ V.
//!
//! τ is the age: a time τ ago the material now at x was at x + s, upstream. In steady motion
//! s = Vτ gives the Abel integral 1/(β√(πV)) ∫ₓ^∞ q(x') dx'/√(x' − x) of the paper's equations 7
//! and 8.
//!
//! # Discretisation
//!
//! The flux arrives as means over elements and over windows of time. [`reconstruction`] turns the
//! means into a continuous, piecewise parabolic flux that has the same means and is nowhere
//! negative where they are not; [`moments`] integrates it against the kernel in closed form, the
//! element of the point itself included; [`stencil`] collects the weights, which are the same for
//! every point of the grid, and [`convolution`] applies them. In steady motion there is one
//! stencil for both bodies, whatever their speeds, since √(h/V) comes out of the integral (h is
//! the element length); long rows take the way over [`spectral`]. In transient motion
//! [`history`] keeps the flux of earlier windows along the way the material has come, and the
//! integral is exact for the reconstructed flux, held constant over each window.
//!
//! # Errors
//!
//! Where the flux is smooth, the parabola's error is of third order and without a mean, so that
//! the temperature's is of order h^3.5 in the near field and h⁴ from afar. At an edge where the
//! flux sets in like a square root the first moment of the end element is wrong by O(h^2.5), and
//! so is the temperature some way downstream: order 2.5 is expected for elliptic fluxes. At a jump
//! of the flux the order is 2. Windows shorter than what the grid resolves are merged, see
//! [`history`].

pub mod convolution;
pub mod history;
pub mod moments;
pub mod reconstruction;
pub mod spectral;
pub mod stencil;
