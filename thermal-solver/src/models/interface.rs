//! Heat exchange between the surfaces of two bodies in contact, found iteratively.
//!
//! A model computes its surface rises for a given exchanged flux. The corrections of that flux come
//! from half-spaces in the same windows ([`heat::moving_source::exchange`]). The half-spaces need
//! only resemble the bodies of the model, because the model itself evaluates the error after each
//! correction.

use super::conduction::InterfaceLoad;
use super::frame::Frame;
use crate::effects::contact_conductance::Conductance;
use crate::effects::friction_heat::Partition;
use crate::{LOWER, UPPER};
use heat::columns::reconstruction::Flux;
use heat::moving_source::ages::PastInterval;
use heat::moving_source::contact_basis::{ContactBasis, Shapes};
use heat::moving_source::exchange::{Exchange, Resisting};
use heat::moving_source::half_space::{Influence, convolution};
use numerics::convolution::Convolution;
use numerics::team;
use proto::grid::Structured;
use proto::model::StepError;
use std::sync::Arc;

/// Tolerance of the exchanged flux: largest temperature error over the highest rise.
const SETTLED: f64 = 1e-7;
/// Share of the exchanged flux that is attributed to rounding in sums.
const ROUNDING: f64 = 1e-10;
/// Largest number of corrections.
const MOST_CORRECTIONS: usize = 40;

/// Flux from the upper into the lower body, in addition to their shares of the friction heat.
#[derive(Clone, Copy, Default)]
pub(super) struct Flow<'a> {
    elements: &'a [usize],
    /// Element means of the flux [W/m²].
    values: &'a [f64],
}

impl Flow<'_> {
    /// Adds this flux to the flux into a body.
    pub(super) fn add(&self, body: usize, flux: &mut Flux) {
        let factor = if body == UPPER { -1.0 } else { 1.0 };
        flux.add(self.elements, self.values, factor);
    }
}

/// Bodies of a model as the interface sees them.
pub(super) trait HeatedBodies {
    /// Computes the surface rises under the shares of the friction heat and the exchanged flux.
    /// Returns the operation count.
    fn warm(&mut self, flow: Flow, rise: &mut [Vec<f64>; 2]) -> Result<u64, StepError>;

    /// Windows of half-spaces that resemble the bodies in the newest window.
    fn windows(&self) -> [PastInterval; 2];

    /// Influences of these half-spaces.
    fn influences(&self, convolution: &mut Convolution) -> [Arc<Influence>; 2];
}

/// Interface between the surfaces of two bodies.
pub(super) struct Interface {
    /// Conductance between the surfaces; without a law the surfaces in contact have the same
    /// temperature.
    law: Option<Conductance>,
    /// Initial temperature of the upper body minus that of the lower one [K].
    offset: f64,
    /// Resistances 1/h of the elements in contact [m²·K/W].
    resistances: Vec<f64>,
    /// Smallest of the resistances [m²·K/W].
    least: f64,
    /// Correction operator, and the windows for which it is valid.
    exchange: Option<([PastInterval; 2], Exchange)>,
    convolution: Option<Convolution>,
    touching: ContactBasis,
    /// Coefficients of the exchanged flux in the basis functions of the contact [W/m²].
    flows: Vec<f64>,
    /// Correction of these coefficients [W/m²].
    correction: Vec<f64>,
    /// Temperature errors in the basis functions [K].
    errors: Vec<f64>,
    /// Exchanged flux at the elements in contact [W/m²].
    flow: Vec<f64>,
    /// Temperature errors at the elements in contact [K].
    differences: Vec<f64>,
}

impl Interface {
    /// Creates the interface in the given basis functions; `None` if no heat flows between the
    /// surfaces.
    pub(super) fn of(frame: &Frame, shapes: Shapes) -> Option<Self> {
        let law = frame.conductance;
        if law.is_none() && frame.partition != Partition::Continuity {
            return None;
        }
        let [upper, lower] = frame.scene.initial_temperatures;
        Some(Self {
            law,
            offset: upper - lower,
            resistances: Vec::new(),
            least: 0.0,
            exchange: None,
            convolution: None,
            touching: ContactBasis::new(shapes),
            flows: Vec::new(),
            correction: Vec::new(),
            errors: Vec::new(),
            flow: Vec::new(),
            differences: Vec::new(),
        })
    }

    /// Exchanged flux from the upper into the lower body, without their shares of the friction
    /// heat, summed over the elements [W/m²].
    pub(super) fn flow(&self) -> f64 {
        self.flow.iter().sum()
    }

    /// Checks that the heat leaving the upper body enters the lower one. The arguments are sums
    /// over the elements [W/m²]: the shares of the friction heat, and the total heat that entered
    /// each body.
    ///
    /// The energy audit of a run compares the friction heat alone. This can be an arbitrarily small
    /// part of the exchanged heat between bodies with different initial temperatures.
    ///
    /// # Errors
    /// An imbalance larger than the rounding error of the exchanged flux.
    pub(super) fn audit(&self, shares: [f64; 2], heat: [f64; 2]) -> Result<(), StepError> {
        let lost = shares[UPPER] + shares[LOWER] - heat[UPPER] - heat[LOWER];
        let scale = shares.iter().chain(&self.flow).map(|flux| flux.abs()).sum::<f64>();
        if lost.abs() <= ROUNDING * scale {
            return Ok(());
        }
        Err(StepError::NoSolution(format!(
            "of {scale:e} W/m2 that flow between the surfaces {lost:e} W/m2 are lost"
        )))
    }

    /// Iterates the exchanged flux until the surface temperatures of the elements in contact differ
    /// by the drop over the resistances. Returns the operation count.
    pub(super) fn settle(
        &mut self,
        grid: &Structured,
        rub: &InterfaceLoad<'_>,
        bodies: &mut dyn HeatedBodies,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<u64, StepError> {
        self.touching.find(rub.pressure.unwrap_or(&[]), grid.ni);
        self.resist(rub.pressure);
        for values in [&mut self.flows, &mut self.correction, &mut self.errors] {
            values.clear();
            values.resize(self.touching.shapes(), 0.0);
        }
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let friction = largest(rub.flux);
        let mut work = 0;
        for corrections in 0..=MOST_CORRECTIONS {
            self.touching.spread(&self.flows, &mut self.flow);
            let flow = Flow { elements: self.touching.elements(), values: &self.flow };
            work += bodies.warm(flow, rise)?;
            let warmest = rise.iter().map(|rise| largest(rise)).fold(0.0, f64::max);
            let flows = friction.max(largest(&self.flow));
            // Without a flux the response of the surfaces is unknown: the error counts in full.
            let warmth = if flows > 0.0 { warmest / flows } else { f64::MAX };
            let error = self.judge(rise, warmth.min(f64::MAX));
            if error <= SETTLED * warmest {
                return Ok(work);
            }
            if corrections < MOST_CORRECTIONS {
                work += self.correct(grid, bodies) * rub.flux.len() as u64;
            }
        }
        Err(StepError::NoSolution(format!(
            "the heat that flows between the surfaces did not converge in {MOST_CORRECTIONS} \
             corrections; write another effects.friction_heat.partition, effects.contact_conductance or thermal.resolution"
        )))
    }

    /// Computes the resistances of the elements in contact.
    fn resist(&mut self, pressure: Option<&[f64]>) {
        let Self { law, touching, resistances, .. } = self;
        let elements = touching.elements().iter();
        resistances.clear();
        match law.as_ref().zip(pressure) {
            None => resistances.extend(elements.map(|_| 0.0)),
            Some((law, pressure)) => {
                let largest = pressure.iter().copied().fold(0.0, f64::max);
                resistances.extend(elements.map(|at| law.resistance(pressure[*at], largest)));
            }
        }
        let least = resistances.iter().copied().fold(f64::INFINITY, f64::min);
        self.least = if least.is_finite() { least } else { 0.0 };
    }

    /// Evaluates the errors T_u − T_l − g/h [K] of the temperatures, not of the rises. Returns the
    /// largest temperature error that they cause; `warmth` [m²·K/W] is the rise of a surface per
    /// flux into it.
    fn judge(&mut self, rise: &[Vec<f64>; 2], warmth: f64) -> f64 {
        let Self { touching, flow, differences, resistances, errors, offset, .. } = self;
        let flows = touching.elements().iter().zip(flow.iter().zip(&*resistances));
        differences.clear();
        differences.extend(flows.map(|(at, (flow, resistance))| {
            *offset + rise[UPPER][*at] - rise[LOWER][*at] - resistance * flow
        }));
        touching.gather(differences, errors);
        for (difference, resistance) in differences.iter_mut().zip(&*resistances) {
            if *resistance > 0.0 {
                *difference *= warmth / (resistance + warmth);
            }
        }
        touching.gather(differences, &mut self.correction);
        self.correction.iter().fold(0.0_f64, |most, error| most.max(error.abs()))
    }

    /// Corrects the exchanged flux for the errors. Returns the number of operator products.
    fn correct(&mut self, grid: &Structured, bodies: &dyn HeatedBodies) -> u64 {
        let windows = bodies.windows();
        let plan = self.convolution.get_or_insert_with(|| convolution(grid));
        let least = self.least;
        let same = |known: &mut ([PastInterval; 2], Exchange)| {
            known.0 == windows && known.1.least() == least
        };
        let known = self.exchange.take_if(same).map(|(_, exchange)| exchange);
        let mut exchange = known.unwrap_or_else(|| {
            let influences = bodies.influences(plan);
            Exchange::new(grid, influences.each_ref().map(|one| &**one), self.least)
        });
        let contact = Resisting { touching: &self.touching, resistances: &self.resistances };
        let products = exchange.correct(plan, &contact, &self.errors, &mut self.correction);
        self.flows.iter_mut().zip(&self.correction).for_each(|(flow, more)| *flow += more);
        self.exchange = Some((windows, exchange));
        products as u64
    }
}

/// Runs `each` for the upper and the lower body, on two threads if there are two. Returns the sum
/// of both operation counts.
pub(super) fn both<B: Send>(
    threads: usize,
    bodies: &mut [B; 2],
    rise: &mut [Vec<f64>; 2],
    each: impl Fn(usize, &mut B, &mut [f64]) -> Result<u64, StepError> + Sync,
) -> Result<u64, StepError> {
    let ([upper, lower], [of_upper, of_lower]) = (bodies, rise);
    let (upper, lower) =
        team::both(threads, || each(UPPER, upper, of_upper), || each(LOWER, lower, of_lower));
    Ok(upper? + lower?)
}
