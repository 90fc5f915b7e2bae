//! What flows between the surfaces of two bodies where they touch, found by corrections.
//!
//! A model says what its surfaces become under what flows; the corrections come from half-spaces in the same
//! windows ([`heat::moving_source::exchange`]), which another model need only resemble: what each correction
//! leaves is measured by the model itself.

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

/// Difference of the temperatures, over the highest, at which what flows between the surfaces is found.
const SETTLED: f64 = 1e-7;
/// Part of what flows between the surfaces that is rounding of sums.
const ROUNDING: f64 = 1e-10;
/// Corrections of it at most.
const MOST_CORRECTIONS: usize = 40;

/// What flows from the upper into the lower body besides their shares of the friction heat.
#[derive(Clone, Copy, Default)]
pub(super) struct Flow<'a> {
    elements: &'a [usize],
    /// Element means [W/m²].
    values: &'a [f64],
}

impl Flow<'_> {
    /// Adds it to the flux into a body.
    pub(super) fn add(&self, body: usize, flux: &mut Flux) {
        let factor = if body == UPPER { -1.0 } else { 1.0 };
        flux.add(self.elements, self.values, factor);
    }
}

/// The bodies of a model, as their interface sees them.
pub(super) trait HeatedBodies {
    /// Surfaces under the bodies' shares of the friction heat and what flows between them; the work.
    fn warm(&mut self, flow: Flow, rise: &mut [Vec<f64>; 2]) -> Result<u64, StepError>;

    /// Half-spaces that resemble the bodies in the newest window.
    fn windows(&self) -> [PastInterval; 2];

    /// Their influences.
    fn influences(&self, convolution: &mut Convolution) -> [Arc<Influence>; 2];
}

/// The interface.
pub(super) struct Interface {
    /// Conductance between the surfaces; without a law they have one temperature.
    law: Option<Conductance>,
    /// By how much the upper body is warmer than the lower one to begin with [K].
    offset: f64,
    /// Resistances 1/h of the elements that touch, and the smallest [m²·K/W].
    resistances: Vec<f64>,
    least: f64,
    /// The operator, with the windows that it is for.
    exchange: Option<([PastInterval; 2], Exchange)>,
    convolution: Option<Convolution>,
    touching: ContactBasis,
    /// What flows, in the shapes where the surfaces touch [W/m²], its correction, and the errors [K].
    flows: Vec<f64>,
    correction: Vec<f64>,
    errors: Vec<f64>,
    /// What flows at the elements that touch [W/m²], and the errors there [K].
    flow: Vec<f64>,
    differences: Vec<f64>,
}

impl Interface {
    /// Of a case in which heat flows between the surfaces, in these shapes.
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

    /// What flows from the upper into the lower body, besides their shares of the friction heat, summed over the elements [W/m²].
    pub(super) fn flow(&self) -> f64 {
        self.flow.iter().sum()
    }

    /// Checks that what has left the upper body has come into the lower one: of sums over the elements of the bodies'
    /// shares of the friction heat, and of all the heat that went into them [W/m²].
    ///
    /// The energy audit of a run compares the friction heat alone, which may be any small part of what flows between
    /// bodies that are not equally warm to begin with.
    ///
    /// # Errors
    /// Heat is lost or made, by more than rounding of what flows.
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

    /// Lets heat flow between the elements that touch until the temperatures of the surfaces
    /// differ by what the resistances ask for; the work.
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
            // Before anything flows nothing is known of how warm a surface becomes: all of the error is left.
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
            "the heat that flows between the surfaces was not found in {MOST_CORRECTIONS} \
             corrections; write another effects.friction_heat.partition, effects.contact_conductance or thermal.resolution"
        )))
    }

    /// Resistances of the elements that touch.
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

    /// The errors T_u − T_l − g/h, of temperatures and not of rises [K]; the largest of what they leave in the temperatures, where a surface becomes `warmth`
    /// [m²·K/W] warmer with what flows into it.
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

    /// Makes a correction of the errors; the products that it took.
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

/// Does something to both bodies, upper and lower, on a thread each if there are two; the work of both.
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
