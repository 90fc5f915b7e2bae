//! Convolution on a grid of nx × ny elements by Fourier transforms with zero padding.
//!
//! out(i, j) = Σ_{i', j'} A(i − i', j − j') in(i', j'), over all elements of the grid, without
//! periodic images. The grid is padded to P_x × P_y with P ≥ 2n − 1, where the cyclic convolution
//! equals the free one. With the transform f̂(k, l) = Σ f(i, j) e^{−2πi(ik/P_x + jl/P_y)}, the
//! result is the inverse transform of Â f̂. Its factor 1/(P_x P_y) is included in [`Spectrum`]. P_x
//! is even, and both sizes have only the prime factors 2, 3 and 5.
//!
//! Rows along x use real transforms, which leave P_x/2 + 1 columns. Only the ny rows inside the
//! grid are transformed and stored. Columns are processed in blocks while in the cache: gathered,
//! padded, transformed, multiplied by Â, transformed back and cut to ny values. After construction
//! nothing is allocated on one thread, except when building a [`Spectrum`]. On large grids, threads
//! share rows and blocks of columns ([`crate::team`]).
//!
//! Kernels are transformed in double precision. Where seven digits suffice, as within Krylov
//! iterations, a spectrum is rounded to single precision ([`Spectrum::rounded`]) and applied to
//! single-precision fields in half the time.
//!
//! Rows may be displaced along x by parts of an element ([`Convolution::displace_rows`]).

mod displaced;
mod even;
mod near_rows;

pub use even::EvenSpectrum;

use crate::fourier::{Complex, ComplexToReal, Fft, Real, RealToComplex};
use crate::team::Team;
use near_rows::{NearRows, Phases};
use std::ops::Range;
use std::sync::Arc;

/// Number of columns or rows transformed at a time: fills one or two cache lines.
const BLOCK: usize = 8;

/// Complex number in double precision.
pub type Complex64 = Complex<f64>;

/// Transform of a kernel, or any other factor in Fourier space, on the padded grid.
///
/// Valid for every [`Convolution`] with the same nx, ny and padding.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum<T = f64> {
    /// Â(k, l)/(P_x P_y), column by column: index k·P_y + l, k ≤ P_x/2.
    values: Vec<Complex<T>>,
    /// P_x P_y.
    size: f64,
}

impl Spectrum {
    /// Combines spectra of the same grid wave by wave, for instance to invert a symmetric 2 × 2
    /// tensor of kernels. `function` maps the values Â(k, l) [unit of the kernel].
    #[must_use]
    pub fn combine<const N: usize>(
        spectra: [&Self; N],
        function: impl Fn([Complex64; N]) -> Complex64,
    ) -> Self {
        let (len, size) = (spectra[0].values.len(), spectra[0].size);
        assert!(spectra.iter().all(|other| other.values.len() == len && other.size == size));
        let value = |at| function(spectra.map(|spectrum| spectrum.values[at] * size)) / size;
        Self { values: (0..len).map(value).collect(), size }
    }

    /// Maps a single spectrum wave by wave, like [`Spectrum::combine`].
    #[must_use]
    pub fn map(&self, function: impl Fn(Complex64) -> Complex64) -> Self {
        Self::combine([self], |[value]| function(value))
    }

    /// Returns the spectrum times a factor, in single precision.
    #[must_use]
    pub fn rounded(&self, factor: f64) -> Spectrum<f32> {
        let values = self.values.iter().map(|value| single(value * factor)).collect();
        Spectrum { values, size: self.size }
    }

    /// Returns the values Â(k, l), in unspecified order.
    pub fn values(&self) -> impl Iterator<Item = Complex64> + '_ {
        self.values.iter().map(|value| value * self.size)
    }
}

/// Rounds to single precision.
fn single(value: Complex64) -> Complex<f32> {
    Complex::new(value.re as f32, value.im as f32)
}

/// A sum of convolutions in Fourier space, see [`Convolution::add`].
#[derive(Clone, Debug)]
pub struct SpectralSum<T = f64> {
    /// Values column by column, as in a [`Spectrum`].
    values: Vec<Complex<T>>,
}

/// Plans and working memory for convolutions on one grid.
pub struct Convolution<T = f64> {
    nx: usize,
    ny: usize,
    padded_x: usize,
    padded_y: usize,
    rows_forward: Arc<dyn RealToComplex<T>>,
    rows_inverse: Arc<dyn ComplexToReal<T>>,
    columns_forward: Arc<dyn Fft<T>>,
    columns_inverse: Arc<dyn Fft<T>>,
    /// Transformed rows, ny × (P_x/2 + 1), for each component.
    rows: [Vec<Complex<T>>; 2],
    /// Columns after the inverse transform, (P_x/2 + 1) × ny, for each component.
    columns: [Vec<Complex<T>>; 2],
    /// Phases of displaced rows.
    phases: Option<Phases<T>>,
    /// Phases of the rows of an image, with the factors of its waves along x.
    leaving: Option<Phases<T>>,
    team: Team<Workspace<T>>,
}

/// Working memory of a thread.
#[derive(Clone)]
struct Workspace<T> {
    row: Vec<T>,
    scratch: Vec<Complex<T>>,
    /// Up to BLOCK transformed rows.
    rows: Vec<Complex<T>>,
    /// Up to BLOCK columns of P_y values, for each component.
    block: [Vec<Complex<T>>; 2],
    /// The ny values of these columns before the transform, for each component.
    entering: [Vec<Complex<T>>; 2],
}

impl<T> std::fmt::Debug for Convolution<T> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { nx, ny, padded_x, padded_y, .. } = self;
        write!(formatter, "Convolution({nx} x {ny}, padded to {padded_x} x {padded_y})")
    }
}

impl<T: Real> Convolution<T> {
    /// Plans the transforms for nx × ny elements, with enough padding to exclude periodic images.
    ///
    /// # Panics
    /// Panics if a count is zero.
    #[must_use]
    pub fn new(nx: usize, ny: usize) -> Self {
        assert!(nx > 0 && ny > 0, "a grid of {nx} x {ny} elements is empty");
        Self::padded(nx, ny, 2 * smooth_size(nx), smooth_size(2 * ny - 1))
    }

    /// Plans the transforms for nx × ny elements with padding by only a tenth. This is cheaper but
    /// has errors from periodic images; meant for preconditioners.
    ///
    /// # Panics
    /// Panics if a count is zero.
    #[must_use]
    pub fn barely_padded(nx: usize, ny: usize) -> Self {
        assert!(nx > 0 && ny > 0, "a grid of {nx} x {ny} elements is empty");
        let more = |n: usize| n + n.div_ceil(10);
        Self::padded(nx, ny, 2 * smooth_size(more(nx).div_ceil(2)), smooth_size(more(ny)))
    }

    /// Plans the transforms for nx × ny elements that repeat periodically, without padding.
    ///
    /// # Panics
    /// Panics if ny is zero, or if nx is odd or zero.
    #[must_use]
    pub fn cyclic(nx: usize, ny: usize) -> Self {
        let even = nx > 0 && nx.is_multiple_of(2);
        assert!(even && ny > 0, "{nx} x {ny} elements are not an even number along x");
        Self::padded(nx, ny, nx, ny)
    }

    fn padded(nx: usize, ny: usize, padded_x: usize, padded_y: usize) -> Self {
        let (rows_forward, rows_inverse) = T::real(padded_x);
        let [columns_forward, columns_inverse] = T::complex(padded_y);
        let scratch = [
            rows_forward.get_scratch_len(),
            rows_inverse.get_scratch_len(),
            columns_forward.get_inplace_scratch_len(),
            columns_inverse.get_inplace_scratch_len(),
        ];
        let zeros = |len: usize| vec![Complex::new(T::zero(), T::zero()); len];
        let columns = padded_x / 2 + 1;
        let half = zeros(ny * columns);
        let block = zeros(BLOCK * padded_y);
        let work = Workspace {
            row: vec![T::zero(); padded_x],
            scratch: zeros(scratch.into_iter().max().unwrap_or(0)),
            rows: zeros(BLOCK * columns),
            block: [block.clone(), block],
            entering: [zeros(BLOCK * ny), zeros(BLOCK * ny)],
        };
        Self {
            nx,
            ny,
            padded_x,
            padded_y,
            rows_forward,
            rows_inverse,
            columns_forward,
            columns_inverse,
            rows: [half.clone(), half.clone()],
            columns: [half.clone(), half],
            phases: None,
            leaving: None,
            team: Team::of_process(work),
        }
    }

    /// Returns the numbers of elements along x and y.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.nx, self.ny)
    }

    /// Returns the numbers of elements of the padded grid along x and y.
    #[must_use]
    pub fn padded_shape(&self) -> (usize, usize) {
        (self.padded_x, self.padded_y)
    }

    /// Computes the convolution of `input` with a kernel; both fields have nx·ny values.
    ///
    /// # Panics
    /// Panics if a field or the spectrum belongs to another grid.
    pub fn apply(&mut self, kernel: &Spectrum<T>, input: &[T], output: &mut [T]) {
        self.check(&[kernel], &[input], &[output]);
        self.rows_in(0, input);
        let multiply = |range, [block, _]: [&mut [Complex<T>]; 2]| {
            for (value, factor) in block.iter_mut().zip(&kernel.values[Range::clone(&range)]) {
                *value = *value * factor;
            }
        };
        self.through([true, false], [true, false], multiply, [[None; 2]; 2]);
        self.rows_out(0, output);
    }

    /// Computes the sum of the convolutions of two fields, each with its own kernel.
    ///
    /// # Panics
    /// Panics if a field or a spectrum belongs to another grid.
    pub fn apply_sum(&mut self, kernels: [&Spectrum<T>; 2], input: [&[T]; 2], output: &mut [T]) {
        self.check(&kernels, &input, &[output]);
        self.rows_in(0, input[0]);
        self.rows_in(1, input[1]);
        let multiply = |range: Range<usize>, [block, other]: [&mut [Complex<T>]; 2]| {
            let [one, two] = kernels.map(|kernel| &kernel.values[range.clone()]);
            for (((x, y), a), b) in block.iter_mut().zip(other.iter()).zip(one).zip(two) {
                *x = a * *x + b * y;
            }
        };
        self.through([true, true], [true, false], multiply, [[None; 2]; 2]);
        self.rows_out(0, output);
    }

    /// Returns an empty sum of convolutions, for any number of fields with kernels of their own.
    #[must_use]
    pub fn empty_sum(&self) -> SpectralSum<T> {
        let len = self.columns() * self.padded_y;
        SpectralSum { values: vec![Complex::new(T::zero(), T::zero()); len] }
    }

    /// Adds the convolution of a field with a kernel to a sum that stays in Fourier space.
    ///
    /// # Panics
    /// Panics if the field, the spectrum or the sum belongs to another grid.
    pub fn add(&mut self, kernel: &Spectrum<T>, input: &[T], sum: &mut SpectralSum<T>) {
        self.check(&[kernel], &[input], &[]);
        assert_eq!(sum.values.len(), kernel.values.len(), "the sum is not of this grid");
        self.rows_in(0, input);
        let Self { rows, team, columns_forward, ny, padded_y, phases, .. } = self;
        let (ny, padded, len) = (*ny, *padded_y, rows[0].len() / *ny);
        let work = team.first();
        for first in (0..len).step_by(BLOCK) {
            let count = BLOCK.min(len - first);
            let range = first * padded..(first + count) * padded;
            let block = &mut work.block[0][..range.len()];
            gather(&rows[0], phases.as_ref(), [len, ny, padded], first, block);
            columns_forward.process_with_scratch(block, &mut work.scratch);
            let factors = block.iter().zip(&kernel.values[range.clone()]);
            for (sum, (value, factor)) in sum.values[range].iter_mut().zip(factors) {
                *sum = *sum + *value * *factor;
            }
        }
    }

    /// Transforms a sum back to a field.
    ///
    /// # Panics
    /// Panics if the sum or the field belongs to another grid.
    pub fn finish(&mut self, sum: &SpectralSum<T>, output: &mut [T]) {
        self.check(&[], &[], &[output]);
        assert_eq!(sum.values.len(), self.columns() * self.padded_y, "the sum is not of this grid");
        let copy = |range, [block, _]: [&mut [Complex<T>]; 2]| {
            block.copy_from_slice(&sum.values[Range::clone(&range)]);
        };
        self.through([false, false], [true, false], copy, [[None; 2]; 2]);
        self.rows_out(0, output);
    }

    /// Computes the convolution of a vector field with a tensor of kernels, out_r = Σ_c
    /// kernels[r][c] ∗ in_c.
    ///
    /// # Panics
    /// Panics if a field or a spectrum belongs to another grid.
    pub fn apply_tensor(
        &mut self,
        kernels: &[[&Spectrum<T>; 2]; 2],
        input: [&[T]; 2],
        output: [&mut [T]; 2],
    ) {
        let [[xx, xy], [yx, yy]] = *kernels;
        let [output_x, output_y] = output;
        self.check(&[xx, xy, yx, yy], &input, &[output_x, output_y]);
        self.rows_in(0, input[0]);
        self.rows_in(1, input[1]);
        let multiply = |range: Range<usize>, [block_x, block_y]: [&mut [Complex<T>]; 2]| {
            let rows = xx.values[range.clone()].iter().zip(&xy.values[range.clone()]);
            let rows = rows.zip(yx.values[range.clone()].iter().zip(&yy.values[range]));
            let fields = block_x.iter_mut().zip(block_y.iter_mut());
            for ((x, y), ((xx, xy), (yx, yy))) in fields.zip(rows) {
                (*x, *y) = (xx * *x + xy * *y, yx * *x + yy * *y);
            }
        };
        self.through([true, true], [true, true], multiply, [[None; 2]; 2]);
        self.rows_out(0, output_x);
        self.rows_out(1, output_y);
    }

    fn columns(&self) -> usize {
        self.padded_x / 2 + 1
    }

    fn check(&self, spectra: &[&Spectrum<T>], input: &[&[T]], output: &[&mut [T]]) {
        let (fields, len) = (self.nx * self.ny, self.columns() * self.padded_y);
        let size = (self.padded_x * self.padded_y) as f64;
        assert!(
            input.iter().all(|field| field.len() == fields)
                && output.iter().all(|field| field.len() == fields)
                && spectra.iter().all(|one| one.values.len() == len && one.size == size),
            "a field or spectrum is not of the grid of {} x {} elements",
            self.nx,
            self.ny
        );
    }

    /// Approximate number of multiply-adds to transform `lines` lines of a length.
    fn operations(lines: usize, length: usize) -> u64 {
        2 * lines as u64 * length as u64 * u64::from(length.ilog2() + 1)
    }

    /// Transforms the rows of a field.
    fn rows_in(&mut self, component: usize, input: &[T]) {
        let columns = self.columns();
        let Self { nx, ny, padded_x, rows_forward, rows, team, .. } = self;
        let pieces = input.chunks(BLOCK * *nx).zip(rows[component].chunks_mut(BLOCK * columns));
        team.sweep(Self::operations(*ny, *padded_x) / 2, pieces, |work, (values, transformed)| {
            let pairs = values.chunks_exact(*nx).zip(transformed.chunks_exact_mut(columns));
            for (values, transformed) in pairs {
                work.row[..*nx].copy_from_slice(values);
                work.row[*nx..].fill(T::zero());
                rows_forward
                    .process_with_scratch(&mut work.row, transformed, &mut work.scratch)
                    .expect("all lengths are the plan's");
            }
            0
        });
    }

    /// Processes blocks of columns. Components marked in `into` are padded and transformed.
    /// `multiply` modifies them, given the range of their indices in a [`Spectrum`]. Components
    /// marked in `out` are transformed back and cut. Corrections between near rows, for each
    /// component that leaves from each that enters, are added.
    fn through(
        &mut self,
        into: [bool; 2],
        out: [bool; 2],
        multiply: impl Fn(Range<usize>, [&mut [Complex<T>]; 2]) + Sync,
        near: [[Option<&NearRows<T>>; 2]; 2],
    ) {
        let len = self.columns();
        let Self { ny, padded_y, columns_forward, columns_inverse, rows, columns, .. } = self;
        let (phases, leaving) = (self.phases.as_ref(), self.leaving.as_ref());
        let team = &mut self.team;
        let (ny, padded) = (*ny, *padded_y);
        let [along, across] = columns;
        let pieces = along.chunks_mut(BLOCK * ny).zip(across.chunks_mut(BLOCK * ny)).enumerate();
        let components = into.iter().chain(&out).filter(|on| **on).count();
        let operations = components as u64 * Self::operations(len, padded);
        team.sweep(operations, pieces, |work, (piece, (along, across))| {
            let first = piece * BLOCK;
            let count = BLOCK.min(len - first);
            let [x, y] = &mut work.block;
            let mut blocks = [&mut x[..count * padded], &mut y[..count * padded]];
            for (component, block) in blocks.iter_mut().enumerate().filter(|(k, _)| into[*k]) {
                gather(&rows[component], phases, [len, ny, padded], first, block);
                if near.iter().any(|of| of[component].is_some()) {
                    let columns = work.entering[component].chunks_exact_mut(ny);
                    for (kept, column) in columns.zip(block.chunks_exact(padded)) {
                        kept.copy_from_slice(&column[..ny]);
                    }
                }
                columns_forward.process_with_scratch(block, &mut work.scratch);
            }
            let [x, y] = &mut blocks;
            multiply(first * padded..(first + count) * padded, [x, y]);
            for ((block, kept), (_, near)) in blocks
                .iter_mut()
                .zip([along, across])
                .zip(out.iter().zip(near))
                .filter(|(_, (on, _))| **on)
            {
                columns_inverse.process_with_scratch(block, &mut work.scratch);
                for (column, kept) in block.chunks_exact(padded).zip(kept.chunks_exact_mut(ny)) {
                    kept.copy_from_slice(&column[..ny]);
                }
                for (near, entering) in near.iter().zip(&work.entering) {
                    near.iter().for_each(|near| near.add(entering, first, kept));
                }
                if let Some(leaving) = leaving {
                    leaving.displace(len, first, kept);
                }
            }
            0
        });
    }

    /// Transforms the rows back to a field.
    fn rows_out(&mut self, component: usize, output: &mut [T]) {
        let len = self.columns();
        let Self { nx, ny, padded_x, rows_inverse, columns, team, .. } = self;
        let (nx, ny, columns) = (*nx, *ny, &columns[component]);
        let pieces = output.chunks_mut(BLOCK * nx).enumerate();
        team.sweep(Self::operations(ny, *padded_x) / 2, pieces, |work, (piece, values)| {
            let (first, count) = (piece * BLOCK, values.len() / nx);
            for (place, column) in columns.chunks_exact(ny).enumerate() {
                for (row, value) in column[first..first + count].iter().enumerate() {
                    work.rows[row * len + place] = *value;
                }
            }
            let rows = work.rows.chunks_exact_mut(len);
            for (transformed, values) in rows.zip(values.chunks_exact_mut(nx)) {
                // Zero within rounding; the plan requires exact zeros.
                transformed[0].im = T::zero();
                transformed[len - 1].im = T::zero();
                rows_inverse
                    .process_with_scratch(transformed, &mut work.row, &mut work.scratch)
                    .expect("all lengths are the plan's and the ends are real");
                values.copy_from_slice(&work.row[..nx]);
            }
            0
        });
    }
}

/// Copies columns, starting at `first`, out of transformed rows of length `len`, moves displaced
/// rows back, and pads the columns.
fn gather<T: Real>(
    rows: &[Complex<T>],
    phases: Option<&Phases<T>>,
    [len, ny, padded]: [usize; 3],
    first: usize,
    block: &mut [Complex<T>],
) {
    let count = block.len() / padded;
    for (line, row) in rows.chunks_exact(len).enumerate() {
        for (column, value) in row[first..first + count].iter().enumerate() {
            block[column * padded + line] = *value;
        }
        if let Some(Phases(phases)) = phases {
            for (column, phase) in phases[line * len + first..][..count].iter().enumerate() {
                let value = &mut block[column * padded + line];
                *value = *value * phase.conj();
            }
        }
    }
    for column in block.chunks_exact_mut(padded) {
        column[ny..].fill(Complex::new(T::zero(), T::zero()));
    }
}

impl Convolution<f64> {
    /// Returns the transform of a kernel. `kernel(di, dj)` is the effect of one element on another;
    /// di and dj are the target's index minus the source's. The kernel is called for |di| < nx,
    /// |dj| < ny, limited to half the padded grid.
    #[must_use]
    pub fn spectrum(&mut self, kernel: impl Fn(i32, i32) -> f64) -> Spectrum {
        self.transform(offset((self.nx - 1).min(self.padded_x / 2)), &kernel)
    }

    /// Returns the transform of a kernel that is zero beyond `reach_x` elements along x.
    fn transform(&mut self, reach_x: i32, kernel: &dyn Fn(i32, i32) -> f64) -> Spectrum {
        let columns = self.columns();
        let Self { team, rows_forward, columns_forward, .. } = self;
        let Workspace { row, scratch, .. } = team.first();
        let mut values = vec![Complex64::default(); columns * self.padded_y];
        let mut transformed = vec![Complex64::default(); columns];
        let reach_y = offset((self.ny - 1).min(self.padded_y / 2));
        for dj in -reach_y..=reach_y {
            row.fill(0.0);
            for di in -reach_x..=reach_x {
                row[wrapped(di, self.padded_x)] = kernel(di, dj);
            }
            rows_forward
                .process_with_scratch(row, &mut transformed, scratch)
                .expect("all lengths are the plan's");
            let line = wrapped(dj, self.padded_y);
            for (column, value) in transformed.iter().enumerate() {
                values[column * self.padded_y + line] = *value;
            }
        }
        columns_forward.process_with_scratch(&mut values, scratch);
        let size = (self.padded_x * self.padded_y) as f64;
        values.iter_mut().for_each(|value| *value /= size);
        Spectrum { values, size }
    }

    /// Returns a factor for every wave e^{2πi(ik/P_x + jl/P_y)}: `factor(k, l)`, called for 0 ≤ k ≤
    /// P_x/2 and |l| ≤ P_y/2. For real fields, the factor at (−k, −l) must be its complex
    /// conjugate.
    #[must_use]
    pub fn factors(&self, factor: impl Fn(i32, i32) -> Complex64) -> Spectrum {
        let size = (self.padded_x * self.padded_y) as f64;
        let lines = || (0..self.padded_y).map(|line| signed(line, self.padded_y));
        let values = (0..offset(self.columns()))
            .flat_map(|column| lines().map(move |line| (column, line)))
            .map(|(column, line)| factor(column, line) / size)
            .collect();
        Spectrum { values, size }
    }
}

/// Returns the smallest number of at least `least` with only the prime factors 2, 3 and 5.
#[must_use]
pub fn smooth_size(least: usize) -> usize {
    let smooth = |size: &usize| {
        let strip = |mut rest: usize, prime: usize| {
            while rest.is_multiple_of(prime) {
                rest /= prime;
            }
            rest
        };
        [2, 3, 5].into_iter().fold(*size, strip) == 1
    };
    (least.max(1)..).find(smooth).expect("the next power of two is one")
}

/// Converts a count of elements to a signed offset.
fn offset(count: usize) -> i32 {
    i32::try_from(count).expect("a grid in memory has fewer elements a side")
}

/// Returns the offset of an index on a cyclic grid that is nearest to zero.
pub(crate) fn signed(index: usize, size: usize) -> i32 {
    if index <= size / 2 { offset(index) } else { -offset(size - index) }
}

/// Returns the index of an offset on a cyclic grid.
fn wrapped(offset: i32, size: usize) -> usize {
    let size = i64::try_from(size).expect("a grid in memory has fewer elements a side");
    usize::try_from(i64::from(offset).rem_euclid(size)).expect("a remainder is not negative")
}

#[cfg(test)]
mod tests;
