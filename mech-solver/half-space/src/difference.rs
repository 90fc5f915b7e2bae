//! Differences of displacements along x: the elastic slip of steady rolling.
//!
//! In steady rolling the surfaces keep their shape in the frame of the contact. The slip over the
//! distance rolled is s = w − ∂u/∂x, with the rigid slip w and the displacement difference u of the
//! bodies. The derivative is a sum over neighbours, u_m that of the element m places upstream:
//!
//! | | Δx (s_I − w_I) | order | where it holds |
//! |---|---|---|---|
//! | upwind | u_0 − u_1 | 1 | half an element upstream of the centre |
//! | Fromm | (u_{−1} + 3u_0 − 5u_1 + u_2)/4 | 2 | at the centre |
//!
//! Fromm's difference is the mean of the central and the second-order upwind difference. The
//! central difference alone does not see tractions that alternate from element to element. With the
//! upstream shift S the difference is (1 − S)(S⁻¹ + 4 − S)/4.
//!
//! **Energy.** Tractions p do the work Σ p·s. The displacement u = A p has a symmetric A, so the
//! antisymmetric part of the difference does no work. The symmetric part of Fromm's difference is
//! (δ²)²/8, with the second difference δ² along x:
//!
//! −Σ p·w Δx = −Σ p·s Δx + ⅛ Σ (δ²p)·A(δ²p).
//!
//! The last term is the numerical dissipation ([`super::dissipation`]). Where tractions are smooth
//! it falls with Δx⁴. With the upwind difference the mean of the tractions at both ends of a step
//! does the work, and there is no dissipation ([`super::tangential`]).
//!
//! **In time.** In transient rolling an element's displacement also changes in time. With the
//! displacements u' and u'' one and two steps of Δx/V ago, the slip with the second-order backward
//! difference is
//!
//! Δx (s − w) = Δx ∂u/∂x + (3u − 4u' + u'')/2,
//!
//! so that the steady state equals that of steady rolling on the same grid. Over the area of an
//! element, tractions p with this slip do the work −p·s Δx = −p·w Δx − (E − E') − ⅛ δ²p·A δ²p
//! − ¼ δ_t²p·A δ_t²p, with the elastic energy E = ¼ (p·A p + (2p − p')·A(2p − p')), and
//! δ_t²p = p − 2p' + p''.
//!
//! Source: J. E. Fromm, J. Comput. Phys. 3 (1968) 176, for the difference. For the energy of the
//! backward difference: C. W. Gear, Numerical Initial Value Problems (1971), G. Dahlquist, BIT 18
//! (1978) 384. The application to rolling contact is this project's.

/// A difference along the direction of rolling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Difference {
    /// Second order.
    #[default]
    Fromm,
    /// First order, as in CONTACT.
    Upwind,
}

impl Difference {
    /// Positions upstream, in elements, and the weights of the displacements there.
    #[must_use]
    pub fn weights(self) -> &'static [(i32, f64)] {
        match self {
            Self::Fromm => &[(-1, 0.25), (0, 0.75), (1, -1.25), (2, 0.25)],
            Self::Upwind => &[(0, 1.0), (1, -1.0)],
        }
    }

    /// Weights a_m of u_{I−m} − u_{I+m}, m = 1 and 2, in the antisymmetric part.
    #[must_use]
    pub fn antisymmetric(self) -> [f64; 2] {
        let weight = |place: i32| -> f64 {
            self.weights().iter().filter(|(m, _)| *m == place).map(|(_, weight)| weight).sum()
        };
        [1, 2].map(|m| 0.5 * (weight(-m) - weight(m)))
    }

    /// Traction that does work on the slip of an element, in rows of nx elements [Pa].
    #[must_use]
    pub fn working(self, traction: &[f64], nx: usize, index: usize) -> f64 {
        match self {
            Self::Fromm => traction[index],
            Self::Upwind if (index + 1).is_multiple_of(nx) => 0.5 * traction[index],
            Self::Upwind => 0.5 * (traction[index] + traction[index + 1]),
        }
    }

    /// Difference of displacements in rows of nx elements [m]. Next to the ends of a row, where a
    /// neighbour is missing and nothing touches, the result is zero.
    #[must_use]
    pub fn along(self, displacement: &[f64], nx: usize, index: usize) -> f64 {
        let (row, column) = (index - index % nx, (index % nx) as i64);
        let neighbour = |m: i32| usize::try_from(column + i64::from(m)).ok().filter(|i| *i < nx);
        if self.weights().iter().any(|(m, _)| neighbour(*m).is_none()) {
            return 0.0;
        }
        let stencil = Stencil { along: Some(self), own: 0.0 };
        let [sum] = stencil.of(|m| [neighbour(m).map_or(0.0, |i| displacement[row + i])]);
        sum
    }

    /// Position of an element's slip and friction power, upstream of its centre [elements].
    #[must_use]
    pub fn middle(self) -> f64 {
        match self {
            Self::Fromm => 0.0,
            Self::Upwind => 0.5,
        }
    }

    /// Position at which an element's rigid slip is taken, upstream of its centre [elements].
    ///
    /// The upwind difference is the elastic slip in the middle of a step, and turns the traction at
    /// the end of the step. In between, the errors of forces under spin nearly cancel
    /// (docs/theory/half-space.md). CONTACT uses the same position.
    #[must_use]
    pub fn rigid_slip_ahead(self) -> f64 {
        match self {
            Self::Fromm => 0.0,
            Self::Upwind => 1.0 / 6.0,
        }
    }
}

/// Slip as a combination of a difference of displacements along x and the displacement itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stencil {
    /// Difference along x, if the bodies roll.
    pub along: Option<Difference>,
    /// Weight of the displacement of the element itself.
    pub own: f64,
}

impl Stencil {
    /// Stencil of the displacement itself.
    pub const DISPLACEMENT: Self = Self { along: None, own: 1.0 };

    /// Positions upstream, in elements, and the weights of the displacements there.
    pub(super) fn weights(self) -> impl Iterator<Item = (i32, f64)> {
        let along = self.along.map_or(&[][..], Difference::weights).iter().copied();
        let own = (self.own != 0.0).then_some((0, self.own));
        along.chain(own)
    }

    /// Applies the stencil to displacements given as a function of the position upstream.
    pub(super) fn of<const N: usize>(self, value: impl Fn(i32) -> [f64; N]) -> [f64; N] {
        self.weights().fold([0.0; N], |mut sum, (upstream, weight)| {
            sum.iter_mut().zip(value(upstream)).for_each(|(sum, value)| *sum += weight * value);
            sum
        })
    }
}
