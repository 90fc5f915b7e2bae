//! Heat conduction normal to the surface: columns of material without lateral conduction.
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
//! The flux is given as means over elements and over windows of time. [`reconstruction`] turns the
//! means into a continuous, piecewise parabolic flux with the same means, which is nowhere negative
//! where no mean is negative. [`moments`] integrates this flux against the kernel in closed form,
//! also over the element that contains the point. [`stencil`] collects the weights, which are the
//! same for every point of the grid, and [`convolution`] applies them. In steady motion one stencil
//! serves both bodies at any speed, since √(h/V) is a factor of the integral (h is the element
//! length); long rows use [`spectral`]. In transient motion [`history`] keeps the flux of earlier
//! windows along the path of the material. The integral is exact for the reconstructed flux, held
//! constant over each window.
//!
//! # Errors
//!
//! For a smooth flux, the error of the parabola is of third order and has zero mean. The error of
//! the temperature is therefore of order h^3.5 in the near field and h⁴ far away. At an edge where
//! the flux begins like a square root, the first moment of the end element has an error of
//! O(h^2.5), and so has the temperature for some distance downstream: order 2.5 is expected for
//! elliptic fluxes. At a jump of the flux the order is 2. Windows shorter than the grid can resolve
//! are merged, see [`history`].

pub mod convolution;
pub mod history;
pub mod moments;
pub mod reconstruction;
pub mod spectral;
pub mod stencil;
