//! What flows between the surfaces of two bodies where friction heats them, found by corrections.
//!
//! A model says what its surfaces become under what flows; the corrections come from half-spaces in the same
//! windows ([`crate::moving_source::exchange`]), which another model need only resemble: what each correction
//! leaves is measured by the model itself.

use crate::moving_source::ages::Stretch;
use crate::moving_source::exchange::Exchange;
use crate::moving_source::half_space::{Influence, convolution};
use crate::{LOWER, UPPER};
use numerics::convolution::Convolution;
use proto::grid::Structured;
use proto::model::StepError;
use std::sync::Arc;

/// Difference of the temperatures, over the highest, at which what flows between the surfaces is found.
const SETTLED: f64 = 1e-7;
/// Corrections of it at most.
const MOST_CORRECTIONS: usize = 40;

/// The bodies of a model, as their interface sees them.
pub(super) trait Rubbing {
    /// Element means of the flux into the upper and the lower body [W/m²].
    fn means(&mut self) -> [&mut [f64]; 2];

    /// Surfaces under the flux means; the work.
    fn warm(&mut self, rise: &mut [Vec<f64>; 2]) -> Result<u64, StepError>;

    /// Half-spaces that resemble the bodies in the newest window.
    fn windows(&self) -> [Stretch; 2];

    /// Their influences.
    fn influences(&self, convolution: &mut Convolution) -> [Arc<Influence>; 2];
}

/// The interface.
#[derive(Default)]
pub(super) struct Interface {
    /// The operator, with the windows that it is for.
    exchange: Option<([Stretch; 2], Exchange)>,
    convolution: Option<Convolution>,
    touching: Vec<usize>,
    flows: Vec<f64>,
    errors: Vec<f64>,
    correction: Vec<f64>,
}

impl Interface {
    /// Lets heat flow between the elements that rub under a flux until the temperatures of the surfaces
    /// differ by what the resistance [m²·K/W] asks for; the work.
    pub(super) fn settle(
        &mut self,
        grid: &Structured,
        resistance: f64,
        flux: &[f64],
        bodies: &mut dyn Rubbing,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<u64, StepError> {
        self.touch(flux, grid.ni);
        let mut work = 0;
        for _ in 0..MOST_CORRECTIONS {
            let largest = self.judge(resistance, rise);
            let warmest = rise.iter().flatten().fold(0.0_f64, |most, rise| most.max(rise.abs()));
            if largest <= SETTLED * warmest {
                return Ok(work);
            }
            work += self.correct(grid, resistance, bodies) * flux.len() as u64;
            let [upper, lower] = bodies.means();
            for (at, more) in self.touching.iter().zip(&self.correction) {
                upper[*at] -= more;
                lower[*at] += more;
            }
            work += bodies.warm(rise)?;
        }
        Err(StepError::NoSolution(format!(
            "the heat that flows between the surfaces was not found in {MOST_CORRECTIONS} \
             corrections; write another effects.friction_heat.partition or thermal.resolution"
        )))
    }

    /// Nothing flows yet between the elements where the surfaces rub: in every row from the first that is
    /// heated to the last.
    fn touch(&mut self, flux: &[f64], columns: usize) {
        self.touching.clear();
        for (row, values) in flux.chunks_exact(columns).enumerate() {
            let heated = |value: &f64| *value != 0.0;
            let ends = (values.iter().position(heated), values.iter().rposition(heated));
            if let (Some(first), Some(last)) = ends {
                self.touching.extend((first..=last).map(|i| row * columns + i));
            }
        }
        for values in [&mut self.flows, &mut self.correction] {
            values.clear();
            values.resize(self.touching.len(), 0.0);
        }
    }

    /// The errors T_u − T_l − g/h [K]; the largest.
    fn judge(&mut self, resistance: f64, rise: &[Vec<f64>; 2]) -> f64 {
        let error =
            |(at, flow): (&usize, &f64)| rise[UPPER][*at] - rise[LOWER][*at] - resistance * flow;
        self.errors.clear();
        self.errors.extend(self.touching.iter().zip(&self.flows).map(error));
        self.errors.iter().fold(0.0_f64, |most, error| most.max(error.abs()))
    }

    /// Makes a correction of the errors; the products that it took.
    fn correct(&mut self, grid: &Structured, resistance: f64, bodies: &dyn Rubbing) -> u64 {
        let windows = bodies.windows();
        let plan = self.convolution.get_or_insert_with(|| convolution(grid));
        let known = self.exchange.take_if(|(of, _)| *of == windows).map(|(_, exchange)| exchange);
        let mut exchange = known.unwrap_or_else(|| {
            let influences = bodies.influences(plan);
            Exchange::new(grid, influences.each_ref().map(|one| &**one), resistance)
        });
        let products = exchange.correct(plan, &self.touching, &self.errors, &mut self.correction);
        self.flows.iter_mut().zip(&self.correction).for_each(|(flow, more)| *flow += more);
        self.exchange = Some((windows, exchange));
        products as u64
    }
}

/// Does something to both bodies, on a thread each if there are two; the work of both.
pub(super) fn both<B: Send>(
    threads: usize,
    bodies: &mut [B; 2],
    rise: &mut [Vec<f64>; 2],
    each: impl Fn(&mut B, &mut [f64]) -> Result<u64, StepError> + Sync,
) -> Result<u64, StepError> {
    let ([upper, lower], [of_upper, of_lower]) = (bodies, rise);
    if threads < 2 {
        return Ok(each(upper, of_upper)? + each(lower, of_lower)?);
    }
    std::thread::scope(|scope| {
        let other = scope.spawn(|| each(lower, of_lower));
        let own = each(upper, of_upper);
        let others = other.join().expect("a body panics on this thread as on its own");
        Ok(own? + others?)
    })
}
