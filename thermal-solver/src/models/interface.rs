//! What flows between the surfaces of two bodies where friction heats them, found by corrections.
//!
//! A model says what its surfaces become under what flows; the corrections come from half-spaces in the same
//! windows ([`crate::moving_source::exchange`]), which another model need only resemble: what each correction
//! leaves is measured by the model itself.

use crate::columns::reconstruction::Flux;
use crate::effects::friction_heat::Partition;
use crate::moving_source::ages::Stretch;
use crate::moving_source::exchange::Exchange;
use crate::moving_source::half_space::{Influence, convolution};
use crate::moving_source::touching::{Shapes, Touching};
use crate::{LOWER, UPPER};
use numerics::convolution::Convolution;
use proto::grid::Structured;
use proto::model::StepError;
use std::sync::Arc;

/// Difference of the temperatures, over the highest, at which what flows between the surfaces is found.
const SETTLED: f64 = 1e-7;
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
pub(super) trait Rubbing {
    /// Surfaces under the bodies' shares of the friction heat and what flows between them; the work.
    fn warm(&mut self, flow: Flow, rise: &mut [Vec<f64>; 2]) -> Result<u64, StepError>;

    /// Half-spaces that resemble the bodies in the newest window.
    fn windows(&self) -> [Stretch; 2];

    /// Their influences.
    fn influences(&self, convolution: &mut Convolution) -> [Arc<Influence>; 2];
}

/// The interface.
pub(super) struct Interface {
    /// Resistance 1/h of the contact [m²·K/W].
    resistance: f64,
    /// The operator, with the windows that it is for.
    exchange: Option<([Stretch; 2], Exchange)>,
    convolution: Option<Convolution>,
    touching: Touching,
    /// What flows, in the shapes where the surfaces touch [W/m²], its correction, and the errors [K].
    flows: Vec<f64>,
    correction: Vec<f64>,
    errors: Vec<f64>,
    /// What flows at the elements that touch [W/m²], and the errors there [K].
    flow: Vec<f64>,
    differences: Vec<f64>,
}

impl Interface {
    /// Of a partition that lets heat flow between the surfaces, in these shapes.
    pub(super) fn of(partition: Partition, shapes: Shapes) -> Option<Self> {
        let resistance = partition.resistance()?;
        Some(Self {
            resistance,
            exchange: None,
            convolution: None,
            touching: Touching::new(shapes),
            flows: Vec::new(),
            correction: Vec::new(),
            errors: Vec::new(),
            flow: Vec::new(),
            differences: Vec::new(),
        })
    }

    /// Lets heat flow between the elements that rub under a flux until the temperatures of the surfaces
    /// differ by what the resistance asks for; the work.
    pub(super) fn settle(
        &mut self,
        grid: &Structured,
        flux: &[f64],
        bodies: &mut dyn Rubbing,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<u64, StepError> {
        self.touching.find(flux, grid.ni);
        for values in [&mut self.flows, &mut self.correction, &mut self.errors] {
            values.clear();
            values.resize(self.touching.shapes(), 0.0);
        }
        let mut work = 0;
        for corrections in 0..=MOST_CORRECTIONS {
            self.touching.spread(&self.flows, &mut self.flow);
            let flow = Flow { elements: self.touching.elements(), values: &self.flow };
            work += bodies.warm(flow, rise)?;
            let largest = self.judge(rise);
            let warmest = rise.iter().flatten().fold(0.0_f64, |most, rise| most.max(rise.abs()));
            if largest <= SETTLED * warmest {
                return Ok(work);
            }
            if corrections < MOST_CORRECTIONS {
                work += self.correct(grid, bodies) * flux.len() as u64;
            }
        }
        Err(StepError::NoSolution(format!(
            "the heat that flows between the surfaces was not found in {MOST_CORRECTIONS} \
             corrections; write another effects.friction_heat.partition or thermal.resolution"
        )))
    }

    /// The errors T_u − T_l − g/h [K]; the largest.
    fn judge(&mut self, rise: &[Vec<f64>; 2]) -> f64 {
        let resistance = self.resistance;
        let error =
            |(at, flow): (&usize, &f64)| rise[UPPER][*at] - rise[LOWER][*at] - resistance * flow;
        self.differences.clear();
        self.differences.extend(self.touching.elements().iter().zip(&self.flow).map(error));
        self.touching.gather(&self.differences, &mut self.errors);
        self.errors.iter().fold(0.0_f64, |most, error| most.max(error.abs()))
    }

    /// Makes a correction of the errors; the products that it took.
    fn correct(&mut self, grid: &Structured, bodies: &dyn Rubbing) -> u64 {
        let windows = bodies.windows();
        let plan = self.convolution.get_or_insert_with(|| convolution(grid));
        let known = self.exchange.take_if(|(of, _)| *of == windows).map(|(_, exchange)| exchange);
        let mut exchange = known.unwrap_or_else(|| {
            let influences = bodies.influences(plan);
            Exchange::new(grid, influences.each_ref().map(|one| &**one), self.resistance)
        });
        let products = exchange.correct(plan, &self.touching, &self.errors, &mut self.correction);
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
    if threads < 2 {
        return Ok(each(UPPER, upper, of_upper)? + each(LOWER, lower, of_lower)?);
    }
    std::thread::scope(|scope| {
        let other = scope.spawn(|| each(LOWER, lower, of_lower));
        let own = each(UPPER, upper, of_upper);
        let others = other.join().expect("a body panics on this thread as on its own");
        Ok(own? + others?)
    })
}
