//! Stresses on a vertical section y = constant below all columns of a grid.
//!
//! σ(x_i, z) = Σ_j Σ_i' K(x_i − x_i', y − y_j, z) f(i', j): for each depth and row of elements this
//! is a convolution along x, done by real Fourier transforms of length P ≥ 2 n_x − 1. The results
//! of the rows are added in Fourier space, so that a depth takes six inverse transforms. A stress
//! even in x and a stress odd in x by the same load share a transform, since the transform of an
//! even sequence is real and that of an odd one imaginary. Four transforms, of the sums xx + xy,
//! yy + xz, and of zz and yz alone, then give the six stresses for each of the three loads.
//!
//! Where y lies on a row or halfway between rows, rows at ±(y − y_j) have the same kernels except
//! for signs, and are combined by sums and differences of their loads.
//!
//! Corners are shared: the antiderivatives on an edge line between two rows are evaluated once.

use super::{Element, SurfaceLoad, UnitStresses};
use elastic::Stress;
use grids::Structured;
use numerics::convolution::{Complex64, smooth_size};
use numerics::fourier::{ComplexToReal, Real, RealToComplex};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Distance from half a row, in rows, within which y counts as symmetric to the rows: rounding of
/// y_j.
const SYMMETRIC: f64 = 1e-10;

/// Kinds of load: q_x, q_y.
const ALONG_X: usize = 1;
const ALONG_Y: usize = 2;

/// Components that share a transform: the first is even in x and the second odd, and the reverse
/// under q_x. Numbers follow [`Stress::components`].
const PAIRS: [(usize, Option<usize>); 4] = [(0, Some(5)), (1, Some(4)), (2, None), (3, None)];

/// Components that are odd in y; under q_y the other components are.
const ODD_IN_Y: [bool; 6] = [false, false, false, true, false, true];

/// Rows of elements whose distance |y − y_j| is the same.
struct EquidistantRows {
    /// Twice the distance in elements, counted from `Section::base`.
    key: i64,
    /// Rows j and the sign of y − y_j against the distance of the kernel.
    members: Vec<(usize, f64)>,
}

/// Cost of the stresses on one section.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SectionCost {
    /// Corners at which antiderivatives were evaluated.
    pub corners: usize,
    /// Transforms of length P.
    pub transforms: usize,
}

/// Plans and working memory for the stresses on one section; a solve allocates nothing.
pub struct Section {
    grid: Structured,
    element: Element,
    depths: Vec<f64>,
    rows: Vec<EquidistantRows>,
    /// Distance of key 0 [m].
    base: f64,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    line: Vec<f64>,
    spectrum: Vec<Complex64>,
    scratch: Vec<Complex64>,
    /// Transformed sums and differences of the loads of `rows`, for p, q_x, q_y.
    loads: [[Vec<Complex64>; 2]; 3],
    /// Load components in use, for each of `rows`.
    active: Vec<[bool; 3]>,
    /// Antiderivatives on the lower and upper edge line of the current row, and their keys.
    edges: [(Option<i64>, Vec<UnitStresses>); 2],
    /// Unit stresses by p, q_x, q_y at offsets 0..ni of the current row.
    kernels: Vec<[[f64; 6]; 3]>,
    /// Transformed stresses of the current depth; components as in [`Stress::components`].
    sums: [Vec<Complex64>; 6],
    /// Stresses of the current depth.
    lines: [Vec<f64>; 6],
    effort: SectionCost,
}

impl std::fmt::Debug for Section {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (ni, depths, rows) = (self.grid.ni, self.depths.len(), self.rows.len());
        write!(formatter, "Section({ni} x {depths} points below {rows} different rows)")
    }
}

impl Section {
    /// Creates a section at `y` [m], with points below the centres of all columns of a
    /// contact-plane grid, at `depths` ≥ 0 [m], in a body of the given Poisson's ratio [-].
    ///
    /// # Panics
    /// If the grid is empty, `y` not finite, or a depth negative or not finite.
    #[must_use]
    pub fn new(grid: &Structured, poisson_ratio: f64, y: f64, depths: &[f64]) -> Self {
        let inside = |depth: &f64| *depth >= 0.0 && depth.is_finite();
        assert!(
            grid.points() > 0 && y.is_finite() && depths.iter().all(inside),
            "{grid:?}, depths {depths:?}"
        );
        let padded = 2 * smooth_size(grid.ni);
        let (forward, inverse) = f64::real(padded);
        let scratch = forward.get_scratch_len().max(inverse.get_scratch_len());
        let zeros = |len: usize| vec![Complex64::default(); len];
        let (rows, base) = distances(grid, y);
        let columns = padded / 2 + 1;
        let load = || zeros(rows.len() * columns);
        Self {
            grid: *grid,
            element: Element { dx: grid.dx(), dy: grid.dy(), poisson_ratio },
            depths: depths.to_vec(),
            base,
            forward,
            inverse,
            line: vec![0.0; padded],
            spectrum: zeros(columns),
            scratch: zeros(scratch),
            loads: std::array::from_fn(|_| [load(), load()]),
            active: vec![[false; 3]; rows.len()],
            edges: std::array::from_fn(|_| (None, vec![UnitStresses::default(); grid.ni + 1])),
            kernels: vec![[[0.0; 6]; 3]; grid.ni],
            sums: std::array::from_fn(|_| zeros(columns)),
            lines: std::array::from_fn(|_| vec![0.0; grid.ni]),
            effort: SectionCost::default(),
            rows,
        }
    }

    /// Number of points, ni × depths.
    #[must_use]
    pub fn points(&self) -> usize {
        self.grid.ni * self.depths.len()
    }

    /// Computes the stresses under a load [Pa]; point (i, d) has the index d·ni + i. Rows and load
    /// components that are zero cost nothing.
    ///
    /// # Panics
    /// If the load is on another grid or `output` has another length than [`Section::points`].
    pub fn stresses(&mut self, load: &SurfaceLoad<'_>, output: &mut [Stress]) -> SectionCost {
        assert_eq!(output.len(), self.points(), "stresses of the section");
        self.solve(load, |index, stress| output[index] = stress)
    }

    /// Computes the von Mises stress and the largest shear stress under a load [Pa], in the order
    /// of [`Section::stresses`]. The stresses `besides`, if any, are added first.
    ///
    /// # Panics
    /// If the load is on another grid or a slice has another length than [`Section::points`].
    pub fn equivalents(
        &mut self,
        load: &SurfaceLoad<'_>,
        besides: Option<&[Stress]>,
        von_mises: &mut [f64],
        max_shear: &mut [f64],
    ) -> SectionCost {
        let points = self.points();
        assert_eq!([von_mises.len(), max_shear.len()], [points; 2], "values on the section");
        assert_eq!(besides.map_or(points, <[Stress]>::len), points, "stresses on the section");
        self.solve(load, |index, stress| {
            let stress = besides.map_or(stress, |besides| stress + besides[index]);
            von_mises[index] = stress.von_mises();
            max_shear[index] = stress.max_shear();
        })
    }

    /// Calls `store` with the index and stress of every point.
    fn solve(
        &mut self,
        load: &SurfaceLoad<'_>,
        mut store: impl FnMut(usize, Stress),
    ) -> SectionCost {
        assert_eq!(*load.grid, self.grid, "a load on another grid than the section's");
        self.effort = SectionCost::default();
        self.transform_loads(load);
        let ni = self.grid.ni;
        for level in 0..self.depths.len() {
            self.sum_rows(self.depths[level]);
            self.transform_back();
            for i in 0..ni {
                let [xx, yy, zz, yz, xz, xy] = [0, 1, 2, 3, 4, 5].map(|at| self.lines[at][i]);
                store(level * ni + i, Stress { xx, yy, zz, yz, xz, xy });
            }
        }
        self.effort
    }

    /// Transforms sums and differences of the loads of every set of rows.
    fn transform_loads(&mut self, load: &SurfaceLoad<'_>) {
        let (ni, columns) = (self.grid.ni, self.spectrum.len());
        for (place, (rows, active)) in self.rows.iter().zip(&mut self.active).enumerate() {
            for (kind, field) in load.fields.iter().enumerate() {
                let of_row = |j: usize| field.get(j * ni..(j + 1) * ni).unwrap_or(&[]);
                let mut values = rows.members.iter().flat_map(|(j, _)| of_row(*j));
                active[kind] = values.any(|value| *value != 0.0);
                if !active[kind] {
                    continue;
                }
                for (target, odd) in self.loads[kind].iter_mut().zip([false, true]) {
                    self.line.fill(0.0);
                    for (j, sign) in &rows.members {
                        let factor = if odd { *sign } else { 1.0 };
                        for (sum, value) in self.line.iter_mut().zip(of_row(*j)) {
                            *sum += factor * value;
                        }
                    }
                    let range = place * columns..(place + 1) * columns;
                    self.forward
                        .process_with_scratch(&mut self.line, &mut target[range], &mut self.scratch)
                        .expect("all lengths are the plan's");
                    self.effort.transforms += 1;
                }
            }
        }
    }

    /// Sums the transformed stresses at a depth over all rows.
    fn sum_rows(&mut self, depth: f64) {
        self.sums.iter_mut().for_each(|sum| sum.fill(Complex64::default()));
        self.edges.iter_mut().for_each(|edge| edge.0 = None);
        for place in 0..self.rows.len() {
            let active = self.active[place];
            if active == [false; 3] {
                continue;
            }
            self.unit_stresses(self.rows[place].key, depth);
            for kind in (0..3).filter(|kind| active[*kind]) {
                for pair in PAIRS {
                    self.add_pair(place, kind, pair);
                }
            }
        }
    }

    /// Unit stresses by an element of the rows with this key, divided by the transform length P.
    fn unit_stresses(&mut self, key: i64, depth: f64) {
        if self.edges[1].0 == Some(key - 1) {
            self.edges.swap(0, 1);
        } else {
            self.edge_line(0, key - 1, depth);
        }
        self.edge_line(1, key + 1, depth);
        let scale = 1.0 / self.line.len() as f64;
        let [(_, low), (_, high)] = &self.edges;
        for (kernel, (low, high)) in
            self.kernels.iter_mut().zip(low.windows(2).zip(high.windows(2)))
        {
            let ends = [1, 0].map(|end| high[end].plus(-1.0, &low[end]));
            *kernel = ends[0].plus(-1.0, &ends[1]).components().map(|one| one.map(|v| v * scale));
        }
    }

    /// Evaluates the antiderivatives on an edge line.
    fn edge_line(&mut self, edge: usize, key: i64, depth: f64) {
        let distance = self.base + 0.5 * key as f64 * self.element.dy;
        let (line, values) = &mut self.edges[edge];
        for (node, value) in values.iter_mut().enumerate() {
            *value = self.element.corner((node as f64 - 0.5) * self.element.dx, distance, depth);
        }
        *line = Some(key);
        self.effort.corners += self.grid.ni + 1;
    }

    /// Adds the effect of one load component on a set of rows to one or two stress components.
    fn add_pair(&mut self, place: usize, kind: usize, (first, second): (usize, Option<usize>)) {
        let first_even = kind != ALONG_X;
        let mirrored = if first_even { 1.0 } else { -1.0 };
        self.line.fill(0.0);
        for (offset, kernel) in self.kernels.iter().enumerate() {
            let one = kernel[kind][first];
            let other = second.map_or(0.0, |second| kernel[kind][second]);
            self.line[offset] = one + other;
            if offset > 0 {
                let len = self.line.len();
                self.line[len - offset] = mirrored * (one - other);
            }
        }
        self.forward
            .process_with_scratch(&mut self.line, &mut self.spectrum, &mut self.scratch)
            .expect("all lengths are the plan's");
        self.effort.transforms += 1;
        let columns = self.spectrum.len();
        for (component, even) in [(Some(first), first_even), (second, !first_even)] {
            let Some(component) = component else { continue };
            let turned = ODD_IN_Y[component] != (kind == ALONG_Y);
            let load = &self.loads[kind][usize::from(turned)][place * columns..];
            let terms = self.sums[component].iter_mut().zip(&self.spectrum).zip(load);
            if even {
                terms.for_each(|((sum, kernel), load)| *sum += load * kernel.re);
            } else {
                let turn = |load: &Complex64| Complex64::new(-load.im, load.re);
                terms.for_each(|((sum, kernel), load)| *sum += turn(load) * kernel.im);
            }
        }
    }

    /// Transforms the stresses of a depth back.
    fn transform_back(&mut self) {
        for (sum, output) in self.sums.iter_mut().zip(&mut self.lines) {
            // The imaginary parts are zero except for rounding; the plan requires exact zeros.
            sum[0].im = 0.0;
            sum.last_mut().expect("a spectrum is not empty").im = 0.0;
            self.inverse
                .process_with_scratch(sum, &mut self.line, &mut self.scratch)
                .expect("all lengths are the plan's and the ends are real");
            output.copy_from_slice(&self.line[..self.grid.ni]);
            self.effort.transforms += 1;
        }
    }
}

/// Rows by distance from `y`, nearest or lowest first, and the distance of key 0.
fn distances(grid: &Structured, y: f64) -> (Vec<EquidistantRows>, f64) {
    let from_first = y - grid.y(0);
    let halves = 2.0 * from_first / grid.dy();
    let symmetric = (halves - halves.round()).abs() < 2.0 * SYMMETRIC;
    let shift = if symmetric { halves.round() as i64 } else { 0 };
    let mut by_key = BTreeMap::<i64, Vec<(usize, f64)>>::new();
    for j in 0..grid.nj {
        let twice = i64::try_from(2 * j).expect("a grid in memory has fewer rows");
        let key = shift - twice;
        let (key, sign) = if symmetric && key < 0 { (-key, -1.0) } else { (key, 1.0) };
        by_key.entry(key).or_default().push((j, sign));
    }
    let rows = by_key.into_iter().map(|(key, members)| EquidistantRows { key, members }).collect();
    (rows, if symmetric { 0.0 } else { from_first })
}
