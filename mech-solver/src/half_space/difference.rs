//! The difference that makes the slip of steady rolling of displacements.
//!
//! In steady rolling a surface keeps its shape in the frame of the contact, and a particle's slip over the distance
//! rolled is s = w − ∂u/∂x, with the displacement difference u of the bodies and x in the direction of rolling. On
//! elements of side Δx the derivative is a sum over neighbours, u_m that of the element m places upstream:
//!
//! | | Δx s_I − Δx w_I | error | where it holds |
//! |---|---|---|---|
//! | upwind | u_0 − u_1 | first order | between the element and the upstream one |
//! | Fromm | (u_{−1} + 3u_0 − 5u_1 + u_2)/4 | second order | at the element's centre |
//!
//! Fromm's is the mean of the central difference, which does not see tractions that alternate from element to element, and of the
//! second-order upwind one, which damps them most. In Fourier space it is (1 − S)(S⁻¹ + 4 − S)/4 with the upstream shift S = e^{iθ}.
//!
//! **What the difference takes.** Tractions p do the work Σ p·s on the slip; the antisymmetric part of the difference drops out
//! of it, as u = A p with a symmetric A. The symmetric part stays. With δ² the second difference along x it is (δ²)²/8 for Fromm's, so that
//!
//! −Σ p·w Δx = −Σ p·s Δx + ⅛ Σ (δ²p)·A(δ²p),
//!
//! ([`super::scheme`]), which smooth tractions make of fourth order in Δx. With the upwind difference the mean of the tractions at both ends of a step is
//! taken instead, and nothing is lost ([`super::tangential`]).
//!
//! Source: J. E. Fromm, J. Comput. Phys. 3 (1968) 176, for the difference. Its use in rolling contact is this project's.

use serde::Deserialize;

/// A difference along the direction of rolling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Difference {
    /// Of second order.
    Fromm,
    /// Of first order, as CONTACT has it.
    #[default]
    Upwind,
}

impl Difference {
    /// Elements upstream, and the weights of their displacements in the slip.
    #[must_use]
    pub fn weights(self) -> &'static [(i32, f64)] {
        match self {
            Self::Fromm => &[(-1, 0.25), (0, 0.75), (1, -1.25), (2, 0.25)],
            Self::Upwind => &[(0, 1.0), (1, -1.0)],
        }
    }

    /// The weights a_m of u_{I−m} − u_{I+m}, m = 1 and 2, in the antisymmetric part.
    #[must_use]
    pub fn antisymmetric(self) -> [f64; 2] {
        match self {
            Self::Fromm => [0.75, -0.125],
            Self::Upwind => [0.5, 0.0],
        }
    }

    /// The difference of what a kernel gives so many elements upstream.
    pub(super) fn of<const N: usize>(self, kernel: impl Fn(i32) -> [f64; N]) -> [f64; N] {
        self.weights().iter().fold([0.0; N], |mut sum, (upstream, weight)| {
            sum.iter_mut().zip(kernel(*upstream)).for_each(|(sum, value)| *sum += weight * value);
            sum
        })
    }

    /// The traction that does the work of an element's slip, in rows of nx elements [Pa].
    #[must_use]
    pub fn working(self, traction: &[f64], nx: usize, index: usize) -> f64 {
        match self {
            Self::Fromm => traction[index],
            Self::Upwind if (index + 1).is_multiple_of(nx) => 0.5 * traction[index],
            Self::Upwind => 0.5 * (traction[index] + traction[index + 1]),
        }
    }

    /// The difference of displacements in rows of nx elements; zero where it would reach beyond them [m].
    #[must_use]
    pub fn along(self, displacement: &[f64], nx: usize, index: usize) -> f64 {
        let column = (index % nx) as i64;
        let within = |m: i32| (0..nx as i64).contains(&(column + i64::from(m)));
        if !self.weights().iter().all(|(m, _)| within(*m)) {
            return 0.0;
        }
        self.weights()
            .iter()
            .map(|(m, w)| w * displacement[(index as i64 + i64::from(*m)) as usize])
            .sum()
    }

    /// Where slip and friction power of an element are, ahead of its centre [elements].
    #[must_use]
    pub fn middle(self) -> f64 {
        match self {
            Self::Fromm => 0.0,
            Self::Upwind => 0.5,
        }
    }

    /// Where the rigid slip of an element is taken, ahead of its centre [elements]. The upwind difference's elastic slip is that of the
    /// middle of a step, and the traction that it turns against that of its end: in between, errors of forces under spin nearly cancel
    /// (docs/theory/half-space.md). CONTACT has the same.
    #[must_use]
    pub fn rigid_slip_ahead(self) -> f64 {
        match self {
            Self::Fromm => 0.0,
            Self::Upwind => 1.0 / 6.0,
        }
    }
}
