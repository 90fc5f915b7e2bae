//! The shape of the elements of a row: data for their gradients and hourglass modes.
//!
//! All elements of a row are equal: a quadrilateral of the cross-section, extruded along x over a
//! length, or revolved about an axis over an angle. In the frame of its middle such an element is
//! symmetric in ξ. With the eight Hadamard vectors Γ of the nodes' signs, û_m = Σ_a Γ_m(a) u_a, the
//! mean gradient (Flanagan & Belytschko, Int. J. Numer. Meth. Engng 17 (1981) 679–706)
//! B_ra = ∂V/∂x_ra / V then has ten numbers instead of 24:
//!
//! ∂u/∂x over ξ, ξη, ξζ, ξηζ; ∂u/∂y and ∂u/∂z over η, ζ, ηζ.
//!
//! Deviation from the source: none; ∂V/∂x is integrated with 2×2×2 points, which is exact.

/// Signs of ξ, η, ζ at the nodes; nodes 2p and 2p + 1 are the ends along ξ of corner p of the
/// quadrilateral.
pub const SIGNS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];

/// Modes that are even in ξ: η, ζ, ηζ.
const EVEN: [[bool; 3]; 3] = [[false, true, false], [false, false, true], [false, true, true]];
/// Modes that are odd in ξ: ξ, ξη, ξζ, ξηζ.
const ODD: [[bool; 3]; 4] =
    [[true, false, false], [true, true, false], [true, false, true], [true, true, true]];

/// Shape of the elements of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Volume [m³].
    pub volume: f64,
    /// Coefficients of ∂/∂x for the sums over ξ, ξη, ξζ and ξηζ [1/m].
    pub along: [f64; 4],
    /// Coefficients of ∂/∂y and ∂/∂z for the sums over η, ζ and ηζ [1/m].
    pub across: [[f64; 3]; 2],
    /// Sums of ξη x, ξζ x and ξηζ x [m].
    pub twist: [f64; 3],
    /// Sums of ηζ y and ηζ z [m].
    pub bend: [f64; 2],
    /// Σ B² over the nodes and directions [1/m²].
    pub squares: f64,
    /// Half the angle between the ends of an element [rad]; 0 for a straight body.
    pub half_angle: f64,
}

impl Shape {
    /// Creates the shape of a quadrilateral with corners (y, depth z) [m], in the order η,
    /// ζ = −−, +−, −+, ++. It is extruded over `length` [m] at z = 0: along x, or about an axis
    /// `radius` [m] below.
    #[must_use]
    pub fn new(corners: [[f64; 2]; 4], length: f64, radius: f64) -> Self {
        let places = nodes(corners, length, radius);
        let (gradient, volume) = mean_gradient(&places);
        let sum = |value: &dyn Fn(usize) -> f64, mode: [bool; 3]| -> f64 {
            let sign = |a: usize| -> f64 {
                mode.iter().zip(SIGNS[a]).map(|(has, sign)| if *has { sign } else { 1.0 }).product()
            };
            (0..8).map(|a| sign(a) * value(a)).sum()
        };
        let of_gradient = |r: usize, mode| sum(&|a| gradient[r][a], mode) / 8.0;
        let of_place = |r: usize, mode| sum(&|a| places[a][r], mode);
        Self {
            volume,
            along: ODD.map(|mode| of_gradient(0, mode)),
            across: [1, 2].map(|r| EVEN.map(|mode| of_gradient(r, mode))),
            twist: [ODD[1], ODD[2], ODD[3]].map(|mode| of_place(0, mode)),
            bend: [1, 2].map(|r| of_place(r, EVEN[2])),
            squares: gradient.iter().flatten().map(|b| b * b).sum(),
            half_angle: 0.5 * length / radius,
        }
    }

    /// Coefficients of the mean divergence for the displacements of the near and the far end of the
    /// four corners [1/m], in the directions of the nodes.
    #[must_use]
    pub fn divergence(&self) -> [[[f64; 3]; 4]; 2] {
        let Self { along, across: [by, bz], half_angle, .. } = self;
        let (sine, cosine) = half_angle.sin_cos();
        let of_corner = |corner: usize| {
            let [_, eta, zeta] = SIGNS[corner * 2];
            let even = |b: &[f64; 3]| b[0] * eta + b[1] * zeta + b[2] * eta * zeta;
            let odd = along[0] + along[1] * eta + along[2] * zeta + along[3] * eta * zeta;
            (odd, even(by), even(bz))
        };
        [-1.0, 1.0].map(|end| {
            std::array::from_fn(|corner| {
                let (x, y, z) = of_corner(corner);
                let forward = end * x;
                [cosine * forward + end * sine * z, y, cosine * z - sine * x]
            })
        })
    }
}

/// Positions of the eight nodes in the frame of the element's middle [m]; arguments as in
/// [`Shape::new`].
#[must_use]
pub fn nodes(corners: [[f64; 2]; 4], length: f64, radius: f64) -> [[f64; 3]; 8] {
    let half_angle = 0.5 * length / radius;
    std::array::from_fn(|a| {
        let ([y, z], side) = (corners[a >> 1], SIGNS[a][0]);
        if radius.is_finite() {
            let to_axis = radius - z;
            [side * to_axis * half_angle.sin(), y, radius - to_axis * half_angle.cos()]
        } else {
            [side * 0.5 * length, y, z]
        }
    })
}

/// ∂V/∂x_ra / V [1/m] of a trilinear hexahedron, and its volume V [m³].
fn mean_gradient(places: &[[f64; 3]; 8]) -> ([[f64; 8]; 3], f64) {
    let mut sums = [[0.0; 8]; 3];
    let mut volume = 0.0;
    for point in SIGNS {
        let at = point.map(|sign| sign / 3.0_f64.sqrt());
        // Derivatives of the shape functions with respect to ξ, η and ζ.
        let slopes = SIGNS.map(|sign| {
            let f: [f64; 3] = std::array::from_fn(|k| 1.0 + sign[k] * at[k]);
            [sign[0] * f[1] * f[2], f[0] * sign[1] * f[2], f[0] * f[1] * sign[2]].map(|s| s / 8.0)
        });
        let jacobian: [[f64; 3]; 3] = std::array::from_fn(|r| {
            std::array::from_fn(|c| slopes.iter().zip(places).map(|(s, x)| s[r] * x[c]).sum())
        });
        let cofactor = |r: usize, c: usize| {
            let ([r1, r2], [c1, c2]) = ([(r + 1) % 3, (r + 2) % 3], [(c + 1) % 3, (c + 2) % 3]);
            jacobian[r1][c1] * jacobian[r2][c2] - jacobian[r1][c2] * jacobian[r2][c1]
        };
        volume += (0..3).map(|c| jacobian[0][c] * cofactor(0, c)).sum::<f64>();
        for (c, sums) in sums.iter_mut().enumerate() {
            for (sum, slope) in sums.iter_mut().zip(&slopes) {
                *sum += (0..3).map(|r| cofactor(r, c) * slope[r]).sum::<f64>();
            }
        }
    }
    (sums.map(|sums| sums.map(|sum| sum / volume)), volume)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of the edge h: ∂/∂x = ξ/(4h), Σ B² = 3/(2h²), no twist.
    #[test]
    fn a_cube() {
        let h = 2e-3;
        let shape = Shape::new([[0.0, 0.0], [h, 0.0], [0.0, h], [h, h]], h, f64::INFINITY);
        let near = |one: f64, other: f64| (one - other).abs() <= 1e-13 / h;
        assert!((shape.volume / h.powi(3) - 1.0).abs() < 1e-14);
        assert!(near(shape.along[0], 0.25 / h) && shape.along[1..].iter().all(|b| near(*b, 0.0)));
        assert!(near(shape.across[0][0], 0.25 / h) && near(shape.across[1][1], 0.25 / h));
        assert!((shape.squares * h * h / 1.5 - 1.0).abs() < 1e-13);
        assert!(shape.twist.iter().chain(&shape.bend).all(|sum| sum.abs() < 1e-16));
    }

    /// For linear displacements the divergence is the sum of their slopes, for a straight element
    /// and a wedge. Tolerance: rounding.
    #[test]
    fn divergence_of_linear_displacements() {
        for radius in [f64::INFINITY, 0.05] {
            let corners = [[0.0, 0.0], [2e-3, 1e-4], [0.0, 1.5e-3], [2.2e-3, 1.7e-3]];
            let (length, half) = (1e-3, 0.5e-3 / radius);
            let (shape, places) =
                (Shape::new(corners, length, radius), nodes(corners, length, radius));
            let slopes = [2e-3, -5e-4, 7e-4];
            let mut sum = 0.0;
            for (end, of_end) in shape.divergence().iter().enumerate() {
                let (sine, cosine) = (half * [-1.0, 1.0][end]).sin_cos();
                for (corner, weights) in of_end.iter().enumerate() {
                    let [x, y, z] =
                        std::array::from_fn(|k| slopes[k] * places[2 * corner + end][k]);
                    // Rotates from the directions of the middle to those of the node.
                    let own = [cosine * x + sine * z, y, cosine * z - sine * x];
                    sum += own.iter().zip(weights).map(|(u, weight)| u * weight).sum::<f64>();
                }
            }
            assert!((sum / slopes.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{radius} {sum}");
        }
    }

    /// Volume of a wedge with trapezoidal faces: area times half the sum of the chords. Tolerance:
    /// rounding.
    #[test]
    fn a_wedge_has_its_volume() {
        let (radius, depth, length) = (0.4, 0.1, 0.02);
        let half = 0.5 * length / radius;
        let corners = [[0.0, 0.0], [0.01, 0.0], [0.0, depth], [0.01, depth]];
        let shape = Shape::new(corners, length, radius);
        let area = half.sin() * half.cos() * (radius * radius - (radius - depth).powi(2));
        assert!((shape.volume / (0.01 * area) - 1.0).abs() < 1e-13, "{shape:?}");
    }
}
