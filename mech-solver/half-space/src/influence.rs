//! Influence numbers of piecewise constant tractions on two elastic half-spaces.
//!
//! A traction p = (p_x, p_y, p_z) acts on body 1, which fills z ≥ 0, and −p on body 2 in z ≤ 0;
//! p_z > 0 presses. The displacement difference u = u₁ − u₂ of the surfaces at the distance
//! (x, y) from a point load, target minus source, R² = x² + y², is per unit of force
//!
//! - xx: (1/πG) [(1 − ν)/R + ν x²/R³], yy with y² in place of x²,
//! - xy = yx: (1/πG) ν xy/R³,
//! - zz: (1/πG) (1 − ν)/R,
//! - zx = −xz: (K/πG) x/R², zy = −yz: (K/πG) y/R²,
//!
//! where the first letter names the displacement, the second the load. The constants of the pair
//! are 1/G = ½(1/G₁ + 1/G₂), ν/G = ½(ν₁/G₁ + ν₂/G₂), K/G = ¼((1 − 2ν₁)/G₁ − (1 − 2ν₂)/G₂). The
//! compliance (1 − ν)/G is the sum (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂.
//!
//! An influence number is the kernel k integrated over one loaded element,
//! A(x, y) = ∫∫ k(X, Y) dX dY over |X − x| < dx/2, |Y − y| < dy/2 [m/Pa]: the displacement at
//! (x, y) from the centre of an element dx × dy under a traction of 1 Pa. It is the corner sum
//! F(x₊, y₊) − F(x₊, y₋) − F(x₋, y₊) + F(x₋, y₋) of an antiderivative with ∂²F/∂X∂Y = k:
//!
//! | k | F |
//! |---|---|
//! | 1/R | Y asinh(X/\|Y\|) + X asinh(Y/\|X\|) |
//! | X²/R³ | Y asinh(X/\|Y\|) |
//! | Y²/R³ | X asinh(Y/\|X\|) |
//! | XY/R³ | −R |
//! | X/R² | Y ln R + X arctan(Y/X) |
//! | Y/R² | X ln R + Y arctan(X/Y) |
//!
//! Terms of a single variable cancel in the sum and are omitted. asinh in place of ln(X + R) keeps
//! F odd and free of cancellation at X < 0. The sum itself loses digits with the square of the
//! distance in elements, so beyond 16 elements Gauss's rule takes its place. Every number has a
//! relative error of about 1e-13.
//!
//! **Plane strain.** A line contact is one row, whose tractions are uniform over its width w along
//! y. In the middle, far from the ends, the integrals over y of the kernels above are
//!
//! | k | ∫ k dY | F |
//! |---|---|---|
//! | 1/R | 2 ln(w/\|X\|) | 2X (1 + ln(w/\|X\|)) |
//! | X²/R³ | 2 | 2X |
//! | Y²/R³ | 2 ln(w/\|X\|) − 2 | 2X ln(w/\|X\|) |
//! | X/R² | π sgn X | π \|X\| |
//!
//! and the others vanish. The displacement of a half-plane has no natural zero: the width affects
//! only the approach and the shift (Johnson §2.3).
//!
//! Source: J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), §1.6 and
//! §4.3; K. L. Johnson, Contact Mechanics (1985), §3.2 and §3.6. Deviation: Kalker writes the
//! distance as source minus target, which turns the sign of the odd terms.

use elastic::Elasticity;
use grids::Structured;
use numerics::quadrature::GAUSS_4;
use std::f64::consts::PI;

/// Distance, in units of the element's longer side, beyond which Gauss's rule with 4 × 4 points is
/// used. There its error is 1e-14 and the rounding of the corner sum 1e-13; farther away the former
/// falls and the latter rises.
const FAR: f64 = 16.0;

/// Influence numbers of an element under unit traction [m/Pa].
///
/// Methods without `_at` take an offset in whole elements, methods with it take metres. Both are
/// the target's centre minus the loaded element's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    /// Side of an element along x [m].
    pub dx: f64,
    /// Side of an element along y [m].
    pub dy: f64,
    /// Constants of the two bodies.
    pub elasticity: Elasticity,
    /// The grid is one row in plane strain, of the width `dy`.
    pub plane_strain: bool,
}

/// Defines `$name(i, j)` as `$at(i dx, j dy)`.
macro_rules! on_elements {
    ($($name:ident, $at:ident, $what:literal;)*) => {$(
        #[doc = concat!($what, " at an offset of (i, j) elements [m/Pa].")]
        #[must_use]
        pub fn $name(&self, i: i32, j: i32) -> f64 {
            self.$at(f64::from(i) * self.dx, f64::from(j) * self.dy)
        }
    )*};
}

impl Influence {
    /// Influence of the elements of a grid; a single row is a line contact in plane strain.
    #[must_use]
    pub fn of_grid(grid: &Structured, elasticity: Elasticity) -> Self {
        Self { dx: grid.dx(), dy: grid.dy(), elasticity, plane_strain: grid.nj == 1 }
    }

    /// Influence of elements dx × dy [m], not in plane strain.
    #[must_use]
    pub fn of_elements([dx, dy]: [f64; 2], elasticity: Elasticity) -> Self {
        Self { dx, dy, elasticity, plane_strain: false }
    }

    on_elements! {
        zz, zz_at, "Normal displacement by normal pressure";
        xx, xx_at, "Displacement along x by traction along x";
        yy, yy_at, "Displacement along y by traction along y";
        xy, xy_at, "Displacement along x by traction along y, and the reverse";
        xz, xz_at, "Displacement along x by normal pressure";
        yz, yz_at, "Displacement along y by normal pressure";
        zx, zx_at, "Normal displacement by traction along x";
        zy, zy_at, "Normal displacement by traction along y";
    }

    /// Normal displacement by normal pressure at (x, y) [m/Pa].
    #[must_use]
    pub fn zz_at(&self, x: f64, y: f64) -> f64 {
        let integral = match self.plane_strain {
            true => self.across(x, |x| logarithmic(x, self.dy) + 2.0 * x),
            false => self.integral(
                (x, y),
                |x, y| along_first(x, y) + along_first(y, x),
                |x, y| (x * x + y * y).sqrt().recip(),
            ),
        };
        self.elasticity.contact_compliance() / PI * integral
    }

    /// Displacement along x by traction along x at (x, y) [m/Pa].
    #[must_use]
    pub fn xx_at(&self, x: f64, y: f64) -> f64 {
        let (whole, poisson) = self.tangential_constants();
        if self.plane_strain {
            return self
                .across(x, |x| (whole - poisson) * logarithmic(x, self.dy) + 2.0 * whole * x);
        }
        self.integral(
            (x, y),
            |x, y| whole * along_first(x, y) + (whole - poisson) * along_first(y, x),
            |x, y| {
                let square = x * x + y * y;
                (whole - poisson + poisson * (x * x / square)) / square.sqrt()
            },
        )
    }

    /// Displacement along y by traction along y at (x, y) [m/Pa].
    #[must_use]
    pub fn yy_at(&self, x: f64, y: f64) -> f64 {
        if self.plane_strain {
            let (whole, poisson) = self.tangential_constants();
            return self
                .across(x, |x| whole * logarithmic(x, self.dy) + 2.0 * (whole - poisson) * x);
        }
        let turned = Self { dx: self.dy, dy: self.dx, ..*self };
        turned.xx_at(y, x)
    }

    /// Displacement along x by traction along y, and the reverse, at (x, y) [m/Pa].
    #[must_use]
    pub fn xy_at(&self, x: f64, y: f64) -> f64 {
        if self.plane_strain {
            return 0.0;
        }
        let integral = self.integral(
            (x, y),
            |x, y| -x.hypot(y),
            |x, y| {
                let square = x * x + y * y;
                x * y / (square * square.sqrt())
            },
        );
        let sign = sign(x) * sign(y);
        sign * self.tangential_constants().1 * integral
    }

    /// Displacement along x by normal pressure at (x, y) [m/Pa].
    #[must_use]
    pub fn xz_at(&self, x: f64, y: f64) -> f64 {
        -self.zx_at(x, y)
    }

    /// Displacement along y by normal pressure at (x, y) [m/Pa].
    #[must_use]
    pub fn yz_at(&self, x: f64, y: f64) -> f64 {
        -self.zy_at(x, y)
    }

    /// Normal displacement by traction along x at (x, y) [m/Pa].
    #[must_use]
    pub fn zx_at(&self, x: f64, y: f64) -> f64 {
        if !self.elasticity.is_coupled() {
            return 0.0;
        }
        let integral = match self.plane_strain {
            true => self.across(x.abs(), |x| PI * x.abs()),
            false => self.integral(
                (x, y),
                |x, y| logarithm(x, y, self.dx) + arc(x, y),
                |x, y| x / (x * x + y * y),
            ),
        };
        sign(x) * self.elasticity.coupling_compliance / PI * integral
    }

    /// Normal displacement by traction along y at (x, y) [m/Pa].
    #[must_use]
    pub fn zy_at(&self, x: f64, y: f64) -> f64 {
        if self.plane_strain {
            return 0.0;
        }
        let turned = Self { dx: self.dy, dy: self.dx, ..*self };
        turned.zx_at(y, x)
    }

    /// Constants 1/(πG) and ν/(πG).
    fn tangential_constants(&self) -> (f64, f64) {
        (self.elasticity.shear_compliance / PI, self.elasticity.poisson_compliance / PI)
    }

    /// Integral over the length of an element at |x|, from an antiderivative.
    fn across(&self, x: f64, primitive: impl Fn(f64) -> f64) -> f64 {
        let (x, half) = (x.abs(), 0.5 * self.dx);
        primitive(x + half) - primitive(x - half)
    }

    /// Integral of `kernel`, whose antiderivative is `primitive`, over the element around the
    /// point. It is evaluated at the mirror image with x, y ≥ 0, so that symmetries hold bit for
    /// bit.
    fn integral(
        &self,
        (x, y): (f64, f64),
        primitive: impl Fn(f64, f64) -> f64,
        kernel: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let (x, y) = (x.abs(), y.abs());
        let (half_x, half_y) = (0.5 * self.dx, 0.5 * self.dy);
        let far = FAR * self.dx.max(self.dy);
        if x * x + y * y > far * far {
            let row = |t: f64| -> f64 {
                GAUSS_4.iter().map(|(s, weight)| weight * kernel(x + s * half_x, t)).sum()
            };
            let sum: f64 = GAUSS_4.iter().map(|(t, weight)| weight * row(y + t * half_y)).sum();
            return 0.25 * self.dx * self.dy * sum;
        }
        let (left, right, low, high) = (x - half_x, x + half_x, y - half_y, y + half_y);
        (primitive(right, high) - primitive(right, low))
            - (primitive(left, high) - primitive(left, low))
    }
}

/// Values at all offsets of a grid that are even in both offsets, each evaluated once.
#[derive(Clone, Debug)]
pub struct EvenOffsetTable<T> {
    width: usize,
    values: Vec<T>,
}

impl<T: Copy> EvenOffsetTable<T> {
    /// Evaluates the offsets of up to `width` − 1 elements along x and `height` − 1 along y.
    #[must_use]
    pub fn new(width: usize, height: usize, value: impl Fn(i32, i32) -> T) -> Self {
        let rows = 0..height as i32;
        let row = |j: i32| (0..width as i32).map(move |i| (i, j));
        Self { width, values: rows.flat_map(row).map(|(i, j)| value(i, j)).collect() }
    }

    /// Value at an offset of either sign.
    #[must_use]
    pub fn value(&self, i: i32, j: i32) -> T {
        self.values[j.unsigned_abs() as usize * self.width + i.unsigned_abs() as usize]
    }
}

/// Sign of an odd component: zero on the axis.
fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

/// Y asinh(X/|Y|).
fn along_first(x: f64, y: f64) -> f64 {
    if y == 0.0 { 0.0 } else { y * (x / y.abs()).asinh() }
}

/// 2X ln(w/|X|).
fn logarithmic(x: f64, width: f64) -> f64 {
    if x == 0.0 { 0.0 } else { 2.0 * x * (width / x.abs()).ln() }
}

/// Y ln(R/unit); the unit drops out of the corner sum.
fn logarithm(x: f64, y: f64, unit: f64) -> f64 {
    if y == 0.0 { 0.0 } else { y * (x.hypot(y) / unit).ln() }
}

/// X arctan(Y/X).
fn arc(x: f64, y: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x * (y / x).atan() }
}

#[cfg(test)]
mod tests;
