//! Modes of a body across and in depth, and transforms between them and the rows of the heat flux.
//!
//! A field is Σ ψ_l(y) φ_m(z) φ_m(0) b_lm. The amplitudes b, divided by φ_m(0), have the same
//! source for all modes in depth: the flux in the mode across. The surface is Σ φ_m(0)² b.
//! Amplitudes of a column are padded to a multiple of [`LANES`].

use super::mesh::Axis;
use super::modes::Modes;
use pulp::{Arch, NullaryFnOnce};

/// Numbers computed at once.
pub const LANES: usize = 8;

/// Modes across and in depth.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Number of rows of the heat flux.
    pub rows: usize,
    /// Node across of the first row.
    first_row: usize,
    /// Modes across.
    pub across: Modes,
    widths: Vec<f64>,
    /// Modes in depth.
    pub depth: Modes,
    /// φ_m(0) [1/√m], padded.
    pub top: Vec<f64>,
}

impl Basis {
    /// Creates the basis for `rows` rows of flux, the first at the node `first_row` across.
    #[must_use]
    pub fn new(across: &Axis, depth: &Axis, first_row: usize, rows: usize) -> Self {
        let modes = Modes::new(depth);
        let top: Vec<f64> = (0..modes.len()).map(|mode| modes.shape(mode)[0]).collect();
        Self {
            rows,
            first_row,
            across: Modes::new(across),
            widths: across.widths.clone(),
            depth: modes,
            top: padded(&top),
        }
    }

    /// Returns the number of amplitudes of a column in a mode across, including padding.
    #[must_use]
    pub fn size(&self) -> usize {
        self.top.len()
    }

    /// Returns the fraction of a row of the flux that goes into a mode across.
    #[must_use]
    pub fn part(&self, mode: usize, row: usize) -> f64 {
        let node = self.first_row + row;
        self.widths[node] * self.across.shape(mode)[node]
    }

    /// Returns the value of a mode across in a row.
    #[must_use]
    pub fn shape(&self, mode: usize, row: usize) -> f64 {
        self.across.shape(mode)[self.first_row + row]
    }

    /// Adds the surface values of the modes across to the rises of rows of `columns` [K].
    pub fn add_modes(&self, columns: usize, surfaces: &[f64], rise: &mut [f64]) {
        Arch::new().dispatch(Sum { basis: self, columns, surfaces, rise });
    }

    /// Returns the rises [K] at the nodes in depth, node after node, from amplitudes column after
    /// column.
    #[must_use]
    pub fn rises(&self, amplitudes: &[f64]) -> Vec<f64> {
        let (size, nodes) = (self.size(), self.depth.len());
        let columns = amplitudes.len() / size;
        let mut rises = vec![0.0; columns * nodes];
        let mut shapes = vec![0.0; nodes];
        for (k, rises) in rises.chunks_exact_mut(columns).enumerate() {
            for (mode, shape) in shapes.iter_mut().enumerate() {
                *shape = self.depth.shape(mode)[k] * self.top[mode];
            }
            for (rise, amplitudes) in rises.iter_mut().zip(amplitudes.chunks_exact(size)) {
                *rise = shapes.iter().zip(amplitudes).map(|(shape, a)| shape * a).sum();
            }
        }
        rises
    }
}

/// Sum of the modes across at the surface, four at a time.
struct Sum<'a> {
    basis: &'a Basis,
    columns: usize,
    surfaces: &'a [f64],
    rise: &'a mut [f64],
}

impl NullaryFnOnce for Sum<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { basis, columns, surfaces, rise } = self;
        for (row, rise) in rise.chunks_exact_mut(columns).enumerate() {
            for (group, surfaces) in surfaces.chunks(4 * columns).enumerate() {
                let mut modes = surfaces.chunks_exact(columns);
                let shape = |mode: usize| match 4 * group + mode {
                    mode if mode < basis.across.len() => basis.shape(mode, row),
                    _ => 0.0,
                };
                match [modes.next(), modes.next(), modes.next(), modes.next()] {
                    [Some(a), Some(b), Some(c), Some(d)] => {
                        let shapes: [f64; 4] = std::array::from_fn(shape);
                        let four = a.iter().zip(b).zip(c.iter().zip(d));
                        for (rise, ((a, b), (c, d))) in rise.iter_mut().zip(four) {
                            *rise +=
                                (shapes[0] * a + shapes[1] * b) + (shapes[2] * c + shapes[3] * d);
                        }
                    }
                    rest => {
                        for (mode, surface) in rest.iter().flatten().enumerate() {
                            let shape = shape(mode);
                            for (rise, surface) in rise.iter_mut().zip(*surface) {
                                *rise += shape * surface;
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Returns the values, padded with zeros to a multiple of [`LANES`].
#[must_use]
pub fn padded(values: &[f64]) -> Vec<f64> {
    let mut padded = values.to_vec();
    padded.resize(values.len().next_multiple_of(LANES), 0.0);
    padded
}
