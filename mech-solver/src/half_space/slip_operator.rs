//! From tractions to slip, and an approximate inverse.
//!
//! **Shift, and a step of transient rolling.** The slip distance of the step is
//! S = w Δq + A p − u', where u' is the displacement difference that the particle had before it: that
//! at the same place after a shift, that at the upstream element I + e_x after rolling Δq = Δx. The
//! operator is A itself, and u' is known.
//!
//! **Steady rolling.** A particle at element I was at the upstream element I + e_x one step Δq = Δx
//! earlier. The displacement difference u = A p of the bodies grew on the way, and the slip distance
//! of the step is
//!
//! S_I = w_I Δq + (A p)_I − (A p)_{I+e_x} = w_I Δq + (B p)_I,   B = (1 − S) A,
//!
//! with the rigid slip w [-] and the upstream shift S. B is a convolution like A, but not symmetric.
//!
//! **Layer.** A third body of tangential flexibility L [m/Pa] adds L to the diagonal of A_xx, A_yy.
//!
//! **Approximate inverse.** In Fourier space B is (1 − e^{iθ}) Â with the wave number θ along x in
//! radians per element. It vanishes for waves that do not vary along x, where the infinite plane has
//! no answer; a patch of length 2a has. P = [(1 − ρS) A]⁻¹ with the damped shift ρ = e^{−c Δx/a}
//! gives the shift a memory of the patch's own length. Restricted to the elements of adhesion it is
//! a preconditioner with which GMRES takes at most 14 iterations to 1e-6 at a/10 and 23 at a/80
//! (test `linear_steps_hardly_depend_on_the_resolution`), hardly depending on c. Periodic images do
//! not matter to it, so that its grid is padded by a tenth only; A is tapered by triangular windows,
//! which keeps its symbol positive definite on a finite grid (Fejér).
//!
//! Sources: Kalker, *Three-Dimensional Elastic Bodies in Rolling Contact* (1990) ch. 4 for the
//! discretisation; Vollebregt, Wear 314 (2014) for Fourier preconditioning of the shift problem.
//! The damped shift is this project's.

use super::influence::Influence;
use numerics::convolution::{Convolution, Spectrum};

/// Memory of the damped shift, in semi-axes.
const MEMORY: f64 = 1.5;

/// A symmetric tensor of spectra.
#[derive(Debug)]
struct Tensor {
    xx: Spectrum,
    yy: Spectrum,
    xy: Spectrum,
}

impl Tensor {
    fn of(convolution: &mut Convolution, kernel: impl Fn(i32, i32) -> [f64; 3]) -> Self {
        Self {
            xx: convolution.spectrum(|i, j| kernel(i, j)[0]),
            yy: convolution.spectrum(|i, j| kernel(i, j)[1]),
            xy: convolution.spectrum(|i, j| kernel(i, j)[2]),
        }
    }

    fn apply(&self, convolution: &mut Convolution, input: [&[f64]; 2], output: [&mut [f64]; 2]) {
        let kernels = [[&self.xx, &self.xy], [&self.xy, &self.yy]];
        convolution.apply_tensor(&kernels, input, output);
    }
}

/// B of steady rolling, or A, and its approximate inverse on one grid.
#[derive(Debug)]
pub struct SlipOperator {
    convolution: Convolution,
    operator: Tensor,
    rough_convolution: Convolution,
    inverse: Tensor,
    self_influence: f64,
    applications: usize,
    preconditionings: usize,
}

impl SlipOperator {
    /// B of steady rolling for nx × ny elements; `elements_per_semi_axis` is a/Δx.
    #[must_use]
    pub fn rolling(
        influence: &Influence,
        layer_flexibility: f64,
        nx: usize,
        ny: usize,
        elements_per_semi_axis: f64,
    ) -> Self {
        let table = Table::new(influence, layer_flexibility, nx, ny);
        let damping = (-MEMORY / elements_per_semi_axis).exp();
        Self::new(nx, ny, &table, Some(damping), |i, j| table.step(i, j))
    }

    /// A, the operator of a shift and of a step of transient rolling, for nx × ny elements.
    #[must_use]
    pub fn instantaneous(
        influence: &Influence,
        layer_flexibility: f64,
        nx: usize,
        ny: usize,
    ) -> Self {
        let table = Table::new(influence, layer_flexibility, nx, ny);
        Self::new(nx, ny, &table, None, |i, j| table.value(i, j))
    }

    fn new(
        nx: usize,
        ny: usize,
        table: &Table,
        damping: Option<f64>,
        kernel: impl Fn(i32, i32) -> [f64; 3],
    ) -> Self {
        let mut convolution = Convolution::new(nx, ny);
        let self_influence = kernel(0, 0)[0];
        let operator = Tensor::of(&mut convolution, kernel);
        let mut rough_convolution = Convolution::barely_padded(nx, ny);
        let inverse = approximate_inverse(&mut rough_convolution, table, damping);
        Self {
            convolution,
            operator,
            rough_convolution,
            inverse,
            self_influence,
            applications: 0,
            preconditionings: 0,
        }
    }

    /// Slip of an element by its own unit traction [m/Pa].
    #[must_use]
    pub fn self_influence(&self) -> f64 {
        self.self_influence
    }

    /// Products with the operator, and with its approximate inverse, so far.
    #[must_use]
    pub fn work(&self) -> (usize, usize) {
        (self.applications, self.preconditionings)
    }

    /// slip = B traction, or A traction [m]; fields of nx·ny values, components x and y.
    pub fn apply(&mut self, traction: [&[f64]; 2], slip: [&mut [f64]; 2]) {
        self.applications += 1;
        self.operator.apply(&mut self.convolution, traction, slip);
    }

    /// traction ≈ B⁻¹ slip, or A⁻¹ slip [Pa].
    pub fn apply_inverse(&mut self, slip: [&[f64]; 2], traction: [&mut [f64]; 2]) {
        self.preconditionings += 1;
        self.inverse.apply(&mut self.rough_convolution, slip, traction);
    }
}

fn approximate_inverse(
    convolution: &mut Convolution,
    table: &Table,
    damping: Option<f64>,
) -> Tensor {
    let (nx, ny) = convolution.shape();
    let window = |at: i32, count: usize| 1.0 - f64::from(at.unsigned_abs()) / count as f64;
    let direct = Tensor::of(convolution, |i, j| {
        let weight = window(i, nx) * window(j, ny);
        table.value(i, j).map(|value| weight * value)
    });
    let shift = convolution.spectrum(|i, j| match (i, j) {
        (0, 0) => 1.0,
        (-1, 0) => -damping.unwrap_or(0.0),
        _ => 0.0,
    });
    let of = |which: fn(f64, f64, f64) -> f64| {
        Spectrum::combine([&direct.xx, &direct.yy, &direct.xy, &shift], |[xx, yy, xy, shift]| {
            let (xx, yy, xy) = (xx.re, yy.re, xy.re);
            shift.inv() * (which(xx, yy, xy) / (xx * yy - xy * xy))
        })
    };
    Tensor { xx: of(|_, yy, _| yy), yy: of(|xx, _, _| xx), xy: of(|_, _, xy| -xy) }
}

/// Influence numbers [xx, yy, xy] of all offsets that occur, evaluated once: a quarter of the plane,
/// since xx and yy are even and xy is odd in both offsets.
struct Table {
    width: usize,
    values: Vec<[f64; 3]>,
}

impl Table {
    fn new(influence: &Influence, layer_flexibility: f64, nx: usize, ny: usize) -> Self {
        // One more than the grid along x, for the upstream neighbour.
        let width = nx + 1;
        let mut values = Vec::with_capacity(width * ny);
        for j in 0..ny as i32 {
            for i in 0..width as i32 {
                values.push([influence.xx(i, j), influence.yy(i, j), influence.xy(i, j)]);
            }
        }
        values[0][0] += layer_flexibility;
        values[0][1] += layer_flexibility;
        Self { width, values }
    }

    fn value(&self, i: i32, j: i32) -> [f64; 3] {
        let at = j.unsigned_abs() as usize * self.width + i.unsigned_abs() as usize;
        let [xx, yy, xy] = self.values[at];
        let odd = if (i < 0) == (j < 0) { xy } else { -xy };
        [xx, yy, odd]
    }

    /// Influence on the element less that on its upstream neighbour.
    fn step(&self, i: i32, j: i32) -> [f64; 3] {
        let (here, upstream) = (self.value(i, j), self.value(i + 1, j));
        std::array::from_fn(|k| here[k] - upstream[k])
    }
}
