//! Thermal displacement of the surface of a body, from the temperatures of its nodes.
//!
//! W = ∫ ϑ̂ e^{−kz} dz for the wave number k along the surface
//! ([`crate::moving_source::rise_integral`]), summed over the layers of the nodes. Each layer is a
//! product in Fourier space, where the layers are added. The grid is padded to twice its size and
//! extended behind by a quarter of its length; heat further behind is neglected.

use grids::Structured;
use numerics::convolution::{Complex64, Convolution, Spectrum};
use std::f64::consts::TAU;

/// Layers of a body with their transforms.
pub struct Height {
    /// Number of columns of the grid, and behind it.
    columns: usize,
    /// Number of columns behind the grid.
    pub behind: usize,
    convolution: Convolution,
    /// Weight Δz e^{−kz} of every layer.
    layers: Vec<Spectrum>,
    /// Rises of a layer, later the sum, including the columns behind.
    values: Vec<f64>,
}

impl Height {
    /// Prepares the nodes at some depths [m], the last of which is held, and the faces between
    /// them.
    #[must_use]
    pub fn new(grid: &Structured, depths: &[f64], faces: &[f64]) -> Self {
        let behind = grid.ni / 4;
        let convolution = Convolution::new(grid.ni + behind, grid.nj);
        let (along, across) = convolution.padded_shape();
        let sides = [along as f64 * grid.dx(), across as f64 * grid.dy()];
        let layer = |(depth, faces): (&f64, &[f64])| {
            let thickness = faces[1] - faces[0];
            convolution.factors(|k, l| {
                let number = TAU * (f64::from(k) / sides[0]).hypot(f64::from(l) / sides[1]);
                Complex64::new(thickness * (-number * depth).exp(), 0.0)
            })
        };
        let layers = depths.iter().zip(faces.windows(2)).map(layer).collect();
        let values = vec![0.0; (grid.ni + behind) * grid.nj];
        Self { columns: grid.ni, behind, convolution, layers, values }
    }

    /// Computes W [K m] of the rises [K] that `fill(layer, rises)` writes, row by row, beginning
    /// with the columns behind. Returns the number of multiply-adds.
    pub fn of(&mut self, mut fill: impl FnMut(usize, &mut [f64]), integral: &mut [f64]) -> u64 {
        let Self { columns, behind, convolution, layers, values } = self;
        let mut sum = convolution.empty_sum();
        for (number, layer) in layers.iter().enumerate() {
            fill(number, values);
            convolution.add(layer, values, &mut sum);
        }
        convolution.finish(&sum, values);
        let rows = values.chunks_exact(*columns + *behind);
        for (integral, row) in integral.chunks_exact_mut(*columns).zip(rows) {
            integral.copy_from_slice(&row[*behind..]);
        }
        (layers.len() * values.len()) as u64
    }
}
