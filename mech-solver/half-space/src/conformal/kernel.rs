//! Displacement and traction of an elastic space under forces that vary like a wave along x.
//!
//! A line of forces along x through a point of the plane (y, z), with the components f_j e^{ikx},
//! displaces an infinite elastic body, at the distance (y, z) from the line, by u_i e^{ikx} with
//! u_i = U_ij f_j. U is the transform along x of Kelvin's solution,
//! U_ij = C ½ [(4 − 4ν) δ_ij g − h,ij], C = 1/(8πG(1 − ν)), with the transforms g = 2 K₀(kρ) of 1/R
//! and h of R, whose gradients are h,α = y_α g. Tractions on a plane with the normal n (n_x = 0)
//! are t_i = T_ij f_j,
//!
//! T_ij = C G {2ν n_i g,j + (2 − 2ν)(n_j g,i + δ_ij g,n) − h,ijn}.
//!
//! Components along x carry a factor i, so all numbers are real: u_x = i ũ_x, f_x = i f̃_x.
//!
//! As k → 0 this becomes Kelvin's solution of plane strain, and the solution of antiplane shear.
//!
//! Source: C. A. Brebbia, J. C. F. Telles, L. C. Wrobel, Boundary Element Techniques (1984), §5.2,
//! for Kelvin's solution. The transform is derived here. Tadeu and Kausel, J. Eng. Mech. 126 (2000)
//! 1093, give the dynamic case.

use numerics::bessel::k0_k1;
use std::f64::consts::PI;

/// A 3 × 3 tensor with components x, y, z; rows belong to the displacement or traction.
pub(super) type Tensor = [[f64; 3]; 3];

/// An elastic body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ElasticConstants {
    /// Shear modulus G [Pa].
    pub(super) shear_modulus: f64,
    /// Poisson's ratio ν [-].
    pub(super) poisson_ratio: f64,
}

impl ElasticConstants {
    /// Constants of a material.
    pub(super) fn of(material: &elastic::Material) -> Self {
        let shear_modulus = material.shear_modulus();
        Self { shear_modulus, poisson_ratio: material.poisson_ratio }
    }
}

/// U [1/Pa] and T [1/m] of a wave number k [1/m], at (y, z) [m] from the line, on a plane with this
/// normal. At k = 0 displacements are determined up to a translation.
#[must_use]
pub(super) fn kernel(
    material: &ElasticConstants,
    k: f64,
    [y, z]: [f64; 2],
    normal: [f64; 2],
) -> [Tensor; 2] {
    let nu = material.poisson_ratio;
    let c = 1.0 / (8.0 * PI * material.shear_modulus * (1.0 - nu));
    let cg = 1.0 / (8.0 * PI * (1.0 - nu));
    let square = y * y + z * z;
    let rho = square.sqrt();
    // F = g, G = F'/ρ, H = G'/ρ, and h,xx = −k² h.
    let (f, g, h, h_xx) = if k > 0.0 {
        let [k0, k1] = k0_k1(k * rho);
        let g = -2.0 * k * k1 / rho;
        (2.0 * k0, g, (2.0 * k * k * k0 - 2.0 * g) / square, 2.0 * k * rho * k1)
    } else {
        (-square.ln(), -2.0 / square, 4.0 / (square * square), 2.0)
    };
    let d = [y, z];
    let along = y * normal[0] + z * normal[1];
    let mut u = [[0.0; 3]; 3];
    let mut t = [[0.0; 3]; 3];
    u[0][0] = 0.5 * c * ((4.0 - 4.0 * nu) * f - h_xx);
    t[0][0] = cg * along * ((2.0 - 2.0 * nu) * g + k * k * f);
    for a in 0..2 {
        // ∂x = ik: divided by i if the row is x, multiplied by i if the column is x.
        let u_x = -0.5 * c * k * d[a] * f;
        (u[0][a + 1], u[a + 1][0]) = (u_x, -u_x);
        let shared = normal[a] * f + d[a] * along * g;
        t[0][a + 1] = cg * k * ((2.0 - 2.0 * nu) * normal[a] * f - shared);
        t[a + 1][0] = -cg * k * (2.0 * nu * normal[a] * f - shared);
        for b in 0..2 {
            let same = if a == b { 1.0 } else { 0.0 };
            u[b + 1][a + 1] = 0.5 * c * ((4.0 - 4.0 * nu) * same * f - same * f - d[a] * d[b] * g);
            let third =
                (same * along + d[b] * normal[a] + d[a] * normal[b]) * g + d[a] * d[b] * along * h;
            t[b + 1][a + 1] = cg
                * (2.0 * nu * normal[b] * d[a] * g
                    + (2.0 - 2.0 * nu) * (normal[a] * d[b] * g + same * along * g)
                    - third);
        }
    }
    [u, t]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tractions agree with Hooke's law on differences of the displacements.
    #[test]
    fn tractions_are_those_of_the_displacements() {
        let material = ElasticConstants { shear_modulus: 3.0, poisson_ratio: 0.3 };
        let (at, step) = ([0.7, -0.4], 1e-5);
        let normal = [0.6, 0.8];
        for k in [0.0, 0.3, 2.0] {
            let u = |y: f64, z: f64| kernel(&material, k, [y, z], normal)[0];
            let [y, z] = at;
            let slope = |a: [f64; 2]| {
                let (more, less) =
                    (u(y + step * a[0], z + step * a[1]), u(y - step * a[0], z - step * a[1]));
                move |i: usize, j: usize| (more[i][j] - less[i][j]) / (2.0 * step)
            };
            let (by_y, by_z) = (slope([1.0, 0.0]), slope([0.0, 1.0]));
            let here = u(y, z);
            let [_, t] = kernel(&material, k, at, normal);
            let (g, nu) = (3.0, 0.3);
            for j in 0..3 {
                // Strain over i for mixed components: d/dx of u_x = i·i k ũ_x.
                let d = |i: usize, l: usize| match l {
                    0 if i == 0 => -k * here[0][j],
                    0 => k * here[i][j],
                    1 => by_y(i, j),
                    _ => by_z(i, j),
                };
                let divergence = d(0, 0) + d(1, 1) + d(2, 2);
                for (i, exact) in t.iter().map(|row| row[j]).enumerate() {
                    let stress = |l: usize| {
                        let same =
                            if i == l { 2.0 * nu / (1.0 - 2.0 * nu) * divergence } else { 0.0 };
                        g * (same + d(i, l) + d(l, i))
                    };
                    let traction = stress(1) * normal[0] + stress(2) * normal[1];
                    assert!((traction - exact).abs() < 1e-8, "k = {k}, {i}{j}: {traction} {exact}");
                }
            }
        }
    }
}
