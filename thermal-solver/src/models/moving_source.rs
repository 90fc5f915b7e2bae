//! Model `moving-source`: conduction in all directions into half-spaces under a moving flux, at any speed
//! down to rest, steady and transient. Equations and discretisation: [`crate::moving_source`].
//!
//! In time the flux of every window is held constant over it. What earlier windows leave is the sum of
//! their influences, each over its own ages; they are merged as they grow old ([`crate::columns::history`]),
//! and what they leave is kept while only the flux of the newest window changes.

use super::conduction::{Conduction, Cost, Work};
use super::fields::fields;
use super::frame::Frame;
use super::names;
use super::setup::{resolution, section_key};
use super::summary::Peak;
use crate::columns::convolution::remove_negative_rounding;
use crate::columns::history::History;
use crate::columns::reconstruction::Flux;
use crate::moving_source::ages::Stretch;
use crate::moving_source::exchange::Exchange;
use crate::moving_source::half_space::{Contracted, HalfSpace, Influence, convolution};
use crate::search::maximum;
use crate::window::{Drive, Stage};
use crate::{LOWER, UPPER};
use numerics::convolution::Convolution;
use proto::accuracy::{Accuracy, Simplification};
use proto::configuration::Mode;
use proto::description::ModelSpec;
use proto::grid::blocked_sum;
use proto::model::StepError;
use std::cell::RefCell;
use std::io::{self, Read, Write};
use std::rc::Rc;

/// Its description.
#[must_use]
pub fn spec() -> ModelSpec {
    let (consumes, provides) = fields();
    ModelSpec {
        name: names::MOVING_SOURCE.to_owned(),
        summary: "heat conduction in three dimensions into half-spaces, at any speed".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 10.4 and 10.7".to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        consumes,
        provides,
        keys: vec![resolution(), section_key()],
        accuracy: Accuracy { refinement: None, simplifications: vec![by_quadrature()] },
    }
}

/// All that is not exact besides the flux, whose grid is another's.
fn by_quadrature() -> Simplification {
    let source = "closed forms in the tests of moving_source (docs/theory/moving-source.md)";
    Simplification::always("ages and elements by Gauss's rule", 1e-9, source)
}

/// Time of a solve over the elements of the grid, both bodies, measured [s].
const SECONDS_PER_POINT: f64 = 4e-6;
/// Difference of the temperatures, over the highest, at which what flows between the surfaces is found.
const SETTLED: f64 = 1e-7;
/// Windows of the past in a transient case, about.
const WINDOWS: usize = 100;
/// Corrections of it at most.
const MOST_CORRECTIONS: usize = 40;
/// Memory over the elements of the grid: spectra and fields on padded grids [byte].
const BYTES_PER_POINT: u64 = 400;

/// A body: its past, and what the newest window does to its surface.
struct Body {
    history: History,
    /// Rises that earlier windows leave at the end of this one [K], and the window for which.
    past: Vec<f64>,
    past_of: Option<Stretch>,
    newest: Option<(Stretch, Rc<Influence>)>,
    /// Element means of the flux into it [W/m²].
    means: Vec<f64>,
}

/// The fluxes of a state into a body, contracted to a row, newest first; kept from one question to the
/// next.
struct Row {
    stage: Stage,
    body: usize,
    row: usize,
    windows: Vec<(HalfSpace, Contracted)>,
    /// The place asked for last [m], and what every age of every window adds there.
    place: Option<(f64, Vec<Vec<f64>>)>,
}

/// The model.
pub struct MovingSource {
    frame: Frame,
    convolution: Convolution,
    fields: [Vec<f64>; 3],
    line: Vec<f64>,
    bodies: [Body; 2],
    /// What flows between the surfaces, with the windows that it is for.
    exchange: Option<([Stretch; 2], Exchange)>,
    row: RefCell<Option<Row>>,
}

impl Conduction for MovingSource {
    const TRANSIENT: bool = true;
    const AT_REST: bool = true;
    const EXCHANGES: bool = true;
    const STATE_TAG: u8 = 3;

    fn new(frame: &Frame) -> Self {
        let (columns, rows) = (frame.grid.ni, frame.grid.nj);
        let body = |body: usize| Body {
            history: {
                let diffusivity = frame.scene.materials[body].diffusivity();
                History::new(columns, rows, frame.grid.dx(), diffusivity)
            },
            past: vec![0.0; columns * rows],
            past_of: None,
            newest: None,
            means: vec![0.0; columns * rows],
        };
        Self {
            frame: frame.clone(),
            convolution: convolution(&frame.grid),
            fields: Default::default(),
            line: vec![0.0; columns],
            bodies: [body(UPPER), body(LOWER)],
            exchange: None,
            row: RefCell::new(None),
        }
    }

    fn cost(frame: &Frame) -> Cost {
        let points = frame.grid.points();
        let windows = match frame.mode {
            Mode::Steady => 1,
            Mode::Transient => WINDOWS,
        };
        Cost {
            solve_seconds: (points * windows) as f64 * SECONDS_PER_POINT,
            memory_bytes: points as u64 * BYTES_PER_POINT
                + 2 * windows as u64 * Flux::bytes(frame.grid.ni, frame.grid.nj),
        }
    }

    fn remarks(_: &Frame) -> Vec<String> {
        Vec::new()
    }

    fn left_out(_: &Frame) -> Option<Simplification> {
        None
    }

    fn solve(
        &mut self,
        drive: &Drive,
        flux: &[f64],
        rise: &mut [Vec<f64>; 2],
    ) -> Result<Work, StepError> {
        let mut work = Work::default();
        self.row.get_mut().take_if(|row| row.stage == Stage::Trial);
        for body in 0..2 {
            work.operations += self.pass(body, drive);
            let share = drive.shares[body];
            let means = &mut self.bodies[body].means;
            means.iter_mut().zip(flux).for_each(|(mean, flux)| *mean = share * flux);
        }
        work.operations += self.warm(rise);
        if let Some(resistance) = self.frame.partition.resistance() {
            work.operations += self.settle(resistance, flux, rise)?;
        }
        for (body, (heat, rise)) in self.bodies.iter_mut().zip(work.heat.iter_mut().zip(rise)) {
            let window = body.history.trial_mut();
            window.heat = heat_of(&window.flux, &mut self.line);
            *heat = window.heat;
            if body.history.windows(Stage::Trial).all(|window| window.flux.is_heating()) {
                remove_negative_rounding(rise);
            }
        }
        Ok(work)
    }

    fn accept(&mut self) {
        for body in &mut self.bodies {
            body.history.accept();
            body.past_of = None;
        }
        // Older windows may have been merged.
        let same = self.frame.mode == Mode::Steady;
        let row = self.row.get_mut().take_if(|row| same && row.stage == Stage::Trial);
        *self.row.get_mut() = row.map(|row| Row { stage: Stage::Accepted, ..row });
    }

    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]) {
        rise.fill(0.0);
        self.on_row(stage, body, row, |row| {
            for (half_space, contracted) in &row.windows {
                half_space.section(contracted, depths, rise);
            }
        });
        if self.bodies[body].history.windows(stage).all(|window| window.flux.is_heating()) {
            remove_negative_rounding(rise);
        }
    }

    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let mut rise = 0.0;
        self.on_row(Stage::Accepted, body, row, |row| {
            let windows = &row.windows;
            let shares = || windows.iter().map(|(half_space, flux)| half_space.shares_at(flux, x));
            let (_, shares) = match row.place.take_if(|(at, _)| *at == x) {
                Some(place) => row.place.insert(place),
                None => row.place.insert((x, shares().collect())),
            };
            let of = |((half_space, _), shares): (&(HalfSpace, _), &Vec<f64>)| {
                half_space.rise_below(shares, depth)
            };
            rise = windows.iter().zip(shares.iter()).map(of).sum();
        });
        rise
    }

    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak> {
        let grid = &self.frame.grid;
        let hottest = (0..rise.len()).reduce(|a, b| if rise[b] > rise[a] { b } else { a })?;
        if rise[hottest] <= 0.0 {
            return None;
        }
        let (row, column) = (hottest / grid.ni, hottest % grid.ni);
        let low = grid.x(column.saturating_sub(1));
        let high = grid.x((column + 1).min(grid.ni - 1));
        let (x, rise) = maximum(low, high, |x| self.rise_at(body, row, x, 0.0));
        Some(Peak { rise, x, row })
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.bodies.iter().try_for_each(|body| body.history.save(into))
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.row.get_mut().take();
        for body in &mut self.bodies {
            body.history.restore(from)?;
            body.past_of = None;
        }
        Ok(())
    }
}

impl MovingSource {
    /// Rises of both surfaces under the element means of the newest window.
    fn warm(&mut self, rise: &mut [Vec<f64>; 2]) -> u64 {
        for (body, rise) in self.bodies.iter_mut().zip(rise.iter_mut()) {
            rise.copy_from_slice(&body.past);
            let window = body.history.trial_mut();
            window.flux.reconstruct(&body.means);
            if let Some((_, influence)) = &body.newest {
                influence.add(&window.flux, &mut self.convolution, &mut self.fields, rise);
            }
        }
        2 * rise[0].len() as u64
    }

    /// Finds what flows between the surfaces where friction heats them, until their temperatures differ by
    /// what the resistance asks for.
    fn settle(
        &mut self,
        resistance: f64,
        flux: &[f64],
        rise: &mut [Vec<f64>; 2],
    ) -> Result<u64, StepError> {
        let touching = touching(flux, self.frame.grid.ni);
        let mut flows = vec![0.0; touching.len()];
        let mut correction = flows.clone();
        let mut work = 0;
        for _ in 0..MOST_CORRECTIONS {
            let error = |(at, flow): (&usize, &f64)| {
                rise[UPPER][*at] - rise[LOWER][*at] - resistance * flow
            };
            let errors: Vec<f64> = touching.iter().zip(&flows).map(error).collect();
            let largest = errors.iter().fold(0.0_f64, |most, error| most.max(error.abs()));
            let warmest = rise.iter().flatten().fold(0.0_f64, |most, rise| most.max(rise.abs()));
            if largest <= SETTLED * warmest {
                return Ok(work);
            }
            self.pair(resistance);
            let Some((_, exchange)) = &mut self.exchange else { unreachable!("a pair is made") };
            let products =
                exchange.correct(&mut self.convolution, &touching, &errors, &mut correction);
            for ((at, flow), more) in touching.iter().zip(&mut flows).zip(&correction) {
                *flow += more;
                self.bodies[UPPER].means[*at] -= more;
                self.bodies[LOWER].means[*at] += more;
            }
            work += self.warm(rise) + (products * flux.len()) as u64;
        }
        Err(StepError::NoSolution(format!(
            "the heat that flows between the surfaces was not found in {MOST_CORRECTIONS} \
             corrections; write another effects.friction_heat.partition or thermal.resolution"
        )))
    }

    /// Makes the operator of what flows between the bodies in the newest window.
    fn pair(&mut self, resistance: f64) {
        let [Some((upper, of_upper)), Some((lower, of_lower))] =
            self.bodies.each_ref().map(|body| body.newest.as_ref())
        else {
            return;
        };
        let windows = [*upper, *lower];
        if self.exchange.as_ref().is_none_or(|(of, _)| *of != windows) {
            let exchange = Exchange::new(&self.frame.grid, [of_upper, of_lower], resistance);
            self.exchange = Some((windows, exchange));
        }
    }

    /// Lets a body pass in the newest window, and sums up what earlier ones leave; the work that it took.
    fn pass(&mut self, body: usize, drive: &Drive) -> u64 {
        let speed = drive.speeds[body];
        let stretch = Stretch { from: 0.0, to: drive.duration, way: 0.0, speed };
        let window = self.bodies[body].history.trial_mut();
        window.drive = Drive { duration: drive.duration, speeds: [speed; 2], shares: [1.0; 2] };
        let mut work = self.newest(body, stretch);
        if self.bodies[body].past_of == Some(stretch) {
            return work;
        }
        let material = &self.frame.scene.materials[body];
        let (diffusivity, effusivity) = (material.diffusivity(), material.effusivity());
        let Body { history, past, past_of, .. } = &mut self.bodies[body];
        past.fill(0.0);
        for (stretch, flux) in stretches(history, Stage::Trial).skip(1) {
            let half_space = HalfSpace::new(&self.frame.grid, diffusivity, effusivity, stretch);
            let influence = half_space.influence(&mut self.convolution);
            influence.add(flux, &mut self.convolution, &mut self.fields, past);
            work += influence.work() + past.len() as u64;
        }
        *past_of = Some(stretch);
        work
    }

    /// Makes the influence of the newest window, unless it is known, from the other body if it must be.
    fn newest(&mut self, body: usize, stretch: Stretch) -> u64 {
        let materials = &self.frame.scene.materials;
        let known = |body: &Body| match &body.newest {
            Some((of, influence)) if *of == stretch => Some(Rc::clone(influence)),
            _ => None,
        };
        let other = 1 - body;
        let alike = materials[body] == materials[other];
        let found =
            known(&self.bodies[body]).or_else(|| known(&self.bodies[other]).filter(|_| alike));
        let (influence, work) = match found {
            Some(influence) => (influence, 0),
            None => {
                let (grid, material) = (&self.frame.grid, &materials[body]);
                let (diffusivity, effusivity) = (material.diffusivity(), material.effusivity());
                let half_space = HalfSpace::new(grid, diffusivity, effusivity, stretch);
                let influence = half_space.influence(&mut self.convolution);
                let work = influence.work();
                (Rc::new(influence), work)
            }
        };
        self.bodies[body].newest = Some((stretch, influence));
        work
    }

    /// Asks about a row of a body, whose contracted fluxes are kept.
    fn on_row(&self, stage: Stage, body: usize, row: usize, ask: impl FnOnce(&mut Row)) {
        let mut kept = self.row.borrow_mut();
        let kept = match &mut *kept {
            Some(kept) if (kept.stage, kept.body, kept.row) == (stage, body, row) => kept,
            other => {
                let material = &self.frame.scene.materials[body];
                let (diffusivity, effusivity) = (material.diffusivity(), material.effusivity());
                let contracted = |(stretch, flux): (Stretch, &Flux)| {
                    let grid = &self.frame.grid;
                    let half_space = HalfSpace::new(grid, diffusivity, effusivity, stretch);
                    let contracted = half_space.contract(flux, row);
                    (half_space, contracted)
                };
                let windows =
                    stretches(&self.bodies[body].history, stage).map(contracted).collect();
                other.insert(Row { stage, body, row, windows, place: None })
            }
        };
        ask(kept);
    }
}

/// The windows of a state as stretches of the past, newest first, with their fluxes.
fn stretches(history: &History, stage: Stage) -> impl Iterator<Item = (Stretch, &Flux)> {
    let newest = Stretch { from: 0.0, to: 0.0, way: 0.0, speed: 0.0 };
    history.windows(stage).scan(newest, |before, window| {
        let (from, way) = (before.to, before.way_at(before.to));
        let (to, speed) = (from + window.drive.duration, window.drive.speeds[0]);
        *before = Stretch { from, to, way, speed };
        Some((*before, &window.flux))
    })
}

/// The elements where the surfaces rub: in every row from the first that is heated to the last.
fn touching(flux: &[f64], columns: usize) -> Vec<usize> {
    let mut touching = Vec::new();
    for (row, values) in flux.chunks_exact(columns).enumerate() {
        let heated = |value: &f64| *value != 0.0;
        let (Some(first), Some(last)) =
            (values.iter().position(heated), values.iter().rposition(heated))
        else {
            continue;
        };
        touching.extend((first..=last).map(|i| row * columns + i));
    }
    touching
}

/// Sum of the element means of a flux as it is convolved [W/m²].
fn heat_of(flux: &Flux, line: &mut [f64]) -> f64 {
    let sums: Vec<f64> = (0..flux.rows())
        .map(|row| {
            flux.means_into(row, line);
            blocked_sum(line)
        })
        .collect();
    blocked_sum(&sums)
}
