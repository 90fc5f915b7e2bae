//! Closed forms shared by tests, reports and documentation.
//!
//! | module | content |
//! |---|---|
//! | [`scales`] | effusivity, Péclet number, penetration depth (equations 1, 2, 6) |
//! | [`polynomial`] | polynomial approximation of the elliptic heat flux (equations 9–12), in depth |
//! | [`ellipse`] | the exact elliptic heat flux, by quadrature |
//! | [`uniform`] | uniform heat flux: in time (Jaeger) and over the contact, in depth (13–15) |
//!
//! Equations are numbered as in Naeimi et al., "Computation of the flash-temperature at the
//! wheel–rail contact using a 3D finite element model and its comparison with analytical methods".
//! The paper's analysis follows Ertz & Knothe, "A comparison of analytical and numerical methods
//! for the calculation of temperatures in wheel/rail contact", Wear 253 (2002) 498–508.
//!
//! The dimensionless coordinate ξ runs with the material: the leading edge is ξ = −1, so that
//! x/a = −ξ in the frame of this project. The depth is ζ = z/δ with δ = a/√Pe. Deviations from the
//! printed text, each with a test that fails for the printed form:
//!
//! - (6): β = λ/√κ = √(λρc), printed λ/κ, which has another unit ([`scales::effusivity`]);
//! - (8): the rail's own speed V_r = V_0, the wheel's V_w = V_0 + V_s ([`polynomial::rise`]);
//! - (11), (12): the labels are swapped; one root inside the contact, both behind it, nothing
//!   ahead of it ([`polynomial::surface`]).

pub mod ellipse;
pub mod polynomial;
pub mod scales;
pub mod uniform;
