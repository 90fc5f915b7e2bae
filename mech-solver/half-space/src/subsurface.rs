//! Stresses inside an elastic half-space under piecewise constant tractions.
//!
//! Frame: the body fills z ≥ 0, so z is the depth into it; the pressure p and the tractions q_x,
//! q_y act *on this body*, p > 0 presses (along +z). Stresses are positive in tension. At a loaded
//! surface σ_zz = −p, σ_xz = −q_x, σ_yz = −q_y. For the upper body this is the frame of the project
//! with unchanged tractions. For the lower body, where −q acts and z points down, take −q_x and
//! −q_y; in the project's frame its σ_xz and σ_yz then change sign, while invariants stay the same.
//!
//! The stress at (x, y, z) = (x₁, x₂, x₃) from a force P at the origin, R² = x² + y² + z², is
//!
//! 2π σ_ij = −3 x_i x_j (x·P)/R⁵ + (1 − 2ν) A_ij.
//!
//! The first part is the solution of an incompressible body, which is radial. The second is a plane
//! part that vanishes for i or j = z and has Airy's function φ: A_xx = ∂²φ/∂y², A_yy = ∂²φ/∂x²,
//! A_xy = −∂²φ/∂x∂y with φ = P_z ln(R + z) + (P_x ∂/∂x + P_y ∂/∂y)(z ln(R + z) − R), the function
//! ψ₁ of Johnson.
//!
//! For a uniform traction on a rectangle the kernels are integrated over the rectangle, as corner
//! sums F(x₊, y₊) − F(x₊, y₋) − F(x₋, y₊) + F(x₋, y₋) with ∂²F/∂X∂Y the kernel, R² = X² + Y² + z²,
//! Λ_x = asinh(X/√(Y² + z²)), α_x = arctan(XY(R − z)/(X²R + Y²z)), and Λ_y, α_y with X, Y swapped:
//!
//! | kernel | F |
//! |---|---|
//! | −3X³/R⁵ | 2Λ_y + X²Y/(R(X² + z²)) |
//! | −3X²Y/R⁵ | Λ_x − X/R |
//! | −3X²z/R⁵ | XYz/(R(X² + z²)) − α_x − α_y |
//! | −3XYz/R⁵ | −z/R |
//! | −3Xz²/R⁵ | Yz²/(R(X² + z²)) |
//! | −3z³/R⁵ | −XYz/R·[1/(X² + z²) + 1/(Y² + z²)] − α_x − α_y |
//! | ∂²/∂X², ∂²/∂X∂Y of ln(R + z) | α_x, ln(R + z) |
//! | ∂³/∂X³ of z ln(R + z) − R | Y/(R + z) − Λ_y |
//! | ∂³/∂X²∂Y of the same | −X/(R + z) |
//!
//! and likewise with X, Y swapped. Terms of a single variable cancel and are omitted. α_x combines
//! the difference of two arctangents, arctan(Y/X) − arctan(Yz/XR), in one;
//! α_x + α_y = arctan(XY/(Rz)).
//!
//! Accuracy: corner sums lose digits with the square of the distance in elements. Beyond 16 of the
//! longer sides [`Element::at`] uses Gauss's rule with 4 × 4 points. Each number is right to 3e-12
//! of the largest stress by the same load at its distance. A [`Section`] uses corner sums only,
//! right to about 1e-13 of the largest traction.
//!
//! Source: K. L. Johnson, Contact Mechanics (1985), §3.2 (potentials), §3.4 and §3.6; A. E. H.
//! Love, Phil. Trans. R. Soc. A 228 (1929), for pressure. Deviation: the split into a radial and a
//! plane part, and antiderivatives without the cancellation of ln(R + X) at X < 0.

mod element;
mod peak;
mod points;
mod section;
mod thermal;

pub use element::{Element, UnitStresses};
pub use peak::Peak;
pub use points::Nodes;
pub use section::{Section, SectionCost};
pub use thermal::{RiseIntegral, WarmBody};

use elastic::Stress;
use grids::Structured;

/// Pressure and tractions on a body, constant on each element of a grid in the contact plane.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceLoad<'a> {
    grid: &'a Structured,
    /// Fields p, q_x, q_y; an empty slice is zero.
    fields: [&'a [f64]; 3],
}

impl<'a> SurfaceLoad<'a> {
    /// Creates a load. `pressure` has a value for each element [Pa]. `traction` holds all x
    /// components, then all y components [Pa]; if empty, there is no traction.
    ///
    /// # Panics
    /// If a length does not match the grid.
    #[must_use]
    pub fn new(grid: &'a Structured, pressure: &'a [f64], traction: &'a [f64]) -> Self {
        let points = grid.points();
        assert!(
            pressure.len() == points && (traction.is_empty() || traction.len() == 2 * points),
            "{} pressures and {} tractions on {points} elements",
            pressure.len(),
            traction.len()
        );
        let (along_x, along_y) = traction.split_at(traction.len() / 2);
        Self { grid, fields: [pressure, along_x, along_y] }
    }

    /// p, q_x, q_y of an element [Pa].
    fn on_element(&self, index: usize) -> [f64; 3] {
        self.fields.map(|field| field.get(index).copied().unwrap_or(0.0))
    }

    /// Stresses at arbitrary points (x, y, depth) [m], by summation over the loaded elements. For
    /// many points, [`Section`] (vertical sections) and [`SurfaceLoad::on_lattice`] (planes and
    /// boxes) are far faster.
    ///
    /// # Panics
    /// If a depth is negative.
    #[must_use]
    pub fn stresses_at(&self, poisson_ratio: f64, points: &[[f64; 3]]) -> Vec<Stress> {
        let element = Element { dx: self.grid.dx(), dy: self.grid.dy(), poisson_ratio };
        let elements = (0..self.grid.points()).map(|index| {
            let centre = self.grid.centre(index % self.grid.ni, index / self.grid.ni);
            (centre, self.on_element(index))
        });
        let loaded: Vec<_> = elements.filter(|(_, load)| *load != [0.0; 3]).collect();
        let at = |&[x, y, depth]: &[f64; 3]| {
            assert!(depth >= 0.0, "a depth of {depth} m is outside the body");
            let by = |(centre, [pressure, along_x, along_y]): &([f64; 3], [f64; 3])| {
                let units = element.at(x - centre[0], y - centre[1], depth);
                units.under(*pressure, [*along_x, *along_y])
            };
            loaded.iter().map(by).sum()
        };
        points.iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests;
