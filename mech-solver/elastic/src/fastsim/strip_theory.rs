//! FASTRIP: strip theory in the stick zone, the simplified theory in the slip zone.
//!
//! Kalker's strip theory takes the traction of a rolling half-space in plane strain, strip by
//! strip, where the simplified theory has straight lines. With f p₀ the bound at the centre and the
//! reduced creepages
//!
//! ξ' = −(1 − ν) 16 a ξ/(3π² L1 f p₀),  η' = −(1 − ν) 16 a η/(3π² L2 f p₀),
//! φ' = −3 a² φ/(8 L3 f p₀),
//!
//! which are those of strips, scaled so that an ellipse has Kalker's slopes, a strip of half length
//! a_y sticks in −a_y + 2d < x < a_y,
//!
//! d = a/(1 − ν) · [√(η'² + (1 − φ'²)(ξ' − φ' y/a)²) + η' φ']/(1 − φ'²),
//!
//! with the traction, in terms of S = √(a_y² − x²)/a and S_d = √((a_y − d)² − (x − d)²)/a,
//!
//! p_x = f p₀ κ (S − S_d),  p_y = f p₀ (λ S − (λ − φ') S_d),
//!
//! where (κ, λ) is the unit vector along (ξ' − φ' y/a, η' + φ' d/a). Behind the stick zone, p is f
//! times Hertz's pressure, in the direction in which the simplified theory slips under the elliptic
//! bound. The whole strip slips if d is not real, is negative or is not below a_y. A strip is left
//! to the simplified theory in two cases: if φ' is large enough for the sticking traction to exceed
//! the bound, and if friction is not a uniform coefficient times Hertz's pressure, for which the
//! theory has no traction.
//!
//! Without spin the force is 1 − (3/2)(s − s³/3 − δ θ) of f N, δ = d/a = cos θ < 1, s = sin θ
//! (Haines and Ollerton; derived here). Cells have exact mean tractions, and full slip carries f N.
//!
//! **Slip.** Strip theory does not give the slip under spin. The slip of a cell is that of the
//! simplified theory, times one factor for the whole contact, chosen so that friction dissipates
//! the power of the creepages.
//!
//! Sources: Sichani, Enblom, Berg, An alternative to FASTSIM for tangential solution of the
//! wheel–rail contact, Vehicle System Dynamics 54 (2016) 748–764; Kalker, A strip theory for
//! rolling with slip and spin, Proc. Kon. Ned. Akad. Wet. B 70 (1967) 10–62. Deviations: a
//! reduction factor acts on both theories; the factor of the slip.

use super::flexibility::Creepage;
use super::integration::{Cell, Strip, StripIntegration, norm};
use crate::strips::semi_ellipse::segment_area;
use std::f64::consts::PI;

/// Data of strip theory for one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripTheory {
    /// The simplified theory, with the elliptic bound.
    march: StripIntegration,
    /// Bound f p₀, with the factor that makes the sum over the strips exact [Pa].
    amplitude: f64,
    /// Reduced creepages (ξ', η', φ') [-].
    reduced: [f64; 3],
    /// Factor 1/(1 − ν) [-].
    stretch: f64,
}

/// Sticking part of a strip.
struct Stick<'a> {
    theory: &'a StripTheory,
    /// Half length of the strip, and d [m].
    half_length: f64,
    slipping: f64,
    /// κ and λ [-].
    direction: [f64; 2],
}

impl StripTheory {
    /// Adds strip theory to an integration with the elliptic bound, from Kalker's flexibilities L1,
    /// L2, L3 [m/Pa] and Poisson's ratio.
    pub fn new(march: StripIntegration, flexibilities: [f64; 3], poisson_ratio: f64) -> Self {
        Self::of_strip(march, march.creepage, 0.0, flexibilities, poisson_ratio)
    }

    /// Theory of a strip whose middle is at x [m], with the given creepages at x = 0; the creepages
    /// of `march` apply at the middle.
    pub fn of_strip(
        march: StripIntegration,
        [xi, eta, phi]: Creepage,
        x: f64,
        [l1, l2, l3]: [f64; 3],
        poisson_ratio: f64,
    ) -> Self {
        let (a, bound) = (march.lattice.semi_axis_a, march.largest_bound);
        let creep = -(1.0 - poisson_ratio) * 16.0 * a / (3.0 * PI * PI * bound);
        let spin = -3.0 * a * a * phi / (8.0 * l3 * bound);
        let reduced = [creep * xi / l1, creep * eta / l2 + spin * (x / a), spin];
        Self { march, amplitude: bound, reduced, stretch: (1.0 - poisson_ratio).recip() }
    }

    /// Visits the cells of a strip from the leading to the trailing edge, under the bounds of
    /// [`StripIntegration::strip`].
    pub fn strip(
        &self,
        strip: &Strip,
        limit: impl Fn(f64, f64) -> f64,
        mut visit: impl FnMut(&Cell),
    ) {
        if self.is_limited(strip, &limit) {
            return self.march.strip(strip, limit, visit);
        }
        match self.stick(strip) {
            Some(stick) if !stick.beyond_bound(strip) => {
                let border = 2.0 * stick.slipping - stick.half_length;
                self.march.strip(strip, limit, |cell| stick.cut(cell, border, &mut visit));
            }
            Some(_) => self.march.strip(strip, limit, visit),
            None => {
                let half_length = self.march.lattice.semi_axis_a * strip.eta;
                self.march.strip(strip, limit, |cell| visit(&self.sliding(half_length, *cell)));
            }
        }
    }

    /// Returns true if the bounds of a strip differ from those of its mean coefficient.
    fn is_limited(&self, strip: &Strip, limit: impl Fn(f64, f64) -> f64) -> bool {
        /// Rounding of a mean of equal coefficients.
        const ROUNDING: f64 = 1e-9;
        self.march.nodes(strip).any(|(x, bound)| (limit(x, bound) - bound).abs() > ROUNDING * bound)
    }

    /// Sticking part of a strip, if any.
    fn stick(&self, strip: &Strip) -> Option<Stick<'_>> {
        let a = self.march.lattice.semi_axis_a;
        let half_length = a * strip.eta;
        let [xi, eta, phi] = self.reduced;
        let along = xi - phi * strip.y / a;
        let left = 1.0 - phi * phi;
        let square = eta * eta + left * along * along;
        let share = self.stretch * (square.sqrt() + eta * phi) / left;
        let slipping = a * share;
        // The condition is also false for NaN.
        if !(slipping >= 0.0 && slipping < half_length) {
            return None;
        }
        let vector = [along, eta + phi * share];
        let size = norm(vector);
        let direction = if size > 0.0 { vector.map(|part| part / size) } else { [0.0; 2] };
        Some(Stick { theory: self, half_length, slipping, direction })
    }

    /// Replaces the traction of a slipping cell, keeping the direction of the simplified theory.
    fn sliding(&self, half_length: f64, cell: Cell) -> Cell {
        let scale = self.amplitude / self.march.lattice.semi_axis_a;
        let bound = scale * mean_root(&cell, 0.0, half_length);
        let size = norm(cell.traction);
        let traction = match size > 0.0 {
            true => cell.traction.map(|part| bound * (part / size)),
            false => [0.0; 2],
        };
        Cell { traction, slips: true, largest_traction: bound, ..cell }
    }
}

impl Stick<'_> {
    /// Weights of the outer and of the inner half ellipse in the traction, along x and y [-].
    fn shares(&self) -> [[f64; 2]; 2] {
        let [kappa, lambda] = self.direction;
        [[kappa, kappa], [lambda, lambda - self.theory.reduced[2]]]
    }

    /// Returns true if the traction exceeds the bound at a node.
    fn beyond_bound(&self, strip: &Strip) -> bool {
        /// Rounding of the difference of two half ellipses.
        const ROUNDING: f64 = 1e-9;
        let lattice = &self.theory.march.lattice;
        (0..=lattice.cells).map(|index| lattice.node(strip, index)).any(|x| {
            let outer = root(x, self.half_length);
            let inner = root(x - self.slipping, self.half_length - self.slipping);
            let sum = self.shares().map(|[of_outer, of_inner]| of_outer * outer - of_inner * inner);
            norm(sum) > outer + ROUNDING * self.half_length
        })
    }

    /// Visits the slipping part of a cell of the simplified theory, cut at the border of the stick
    /// zone.
    fn cut(&self, cell: &Cell, border: f64, visit: &mut impl FnMut(&Cell)) {
        let [rear, front] = cell.ends;
        if border < front {
            visit(&self.sticking(Cell { ends: [rear.max(border), front], ..*cell }));
        }
        if border > rear {
            let part = Cell { ends: [rear, front.min(border)], ..*cell };
            visit(&self.theory.sliding(self.half_length, part));
        }
    }

    /// Replaces the traction of a sticking cell.
    fn sticking(&self, cell: Cell) -> Cell {
        let scale = self.theory.amplitude / self.theory.march.lattice.semi_axis_a;
        let outer = scale * mean_root(&cell, 0.0, self.half_length);
        let inner = scale * mean_root(&cell, self.slipping, self.half_length - self.slipping);
        let traction =
            self.shares().map(|[of_outer, of_inner]| of_outer * outer - of_inner * inner);
        Cell { traction, slip: [0.0; 2], slips: false, largest_traction: norm(traction), ..cell }
    }
}

/// √(r² − x²) [m]; zero beyond the radius.
fn root(x: f64, radius: f64) -> f64 {
    ((radius - x) * (radius + x)).max(0.0).sqrt()
}

/// Mean of √(r² − (x − middle)²) over a cell [m].
fn mean_root(cell: &Cell, middle: f64, radius: f64) -> f64 {
    let behind = |x: f64| segment_area((1.0 + (x - middle) / radius).clamp(0.0, 2.0));
    let [rear, front] = cell.ends;
    radius * radius * (behind(front) - behind(rear)) / (front - rear)
}
