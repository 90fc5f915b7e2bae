//! Element means of fields with a closed form along every strip of an ellipse.
//!
//! A strip is the line y = const of an ellipse (a, b), of half length a_y = a η, η = √(1 − y²/b²).
//! A field is amplitude · η^n · g(u), u = 1 + x/a_y ∈ [0, 2], given by the integral G(u) = ∫₀^u g.
//! The mean of the field over the element [x₁, x₂] × [y₁, y₂] is
//!
//! 1/(Δx Δy) ∫_{y₁}^{y₂} amplitude · η^n · a_y · [G(u(x₂)) − G(u(x₁))] dy,
//!
//! which is exact along x. Along y a row is cut at |y| = b and wherever a curve on which g is not
//! smooth passes an element's corner: the ellipse itself, and x = ±κ a η for a kink at X = ±κ.
//! Between the cuts the integrand is smooth except for roots at the ends, (y − y_cut)^{n/2}. The
//! substitution y = middle + half · s(3 − s²)/2, whose slope vanishes at both ends, turns the roots
//! into polynomials, and a Gauss–Legendre rule of seven nodes integrates the result.
//!
//! Since G telescopes along x, and the rule is exact for a strip total proportional to η², the sum
//! over all elements equals the exact surface integral to rounding, at every resolution. Rows at ±y
//! are copies of each other. The cost is proportional to the number of elements.
//!
//! A line contact has η = 1: one row, as wide as the line.

pub mod carter;
pub mod semi_ellipse;
pub mod sliding;

use grids::Structured;
use numerics::quadrature::GAUSS_7;

/// Field along a strip, up to the amplitude.
pub trait StripDensity {
    /// G(u) = ∫₀^u g(u') du' for u = 1 + x/a_y in [0, 2]; the strip's trailing end is u = 0.
    fn cumulative(&self, u: f64) -> f64;

    /// Position |x|/a_y < 1 of a kink inside the strip.
    fn kink(&self) -> Option<f64> {
        None
    }
}

/// Variation of the amplitude of a field from strip to strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lateral {
    /// The same on every strip (n = 0).
    Constant,
    /// Like the half length of the strips (n = 1).
    Elliptic,
}

/// A field on all strips of an ellipse.
pub struct StripField<D> {
    /// Course of the field along a strip.
    pub density: D,
    /// Signed amplitude, in the field's unit.
    pub amplitude: f64,
    /// Variation of the amplitude from strip to strip.
    pub lateral: Lateral,
}

/// Ellipse or line contact on the grid that covers it; both have the same centre.
#[derive(Clone, Copy, Debug)]
pub struct Strips {
    semi_axis_a: f64,
    semi_axis_b: f64,
    /// All strips have the length of the middle one.
    line: bool,
    grid: Structured,
}

/// Nodes in [-1, 1] and weights, with the sum 1, of the substituted seven-node rule.
const RULE: [(f64, f64); 7] = {
    let mut rule = GAUSS_7;
    let mut k = 0;
    while k < rule.len() {
        let (node, weight) = rule[k];
        rule[k] = (0.5 * node * (3.0 - node * node), 0.75 * (1.0 - node * node) * weight);
        k += 1;
    }
    rule
};

impl Strips {
    /// Creates the strips of an ellipse with these semi-axes [m], on a grid with odd counts along x
    /// and y and an element centred on the origin.
    pub fn new(semi_axis_a: f64, semi_axis_b: f64, grid: Structured) -> Self {
        Self { semi_axis_a, semi_axis_b, line: false, grid }
    }

    /// Creates a line contact of half length a and half width b [m], on the grid of one row that it
    /// fills.
    pub fn of_line(semi_axis_a: f64, semi_axis_b: f64, grid: Structured) -> Self {
        Self { semi_axis_a, semi_axis_b, line: true, grid }
    }

    /// Writes the element means of a field, one value per element, zero outside the ellipse.
    pub fn write_means(&self, field: &StripField<impl StripDensity>, means: &mut [f64]) {
        let (columns, middle_row) = (self.grid.ni, self.grid.nj / 2);
        let mut cuts = Vec::new();
        means.fill(0.0);
        for row in 0..=middle_row {
            let upper = (middle_row + row) * columns;
            let values = &mut means[upper..upper + columns];
            self.cut_row(row, field.density.kink(), &mut cuts);
            for pair in cuts.windows(2) {
                self.add_segment(field, pair[0], pair[1], values);
            }
            let per_area = ((self.row_end(row) - self.row_start(row)) * self.grid.dx()).recip();
            values.iter_mut().for_each(|value| *value *= per_area);
            let lower = (middle_row - row) * columns;
            means.copy_within(upper..upper + columns, lower);
        }
    }

    /// Start of row `row` ≥ 0, counted from the middle; for the middle row, of the upper half.
    fn row_start(&self, row: usize) -> f64 {
        (row as f64 - 0.5).max(0.0) * self.grid.dy()
    }

    fn row_end(&self, row: usize) -> f64 {
        (row as f64 + 0.5) * self.grid.dy()
    }

    /// Fills `cuts` with the ends of the row's part inside the ellipse and all cuts between them.
    fn cut_row(&self, row: usize, kink: Option<f64>, cuts: &mut Vec<f64>) {
        let (from, to) = (self.row_start(row), self.row_end(row).min(self.semi_axis_b));
        cuts.clear();
        cuts.push(from);
        for curve in std::iter::once(1.0).chain(kink) {
            self.cut_by_curve(curve * self.semi_axis_a, from, to, cuts);
        }
        cuts.push(to);
        cuts.sort_by(f64::total_cmp);
    }

    /// Cuts (from, to) where |x| = `extent` · η passes an edge between columns.
    fn cut_by_curve(&self, extent: f64, from: f64, to: f64, cuts: &mut Vec<f64>) {
        let dx = self.grid.dx();
        let first = (extent * self.eta(to) / dx - 0.5).ceil().max(0.0) as usize;
        for edge in first.. {
            let ratio = (edge as f64 + 0.5) * dx / extent;
            let y = self.semi_axis_b * ((1.0 - ratio) * (1.0 + ratio)).max(0.0).sqrt();
            if ratio >= 1.0 || y <= from {
                break;
            }
            cuts.push(y.min(to));
        }
    }

    fn eta(&self, y: f64) -> f64 {
        if self.line {
            return 1.0;
        }
        let ratio = y / self.semi_axis_b;
        ((1.0 - ratio) * (1.0 + ratio)).max(0.0).sqrt()
    }

    /// Adds the integral over y in [from, to] to every element of a row.
    fn add_segment(
        &self,
        field: &StripField<impl StripDensity>,
        from: f64,
        to: f64,
        values: &mut [f64],
    ) {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        for (node, weight) in RULE {
            let eta = self.eta(middle + half * node);
            if eta > 0.0 {
                let lateral = if field.lateral == Lateral::Elliptic { eta } else { 1.0 };
                let half_length = self.semi_axis_a * eta;
                let scale = field.amplitude * lateral * half_length * weight * (to - from);
                self.add_strip(&field.density, half_length, scale, values);
            }
        }
    }

    /// Adds `scale` times the integral of a density over the part of a strip in every element.
    fn add_strip(
        &self,
        density: &impl StripDensity,
        half_length: f64,
        scale: f64,
        values: &mut [f64],
    ) {
        let reach = half_length / self.grid.dx();
        let middle = (values.len() / 2) as f64;
        // Columns that contain the ends; column i spans [i − middle − ½, i − middle + ½] · Δx.
        let first = (middle + 0.5 - reach).max(0.0) as usize;
        let last = ((middle + 0.5 + reach) as usize).min(values.len() - 1);
        let mut before = 0.0;
        for (column, value) in values.iter_mut().enumerate().take(last).skip(first) {
            let edge = column as f64 - middle + 0.5;
            let up_to = density.cumulative(((edge + reach) / reach).clamp(0.0, 2.0));
            *value += scale * (up_to - before);
            before = up_to;
        }
        values[last] += scale * (density.cumulative(2.0) - before);
    }
}

#[cfg(test)]
mod tests {
    use super::semi_ellipse::SemiEllipse;
    use super::*;
    use std::f64::consts::PI;

    fn grid(resolution: usize, b: f64) -> Structured {
        let step = 1.0 / resolution as f64;
        let (nx, ny) = (resolution, (b / step - 0.5).ceil().max(0.0) as usize);
        let (x0, y0) = (-(nx as f64) * step, -(ny as f64) * step);
        Structured::contact_plane(x0, y0, step, step, 2 * nx + 1, 2 * ny + 1)
    }

    fn means(resolution: usize, b: f64, density: impl StripDensity, lateral: Lateral) -> Vec<f64> {
        let grid = grid(resolution, b);
        let mut means = vec![f64::NAN; grid.points()];
        let field = StripField { density, amplitude: 1.0, lateral };
        Strips::new(1.0, b, grid).write_means(&field, &mut means);
        means
    }

    /// Field g = 1: the share of every element that lies inside the ellipse.
    struct Inside;

    impl StripDensity for Inside {
        fn cumulative(&self, u: f64) -> f64 {
            u
        }
    }

    /// Tolerance: the rule, since the ellipse's area is not polynomial in y.
    #[test]
    fn share_of_every_element_inside_the_ellipse() {
        for (resolution, b) in [(1, 0.3), (1, 1.0), (7, 0.752), (40, 0.752), (5, 12.0), (9, 0.01)] {
            let shares = means(resolution, b, Inside, Lateral::Constant);
            let area = grid(resolution, b).element_area() * shares.iter().sum::<f64>();
            let tolerance = if resolution == 1 { 2e-6 } else { 1e-8 };
            assert!((area / (PI * b) - 1.0).abs() < tolerance, "{resolution} {b}: {area}");
            assert!(shares.iter().all(|share| (0.0..1.0 + 1e-12).contains(share)));
            let middle = shares[shares.len() / 2];
            assert!(resolution < 2 || b < 0.1 || (middle - 1.0).abs() < 1e-14, "{middle}");
        }
    }

    /// Tolerance: rounding, since a strip's total is proportional to η².
    #[test]
    fn sum_of_an_elliptic_field_is_exact_at_every_resolution() {
        for resolution in [1, 2, 3, 10, 40] {
            for b in [0.02, 0.5, 0.752, 1.0, 30.0] {
                let means = means(resolution, b, SemiEllipse, Lateral::Elliptic);
                let volume = grid(resolution, b).element_area() * means.iter().sum::<f64>();
                assert!((volume / (2.0 / 3.0 * PI * b) - 1.0).abs() < 1e-13, "{resolution} {b}");
            }
        }
    }

    /// An element of the coarse grid consists of nine fine elements. Tolerance: the rule in the
    /// elements that the ellipse cuts, whose values are of the order of 1.
    #[test]
    fn means_of_a_coarse_grid_are_means_of_a_fine_grid() {
        let b = 0.752;
        for (lateral, tolerance) in [(Lateral::Constant, 3e-7), (Lateral::Elliptic, 3e-8)] {
            let (coarse, fine) =
                (means(7, b, SemiEllipse, lateral), means(21, b, SemiEllipse, lateral));
            let (coarse_grid, fine_grid) = (grid(7, b), grid(21, b));
            let mut worst: f64 = 0.0;
            for j in 0..coarse_grid.nj {
                for i in 0..coarse_grid.ni {
                    let value = coarse[j * coarse_grid.ni + i];
                    let mean = mean_of_nine(&fine, &fine_grid, &coarse_grid, i, j);
                    worst = worst.max((value - mean).abs());
                }
            }
            assert!(worst < tolerance, "{lateral:?}: {worst}");
        }
    }

    fn mean_of_nine(
        fine: &[f64],
        fine_grid: &Structured,
        coarse_grid: &Structured,
        i: usize,
        j: usize,
    ) -> f64 {
        let centre = |index: usize, coarse: usize, fine: usize| {
            3 * (index as isize - (coarse / 2) as isize) + (fine / 2) as isize
        };
        let (ci, cj) =
            (centre(i, coarse_grid.ni, fine_grid.ni), centre(j, coarse_grid.nj, fine_grid.nj));
        let mut sum = 0.0;
        for (di, dj) in (0..9).map(|n| (n % 3 - 1, n / 3 - 1)) {
            let (fi, fj) = (ci + di, cj + dj);
            let inside = |n: isize, count: usize| (0..count as isize).contains(&n);
            if inside(fi, fine_grid.ni) && inside(fj, fine_grid.nj) {
                sum += fine[fj as usize * fine_grid.ni + fi as usize];
            }
        }
        sum / 9.0
    }
}
