//! Heat exchange between the surfaces of two bodies in contact, found iteratively.
//!
//! A model computes its surface rises for a given exchanged flux. The corrections of that flux come
//! from half-spaces in the same windows ([`heat::moving_source::exchange`]). The half-spaces need
//! only resemble the bodies of the model, because the model itself evaluates the error after each
//! correction, and each correction learns from the earlier ones ([`numerics::secants`]).

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
use numerics::secants::Secants;
use numerics::team;
use numerics::vector::add_scaled;
use proto::grid::Structured;
use proto::model::StepError;
use proto::state::read_bytes;
use std::io::{self, Read, Write};
use std::sync::Arc;

/// Tolerance of the exchanged flux: largest temperature error over the highest rise.
const SETTLED: f64 = 1e-7;
/// Share of the exchanged flux that is attributed to rounding in sums.
const ROUNDING: f64 = 1e-10;
/// Smallest and largest area of contact that an element represents, in areas of an element.
const LEAST_AREA: f64 = 1e-2;
const MOST_AREA: f64 = 1.5;
/// Pressure of an element that represents the largest area, over that of the next one inside.
const JUMP: f64 = 0.868;
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
    /// Whether elements may have different conductances.
    varies: bool,
    /// Initial temperature of the upper body minus that of the lower one [K].
    offset: f64,
    /// Resistances 1/h of the elements in contact [m²·K/W].
    resistances: Vec<f64>,
    /// Smallest of the resistances [m²·K/W].
    least: f64,
    /// Areas of contact that the elements represent, over that of an element; 1 where their
    /// resistances contain it. Hats over elements of different resistance do not settle.
    areas: Vec<f64>,
    /// Exchanged flux through the areas of contact [W/m²].
    density: Vec<f64>,
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
    /// Steps of the coefficients in this window, and what they changed.
    secants: Secants,
    /// Step of these coefficients [W/m²].
    step: Vec<f64>,
    /// Exchanged flux at the elements in contact [W/m²].
    flow: Vec<f64>,
    /// Temperature errors at the elements in contact [K].
    differences: Vec<f64>,
    /// Elements in contact in the accepted state, ascending.
    pub(super) touched: Vec<usize>,
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
            varies: shapes == Shapes::Elements,
            offset: upper - lower,
            resistances: Vec::new(),
            least: 0.0,
            areas: Vec::new(),
            density: Vec::new(),
            exchange: None,
            convolution: None,
            touching: ContactBasis::new(shapes),
            flows: Vec::new(),
            correction: Vec::new(),
            errors: Vec::new(),
            secants: Secants::default(),
            step: Vec::new(),
            flow: Vec::new(),
            differences: Vec::new(),
            touched: Vec::new(),
        })
    }

    /// Accepts the contact of the last solve.
    pub(super) fn accept(&mut self) {
        self.touched.clear();
        self.touched.extend_from_slice(self.touching.elements());
    }

    /// Writes the elements in contact of the accepted state.
    ///
    /// # Errors
    /// Writing to `into` fails.
    pub(super) fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        into.write_all(&(self.touched.len() as u64).to_le_bytes())?;
        self.touched.iter().try_for_each(|at| into.write_all(&(*at as u64).to_le_bytes()))
    }

    /// Reads elements in contact that [`Interface::save`] wrote, on a grid of this many elements.
    ///
    /// # Errors
    /// Reading fails, or the elements are not ascending elements of the grid.
    pub(super) fn read(from: &mut dyn Read, points: usize) -> io::Result<Vec<usize>> {
        let mut number = || Ok::<_, io::Error>(u64::from_le_bytes(read_bytes(from)?) as usize);
        let count = number()?;
        let mut touched: Vec<usize> = Vec::with_capacity(count.min(points));
        for _ in 0..count {
            let at = number()?;
            if at >= points || touched.last().is_some_and(|last| *last >= at) {
                return Err(io::Error::other("the elements in contact are not those of the grid"));
            }
            touched.push(at);
        }
        Ok(touched)
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
        self.resist(grid.ni, rub.pressure);
        for values in [&mut self.flows, &mut self.correction, &mut self.errors, &mut self.step] {
            values.clear();
            values.resize(self.touching.shapes(), 0.0);
        }
        self.secants.clear();
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let friction = largest(rub.flux);
        let mut work = 0;
        for corrections in 0..=MOST_CORRECTIONS {
            self.touching.spread(&self.flows, &mut self.density);
            self.flow.clear();
            self.flow.extend(self.density.iter().zip(&self.areas).map(|(flux, area)| flux * area));
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
    fn resist(&mut self, columns: usize, pressure: Option<&[f64]>) {
        let Self { law, varies, touching, resistances, areas, .. } = self;
        let elements = touching.elements().iter();
        resistances.clear();
        areas.clear();
        areas.resize(elements.len(), 1.0);
        match law.as_ref().zip(pressure) {
            None => resistances.extend(elements.map(|_| 0.0)),
            Some((law, pressure)) => {
                let largest = pressure.iter().copied().fold(0.0, f64::max);
                // The mean of a conductance that grows with the pressure contains the area.
                if law.hardness.is_none() {
                    let of_elements = areas.iter_mut().zip(elements.clone());
                    of_elements
                        .for_each(|(area, at)| *area = touching_area(pressure, columns, *at));
                }
                resistances.extend(elements.map(|at| law.resistance(pressure[*at], largest)));
                if *varies {
                    let pairs = resistances.iter_mut().zip(&mut *areas);
                    pairs
                        .for_each(|(resistance, area)| *resistance /= std::mem::replace(area, 1.0));
                }
            }
        }
        let least = resistances.iter().copied().fold(f64::INFINITY, f64::min);
        self.least = if least.is_finite() { least } else { 0.0 };
    }

    /// Evaluates the errors T_u − T_l − g/h [K] of the temperatures, not of the rises. Returns the
    /// largest temperature error that they cause; `warmth` [m²·K/W] is the rise of a surface per
    /// flux into it.
    fn judge(&mut self, rise: &[Vec<f64>; 2], warmth: f64) -> f64 {
        let Self { touching, density, differences, resistances, errors, offset, .. } = self;
        let flows = touching.elements().iter().zip(density.iter().zip(&*resistances));
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
        self.secants.step(&mut self.errors, &mut self.step);
        let products = exchange.correct(plan, &contact, &self.errors, &mut self.correction);
        add_scaled(&mut self.step, &self.correction, 1.0);
        self.secants.took(&self.step);
        add_scaled(&mut self.flows, &self.step, 1.0);
        self.exchange = Some((windows, exchange));
        products as u64
    }
}

/// Returns the area of contact that an element represents, over the area of an element.
///
/// At the edge of the contact of smooth bodies the pressure rises with the root of the distance
/// from the edge. Its mean over an element of which the share φ is in contact is then
/// φ^1.5/((1 + φ)^1.5 − φ^1.5) of that over the next element inside. If pressures are those of the
/// middles of elements, an element also represents up to half of the next one outside. At an edge
/// where the pressure jumps, both pressures are equal and the element touches wholly.
fn touching_area(pressure: &[f64], columns: usize, at: usize) -> f64 {
    let (row, column) = (at / columns, at % columns);
    let along = [column.checked_sub(1).map(|_| at - 1), (column + 1 < columns).then_some(at + 1)];
    let across = [row.checked_sub(1).map(|_| at - columns), Some(at + columns)];
    let neighbours = || along.into_iter().chain(across).flatten();
    let pressures = || neighbours().filter_map(|at| pressure.get(at).copied());
    let (inside, own) = (pressures().fold(0.0, f64::max), pressure[at]);
    let is_inner = pressures().all(|pressure| pressure > 0.0);
    if is_inner || own <= 0.0 || inside <= 0.0 {
        return 1.0;
    }
    let over = own / inside;
    if over > JUMP {
        return (MOST_AREA - (MOST_AREA - 1.0) * (over - JUMP) / (1.0 - JUMP)).max(1.0);
    }
    ((1.0 + 1.0 / over).powf(2.0 / 3.0) - 1.0).recip().max(LEAST_AREA)
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The area of a Hertz ellipse from the pressures of its elements, means or values at their
    /// middles, on any place of the grid. Counting elements has an error of up to 14 % at a/10.
    #[test]
    fn elements_at_the_edge_touch_in_part() {
        let (columns, rows, b) = (28, 23, 0.75);
        let side = 0.1;
        for (shift, points) in
            [([0.0, 0.0], 16), ([0.03, 0.01], 16), ([0.05, 0.05], 16), ([0.03, 0.01], 1)]
        {
            let place = |index: usize, count: usize, shift: f64, point: usize| {
                let within = (point as f64 + 0.5) / points as f64 - 0.5;
                (index as f64 - 0.5 * (count - 1) as f64 + within) * side + shift
            };
            let mean = |at: usize| {
                let value = |k: usize| {
                    let x = place(at % columns, columns, shift[0], k % points);
                    let y = place(at / columns, rows, shift[1], k / points) / b;
                    (1.0 - x * x - y * y).max(0.0).sqrt()
                };
                let all = points * points;
                (0..all).map(value).sum::<f64>() / all as f64
            };
            let pressure: Vec<f64> = (0..columns * rows).map(mean).collect();
            let touching = (0..columns * rows).filter(|at| pressure[*at] > 0.0);
            let areas = touching.map(|at| touching_area(&pressure, columns, at));
            let error = side * side * areas.sum::<f64>() / (PI * b) - 1.0;
            println!("{shift:?}, {points}: {:.2} %", 1e2 * error);
            assert!(error.abs() < 0.015, "{shift:?} {points}: {error}");
        }
        // An edge with a jump of the pressure, and a contact of one element.
        assert_eq!(touching_area(&[0.0, 1.0, 1.0, 1.0], 4, 1), 1.0);
        assert_eq!(touching_area(&[0.0, 1.0, 0.0, 0.0], 4, 1), 1.0);
    }
}
