//! Coupling of normal and tangential contact between bodies of different materials.
//!
//! With the coupling constant K of the pair ([`super::influence`]) the pressure displaces the
//! surfaces along the plane by A_tz p_n, which adds to the slip. The tractions displace them along
//! the normal by A_zt p_t, which adds to the undeformed distance. Both problems are solved in turn
//! until the pressure settles. Each turn multiplies the change by about f K/(1 − ν), which is
//! ½ f (1 − 2ν)/(1 − ν) on a rigid body. For any pair of bodies with ν ≥ 0 the factor is at most
//! f/2: at f = 0.6 it is 0.3 for ν → 0 on a rigid body, and 0.17 for ν = 0.3.
//!
//! Source: Panagiotopoulos, Ingenieur-Archiv 44 (1975) 421–432, for the iteration; Kalker (1990)
//! §4.2.

use super::difference::Stencil;
use super::influence::Influence;
use super::viscoelastic::{Bodies, RollingInfluenceNumbers};
use numerics::convolution::{Convolution, Spectrum};

/// Operators A_tz and A_zt on one grid.
#[derive(Debug)]
pub struct Coupling {
    convolution: Convolution,
    by_pressure: [Spectrum; 2],
    by_traction: [Spectrum; 2],
    part: Vec<f64>,
}

impl Coupling {
    /// Creates the operators for nx × ny elements. Pressure gives the slip of this stencil in place
    /// of the displacement A_tz.
    #[must_use]
    pub fn new(influence: &Influence, nx: usize, ny: usize, stencil: Stencil) -> Self {
        Self::of(nx, ny, stencil, |i, j| [influence.zx(i, j), influence.zy(i, j)])
    }

    /// Creates the operators of viscoelastic bodies in rolling, on elements dx × dy [m].
    #[must_use]
    pub fn with_memory(
        bodies: &Bodies,
        [nx, ny]: [usize; 2],
        sides: [f64; 2],
        stencil: Stencil,
    ) -> Self {
        let numbers = RollingInfluenceNumbers::new([nx, ny], sides, bodies, |of, x, y| {
            [of.zx_at(x, y), of.zy_at(x, y)]
        });
        Self::of(nx, ny, stencil, |i, j| {
            let [zx, zy] = numbers.value(i, j);
            [zx, if j < 0 { -zy } else { zy }]
        })
    }

    /// Creates the operators from the normal displacements zx and zy; xz and yz are their
    /// opposites.
    fn of(nx: usize, ny: usize, stencil: Stencil, kernel: impl Fn(i32, i32) -> [f64; 2]) -> Self {
        let mut convolution = Convolution::new(nx, ny);
        let slip = |i: i32, j: i32| stencil.of(|upstream| kernel(i + upstream, j));
        let by_pressure = [0, 1].map(|k| convolution.spectrum(|i, j| -slip(i, j)[k]));
        let by_traction = [0, 1].map(|k| convolution.spectrum(|i, j| kernel(i, j)[k]));
        Self { convolution, by_pressure, by_traction, part: vec![0.0; nx * ny] }
    }

    /// Slip along x and y under the pressure [m].
    pub fn slip_by_pressure(&mut self, pressure: &[f64], slip: [&mut [f64]; 2]) {
        for (spectrum, slip) in self.by_pressure.iter().zip(slip) {
            self.convolution.apply(spectrum, pressure, slip);
        }
    }

    /// Normal displacement under the tractions [m].
    pub fn distance_by_traction(&mut self, traction: [&[f64]; 2], distance: &mut [f64]) {
        let [along_x, along_y] = traction;
        self.convolution.apply(&self.by_traction[0], along_x, distance);
        self.convolution.apply(&self.by_traction[1], along_y, &mut self.part);
        distance.iter_mut().zip(&self.part).for_each(|(sum, part)| *sum += part);
    }
}
