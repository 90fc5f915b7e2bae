//! Two half-spaces that exchange heat where their surfaces touch.
//!
//! The friction heat is split uniformly. In addition, a flux g [W/m²] flows from the upper into the
//! lower body where they touch, such that
//!
//! T_u − T_l = g/h,
//!
//! with the conductance h of the contact [W/(m²·K)], element by element; 1/h = 0 for surfaces of
//! equal temperature. M = 1/h + A_u + A_l converts an error of this equation to a correction of g.
//! A is the influence of a flux with the element means g and with edge values that are linear in g
//! ([`Flux::add`]). M is inverted by GMRES. The preconditioner is the inverse of the symbol of M
//! for fluxes that are zero at the edges, restricted to the places of contact. Where 1/h is larger
//! than its smallest value 1/h₀, the preconditioner is scaled on both sides by
//! √((1/h₀ + a)/(1/h + a)), with the influence a of an element on itself. In steady motion A is not
//! symmetric.
//!
//! On the elements in contact, g and the errors are expressed in shape functions
//! ([`ContactBasis`]).

use super::contact_basis::ContactBasis;
use super::half_space::Influence;
use crate::columns::reconstruction::Flux;
use grids::Structured;
use numerics::convolution::{Complex64, Convolution, Spectrum};
use numerics::gmres::{Gmres, Preconditioned};

/// Reduction of the error by a correction.
const REDUCTION: f64 = 1e-2;
/// Fraction of the largest value below which values of the symbol are not inverted.
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
    /// Values at the elements in contact.
    elements: Vec<f64>,
}

impl Exchange {
    /// Prepares the exchange of two bodies on a grid whose contact has this smallest resistance 1/h
    /// [m²·K/W].
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

    /// Returns the smallest resistance for which the exchange was prepared [m²·K/W].
    #[must_use]
    pub fn least(&self) -> f64 {
        self.least
    }

    /// Computes the correction of g [W/m²] for errors T_u − T_l − g/h [K], both in shape functions.
    /// Returns the number of products with M.
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

/// Elements in contact with their resistances 1/h [m²·K/W].
pub struct Resisting<'a> {
    /// Elements and shape functions.
    pub touching: &'a ContactBasis,
    /// Resistance of each element.
    pub resistances: &'a [f64],
}

/// M in the shape functions of the contact.
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
        // A row of the convolution has one more position, for edges.
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
