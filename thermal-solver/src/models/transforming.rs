//! Phase transformation in time ([`crate::effects::phase_transformation`]): follows the material
//! points of a body as they pass through the grid.
//!
//! Temperatures are rises above the initial one, also in the criterion. Each row has one material
//! point per element. The points move towards −x. Points leaving the grid are added to the totals
//! and dropped; new points enter at the initial temperature.
//!
//! Within a window the points move in steps of one element at most. The rises are linear in time
//! between the ends of the window, and linear along x between the element centres. The rates of a
//! point are those of the step in which it passes the start temperature. A point that leaves the
//! grid hot cools as T ~ 1/√t. In a stationary body the points stay at the element centres.
//!
//! The layer of a row is as long as its points that are or were austenite, without those that
//! cooled too slowly. Its depth is the largest at which a row with austenite exceeded the
//! temperature at which its surface transforms.

use super::white_layer::{HALVINGS, later};
use crate::effects::phase_transformation::Criterion;
use proto::grid::Structured;
use proto::state::{read_numbers, write_numbers};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// Depth, in units of √(κt), beyond which no heat has penetrated: the rise there is below 1e-8 of
/// that of the surface.
const REACH: f64 = 8.0;

/// Transformation state of a material point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Steel {
    /// Initial state, or transformed back by slow cooling.
    #[default]
    Pearlite,
    /// Above the start temperature but not transformed; heated through it at this rate [K/s].
    Heated(f64),
    /// Transformed to austenite; heated through the start temperature at this rate [K/s].
    Austenite(f64),
    /// Quenched austenite.
    Martensite,
}

impl Steel {
    /// Updates the state as the rise changes from one value to another [K] in some time [s].
    /// Returns the rate at which austenite cooled through the start temperature, if it did.
    fn follow(&mut self, rises: [f64; 2], time: f64, criterion: &Criterion) -> Option<f64> {
        let [before, now] = rises;
        let rate = (now - before) / time;
        if now < criterion.start {
            let austenite = matches!(self, Self::Austenite(_));
            *self = match self {
                Self::Austenite(_) if -rate >= criterion.critical_rate => Self::Martensite,
                Self::Martensite => Self::Martensite,
                _ => Self::Pearlite,
            };
            return austenite.then_some(-rate);
        }
        let heating = match self {
            Self::Austenite(_) => return None,
            Self::Heated(rate) => *rate,
            // A point that enters the grid hot has no known heating rate.
            _ if before < criterion.start => rate,
            _ => 0.0,
        };
        *self = match now >= criterion.temperature(heating) {
            true => Self::Austenite(heating),
            false => Self::Heated(heating),
        };
        None
    }

    /// Returns the heating rate of a point that is hot [K/s].
    fn heating(self) -> Option<f64> {
        match self {
            Self::Heated(rate) | Self::Austenite(rate) => Some(rate),
            _ => None,
        }
    }

    fn numbers(self) -> [f64; 2] {
        match self {
            Self::Pearlite => [0.0, 0.0],
            Self::Heated(rate) => [1.0, rate],
            Self::Austenite(rate) => [2.0, rate],
            Self::Martensite => [3.0, 0.0],
        }
    }

    fn from_numbers([kind, rate]: [f64; 2]) -> Self {
        match kind {
            1.0 => Self::Heated(rate),
            2.0 => Self::Austenite(rate),
            3.0 => Self::Martensite,
            _ => Self::Pearlite,
        }
    }
}

/// A row of material points.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    /// Points from the trailing to the leading end of the grid.
    places: Vec<Steel>,
    /// Number of points of the layer that have left the grid.
    gone: f64,
    /// Largest depth that exceeded the transformation temperature [m].
    depth: f64,
}

impl Row {
    fn count(&self, which: impl Fn(&Steel) -> bool) -> f64 {
        self.places.iter().filter(|place| which(place)).count() as f64
    }

    fn austenite(&self) -> f64 {
        self.count(|place| matches!(place, Steel::Austenite(_)))
    }

    fn layer(&self) -> f64 {
        self.gone + self.austenite() + self.count(|place| *place == Steel::Martensite)
    }

    fn is_idle(&self) -> bool {
        self.places.iter().all(|place| *place == Steel::Pearlite)
    }
}

/// Rises of a body at both ends of a window, and the motion of its material.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window<'a> {
    /// Rises of the elements at the start and the end of the window [K].
    pub(super) rises: [&'a [f64]; 2],
    /// Duration of the window [s].
    pub(super) duration: f64,
    /// Speed of the material, towards −x [m/s].
    pub(super) speed: f64,
    /// Diffusivity of the material [m²/s].
    pub(super) diffusivity: f64,
}

/// Transformed layer of a body, followed in time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Transforming {
    columns: usize,
    /// Length and width of an element [m].
    sides: [f64; 2],
    rows: Vec<Row>,
    /// Time since the start [s].
    elapsed: f64,
    /// Offset of the points ahead of their element centres, in elements.
    ahead: f64,
    /// Highest rise minus the start temperature [K]; reported as long as no point has exceeded that
    /// temperature.
    below: f64,
    /// Largest excess of a rise over the transformation temperature [K].
    margin: f64,
    /// Heating rate at the point of that excess [K/s].
    heating: f64,
    /// Slowest rate at which austenite cooled through the start temperature [K/s].
    cooling: f64,
}

impl Transforming {
    /// Creates the state before the first window.
    pub(super) fn new(grid: &Structured) -> Self {
        let row = Row { places: vec![Steel::default(); grid.ni], gone: 0.0, depth: 0.0 };
        Self {
            columns: grid.ni,
            sides: [grid.dx(), grid.dy()],
            rows: vec![row; grid.nj],
            elapsed: 0.0,
            ahead: 0.0,
            below: f64::NEG_INFINITY,
            margin: f64::NEG_INFINITY,
            heating: 0.0,
            cooling: f64::INFINITY,
        }
    }

    /// Follows the material through a window. `highest(row, depth)` returns the highest rise [K] of
    /// a row at a depth [m] at the end of the window.
    pub(super) fn follow(
        &mut self,
        window: &Window<'_>,
        criterion: &Criterion,
        mut highest: impl FnMut(usize, f64) -> f64,
    ) {
        let way = window.speed * window.duration / self.sides[0];
        let steps = way.ceil().max(1.0);
        self.elapsed += window.duration;
        let deepest = REACH * (window.diffusivity * self.elapsed).sqrt();
        for row in 0..self.rows.len() {
            self.follow_row(row, window, (way, steps), criterion);
            self.deepen(row, criterion, deepest, &mut highest);
        }
        self.ahead = (0..steps as usize).fold(self.ahead, |ahead, _| stepped(ahead, way / steps).0);
    }

    fn follow_row(
        &mut self,
        row: usize,
        window: &Window<'_>,
        (way, steps): (f64, f64),
        criterion: &Criterion,
    ) {
        let Self { columns, rows, below, margin, heating, cooling, .. } = self;
        let mut ahead = self.ahead;
        let of_row = window.rises.map(|rises| &rises[row * *columns..(row + 1) * *columns]);
        let largest = of_row.map(|rises| rises.iter().copied().fold(0.0, f64::max));
        *below = below.max(largest[1] - criterion.start);
        let row = &mut rows[row];
        if row.is_idle() && largest.iter().all(|largest| *largest < criterion.start) {
            // Nothing can transform: all points are pearlite and stay below the start temperature.
            return;
        }
        let time = window.duration / steps;
        for step in 0..steps as usize {
            let share = [step as f64 / steps, (step + 1) as f64 / steps];
            let (next, leaves) = stepped(ahead, way / steps);
            let at = |share: f64, place: f64| {
                (1.0 - share) * between(of_row[0], place) + share * between(of_row[1], place)
            };
            for (index, place) in row.places.iter_mut().enumerate() {
                let here = index as f64;
                let there = here + next - if leaves { 1.0 } else { 0.0 };
                let rises = [at(share[0], here + ahead), at(share[1], there)];
                if let Some(rate) = place.follow(rises, time, criterion) {
                    *cooling = cooling.min(rate);
                }
                if let Some(rate) = place.heating() {
                    let above = rises[1] - criterion.temperature(rate);
                    if above > *margin {
                        (*margin, *heating) = (above, rate);
                    }
                }
                if leaves && index == 0 {
                    row.gone += gone(place, rises, time, criterion, cooling);
                }
            }
            if leaves {
                row.places.rotate_left(1);
                row.places[*columns - 1] = Steel::default();
            }
            ahead = next;
        }
    }

    /// Updates the depth of the layer of a row.
    fn deepen(
        &mut self,
        row: usize,
        criterion: &Criterion,
        deepest: f64,
        highest: &mut impl FnMut(usize, f64) -> f64,
    ) {
        let Row { places, depth, .. } = &mut self.rows[row];
        let rates = places.iter().filter_map(|place| match place {
            Steel::Austenite(rate) => Some(*rate),
            _ => None,
        });
        let Some(rate) = rates.reduce(f64::min) else { return };
        let needed = criterion.temperature(rate);
        if highest(row, *depth) < needed {
            return;
        }
        let (mut inside, mut outside) = (*depth, deepest);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            match highest(row, middle) >= needed {
                true => inside = middle,
                false => outside = middle,
            }
        }
        *depth = inside;
    }

    /// Returns the figures of the summary. Rates that do not occur are omitted.
    pub(super) fn figures(&self) -> Value {
        let [length, width] = self.sides;
        let most = |of: fn(&Row) -> f64| self.rows.iter().map(of).fold(0.0, f64::max);
        let transformed = || self.rows.iter().filter(|row| row.layer() > 0.0);
        let mut figures = json!({
            "depth_m": transformed().map(|row| row.depth).fold(0.0, f64::max),
            "width_m": transformed().count() as f64 * width,
            "length_m": most(Row::layer) * length,
            "hot_length_m": most(Row::austenite) * length,
            "temperature_margin_k": if self.margin.is_finite() { self.margin } else { self.below },
        });
        let rates =
            [("heating_rate_k_per_s", self.heating), ("cooling_rate_k_per_s", self.cooling)];
        for (name, rate) in rates.into_iter().filter(|(_, rate)| *rate > 0.0 && rate.is_finite()) {
            figures[name] = json!(rate);
        }
        figures
    }

    /// Writes the state.
    ///
    /// # Errors
    /// A failure to write to `into`.
    pub(super) fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(
            into,
            [&self.elapsed, &self.ahead, &self.below, &self.margin, &self.heating, &self.cooling],
        )?;
        for row in &self.rows {
            write_numbers(into, [&row.gone, &row.depth])?;
            write_numbers(
                into,
                &row.places.iter().flat_map(|place| place.numbers()).collect::<Vec<_>>(),
            )?;
        }
        Ok(())
    }

    /// Reads a state that [`Transforming::save`] wrote for the same grid.
    ///
    /// # Errors
    /// Data that end too early, or a failure to read them.
    pub(super) fn restored(&self, from: &mut dyn Read) -> io::Result<Self> {
        let mut own = self.clone();
        read_numbers(
            from,
            [
                &mut own.elapsed,
                &mut own.ahead,
                &mut own.below,
                &mut own.margin,
                &mut own.heating,
                &mut own.cooling,
            ],
        )?;
        for row in &mut own.rows {
            read_numbers(from, [&mut row.gone, &mut row.depth])?;
            for place in &mut row.places {
                let mut numbers = [0.0; 2];
                read_numbers(from, &mut numbers)?;
                *place = Steel::from_numbers(numbers);
            }
        }
        Ok(own)
    }
}

/// Returns the offset of the points after a step of at most one element, and whether the first
/// point has left the grid.
fn stepped(ahead: f64, way: f64) -> (f64, bool) {
    let left = ahead - way;
    if left < 0.0 { (left + 1.0, true) } else { (left, false) }
}

/// Interpolates linearly between the element centres, at a position in elements. Beyond the last
/// centre its value holds; before the first one the line through the first two is extended.
fn between(values: &[f64], at: f64) -> f64 {
    let at = at.min((values.len() - 1) as f64);
    let low = (at.max(0.0) as usize).min(values.len().saturating_sub(2));
    let high = (low + 1).min(values.len() - 1);
    let share = at - low as f64;
    (1.0 - share) * values[low] + share * values[high]
}

/// Returns 1 if a point that leaves the grid belongs to the layer, otherwise 0.
fn gone(
    place: &Steel,
    rises: [f64; 2],
    time: f64,
    criterion: &Criterion,
    cooling: &mut f64,
) -> f64 {
    match place {
        Steel::Martensite => 1.0,
        Steel::Austenite(_) => {
            let rate = later(&[rises[1], rises[0]], time, criterion.start);
            *cooling = cooling.min(rate);
            f64::from(u8::from(rate >= criterion.critical_rate))
        }
        _ => 0.0,
    }
}
