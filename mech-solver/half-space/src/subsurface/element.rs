//! Stresses below one rectangle under uniform tractions; see the equations in [`super`].

use elastic::Stress;
use numerics::quadrature::GAUSS_4;
use std::f64::consts::{E, PI};

/// Distance, in units of the rectangle's longer side, from which Gauss's rule is used.
const FAR: f64 = 16.0;

/// Distance from an edge, in units of a side, below which a point counts as on the edge.
const ON_EDGE: f64 = 1e-9;

/// Term added under roots to avoid a case distinction on the edges of the rectangle [m²].
const TINY: f64 = 1e-300;

/// Stresses by a unit of pressure, of traction along x and of traction along y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UnitStresses {
    /// By pressure [-].
    pub pressure: Stress,
    /// By traction along x [-].
    pub traction_x: Stress,
    /// By traction along y [-].
    pub traction_y: Stress,
}

impl UnitStresses {
    /// Stress under a pressure and tractions along x and y [Pa].
    #[must_use]
    pub fn under(&self, pressure: f64, traction: [f64; 2]) -> Stress {
        let [along_x, along_y] = traction;
        pressure * self.pressure + along_x * self.traction_x + along_y * self.traction_y
    }

    /// Components by each load, in the order of [`Stress::components`].
    pub(super) fn components(&self) -> [[f64; 6]; 3] {
        [self.pressure, self.traction_x, self.traction_y].map(|stress| stress.components())
    }

    /// `self` + `factor` · `other`.
    pub(super) fn plus(self, factor: f64, other: &Self) -> Self {
        Self {
            pressure: self.pressure + factor * other.pressure,
            traction_x: self.traction_x + factor * other.traction_x,
            traction_y: self.traction_y + factor * other.traction_y,
        }
    }
}

/// A rectangle on the surface of a half-space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Side along x [m].
    pub dx: f64,
    /// Side along y [m].
    pub dy: f64,
    /// Poisson's ratio of the body [-].
    pub poisson_ratio: f64,
}

impl Element {
    /// Stresses at (x, y) from the centre of the rectangle, z ≥ 0 below the surface [m], for unit
    /// tractions on it [-].
    ///
    /// Values at z = 0 are the limits from inside the body; on the edges, the mean of the limits of
    /// both sides. Λ and the other logarithm are infinite on edges and corners, where uniform
    /// tractions end abruptly. They are replaced by their mean over half an element around the
    /// point, which cancels between neighbours of equal traction.
    #[must_use]
    pub fn at(&self, x: f64, y: f64, z: f64) -> UnitStresses {
        let (half_x, half_y) = (0.5 * self.dx, 0.5 * self.dy);
        let far = FAR * self.dx.max(self.dy);
        if x * x + y * y + z * z > far * far {
            return self.by_quadrature(x, y, z);
        }
        let edge = |x: f64| {
            let low = self.corner(x, y - half_y, z);
            self.corner(x, y + half_y, z).plus(-1.0, &low)
        };
        edge(x + half_x).plus(-1.0, &edge(x - half_x))
    }

    /// Stresses by Gauss's rule over the rectangle.
    fn by_quadrature(&self, x: f64, y: f64, z: f64) -> UnitStresses {
        let mut sum = UnitStresses::default();
        for (s, weight_x) in GAUSS_4 {
            for (t, weight_y) in GAUSS_4 {
                let (x, y) = (x + 0.5 * s * self.dx, y + 0.5 * t * self.dy);
                let weight = 0.25 * weight_x * weight_y * self.dx * self.dy;
                sum = sum.plus(weight, &point_load(self.poisson_ratio, x, y, z));
            }
        }
        sum
    }

    /// Antiderivatives in x and y of the stresses by point loads.
    pub(super) fn corner(&self, x: f64, y: f64, z: f64) -> UnitStresses {
        let across_x = (x * x + z * z + TINY).sqrt();
        let across_y = (y * y + z * z + TINY).sqrt();
        let (x, log_x) = off_edge(x, across_x, self.dx);
        let (y, log_y) = off_edge(y, across_y, self.dy);
        let distance = (x * x + y * y + z * z + TINY).sqrt();
        let (_, log_distance) = off_edge(0.0, distance, self.dx.min(self.dy));
        let (cos_x, cos_y, cos_z) = (x / distance, y / distance, z / distance);
        let (slope_x, slope_y) = (x / (distance + z), y / (distance + z));
        let along_x = odd_logarithm(x, distance, log_y);
        let along_y = odd_logarithm(y, distance, log_x);
        let lift = x * y * (slope_x * x + slope_y * y);
        let angle_x = lift.atan2(x * x * distance + z * y * y);
        let angle_y = lift.atan2(y * y * distance + z * x * x);
        let solid = angle_x + angle_y;
        let (depth_x, depth_y) = ((z / across_x).powi(2), (z / across_y).powi(2));
        let wing_x = cos_y * (z / across_x) * (x / across_x);
        let wing_y = cos_x * (z / across_y) * (y / across_y);
        let radial = Radial {
            xxx: 2.0 * along_y + cos_y * (1.0 - depth_x),
            yyy: 2.0 * along_x + cos_x * (1.0 - depth_y),
            zzz: -wing_x - wing_y - solid,
            xxy: along_x - cos_x,
            xyy: along_y - cos_y,
            xxz: wing_x - solid,
            yyz: wing_y - solid,
            xzz: cos_y * depth_x,
            yzz: cos_x * depth_y,
            xyz: -cos_z,
        };
        let plane = [
            [angle_y, angle_x, -(log_distance + z).ln()],
            [-slope_y, slope_y - along_y, slope_x],
            [slope_x - along_x, -slope_x, slope_y],
        ];
        radial.with_plane(self.poisson_ratio, plane)
    }
}

/// Radial part of the stresses, −3 x_i x_j x_k/R⁵ or an antiderivative of it. The third index
/// belongs to the load; all three may be exchanged.
struct Radial {
    xxx: f64,
    yyy: f64,
    zzz: f64,
    xxy: f64,
    xyy: f64,
    xxz: f64,
    yyz: f64,
    xzz: f64,
    yzz: f64,
    xyz: f64,
}

impl Radial {
    /// Stresses from the radial parts and the `plane` parts A_xx, A_yy, A_xy of each load.
    fn with_plane(&self, poisson_ratio: f64, plane: [[f64; 3]; 3]) -> UnitStresses {
        let Self { xxx, yyy, zzz, xxy, xyy, xxz, yyz, xzz, yzz, xyz } = *self;
        let unit = 0.5 / PI;
        let share = (1.0 - 2.0 * poisson_ratio) * unit;
        let stress = |[xx, yy, zz, yz, xz, xy]: [f64; 6], [a_xx, a_yy, a_xy]: [f64; 3]| Stress {
            xx: unit * xx + share * a_xx,
            yy: unit * yy + share * a_yy,
            zz: unit * zz,
            yz: unit * yz,
            xz: unit * xz,
            xy: unit * xy + share * a_xy,
        };
        UnitStresses {
            pressure: stress([xxz, yyz, zzz, yzz, xzz, xyz], plane[0]),
            traction_x: stress([xxx, xyy, xzz, xyz, xxz, xxy], plane[1]),
            traction_y: stress([xxy, yyy, yzz, yyz, xyz, xyy], plane[2]),
        }
    }
}

/// Λ = asinh(t/across) with R = √(t² + across²); odd in t.
fn odd_logarithm(t: f64, distance: f64, across: f64) -> f64 {
    if t == 0.0 { 0.0 } else { ((distance + t.abs()) / across).ln().copysign(t) }
}

/// Coordinate and distance from the edge where the coordinate is zero, as arguments of logarithms.
/// On the edge the coordinate is zero and the distance is the one whose logarithm is the mean of ln
/// |t| over |t| < `side`/2.
fn off_edge(coordinate: f64, distance: f64, side: f64) -> (f64, f64) {
    if distance < ON_EDGE * side { (0.0, 0.5 * side / E) } else { (coordinate, distance) }
}

/// Stresses at (x, y, z) from unit forces at the origin [1/m²]: Boussinesq's and Cerruti's
/// solutions in the form of [`super`], with s = 1/(R + z).
fn point_load(poisson_ratio: f64, x: f64, y: f64, z: f64) -> UnitStresses {
    let distance = (x * x + y * y + z * z).sqrt();
    let (inverse, s) = (1.0 / distance, 1.0 / (distance + z));
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let factor = -3.0 * inverse.powi(5);
    let (by_x, by_y, by_z) = (factor * x, factor * y, factor * z);
    let radial = Radial {
        xxx: by_x * xx,
        yyy: by_y * yy,
        zzz: by_z * zz,
        xxy: by_y * xx,
        xyy: by_x * yy,
        xxz: by_z * xx,
        yyz: by_z * yy,
        xzz: by_x * zz,
        yzz: by_y * zz,
        xyz: by_x * y * z,
    };
    let (first, third) = (s * inverse, s * s * inverse);
    let second = first * inverse * (s + inverse);
    let fourth = third * inverse * (2.0 * s + inverse);
    let plane = [
        [first - yy * second, first - xx * second, x * y * second],
        [x * (third - yy * fourth), x * (3.0 * third - xx * fourth), y * (xx * fourth - third)],
        [y * (3.0 * third - yy * fourth), y * (third - xx * fourth), x * (yy * fourth - third)],
    ];
    radial.with_plane(poisson_ratio, plane)
}
