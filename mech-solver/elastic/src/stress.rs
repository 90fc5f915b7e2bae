//! Stress tensor, its invariants and equivalent stresses.

use std::ops::{Add, Mul, Sub};

/// Symmetric stress tensor at a point, tension positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stress {
    /// Normal stress along x [Pa].
    pub xx: f64,
    /// Normal stress along y [Pa].
    pub yy: f64,
    /// Normal stress along the depth [Pa].
    pub zz: f64,
    /// Shear stress in the plane of y and z [Pa].
    pub yz: f64,
    /// Shear stress in the plane of x and z [Pa].
    pub xz: f64,
    /// Shear stress in the plane of x and y [Pa].
    pub xy: f64,
}

/// Applies a function to every component of one or two tensors.
macro_rules! by_component {
    ($function:expr; $($tensor:ident),+) => {
        Stress {
            xx: $function($($tensor.xx),+),
            yy: $function($($tensor.yy),+),
            zz: $function($($tensor.zz),+),
            yz: $function($($tensor.yz),+),
            xz: $function($($tensor.xz),+),
            xy: $function($($tensor.xy),+),
        }
    };
}

impl Stress {
    /// The components xx, yy, zz, yz, xz, xy [Pa].
    #[must_use]
    pub fn components(&self) -> [f64; 6] {
        [self.xx, self.yy, self.zz, self.yz, self.xz, self.xy]
    }

    /// Mean normal stress, a third of the trace [Pa].
    #[must_use]
    pub fn mean(&self) -> f64 {
        (self.xx + self.yy + self.zz) / 3.0
    }

    /// Equivalent stress of von Mises, √(3 J₂) [Pa]: equal to the stress in uniaxial tension, and
    /// to √3 times the stress in pure shear.
    #[must_use]
    pub fn von_mises(&self) -> f64 {
        let normal = [self.xx - self.yy, self.yy - self.zz, self.zz - self.xx];
        let shear = [self.yz, self.xz, self.xy];
        let square = |values: [f64; 3]| values.iter().map(|value| value * value).sum::<f64>();
        (0.5 * square(normal) + 3.0 * square(shear)).sqrt()
    }

    /// Largest shear stress on any plane, half the difference of the extreme principal stresses
    /// [Pa].
    #[must_use]
    pub fn max_shear(&self) -> f64 {
        let [largest, _, smallest] = self.principal();
        0.5 * (largest - smallest)
    }

    /// Principal stresses in descending order [Pa].
    #[must_use]
    pub fn principal(&self) -> [f64; 3] {
        self.principal_directions().map(|(value, _)| value)
    }

    /// Principal stresses in descending order [Pa], with the unit vectors of their directions. The
    /// signs of the vectors are arbitrary; for two equal stresses the directions are any two across
    /// the third.
    ///
    /// Uses Jacobi rotations on the deviator, accurate to a few units in the last place of its
    /// largest value, even for equal principal stresses or a large mean stress. The closed form
    /// with the Lode angle loses half of the digits where two are equal, as on the axis of a round
    /// contact.
    #[must_use]
    pub fn principal_directions(&self) -> [(f64, [f64; 3]); 3] {
        const SWEEPS: usize = 8;
        let mean = self.mean();
        let mut matrix = [
            [self.xx - mean, self.xy, self.xz],
            [self.xy, self.yy - mean, self.yz],
            [self.xz, self.yz, self.zz - mean],
        ];
        let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for _ in 0..SWEEPS {
            for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
                rotate(&mut matrix, &mut axes, p, q, r);
            }
            if [matrix[0][1], matrix[0][2], matrix[1][2]] == [0.0; 3] {
                break;
            }
        }
        let mut found = [0, 1, 2].map(|axis| (matrix[axis][axis] + mean, axes[axis]));
        found.sort_by(|one, other| other.0.total_cmp(&one.0));
        found
    }
}

/// One Jacobi rotation, after which element (p, q) of the symmetric matrix is zero. r is the third
/// axis; `axes` turn too.
fn rotate(matrix: &mut [[f64; 3]; 3], axes: &mut [[f64; 3]; 3], p: usize, q: usize, r: usize) {
    let off = matrix[p][q];
    if off == 0.0 {
        return;
    }
    let cotangent = 0.5 * (matrix[q][q] - matrix[p][p]) / off;
    let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    matrix[p][p] -= tangent * off;
    matrix[q][q] += tangent * off;
    let (with_p, with_q) = (matrix[r][p], matrix[r][q]);
    let turned = (cosine * with_p - sine * with_q, sine * with_p + cosine * with_q);
    (matrix[r][p], matrix[p][r]) = (turned.0, turned.0);
    (matrix[r][q], matrix[q][r]) = (turned.1, turned.1);
    (matrix[p][q], matrix[q][p]) = (0.0, 0.0);
    let (of_p, of_q) = (axes[p], axes[q]);
    axes[p] = std::array::from_fn(|k| cosine * of_p[k] - sine * of_q[k]);
    axes[q] = std::array::from_fn(|k| sine * of_p[k] + cosine * of_q[k]);
}

impl Add for Stress {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        by_component!(|a: f64, b: f64| a + b; self, other)
    }
}

impl Sub for Stress {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        by_component!(|a: f64, b: f64| a - b; self, other)
    }
}

impl Mul<Stress> for f64 {
    type Output = Stress;

    fn mul(self, tensor: Stress) -> Stress {
        by_component!(|value: f64| self * value; tensor)
    }
}

impl std::iter::Sum for Stress {
    fn sum<I: Iterator<Item = Self>>(tensors: I) -> Self {
        tensors.fold(Self::default(), |sum, tensor| sum + tensor)
    }
}
