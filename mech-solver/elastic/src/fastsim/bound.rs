//! The traction bound along a strip, at its nodes and on the whole ellipse.
//!
//! With X = x/(a η) along a strip of half length a η, η = √(1 − y²/b²), and m cells:
//!
//! - `Parabolic`: f · 2N/(π a b) · η² (1 − X²). Nodes in equal steps, X_i = 1 − 2i/m. The factor
//!   m²/(m² − 1) makes the trapezoidal sum of every strip exact, and cos⁴θ is summed exactly over
//!   the strips.
//! - `Elliptic`: f · 3N/(2π a b) · η √(1 − X²), f times Hertz's pressure. Nodes in equal steps
//!   h = π/m of the angle, X_i = cos ih, since the bound rises like a root at both edges. The
//!   trapezoidal sum is (π/2) sin h/h of the exact value, and the factor corrects it. The sum over
//!   the strips is made exact by 1 + O(n⁻⁴).
//!
//! Full slip thus carries f N with both. The parabola reaches full slip at a finite creepage, as
//! its slope at the leading edge is finite. Under the half ellipse a strip sticks at its leading
//! edge at every creepage. On m cells a strip slips entirely where the first cell does, at a
//! creepage that grows with m.

use std::f64::consts::{FRAC_PI_2, PI};

/// Traction bound along a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Kalker's parabola.
    Parabolic,
    /// Friction coefficient times Hertz's pressure.
    Elliptic,
}

impl Bound {
    /// x at node `index` of `cells` cells, counted from the leading edge, on a strip of this half
    /// length.
    #[inline]
    pub fn node(self, index: usize, cells: usize, half_length: f64) -> f64 {
        // Differences of integers make the nodes at ±x mirror images to the last bit.
        let steps = cells as f64 - 2.0 * index as f64;
        match self {
            Self::Parabolic => half_length * steps / cells as f64,
            Self::Elliptic => half_length * (FRAC_PI_2 * (steps / cells as f64)).sin(),
        }
    }

    /// Bound at a node over the bound at the centre of the strip.
    #[inline]
    pub fn shape(self, index: usize, cells: usize) -> f64 {
        match self {
            Self::Parabolic => {
                let (cells, index) = (cells as f64, index as f64);
                4.0 * index * (cells - index) / (cells * cells - 1.0)
            }
            Self::Elliptic => {
                let (x, step) = (self.node(index, cells, 1.0), PI / cells as f64);
                ((1.0 - x) * (1.0 + x)).sqrt() * (step / step.sin())
            }
        }
    }

    /// Bound at the centre of a strip, from the bound at the centre of the ellipse.
    #[inline]
    pub fn of_strip(self, largest: f64, eta: f64) -> f64 {
        match self {
            Self::Parabolic => largest * eta * eta,
            Self::Elliptic => largest * eta,
        }
    }

    /// Slope of the bound in X = x/a over the first cell of the longest strip, the largest of all
    /// cells.
    pub fn steepest(self, largest: f64, cells: usize) -> f64 {
        match self {
            Self::Parabolic => 2.0 * largest * cells as f64 / (cells as f64 + 1.0),
            Self::Elliptic => largest * self.shape(1, cells) / (1.0 - self.node(1, cells, 1.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The trapezoidal sums equal the exact 4/3 and π/2; the first cell is the steepest. Tolerance:
    /// rounding.
    #[test]
    fn sums_and_slopes() {
        for (bound, whole) in [(Bound::Parabolic, 4.0 / 3.0), (Bound::Elliptic, FRAC_PI_2)] {
            for cells in [2, 3, 10, 81] {
                let cell = |index: usize| {
                    let node = |index| bound.node(index, cells, 1.0);
                    let length = node(index - 1) - node(index);
                    (length, bound.shape(index - 1, cells), bound.shape(index, cells))
                };
                let all: Vec<_> = (1..=cells).map(cell).collect();
                let sum: f64 = all.iter().map(|(length, g, h)| 0.5 * length * (g + h)).sum();
                assert!((sum / whole - 1.0).abs() < 1e-13, "{bound:?} {cells}: {sum}");
                let slopes = all.iter().map(|(length, front, rear)| (rear - front) / length);
                let steepest = slopes.fold(f64::MIN, f64::max);
                assert!((steepest / bound.steepest(1.0, cells) - 1.0).abs() < 1e-12, "{bound:?}");
                assert!(bound.shape(0, cells) == 0.0 && bound.shape(cells, cells) == 0.0);
            }
        }
    }
}
