//! A half-space whose surface passes under a flux on a grid.

use super::ages::{Age, PastInterval, REACH, ages};
use super::element::{parabolas, shares};
use crate::columns::reconstruction::Flux;
use grids::Structured;
use numerics::convolution::{Convolution, Spectrum};
use std::f64::consts::PI;
use std::ops::Range;

/// A body in an interval of the past: its response to the heat received then.
#[derive(Clone, Debug)]
pub struct HalfSpace {
    grid: Structured,
    diffusivity: f64,
    stretch: PastInterval,
    /// 1/(β√π) [m²·K·√s/J].
    amplitude: f64,
    ages: Vec<Age>,
}

/// Influence on the surface of a flux in an interval, as Fourier spectra.
#[derive(Clone, Debug)]
pub struct Influence {
    columns: usize,
    /// Spectra of middle coefficients and of edge values.
    spectra: [Spectrum; 2],
    work: u64,
}

/// A flux contracted to a row: for every age, the sum of all rows weighted by the Gaussian across.
#[derive(Clone, Debug)]
pub struct Contracted {
    /// Middle coefficients and edge values of every age, one after another [W/m²].
    middle: Vec<f64>,
    edge: Vec<f64>,
}

/// Integrals along x for one age, by the offset of an element or edge from the target.
struct Along {
    first: i64,
    middle: Vec<f64>,
    edge: Vec<f64>,
}

/// Creates the plan for convolutions on a grid; edges are one more than elements.
#[must_use]
pub fn convolution(grid: &Structured) -> Convolution {
    Convolution::new(grid.ni + 1, grid.nj)
}

impl HalfSpace {
    /// Creates a body of this diffusivity κ [m²/s] and effusivity β [J/(m²·K·√s)] in an interval of
    /// the past.
    #[must_use]
    pub fn new(
        grid: &Structured,
        diffusivity: f64,
        effusivity: f64,
        stretch: PastInterval,
    ) -> Self {
        let (element, length) = ([grid.dx(), grid.dy()], grid.ni as f64 * grid.dx());
        Self {
            grid: *grid,
            diffusivity,
            stretch,
            amplitude: 1.0 / (effusivity * PI.sqrt()),
            ages: ages(diffusivity, &stretch, element, length),
        }
    }

    /// Creates a body of this diffusivity κ [m²/s] in which heat of all ages has the same weight
    /// `factor`.
    #[must_use]
    pub fn ageless(
        grid: &Structured,
        diffusivity: f64,
        factor: f64,
        stretch: PastInterval,
    ) -> Self {
        let mut body = Self::new(grid, diffusivity, 1.0, stretch);
        body.ages.iter_mut().for_each(|age| age.weight *= age.age.sqrt());
        Self { amplitude: factor, ..body }
    }

    /// Returns the influence of the body on the surface.
    #[must_use]
    pub fn influence(&self, convolution: &mut Convolution) -> Influence {
        Influence::of(&self.grid, std::iter::once(self.clone()), convolution)
    }

    /// Returns the number of ages.
    #[must_use]
    pub fn ages(&self) -> usize {
        self.ages.len()
    }

    /// Returns the spreading width s for an age [m].
    fn width(&self, age: f64) -> f64 {
        (4.0 * self.diffusivity * age).sqrt()
    }

    /// Adds the influence of the element and of the edge with the offset d = source − target along
    /// x, from −(n_x − 1) on, and rows apart [m²·K/W]. Returns the number of multiply-adds.
    fn add_to(&self, tables: &mut [Vec<f64>; 2]) -> u64 {
        let columns = self.grid.ni;
        let (first, mut work) = (1 - columns as i64, 0);
        for Age { age, weight } in &self.ages {
            let along = self.along(*age, 0.0, first..columns as i64 + 1);
            if along.middle.is_empty() {
                continue;
            }
            let across = self.across(*age);
            let start = (along.first - first) as usize;
            for (row, share) in across.iter().enumerate() {
                let factor = self.amplitude * weight * share;
                for (table, values) in tables.iter_mut().zip([&along.middle, &along.edge]) {
                    let from = row * 2 * columns + start;
                    let line = &mut table[from..from + values.len()];
                    line.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
                }
            }
            work += (2 * across.len() * along.middle.len()) as u64;
        }
        work
    }

    /// Returns the weights of the rows 0, 1, 2 … away from the target's row, up to the last nonzero
    /// weight.
    fn across(&self, age: f64) -> Vec<f64> {
        let width = self.width(age);
        let side = self.grid.dy() / width;
        let last = (REACH / side + 1.5).floor().min((self.grid.nj - 1) as f64) as usize;
        shares(-0.5 * side, side, last + 1).collect()
    }

    /// Returns the nonzero integrals along x of the elements and edges within some offsets from a
    /// target, which lies `ahead` [m] of an element's centre.
    fn along(&self, age: f64, ahead: f64, offsets: Range<i64>) -> Along {
        let (width, side) = (self.width(age), self.grid.dx());
        let way = ahead + self.stretch.way_at(age);
        let place = |offset: i64| ((offset as f64 - 0.5) * side - way) / width;
        let reach = REACH * width;
        let low = ((way - reach) / side + 0.5).floor().max(offsets.start as f64 - 1.0) as i64;
        let high = ((way + reach) / side + 0.5).ceil().min(offsets.end as f64) as i64;
        let (low, high) = (low.max(offsets.start - 1), high.max(low));
        let first = low.max(offsets.start);
        // The last element has an edge on either side.
        let count = ((high + 1).min(offsets.end) - first).max(0) as usize;
        let mut along = Along { first, middle: vec![0.0; count], edge: vec![0.0; count] };
        if high == low {
            return Along { first, middle: Vec::new(), edge: Vec::new() };
        }
        let parts = parabolas(place(low), side / width, (high - low) as usize);
        for (offset, [before, middle, after]) in (low..).zip(parts) {
            let at = offset - first;
            if at >= 0 {
                along.middle[at as usize] = middle;
                along.edge[at as usize] += before;
            }
            if let Some(edge) = along.edge.get_mut((at + 1) as usize) {
                *edge += after;
            }
        }
        along
    }

    /// Contracts a flux to a row.
    #[must_use]
    pub fn contract(&self, flux: &Flux, target: usize) -> Contracted {
        let edges = self.grid.ni + 1;
        let zeros = vec![0.0; self.ages.len() * edges];
        let mut contracted = Contracted { middle: zeros.clone(), edge: zeros };
        let lines = contracted.middle.chunks_exact_mut(edges);
        let lines = lines.zip(contracted.edge.chunks_exact_mut(edges));
        for (age, (middle, edge)) in self.ages.iter().zip(lines) {
            let across = self.across(age.age);
            for row in 0..self.grid.nj {
                let (Some(share), from) = (across.get(row.abs_diff(target)), flux.row(row)) else {
                    continue;
                };
                let (first, end) = from.support;
                for i in first..end {
                    middle[i] += share * from.middle[i];
                    edge[i] += share * from.edge[i];
                }
                if end > 0 {
                    edge[end] += share * from.edge[end];
                }
            }
        }
        contracted
    }

    /// Returns the contribution of every age to the surface's rise at a position x [m] of the row
    /// to which the flux was contracted [K].
    #[must_use]
    pub fn shares_at(&self, contracted: &Contracted, x: f64) -> Vec<f64> {
        let place = (x - self.grid.x(0)) / self.grid.dx();
        let (target, edges) = (place.round() as i64, self.grid.ni + 1);
        let ahead = (place - place.round()) * self.grid.dx();
        let share = |(at, Age { age, weight }): (usize, &Age)| {
            let along = self.along(*age, ahead, -target..edges as i64 - target);
            let range = at * edges..(at + 1) * edges;
            let (middle, edge) = (&contracted.middle[range.clone()], &contracted.edge[range]);
            self.amplitude * weight * along.dot(target, middle, edge)
        };
        self.ages.iter().enumerate().map(share).collect()
    }

    /// Returns the rise at the depth c = z/(2√κ) [√s] below a place with these contributions of the
    /// ages [K].
    #[must_use]
    pub fn rise_below(&self, shares: &[f64], depth: f64) -> f64 {
        let term = |(age, share): (&Age, &f64)| share * (-depth * depth / age.age).exp();
        self.ages.iter().zip(shares).map(term).sum()
    }

    /// Adds the rises along the row at the elements' centres, at some depths c = z/(2√κ) [√s],
    /// depth after depth.
    pub fn section(&self, contracted: &Contracted, depths: &[f64], rise: &mut [f64]) {
        let (columns, edges) = (self.grid.ni, self.grid.ni + 1);
        let mut line = vec![0.0; columns];
        for (at, Age { age, weight }) in self.ages.iter().enumerate() {
            let along = self.along(*age, 0.0, 1 - columns as i64..columns as i64 + 1);
            if along.middle.is_empty() {
                continue;
            }
            let range = at * edges..(at + 1) * edges;
            let (middle, edge) = (&contracted.middle[range.clone()], &contracted.edge[range]);
            for (target, value) in line.iter_mut().enumerate() {
                *value = along.dot(target as i64, middle, edge);
            }
            for (depth, rise) in depths.iter().zip(rise.chunks_exact_mut(columns)) {
                let factor = self.amplitude * weight * (-depth * depth / age).exp();
                if factor > 0.0 {
                    rise.iter_mut().zip(&line).for_each(|(sum, value)| *sum += factor * value);
                }
            }
        }
    }
}

impl Influence {
    /// Returns the total influence of some bodies on the surface of a grid.
    #[must_use]
    pub fn of(
        grid: &Structured,
        bodies: impl Iterator<Item = HalfSpace>,
        convolution: &mut Convolution,
    ) -> Self {
        let zeros = vec![0.0; 2 * grid.points()];
        let mut tables = [zeros.clone(), zeros];
        let work = bodies.map(|body| body.add_to(&mut tables)).sum();
        let (columns, rows_apart) = (grid.ni as i32, 2 * grid.ni);
        // The convolution is indexed by target minus source.
        let of = |table: &[f64], di: i32, dj: i32| {
            let (offset, row) = (columns - di, dj.unsigned_abs() as usize);
            let inside = (1..=2 * columns).contains(&offset);
            if inside { table[row * rows_apart + offset as usize - 1] } else { 0.0 }
        };
        let spectra = tables.each_ref().map(|table| convolution.spectrum(|i, j| of(table, i, j)));
        Self { columns: grid.ni, spectra, work }
    }

    /// Returns the number of multiply-adds of the setup.
    #[must_use]
    pub fn work(&self) -> u64 {
        self.work
    }

    /// Returns the sum of the influences of two bodies under the same flux.
    #[must_use]
    pub fn sum(bodies: [&Self; 2]) -> Self {
        let [one, other] = bodies;
        let add =
            |k: usize| Spectrum::combine([&one.spectra[k], &other.spectra[k]], |[a, b]| a + b);
        Self { columns: one.columns, spectra: [add(0), add(1)], work: one.work + other.work }
    }

    /// Returns the spectrum of the influence of an element's middle coefficient [m²·K/W].
    #[must_use]
    pub fn of_middle(&self) -> &Spectrum {
        &self.spectra[0]
    }

    /// Adds the surface rises of a flux on the grid [K]; `fields` is working memory for both
    /// coefficients and the result.
    pub fn add(
        &self,
        flux: &Flux,
        convolution: &mut Convolution,
        fields: &mut [Vec<f64>; 3],
        rise: &mut [f64],
    ) {
        let (columns, rows) = (self.columns, flux.rows());
        let [middle, edge, result] = fields;
        for field in [&mut *middle, &mut *edge, &mut *result] {
            field.resize((columns + 1) * rows, 0.0);
        }
        let lines = middle.chunks_exact_mut(columns + 1).zip(edge.chunks_exact_mut(columns + 1));
        for (row, (middle, edge)) in lines.enumerate() {
            let from = flux.row(row);
            middle[..columns].copy_from_slice(&from.middle[..columns]);
            middle[columns] = 0.0;
            edge.copy_from_slice(&from.edge[..=columns]);
        }
        let [of_middle, of_edge] = &self.spectra;
        convolution.apply_sum([of_middle, of_edge], [middle, edge], result);
        let lines = result.chunks_exact(columns + 1).zip(rise.chunks_exact_mut(columns));
        for (from, to) in lines {
            to.iter_mut().zip(from).for_each(|(sum, value)| *sum += value);
        }
    }
}

impl Along {
    /// Returns the sum over the coefficients of a row, seen from a target.
    fn dot(&self, target: i64, middle: &[f64], edge: &[f64]) -> f64 {
        let start = self.first + target;
        let begin = start.max(0);
        let end = (start + self.middle.len() as i64).min(middle.len() as i64);
        if end <= begin {
            return 0.0;
        }
        let skipped = (begin - start) as usize;
        let range = begin as usize..end as usize;
        let weights = self.middle[skipped..].iter().zip(&self.edge[skipped..]);
        let values = middle[range.clone()].iter().zip(&edge[range]);
        weights.zip(values).map(|((wm, we), (m, e))| wm * m + we * e).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::search::maximum;

    struct Heated {
        body: HalfSpace,
        grid: Structured,
        flux: Flux,
        rise: Vec<f64>,
    }

    /// A body of conductivity 1 under a flux at this Péclet number Va/2κ, a = 1.
    fn heated(peclet: f64, grid: Structured, flux: impl Fn(f64, f64) -> f64) -> Heated {
        let mut convolution = convolution(&grid);
        let body = HalfSpace::new(&grid, 1.0, 1.0, PastInterval::steady(2.0 * peclet));
        let means: Vec<f64> = (0..grid.points())
            .map(|at| {
                let (x, y) = (grid.x(at % grid.ni), grid.y(at / grid.ni));
                // Element mean from 8 × 8 points.
                let place = |k: usize| (k as f64 - 3.5) / 8.0;
                let sum: f64 = (0..64)
                    .map(|k| flux(x + place(k % 8) * grid.dx(), y + place(k / 8) * grid.dy()))
                    .sum();
                sum / 64.0
            })
            .collect();
        let mut reconstructed = Flux::zero(grid.ni, grid.nj);
        reconstructed.reconstruct(&means);
        let (mut rise, mut fields) = (vec![0.0; grid.points()], Default::default());
        let influence = body.influence(&mut convolution);
        influence.add(&reconstructed, &mut convolution, &mut fields, &mut rise);
        Heated { body, grid, flux: reconstructed, rise }
    }

    impl Heated {
        fn peak(&self) -> (f64, f64) {
            let at =
                (0..self.rise.len()).reduce(|a, b| if self.rise[b] > self.rise[a] { b } else { a });
            let at = at.unwrap();
            let (x, row) = (self.grid.x(at % self.grid.ni), at / self.grid.ni);
            let contracted = self.body.contract(&self.flux, row);
            let dx = self.grid.dx();
            maximum(x - dx, x + dx, |x| self.body.shares_at(&contracted, x).iter().sum())
        }
    }

    fn covering(a: f64, b: f64, n: usize) -> Structured {
        let (dx, dy) = (a / n as f64, b / n as f64);
        let half = |semi: f64, side: f64| -(semi - 0.5 * side);
        Structured::contact_plane(half(a, dx), half(b, dy), dx, dy, 2 * n, 2 * n)
    }

    /// Returns the largest rise, as T λ/(q₀ a), and its position.
    fn peak_of(
        peclet: f64,
        [a, b]: [f64; 2],
        n: usize,
        flux: impl Fn(f64, f64) -> f64,
    ) -> (f64, f64) {
        let (x, rise) = heated(peclet, covering(a, b, n), flux).peak();
        (rise, x)
    }

    /// The moving Hertz ellipse of the paper's case from rest to high speed, against an independent
    /// quadrature of Carslaw and Jaeger's kernel. Tolerance: 1e-3, that of the references; 32
    /// elements a semi-axis have an error of 3e-4.
    #[test]
    fn a_hertz_ellipse_at_any_speed() {
        let b = 6.01 / 7.98;
        let hertz = |x: f64, y: f64| (1.0 - x * x - (y / b) * (y / b)).max(0.0).sqrt();
        for (peclet, rise, x) in [
            (0.0, 0.678_185, 0.0),
            (10.0, 0.254_120, -0.5737),
            (100.0, 0.086_553, -0.6446),
            (1e4, 0.008_729, -0.6522),
        ] {
            let (found, at) = peak_of(peclet, [1.0, b], 32, hertz);
            println!("Pe = {peclet}: {found:.6} at {at:.4}");
            assert!((found / rise - 1.0).abs() < 1e-3, "Pe = {peclet}: {found}");
            assert!((at - x).abs() < 1e-3, "Pe = {peclet}: at {at}");
        }
    }

    /// Second order in the element size: the flux is constant across an element.
    #[test]
    fn the_peak_converges_with_second_order() {
        let hertz = |x: f64, y: f64| (1.0 - x * x - y * y).max(0.0).sqrt();
        for peclet in [0.0, 30.0] {
            let [coarse, middle, fine] =
                [8, 16, 32].map(|n| peak_of(peclet, [1.0, 1.0], n, hertz).0);
            let order = ((middle - coarse) / (fine - middle)).log2();
            assert!((1.7..2.6).contains(&order), "Pe = {peclet}: {order}");
        }
    }

    /// A disc at rest under a uniform flux warms by q₀ a/λ, under Hertz's flux by π/4 of that.
    /// Tolerance: the elements cut by the edge.
    #[test]
    fn a_disc_at_rest() {
        let inside = |x: f64, y: f64| if x * x + y * y < 1.0 { 1.0 } else { 0.0 };
        let hertz = |x: f64, y: f64| (1.0 - x * x - y * y).max(0.0).sqrt();
        let (uniform, _) = peak_of(0.0, [1.0, 1.0], 32, inside);
        assert!((uniform - 1.0).abs() < 1e-3, "{uniform}");
        let (elliptic, _) = peak_of(0.0, [1.0, 1.0], 32, hertz);
        assert!((elliptic - 0.25 * PI).abs() < 5e-4, "{elliptic}");
    }

    /// The band of half width b at V b/2κ = 1, 5, 10: π λ V T/(2 κ q) by Jaeger's integral.
    /// Tolerance: the jumps of the flux, of second order, and the ends of a band that is a thousand
    /// times as wide.
    #[test]
    fn jaegers_band() {
        for (peclet, expected) in [(1.0, 3.11599), (5.0, 7.6127), (10.0, 10.9484)] {
            let n = 400;
            let side = 1.0 / 200.0;
            let grid = Structured::contact_plane(
                -1.0 + 0.5 * side - 40.0 * side,
                0.0,
                side,
                2e3,
                n + 80,
                1,
            );
            let band = |x: f64, _: f64| if x.abs() < 1.0 { 1.0 } else { 0.0 };
            let (_, rise) = heated(peclet, grid, band).peak();
            let found = PI * peclet * rise;
            assert!((found / expected - 1.0).abs() < 1e-3, "{peclet}: {found}");
        }
    }

    /// Tian and Kennedy's fits for circles under Hertz's flux and under a uniform flux, J. Tribol.
    /// 116 (1994) 167–174, over the mean flux. Tolerance: 1.2 %, the error of the first fit. The
    /// second fit is 2.1 % off at Pe = 1, where discs and bands here agree with their own
    /// references.
    #[test]
    fn tian_and_kennedys_fits() {
        let inside = |x: f64, y: f64| if x * x + y * y < 1.0 { 1.0 } else { 0.0 };
        let hertz = |x: f64, y: f64| 1.5 * (1.0 - x * x - y * y).max(0.0).sqrt();
        for peclet in [0.0, 0.3, 1.0, 3.0, 10.0, 100.0, 1000.0] {
            let (elliptic, _) = peak_of(peclet, [1.0, 1.0], 24, hertz);
            let fit = 2.32 / (PI * (1.234 + peclet)).sqrt();
            assert!((elliptic / fit - 1.0).abs() < 0.012, "Pe = {peclet}: {elliptic} {fit}");
            let (uniform, _) = peak_of(peclet, [1.0, 1.0], 24, inside);
            let fit = 2.0 / (PI * (1.273 + peclet)).sqrt();
            assert!((uniform / fit - 1.0).abs() < 0.022, "Pe = {peclet}: {uniform} {fit}");
        }
    }

    /// At high speed the rises below the surface are those of columns. At every depth the section
    /// agrees with single places. Tolerance: 1/Pe, and rounding.
    #[test]
    fn depths_agree_with_single_places() {
        let hertz = |x: f64, y: f64| (1.0 - x * x - y * y).max(0.0).sqrt();
        let heated = heated(50.0, covering(1.0, 1.0, 12), hertz);
        let contracted = heated.body.contract(&heated.flux, 11);
        let depths = [0.0, 0.05, 0.2];
        let columns = heated.grid.ni;
        let mut section = vec![0.0; depths.len() * columns];
        heated.body.section(&contracted, &depths, &mut section);
        for i in 0..columns {
            let shares = heated.body.shares_at(&contracted, heated.grid.x(i));
            let largest = section.iter().copied().fold(0.0, f64::max);
            assert!((section[i] - heated.rise[11 * columns + i]).abs() < 1e-12 * largest);
            for (level, depth) in depths.iter().enumerate() {
                let one = heated.body.rise_below(&shares, *depth);
                assert!(
                    (section[level * columns + i] - one).abs() < 1e-12 * largest,
                    "{i} {depth}"
                );
            }
        }
    }
}
