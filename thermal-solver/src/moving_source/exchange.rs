//! Two half-spaces that exchange heat where their surfaces touch.
//!
//! Beside a split of the friction heat that is the same everywhere, a flux g [W/m²] flows from the upper
//! into the lower body where they touch, such that
//!
//! T_u − T_l = g/h,
//!
//! with the conductance h of the contact [W/(m²·K)]; 1/h = 0 for surfaces of one temperature.
//! M = 1/h + A_u + A_l makes of an error of this equation a correction of g, with the influence A of a flux
//! that is zero at the edges of its element, 6 θ(1 − θ) times its mean. That is what the reconstruction
//! makes of a flux that changes its sign from one element to the next; of a smoother one it makes less
//! temperature, so that corrections may be too small, and never too large. M is inverted by GMRES, with the
//! inverse of its symbol, cut to the places of contact, for a preconditioner. In steady motion A is not
//! symmetric.

use super::half_space::Influence;
use numerics::convolution::{Complex64, Convolution, Spectrum};
use numerics::gmres::{Gmres, Preconditioned};
use proto::grid::Structured;

/// Reduction of the error by a correction.
const REDUCTION: f64 = 1e-2;
/// Values of the symbol below this part of the largest are not inverted.
const FLOOR: f64 = 1e-4;
/// Middle coefficient over the mean of a flux that is zero at the edges.
const MIDDLE: f64 = 3.0;

/// The operator M of a pair of bodies on a grid.
pub struct Exchange {
    columns: usize,
    influence: Spectrum,
    inverse: Spectrum,
    /// 1/h [m²·K/W].
    resistance: f64,
    gmres: Gmres,
    field: Vec<f64>,
    image: Vec<f64>,
}

impl Exchange {
    /// Of two bodies on a grid whose contact has this resistance 1/h [m²·K/W].
    #[must_use]
    pub fn new(grid: &Structured, bodies: [&Influence; 2], resistance: f64) -> Self {
        let both = bodies.map(Influence::of_middle);
        let influence = Spectrum::combine(both, |[upper, lower]| MIDDLE * (upper + lower));
        let largest = influence.values().map(|value| value.norm()).fold(0.0, f64::max);
        let floor = FLOOR * (resistance + largest);
        let inverse = influence.map(|value| {
            let value = value + resistance;
            let size = value.norm().max(floor);
            Complex64::new(value.re, -value.im) / (size * size)
        });
        let zeros = vec![0.0; (grid.ni + 1) * grid.nj];
        Self {
            columns: grid.ni,
            influence,
            inverse,
            resistance,
            gmres: Gmres::default(),
            field: zeros.clone(),
            image: zeros,
        }
    }

    /// The correction of g [W/m²] for errors T_u − T_l − g/h [K] at the elements where the surfaces touch,
    /// in their order; the number of products with M.
    pub fn correct(
        &mut self,
        convolution: &mut Convolution,
        touching: &[usize],
        error: &[f64],
        correction: &mut [f64],
    ) -> usize {
        let mut gmres = std::mem::take(&mut self.gmres);
        let mut system = Touching { exchange: self, convolution, touching };
        let achieved = gmres.solve(&mut system, error, REDUCTION, correction);
        self.gmres = gmres;
        achieved.steps
    }
}

/// M between the elements that touch.
struct Touching<'a> {
    exchange: &'a mut Exchange,
    convolution: &'a mut Convolution,
    touching: &'a [usize],
}

impl Touching<'_> {
    fn apply(&mut self, inverse: bool, x: &[f64], out: &mut [f64]) {
        let Exchange { columns, influence, inverse: approximate, field, image, .. } =
            &mut *self.exchange;
        // A row of the convolution has one place more, for edges.
        let place = |at: usize| at + at / *columns;
        field.fill(0.0);
        for (at, value) in self.touching.iter().zip(x) {
            field[place(*at)] = *value;
        }
        self.convolution.apply(if inverse { approximate } else { influence }, field, image);
        for (at, out) in self.touching.iter().zip(out) {
            *out = image[place(*at)];
        }
    }
}

impl Preconditioned for Touching<'_> {
    fn operate(&mut self, x: &[f64], out: &mut [f64]) {
        self.apply(false, x, out);
        let resistance = self.exchange.resistance;
        out.iter_mut().zip(x).for_each(|(out, x)| *out += resistance * x);
    }

    fn precondition(&mut self, x: &[f64], out: &mut [f64]) {
        self.apply(true, x, out);
    }
}
