//! Two half-spaces that exchange heat where their surfaces touch.
//!
//! Beside a split of the friction heat that is the same everywhere, a flux g [W/m²] flows from the upper
//! into the lower body where they touch, such that
//!
//! T_u − T_l = g/h,
//!
//! with the conductance h of the contact [W/(m²·K)], element by element; 1/h = 0 for surfaces of one temperature.
//! M = 1/h + A_u + A_l makes of an error of this equation a correction of g, with the influence A of a flux
//! whose means over elements are g, and whose values at edges are linear in them ([`Flux::add`]). M is inverted by
//! GMRES, with the inverse of its symbol for fluxes that are zero at the edges, cut to the places of contact, for a
//! preconditioner; where 1/h is larger than its smallest value 1/h₀, that is scaled on both sides by √((1/h₀ + a)/(1/h + a)), with the
//! influence a of an element on itself. In steady motion A is not symmetric.
//!
//! Between the elements that touch, g and the errors live on shapes ([`ContactBasis`]).

use super::contact_basis::ContactBasis;
use super::half_space::Influence;
use crate::columns::reconstruction::Flux;
use grids::Structured;
use numerics::convolution::{Complex64, Convolution, Spectrum};
use numerics::gmres::{Gmres, Preconditioned};

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
    /// Smallest 1/h, and the influence of an element on itself [m²·K/W].
    least: f64,
    own: f64,
    gmres: Gmres,
    fields: [Vec<f64>; 3],
    flux: Flux,
    image: Vec<f64>,
    /// Values at the elements that touch.
    elements: Vec<f64>,
}

impl Exchange {
    /// Exchange of two bodies on a grid whose contact has this smallest resistance 1/h [m²·K/W].
    #[must_use]
    pub fn new(grid: &Structured, bodies: [&Influence; 2], least: f64) -> Self {
        let influence = Influence::sum(bodies);
        let symbol = influence.of_middle();
        let largest = symbol.values().map(|value| value.norm()).fold(0.0, f64::max);
        let (sum, count) =
            symbol.values().fold((0.0, 0.0), |(sum, count), value| (sum + value.re, count + 1.0));
        let mean = sum / count;
        let floor = FLOOR * (least + MIDDLE * largest);
        let inverse = symbol.map(|value| {
            let value = MIDDLE * value + least;
            let size = value.norm().max(floor);
            Complex64::new(value.re, -value.im) / (size * size)
        });
        Self {
            columns: grid.ni,
            own: MIDDLE * mean,
            influence,
            inverse,
            least,
            gmres: Gmres::default(),
            fields: std::array::from_fn(|_| vec![0.0; (grid.ni + 1) * grid.nj]),
            flux: Flux::zero(grid.ni, grid.nj),
            image: vec![0.0; grid.points()],
            elements: Vec::new(),
        }
    }

    /// The smallest resistance that it is for [m²·K/W].
    #[must_use]
    pub fn least(&self) -> f64 {
        self.least
    }

    /// The correction of g [W/m²] for errors T_u − T_l − g/h [K], both in the shapes where the surfaces touch;
    /// the number of products with M.
    pub fn correct(
        &mut self,
        convolution: &mut Convolution,
        contact: &Resisting<'_>,
        error: &[f64],
        correction: &mut [f64],
    ) -> usize {
        let mut gmres = std::mem::take(&mut self.gmres);
        let mut system = Shapes { exchange: self, convolution, contact };
        let achieved = gmres.solve(&mut system, error, REDUCTION, correction);
        self.gmres = gmres;
        achieved.steps
    }
}

/// Elements that touch, and their resistances 1/h, element by element [m²·K/W].
pub struct Resisting<'a> {
    /// Elements and shapes.
    pub touching: &'a ContactBasis,
    /// Resistances of the elements.
    pub resistances: &'a [f64],
}

/// M between the shapes of what touches.
struct Shapes<'a> {
    exchange: &'a mut Exchange,
    convolution: &'a mut Convolution,
    contact: &'a Resisting<'a>,
}

impl Preconditioned for Shapes<'_> {
    fn operate(&mut self, x: &[f64], out: &mut [f64]) {
        let Exchange { influence, fields, flux, image, elements, .. } = &mut *self.exchange;
        let Resisting { touching: shapes, resistances } = self.contact;
        let touching = shapes.elements();
        shapes.spread(x, elements);
        flux.clear();
        flux.add(touching, elements, 1.0);
        image.fill(0.0);
        influence.add(flux, self.convolution, fields, image);
        for (at, (value, resistance)) in touching.iter().zip(elements.iter_mut().zip(*resistances))
        {
            *value = resistance * *value + image[*at];
        }
        shapes.gather(elements, out);
    }

    fn precondition(&mut self, x: &[f64], out: &mut [f64]) {
        let Exchange { columns, inverse, least, own, fields: [field, image, _], elements, .. } =
            &mut *self.exchange;
        let Resisting { touching: shapes, resistances } = self.contact;
        let scale = |resistance: &f64| match resistance > least {
            true => ((*least + *own) / (resistance + *own)).sqrt(),
            false => 1.0,
        };
        // A row of the convolution has one place more, for edges.
        let place = |at: usize| at + at / *columns;
        let touching = shapes.elements();
        shapes.spread(x, elements);
        field.fill(0.0);
        for (at, (value, resistance)) in touching.iter().zip(elements.iter().zip(*resistances)) {
            field[place(*at)] = scale(resistance) * value;
        }
        self.convolution.apply(inverse, field, image);
        for (at, (value, resistance)) in touching.iter().zip(elements.iter_mut().zip(*resistances))
        {
            *value = scale(resistance) * image[place(*at)];
        }
        shapes.gather(elements, out);
    }
}
