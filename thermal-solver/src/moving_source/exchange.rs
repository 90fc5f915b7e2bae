//! Two half-spaces that exchange heat where their surfaces touch.
//!
//! Beside a split of the friction heat that is the same everywhere, a flux g [W/m²] flows from the upper
//! into the lower body where they touch, such that
//!
//! T_u − T_l = g/h,
//!
//! with the conductance h of the contact [W/(m²·K)]; 1/h = 0 for surfaces of one temperature.
//! M = 1/h + A_u + A_l makes of an error of this equation a correction of g, with the influence A of a flux
//! whose means over elements are g, and whose values at edges are linear in them ([`Flux::add`]). M is inverted by
//! GMRES, with the inverse of its symbol for fluxes that are zero at the edges, cut to the places of contact, for a
//! preconditioner. In steady motion A is not symmetric.
//!
//! Between the elements that touch, g and the errors live on shapes ([`Touching`]).

use super::half_space::Influence;
use super::touching::Touching;
use crate::columns::reconstruction::Flux;
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
    influence: Influence,
    inverse: Spectrum,
    /// 1/h [m²·K/W].
    resistance: f64,
    gmres: Gmres,
    fields: [Vec<f64>; 3],
    flux: Flux,
    image: Vec<f64>,
    /// Values at the elements that touch.
    elements: Vec<f64>,
}

impl Exchange {
    /// Of two bodies on a grid whose contact has this resistance 1/h [m²·K/W].
    #[must_use]
    pub fn new(grid: &Structured, bodies: [&Influence; 2], resistance: f64) -> Self {
        let influence = Influence::sum(bodies);
        let symbol = influence.of_middle();
        let largest = symbol.values().map(|value| value.norm()).fold(0.0, f64::max);
        let floor = FLOOR * (resistance + MIDDLE * largest);
        let inverse = symbol.map(|value| {
            let value = MIDDLE * value + resistance;
            let size = value.norm().max(floor);
            Complex64::new(value.re, -value.im) / (size * size)
        });
        Self {
            columns: grid.ni,
            influence,
            inverse,
            resistance,
            gmres: Gmres::default(),
            fields: std::array::from_fn(|_| vec![0.0; (grid.ni + 1) * grid.nj]),
            flux: Flux::zero(grid.ni, grid.nj),
            image: vec![0.0; grid.points()],
            elements: Vec::new(),
        }
    }

    /// The correction of g [W/m²] for errors T_u − T_l − g/h [K], both in the shapes where the surfaces touch;
    /// the number of products with M.
    pub fn correct(
        &mut self,
        convolution: &mut Convolution,
        touching: &Touching,
        error: &[f64],
        correction: &mut [f64],
    ) -> usize {
        let mut gmres = std::mem::take(&mut self.gmres);
        let mut system = Shapes { exchange: self, convolution, touching };
        let achieved = gmres.solve(&mut system, error, REDUCTION, correction);
        self.gmres = gmres;
        achieved.steps
    }
}

/// M between the shapes of what touches.
struct Shapes<'a> {
    exchange: &'a mut Exchange,
    convolution: &'a mut Convolution,
    touching: &'a Touching,
}

impl Preconditioned for Shapes<'_> {
    fn operate(&mut self, x: &[f64], out: &mut [f64]) {
        let Exchange { influence, resistance, fields, flux, image, elements, .. } =
            &mut *self.exchange;
        let touching = self.touching.elements();
        self.touching.spread(x, elements);
        flux.clear();
        flux.add(touching, elements, 1.0);
        image.fill(0.0);
        influence.add(flux, self.convolution, fields, image);
        for (at, value) in touching.iter().zip(&mut *elements) {
            *value = *resistance * *value + image[*at];
        }
        self.touching.gather(elements, out);
    }

    fn precondition(&mut self, x: &[f64], out: &mut [f64]) {
        let Exchange { columns, inverse, fields: [field, image, _], elements, .. } =
            &mut *self.exchange;
        // A row of the convolution has one place more, for edges.
        let place = |at: usize| at + at / *columns;
        let touching = self.touching.elements();
        self.touching.spread(x, elements);
        field.fill(0.0);
        for (at, value) in touching.iter().zip(&*elements) {
            field[place(*at)] = *value;
        }
        self.convolution.apply(inverse, field, image);
        for (at, value) in touching.iter().zip(&mut *elements) {
            *value = image[place(*at)];
        }
        self.touching.gather(elements, out);
    }
}
