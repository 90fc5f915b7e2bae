//! Operator from tractions to slip, and an approximate inverse.
//!
//! **Shift, and the first step of transient rolling.** The slip distance of the step is
//! S = w Δq + A p − u'. Here u' is the displacement difference that the particle had before: in a
//! shift at the same place, in rolling by Δq = Δx at the upstream element I + e_x. The operator is
//! A itself, and u' is known.
//!
//! **Steady rolling.** A particle at element I was at the upstream element I + e_x one step Δq = Δx
//! earlier. The displacement difference u = A p of the bodies grew on the way, and the slip
//! distance of the step is
//!
//! S_I = w_I Δq + (A p)_I − (A p)_{I+e_x} = w_I Δq + (B p)_I,   B = (1 − S) A,
//!
//! with the rigid slip w [-] and the upstream shift S. B is a convolution like A, but not
//! symmetric. This is the upwind difference of [`super::difference`]; Fromm's is
//! B = (1 − S)(S⁻¹ + 4 − S) A/4.
//!
//! **Further steps of transient rolling** take the difference of steady rolling along x, and the
//! second-order backward difference in time: S = w Δq + B p + (3A p − 4u' + u'')/2, with the
//! displacement differences u' and u'' of the same element one and two steps ago
//! ([`super::difference`]).
//!
//! **Memory.** Viscoelastic bodies have the K of [`super::viscoelastic`] in place of A. The layer
//! has no memory.
//!
//! **Displaced rows** ([`super::aligned`]) have a phase before and behind A and the approximate
//! inverse ([`numerics::convolution::Convolution::displace_rows`]), and exact influence numbers
//! between near rows. The difference multiplies A wave by wave.
//!
//! **Layer.** A third body of tangential flexibility L [m/Pa] adds L to the diagonal of A_xx, A_yy.
//!
//! **Approximate inverse.** In Fourier space B is (1 − e^{iθ}) Â with the wave number θ along x in
//! radians per element. B vanishes for waves that do not vary along x, so it has no inverse on the
//! infinite plane, although it has one on a patch of length 2a. P = [(1 − ρS) A]⁻¹ with the damped
//! shift ρ = e^{−c Δx/a} limits the memory of the shift to the patch's own length. Restricted to
//! the elements of adhesion, P is a preconditioner with which GMRES takes at most 14 iterations to
//! 1e-6 at a/10 and 23 at a/80 (test `linear_steps_hardly_depend_on_the_resolution`); c hardly
//! matters. Periodic images do not affect P, so its grid is padded by a tenth only. P serves
//! Fromm's difference too: including the factor (S⁻¹ + 4 − S)/4 would only add iterations.
//! Triangular windows taper A, which keeps its symbol positive definite on a finite grid (Fejér).
//!
//! Sources: Kalker, *Three-Dimensional Elastic Bodies in Rolling Contact* (1990) ch. 4 for the
//! discretisation; Vollebregt, Wear 314 (2014) for Fourier preconditioning of the shift problem.
//! The damped shift is this project's.

use super::aligned::AlignedGrid;
use super::difference::Stencil;
use super::influence::{EvenOffsetTable, Influence};
use super::viscoelastic::{Bodies, RollingInfluenceNumbers};
use grids::Structured;
use numerics::convolution::{Complex64, Convolution, EvenSpectrum, Spectrum};
use numerics::fourier::Real;

/// Length of the memory of the damped shift, in semi-axes.
const MEMORY: f64 = 1.5;
/// Share of a side that is rounding.
const ROUNDING: f64 = 1e-6;

/// A symmetric tensor of kernels \[xx, yy, xy\], and the convolution that applies it.
#[derive(Debug)]
struct Tensor<T> {
    convolution: Convolution<T>,
    kernels: Kernels<T>,
}

#[derive(Debug)]
enum Kernels<T> {
    /// Kernels of elastic bodies, even under a reversal of both distances.
    Even([EvenSpectrum<T>; 3]),
    /// Kernels of viscoelastic bodies.
    Any([Spectrum<T>; 3]),
}

impl Tensor<f64> {
    fn of(mut convolution: Convolution, kernel: impl Fn(i32, i32) -> [f64; 3]) -> Self {
        let component = |k: usize| convolution.spectrum(|i, j| kernel(i, j)[k]);
        let kernels = Kernels::Any([0, 1, 2].map(component));
        Self { convolution, kernels }
    }

    /// Rounds the tensor times a factor to single precision, for a convolution on the same grid.
    fn rounded(&self, convolution: Convolution<f32>, factor: f64) -> Tensor<f32> {
        let kernels = match &self.kernels {
            Kernels::Even(kernels) => Kernels::Even(kernels.each_ref().map(|k| k.rounded(factor))),
            Kernels::Any(kernels) => Kernels::Any(kernels.each_ref().map(|k| k.rounded(factor))),
        };
        Tensor { convolution, kernels }
    }
}

impl<T: Real> Tensor<T> {
    fn apply(&mut self, input: [&[T]; 2], output: [&mut [T]; 2]) {
        match &self.kernels {
            Kernels::Even(kernels) => self.convolution.apply_even_tensor(kernels, input, output),
            Kernels::Any([xx, yy, xy]) => {
                self.convolution.apply_tensor(&[[xx, xy], [xy, yy]], input, output);
            }
        }
    }
}

/// Influence of elastic bodies on a grid whose rows may be displaced, A.
#[derive(Debug)]
pub struct RowInfluence {
    convolution: Convolution,
    kernels: [EvenSpectrum; 3],
    /// Displacements of the rows [elements]; `None` on a regular grid.
    displacements: Option<Vec<f64>>,
    /// Influence numbers over whole elements.
    table: Table,
    shape: [usize; 2],
}

/// Purpose of an operator of displaced rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accuracy {
    /// The solution: exact between near rows.
    Full,
    /// A start for a finer grid.
    Start,
}

impl Accuracy {
    /// Number of rows on either side whose influence is exact.
    fn reach(self, grid: &Structured) -> usize {
        match self {
            Self::Start => 0,
            Self::Full if grid.dy() > (1.0 - ROUNDING) * grid.dx() => 1,
            Self::Full => (grid.dx() / grid.dy()).ceil() as usize + 1,
        }
    }
}

impl RowInfluence {
    /// Creates the operator, with the flexibility of a layer [m/Pa].
    #[must_use]
    pub fn new(rows: &AlignedGrid, bodies: &Bodies, layer: f64, accuracy: Accuracy) -> Self {
        let grid = rows.grid();
        let influence = Influence::of_grid(grid, bodies.instantaneous);
        let shape = [grid.ni, grid.nj];
        let displacements = rows.displacements();
        let mut convolution = convolution_of_rows(shape, displacements);
        let width = convolution.padded_shape().0 / 2 + 1;
        let table = Table::reaching(&influence, layer, width, grid.nj);
        let regular = vec![0.0; grid.nj];
        let (places, reach) = match displacements {
            Some(displacements) => (displacements, accuracy.reach(grid)),
            None => (&regular[..], 0),
        };
        let mut component = |k: usize, between: fn(&Influence, f64, f64) -> f64| {
            let between =
                |x: f64, j: i32| between(&influence, x * influence.dx, f64::from(j) * influence.dy);
            let kernel = |i, j| table.value(i, j)[k];
            convolution.spectrum_of_rows(places, reach, kernel, between)
        };
        let kernels = [
            component(0, Influence::xx_at),
            component(1, Influence::yy_at),
            component(2, Influence::xy_at),
        ];
        let displacements = displacements.map(<[f64]>::to_vec);
        Self { convolution, kernels, displacements, table, shape }
    }
}

/// Plans a convolution on a grid whose rows may be displaced.
fn convolution_of_rows<T: Real>(
    [nx, ny]: [usize; 2],
    displacements: Option<&[f64]>,
) -> Convolution<T> {
    displaced(Convolution::of_rows(nx, ny), displacements)
}

/// Displaces the rows of a convolution, if they are displaced.
fn displaced<T: Real>(
    convolution: Convolution<T>,
    displacements: Option<&[f64]>,
) -> Convolution<T> {
    match displacements {
        Some(displacements) => convolution.displace_rows(displacements),
        None => convolution,
    }
}

/// Displacement operator: A of elastic bodies, K of viscoelastic ones.
#[derive(Debug)]
pub struct Displacement(Tensor<f64>);

impl From<RowInfluence> for Displacement {
    fn from(influence: RowInfluence) -> Self {
        let RowInfluence { convolution, kernels, .. } = influence;
        Self(Tensor { convolution, kernels: Kernels::Even(kernels) })
    }
}

impl Displacement {
    /// Creates the operator K of viscoelastic bodies on nx × ny elements of these sides [m], with
    /// the flexibility of a layer [m/Pa].
    #[must_use]
    pub fn with_memory(bodies: &Bodies, layer: f64, counts: [usize; 2], sides: [f64; 2]) -> Self {
        let table = Table::with_memory(bodies, layer, counts, sides);
        let [nx, ny] = counts;
        Self(Tensor::of(Convolution::new(nx, ny), |i, j| table.value(i, j)))
    }

    /// Sets displacement = K traction [m]; fields of nx·ny values, components x and y.
    pub fn apply(&mut self, traction: [&[f64]; 2], displacement: [&mut [f64]; 2]) {
        self.0.apply(traction, displacement);
    }
}

/// Slip operator, B of steady rolling or A, and its approximate inverse on one grid.
#[derive(Debug)]
pub struct SlipOperator {
    operator: Tensor<f64>,
    /// The operator divided by `self_influence`, and the inverse times it.
    single: Tensor<f32>,
    inverse: Tensor<f32>,
    self_influence: f64,
    applications: usize,
    preconditionings: usize,
}

impl SlipOperator {
    /// Creates the operator of viscoelastic bodies in rolling, with K in place of A, on elements
    /// dx × dy [m].
    #[must_use]
    pub fn of_memory(
        bodies: &Bodies,
        stencil: Stencil,
        layer_flexibility: f64,
        [nx, ny]: [usize; 2],
        [dx, dy]: [f64; 2],
        elements_per_semi_axis: f64,
    ) -> Self {
        let at_once = Influence::of_elements([dx, dy], bodies.instantaneous);
        let elastic = Table::new(&at_once, layer_flexibility, nx, ny);
        let table = Table::with_memory(bodies, layer_flexibility, [nx, ny], [dx, dy]);
        let damping = damping(elements_per_semi_axis);
        let growth = |upstream| bodies.growth(upstream, dx);
        let inverse = Inverse { table: &elastic, stencil, damping, growth: Some(&growth) };
        let operator = Tensor::of(Convolution::new(nx, ny), |i, j| table.slip(stencil, i, j));
        let [self_influence, ..] = table.slip(stencil, 0, 0);
        let single = operator.rounded(Convolution::new(nx, ny), self_influence.recip());
        let inverse = inverse.tensor([nx, ny], None, self_influence);
        let (applications, preconditionings) = (0, 0);
        Self { operator, single, inverse, self_influence, applications, preconditionings }
    }

    /// Creates the operator of elastic bodies with this stencil; `elements_per_semi_axis` is a/Δx.
    #[must_use]
    pub fn of_rows(
        influence: &RowInfluence,
        stencil: Stencil,
        elements_per_semi_axis: f64,
    ) -> Self {
        let RowInfluence { convolution, kernels, table, displacements, shape } = influence;
        let displacements = displacements.as_deref();
        let weights: Vec<(i32, f64)> = stencil.weights().collect();
        let factors = convolution.factors_along(&weights);
        let operator = Tensor {
            convolution: convolution_of_rows(*shape, displacements).with_factors(&factors),
            kernels: Kernels::Even(kernels.clone()),
        };
        let [self_influence, ..] = table.slip(stencil, 0, 0);
        let single = convolution_of_rows(*shape, displacements).with_factors(&factors);
        let single = operator.rounded(single, self_influence.recip());
        let damping = damping(elements_per_semi_axis);
        let inverse = Inverse { table, stencil, damping, growth: None };
        let inverse = inverse.tensor(*shape, displacements, self_influence);
        let (applications, preconditionings) = (0, 0);
        Self { operator, single, inverse, self_influence, applications, preconditionings }
    }

    /// Slip of an element by its own unit traction [m/Pa].
    #[must_use]
    pub fn self_influence(&self) -> f64 {
        self.self_influence
    }

    /// Number of products with the operator and with its approximate inverse so far.
    #[must_use]
    pub fn work(&self) -> (usize, usize) {
        (self.applications, self.preconditionings)
    }

    /// Sets slip = B traction, or A traction [m]; fields of nx·ny values, components x and y.
    pub fn apply(&mut self, traction: [&[f64]; 2], slip: [&mut [f64]; 2]) {
        self.applications += 1;
        self.operator.apply(traction, slip);
    }

    /// Like [`SlipOperator::apply`] in single precision, divided by
    /// [`SlipOperator::self_influence`] [Pa].
    pub fn apply_single(&mut self, traction: [&[f32]; 2], slip: [&mut [f32]; 2]) {
        self.applications += 1;
        self.single.apply(traction, slip);
    }

    /// Sets traction ≈ B⁻¹ slip, or A⁻¹ slip, in single precision, times
    /// [`SlipOperator::self_influence`] [m].
    pub fn apply_inverse(&mut self, slip: [&[f32]; 2], traction: [&mut [f32]; 2]) {
        self.preconditionings += 1;
        self.inverse.apply(slip, traction);
    }
}

/// Damping ρ of the shift of steady rolling.
fn damping(elements_per_semi_axis: f64) -> f64 {
    (-MEMORY / elements_per_semi_axis).exp()
}

/// Inputs of an approximate inverse.
#[derive(Clone, Copy)]
struct Inverse<'a> {
    /// Influence numbers of the instantaneous response.
    table: &'a Table,
    stencil: Stencil,
    /// Damping ρ of the shift.
    damping: f64,
    /// Symbol of K over A, as a function of the symbol of the shift.
    growth: Option<&'a dyn Fn(Complex64) -> Complex64>,
}

impl Inverse<'_> {
    /// Creates the inverse times a factor, for rows that may be displaced.
    fn tensor(
        self,
        [nx, ny]: [usize; 2],
        displacements: Option<&[f64]>,
        factor: f64,
    ) -> Tensor<f32> {
        let window = |at: i32, count: usize| 1.0 - f64::from(at.unsigned_abs()) / count as f64;
        let mut convolution = Convolution::barely_padded(nx, ny);
        let component = |k: usize| {
            convolution.spectrum(|i, j| window(i, nx) * window(j, ny) * self.table.value(i, j)[k])
        };
        let [xx, yy, xy] = [0, 1, 2].map(component);
        let of = |which: fn(f64, f64, f64) -> f64| {
            let inverse = Spectrum::combine([&xx, &yy, &xy], |[xx, yy, xy]| {
                let (xx, yy, xy) = (xx.re, yy.re, xy.re);
                (which(xx, yy, xy) / (xx * yy - xy * xy)).into()
            });
            inverse.even().rounded(factor)
        };
        let kernels = [of(|_, yy, _| yy), of(|xx, _, _| xx), of(|_, _, xy| -xy)];
        // A line of one element has no upstream element.
        let upstream = if nx > 1 { 1.0 } else { 0.0 };
        let shift = |at: Complex64| {
            let along = self.stencil.along.map_or(0.0.into(), |_| 1.0 - at * self.damping);
            (along + self.stencil.own) * self.growth.map_or(1.0.into(), |growth| growth(at))
        };
        let upstream = convolution.factors_along(&[(1, upstream)]);
        let factors: Vec<Complex64> = upstream.into_iter().map(|at| shift(at).inv()).collect();
        let convolution = displaced(Convolution::barely_padded(nx, ny), displacements);
        let convolution = convolution.with_factors(&factors);
        Tensor { convolution, kernels: Kernels::Even(kernels) }
    }
}

/// Influence numbers [xx, yy, xy] at all offsets needed.
#[derive(Debug)]
enum Table {
    /// Numbers of elastic bodies.
    Elastic(EvenOffsetTable<[f64; 3]>),
    /// Numbers of viscoelastic bodies, and the flexibility of a layer.
    InternalVariables(RollingInfluenceNumbers<3>, f64),
}

impl Table {
    fn new(influence: &Influence, layer_flexibility: f64, nx: usize, ny: usize) -> Self {
        // The upstream neighbours need two more elements than the grid along x.
        Self::reaching(influence, layer_flexibility, nx + 2, ny)
    }

    /// Table of the numbers over up to `width` − 1 elements along x.
    fn reaching(influence: &Influence, layer_flexibility: f64, width: usize, ny: usize) -> Self {
        let value = |i, j| {
            let own = if (i, j) == (0, 0) { layer_flexibility } else { 0.0 };
            [influence.xx(i, j) + own, influence.yy(i, j) + own, influence.xy(i, j)]
        };
        Self::Elastic(EvenOffsetTable::new(width, ny, value))
    }

    fn with_memory(bodies: &Bodies, layer: f64, counts: [usize; 2], sides: [f64; 2]) -> Self {
        let numbers = RollingInfluenceNumbers::new(counts, sides, bodies, |of, x, y| {
            [of.xx_at(x, y), of.yy_at(x, y), of.xy_at(x, y)]
        });
        Self::InternalVariables(numbers, layer)
    }

    /// Value at an offset. xx and yy are even and xy is odd, in both offsets for elastic bodies,
    /// across only for viscoelastic ones.
    fn value(&self, i: i32, j: i32) -> [f64; 3] {
        match self {
            Self::Elastic(quarter) => {
                let [xx, yy, xy] = quarter.value(i, j);
                [xx, yy, if (i < 0) == (j < 0) { xy } else { -xy }]
            }
            Self::InternalVariables(numbers, layer) => {
                let [xx, yy, xy] = numbers.value(i, j);
                let own = if (i, j) == (0, 0) { *layer } else { 0.0 };
                [xx + own, yy + own, if j < 0 { -xy } else { xy }]
            }
        }
    }

    /// Slip by the influence on the element and its neighbours.
    fn slip(&self, stencil: Stencil, i: i32, j: i32) -> [f64; 3] {
        stencil.of(|upstream| self.value(i + upstream, j))
    }
}
